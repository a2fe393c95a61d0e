"""What of a file was not understood: kept as it is, so that writing the file again loses nothing."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import h5py
import h5py.h5a
import h5py.h5d
import h5py.h5g
import h5py.h5o
import h5py.h5p
import h5py.h5r
import h5py.h5s
import h5py.h5t
import numpy as np

from ..errors import InputError

Kind = Literal["dataset", "attribute", "group", "soft link", "hard link", "type"]


@dataclass(frozen=True, eq=False)
class AxfExtra:
    """One node that was not understood.

    Attributes:
        parts: the names from the material's group (or the file's root) to it; an attribute's own name comes last.
        kind: what it is. A group stands here only when it is empty.
        type: HDF5's own encoding of its data type, which holds every detail (compound, enumeration, opaque, …).
        shape: its extent; () for a scalar, None for an empty data space.
        content: the bytes as they are stored, or where HDF5 stores only pointers (texts and lists of any length) an
            array of objects, or for object references and links the paths they lead to ("" leads nowhere).
    """

    parts: tuple[str, ...]
    kind: Kind
    type: bytes = b""
    shape: tuple[int, ...] | None = ()
    content: bytes | np.ndarray | tuple[str, ...] = b""

    @property
    def path(self) -> str:
        """The path below the material (or the root): `group/dataset`, or `group@attribute`."""
        if self.kind == "attribute":
            return "/".join(self.parts[:-1]) + "@" + self.parts[-1]
        return "/".join(self.parts)

    @property
    def is_newer_than_1_10(self) -> bool:
        """Whether its type is encoded as HDF5 1.10 does not know: in a version above 3 of the data type message."""
        # Two bytes of H5Tencode's own, then the message: class in the low half of its first byte, version in the high.
        return len(self.type) > 2 and self.type[2] >> 4 > 3

    def identical(self, other: "AxfExtra") -> bool:
        """Whether both are the same node with the same bits."""
        same = (self.parts, self.kind, self.type, self.shape) == (other.parts, other.kind, other.type, other.shape)
        return same and _same(self.content, other.content)

    def beside(self, parts: tuple[str, ...]) -> "AxfExtra":
        """The same node at another place."""
        return AxfExtra(parts, self.kind, self.type, self.shape, self.content)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        if a.dtype.hasobject or b.dtype.hasobject:
            return a.dtype == b.dtype and a.shape == b.shape and _same(a.tolist(), b.tolist())
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b, strict=True))
    return type(a) is type(b) and (a == b or (a != a and b != b))


def kept(parts: tuple[str, ...], kind: Kind, node: Any, *, file: h5py.File) -> AxfExtra:
    """A dataset or attribute as it is stored.

    Args:
        parts: where it belongs.
        kind: "dataset" or "attribute".
        node: its low-level identifier (`h5py.h5d.DatasetID` or `h5py.h5a.AttrID`).
        file: the open file, in which references are looked up.

    Raises:
        TypeError: its type cannot be kept (region references, and references inside other types).
        OSError, RuntimeError, ValueError: the file is damaged here.
    """
    stored, space = node.get_type(), node.get_space()
    if space.get_simple_extent_type() == h5py.h5s.NULL:
        return AxfExtra(parts, kind, stored.encode(), None)
    shape = tuple(int(n) for n in space.shape)
    content: bytes | np.ndarray | tuple[str, ...]
    if is_plain(stored):
        values = np.zeros(shape, np.dtype(("V", stored.get_size())))
        _read(node, values, stored)
        content = values.tobytes()
    elif _is_object_reference(stored):
        references = np.empty(shape, h5py.ref_dtype)
        _read(node, references, h5py.h5t.py_create(references.dtype))
        content = tuple(_target(reference, file) for reference in references.reshape(-1))
    elif _has_reference(stored):
        raise TypeError("references of this kind cannot be kept")
    else:
        content = np.empty(shape, stored.dtype)
        _read(node, content, h5py.h5t.py_create(content.dtype))
    return AxfExtra(parts, kind, stored.encode(), shape, content)


def restore(root: h5py.Group, extras: Sequence[AxfExtra]) -> None:
    """Write nodes below a group.

    References and hard links are written last, since what they lead to must be there. A reference whose target is not
    leads nowhere; a hard link becomes a soft one.

    Raises:
        InputError: something else already has its place.
    """
    for extra in sorted(extras, key=lambda extra: (extra.kind in ("hard link", "attribute"), _is_path_list(extra))):
        try:
            _restore(root, extra)
        except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
            reason = " ".join(str(error).split())
            raise InputError(f"{extra.path}: cannot be written back ({reason}); remove it from `extras`") from error


def _restore(root: h5py.Group, extra: AxfExtra) -> None:
    holder, name = _holder(root, extra), _bytes(extra.parts[-1])
    if extra.kind == "attribute":
        stored = h5py.h5t.decode(extra.type)
        _write(h5py.h5a.create(holder, name, stored, _space(extra)), extra, stored, root.file)
        return
    if not isinstance(holder, h5py.h5g.GroupID):
        raise TypeError("what should hold it is no group")
    # Low-level calls throughout: only they take names that are no UTF-8, as bytes.
    names = h5py.h5p.create(h5py.h5p.LINK_CREATE)
    names.set_char_encoding(h5py.h5t.CSET_UTF8)
    if extra.kind == "group":
        if not holder.links.exists(name):
            h5py.h5g.create(holder, name, lcpl=names)
    elif extra.kind == "type":
        h5py.h5t.decode(extra.type).commit(holder, name, lcpl=names)
    elif extra.kind == "dataset":
        stored = h5py.h5t.decode(extra.type)
        node = h5py.h5d.create(holder, None, stored, _space(extra))
        _write(node, extra, stored, root.file)
        h5py.h5o.link(node, holder, name, lcpl=names)
    else:
        target = _bytes(str(extra.content[0]))
        node = _found(root.file, target) if extra.kind == "hard link" else None
        if node is None:
            holder.links.create_soft(name, target, lcpl=names)
        else:
            h5py.h5o.link(node, holder, name, lcpl=names)


def _holder(root: h5py.Group, extra: AxfExtra) -> Any:
    """What holds the node: a group, made if need be, or for an attribute whatever stands there."""
    holder = root.id
    for name in map(_bytes, extra.parts[:-1]):
        if not isinstance(holder, h5py.h5g.GroupID):
            raise TypeError("what should hold it is no group")
        if not holder.links.exists(name):
            h5py.h5g.create(holder, name)
        holder = h5py.h5o.open(holder, name)
    return holder


def _space(extra: AxfExtra) -> h5py.h5s.SpaceID:
    if extra.shape is None:
        return h5py.h5s.create(h5py.h5s.NULL)
    return h5py.h5s.create_simple(extra.shape) if extra.shape else h5py.h5s.create(h5py.h5s.SCALAR)


def _found(file: h5py.File, path: bytes) -> Any:
    """The object at an absolute path, or None."""
    try:
        return h5py.h5o.open(file.id, path)
    except (OSError, RuntimeError, ValueError, KeyError):
        return None


def _write(node: Any, extra: AxfExtra, stored: h5py.h5t.TypeID, file: h5py.File) -> None:
    content = extra.content
    if extra.shape is None or 0 in extra.shape:
        return
    if isinstance(content, bytes):
        values = np.frombuffer(bytearray(content), np.dtype(("V", stored.get_size())))
    elif isinstance(content, tuple):
        values = np.empty(len(content), h5py.ref_dtype)
        values[:] = [_reference(path, file) for path in content]
    else:
        values = content
    values = values.reshape(extra.shape)
    memory_type = stored if isinstance(content, bytes) else h5py.h5t.py_create(values.dtype)
    if isinstance(node, h5py.h5a.AttrID):
        node.write(values, mtype=memory_type)
    else:
        node.write(h5py.h5s.ALL, h5py.h5s.ALL, values, mtype=memory_type)


def _read(node: Any, values: np.ndarray, memory_type: h5py.h5t.TypeID) -> None:
    if values.size == 0:
        return
    if isinstance(node, h5py.h5a.AttrID):
        node.read(values, mtype=memory_type)
    else:
        node.read(h5py.h5s.ALL, h5py.h5s.ALL, values, mtype=memory_type)


def _is_path_list(extra: AxfExtra) -> bool:
    return isinstance(extra.content, tuple)


def _target(reference: h5py.Reference, file: h5py.File) -> str:
    name = h5py.h5r.get_name(reference, file.id) if reference else None
    return "" if name is None else name.decode("utf-8", "surrogateescape")


def _reference(path: str, file: h5py.File) -> h5py.Reference:
    if not path or _found(file, _bytes(path)) is None:
        return h5py.Reference()
    return h5py.h5r.create(file.id, _bytes(path), h5py.h5r.OBJECT)


def _bytes(name: str) -> bytes:
    return name.encode("utf-8", "surrogateescape")


def _parts_of(stored: h5py.h5t.TypeID) -> list[h5py.h5t.TypeID]:
    """The types a type is made of."""
    if isinstance(stored, h5py.h5t.TypeCompoundID):
        return [stored.get_member_type(k) for k in range(stored.get_nmembers())]
    if isinstance(stored, (h5py.h5t.TypeArrayID, h5py.h5t.TypeVlenID)):
        return [stored.get_super()]
    return []


def is_plain(stored: h5py.h5t.TypeID) -> bool:
    """Whether the bytes of a value are the value, so that they can be copied."""
    if isinstance(stored, (h5py.h5t.TypeVlenID, h5py.h5t.TypeReferenceID)):
        return False
    if isinstance(stored, h5py.h5t.TypeStringID) and stored.is_variable_str():
        return False
    return all(is_plain(part) for part in _parts_of(stored))


def _is_object_reference(stored: h5py.h5t.TypeID) -> bool:
    return isinstance(stored, h5py.h5t.TypeReferenceID) and stored.equal(h5py.h5t.STD_REF_OBJ)


def _has_reference(stored: h5py.h5t.TypeID) -> bool:
    return isinstance(stored, h5py.h5t.TypeReferenceID) or any(_has_reference(part) for part in _parts_of(stored))
