"""HDF5 as untrusted input: every leaf of a file, and nothing that reaches outside it.

Sizes and types are checked before anything is read. External links, external storage and virtual datasets are
refused before they are opened; soft links are listed and not followed, so that a loop cannot be walked.
"""

import contextlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import h5py.h5a
import h5py.h5l
import h5py.h5o
import h5py.h5s
import numpy as np

from ..errors import InputError
from . import guard, scratch
from .extras import AxfExtra, Kind, is_plain, kept
from .filters import check_filters
from .heaps import check_heaps

MAXIMUM_BYTES = 4 * 2**30
"""Declared bytes of one dataset above which it is refused: four times the largest flake stack ever seen."""

MAXIMUM_KEPT = 4 * 2**30
"""Bytes of a file's nodes that were not understood, above which the others are listed and not kept."""

MAXIMUM_NODES = 10_000
"""Nodes of a file above which it is refused: looking at so many takes two seconds, and AxF has hundreds."""

MAXIMUM_DEPTH = 32
"""Nesting of groups above which a file is refused."""

MAXIMUM_TEXT = 65_536
"""Bytes of a text or of an attribute above which it is not read."""

# A deflate stream expands at most 1032-fold; what declares more than that holds no data.
_MAXIMUM_EXPANSION = 1100
_SMALL = 64 * 2**20


@dataclass(frozen=True)
class Leaf:
    """One dataset or attribute.

    Attributes:
        parts: the names from the root to it; an attribute's own name comes last.
        shape: its extent, or None for an empty one.
        dtype: its numpy type.
        load: reads the raw value.
        keep: reads it as it is stored, to be written back.
        attribute: whether it is an attribute.
    """

    parts: tuple[str, ...]
    shape: tuple[int, ...] | None
    dtype: np.dtype
    load: Callable[[], object] = field(repr=False)
    keep: Callable[[], AxfExtra] = field(repr=False)
    attribute: bool = False

    @property
    def path(self) -> str:
        """The path for people: `/group/dataset`, or `/group@attribute`."""
        if self.attribute:
            return printable("/" + "/".join(self.parts[:-1]) + "@" + self.parts[-1])
        return printable("/" + "/".join(self.parts))

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.parts[-1]

    @property
    def line(self) -> str:
        """What is said about it where it was not used."""
        return self.path

    @property
    def size(self) -> int:
        """Bytes that its values take."""
        return 0 if self.shape is None else math.prod(self.shape) * self.dtype.itemsize

    @property
    def is_number(self) -> bool:
        """Whether it holds real numbers."""
        return self.dtype.kind in "iuf" and self.shape is not None and 0 not in self.shape

    def text(self) -> str | None:
        """The single text it holds, or None if it holds something else or too much of it.

        Raises:
            InputError: the file is damaged here.
        """
        text_type = h5py.check_string_dtype(self.dtype)
        if text_type is None or self.shape is None or math.prod(self.shape) != 1:
            return None
        if (text_type.length or 0) > MAXIMUM_TEXT:
            return None
        value = self._value()
        while isinstance(value, np.ndarray):
            value = value.reshape(-1)[0]
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        return value if isinstance(value, str) else None

    def array(self) -> np.ndarray:
        """The numbers it holds, in native byte order.

        Raises:
            InputError: the file is damaged here.
        """
        value = np.asarray(self._value())
        return value.astype(value.dtype.newbyteorder("="), copy=False)

    def _value(self) -> object:
        try:
            return self.load()
        except (OSError, RuntimeError, ValueError, KeyError, TypeError, MemoryError) as error:
            raise InputError(
                f"{self.path}: cannot be read ({one_line(error)}); get a fresh copy of the file"
            ) from error


@dataclass(frozen=True)
class Unread:
    """What is no leaf with a value: a link that was not followed, an empty group, a type that numpy has not.

    Attributes:
        parts: the names from the root to it.
        what: what it is, for people.
        keep: reads it as it is stored, to be written back.
        size: bytes that its values take.
        attribute: whether it is an attribute.
        is_empty_group: whether it is a group that holds nothing.
    """

    parts: tuple[str, ...]
    what: str
    keep: Callable[[], AxfExtra] = field(repr=False)
    size: int = 0
    attribute: bool = False
    is_empty_group: bool = False

    @property
    def line(self) -> str:
        """What is said about it."""
        at = "/" + "/".join(self.parts[:-1]) + "@" + self.parts[-1] if self.attribute else "/" + "/".join(self.parts)
        return f"{printable(at)} ({self.what})"


@dataclass(frozen=True)
class Tree:
    """What a file holds.

    Attributes:
        leaves: every dataset and attribute.
        groups: every group, as the names from the root to it.
        unread: everything else.
    """

    leaves: tuple[Leaf, ...]
    groups: tuple[tuple[str, ...], ...]
    unread: tuple[Unread, ...]


@contextlib.contextmanager
def opened(path: str | Path, *, guarded: bool = True) -> Iterator[h5py.File]:
    """The file, open for reading.

    Args:
        path: the file.
        guarded: whether another process reads it first (`guard`), so that it cannot crash or hang this one.

    Raises:
        InputError: it is missing, no file, no HDF5, cut short, or one that libhdf5 itself fails on.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file; give the path of an .axf file")
    if not path.is_file():
        raise InputError(f"{path}: not a file; give the path of an .axf file")
    try:
        if not h5py.is_hdf5(path):
            raise InputError(f"{path}: not an AxF file (no HDF5 signature); give an .axf file")
        if guarded:
            guard.check(path)
        file = h5py.File(path, "r", locking="best-effort")
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path}: damaged or truncated HDF5 ({one_line(error)}); get a fresh copy of the file"
        ) from error
    try:
        yield file
    finally:
        with contextlib.suppress(OSError, RuntimeError, ValueError):
            file.close()


def walk(file: h5py.File, met: Callable[[], None] = lambda: None) -> Tree:
    """Every leaf of the file.

    Args:
        file: the open file.
        met: called at every member of every group, to show that the walk goes on.

    Raises:
        InputError: something reaches outside the file, is too large, too deep or too much, or is damaged.
    """
    found = _Found(file)
    visited: dict[int, tuple[str, ...]] = {}
    pending: list[tuple[tuple[str, ...], h5py.Group]] = [((), file)]
    parts: tuple[str, ...] = ()
    try:
        while pending:
            parts, group = pending.pop()
            address = h5py.h5o.get_info(group.id).addr
            if address in visited:
                first = "/" + "/".join(visited[address])
                found.link(parts, "a group that was met before", "hard link", first)
                continue
            visited[address] = parts
            found.groups.append(parts)
            if len(parts) > MAXIMUM_DEPTH:
                raise InputError(f"{_path(parts)}: nested deeper than {MAXIMUM_DEPTH} groups; flatten the file")
            before = found.count
            found.attributes(parts, group)
            below = []
            # The low-level iterator: h5py's own stops at a name that is no UTF-8.
            for name in group.id:
                met()
                found.member((*parts, _decoded(name)), group, name, below)
                if found.count + len(found.groups) + len(pending) + len(below) > MAXIMUM_NODES:
                    raise InputError(f"{_path(parts)}: more than {MAXIMUM_NODES} nodes; split the file")
            if parts and not below and found.count == before:
                found.link(parts, "an empty group", "group", "")
            pending.extend(reversed(below))
        if found.heaps:
            check_heaps(file.filename, file.id.get_create_plist().get_sizes()[1])
    except (OSError, RuntimeError, KeyError, TypeError, UnicodeError, MemoryError) as error:
        raise InputError(f"{_path(parts)}: damaged ({one_line(error)}); get a fresh copy of the file") from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{_path(parts)}: damaged ({one_line(error)}); get a fresh copy of the file") from error
    return Tree(tuple(found.leaves), tuple(found.groups), tuple(found.unread))


@dataclass
class _Found:
    """What the walk has met so far."""

    file: h5py.File
    leaves: list[Leaf] = field(default_factory=list)
    unread: list[Unread] = field(default_factory=list)
    groups: list[tuple[str, ...]] = field(default_factory=list)
    heaps: bool = False

    @property
    def count(self) -> int:
        return len(self.leaves) + len(self.unread)

    def link(self, parts: tuple[str, ...], what: str, kind: Kind, target: str) -> None:
        self.unread.append(
            Unread(parts, what, lambda: AxfExtra(parts, kind, content=(target,)), is_empty_group=kind == "group")
        )

    def member(
        self,
        parts: tuple[str, ...],
        group: h5py.Group,
        name: bytes,
        below: list[tuple[tuple[str, ...], h5py.Group]],
    ) -> None:
        kind = group.id.links.get_info(name).type
        if kind == h5py.h5l.TYPE_SOFT:
            target = _decoded(group.id.links.get_val(name))
            self.link(parts, f"soft link to {printable(target)}, not followed", "soft link", target)
            return
        if kind != h5py.h5l.TYPE_HARD:
            raise InputError(f"{_path(parts)}: external link to another file; store the data in this file")
        node = group[name]
        if isinstance(node, h5py.Group):
            below.append((parts, node))
        elif isinstance(node, h5py.Dataset):
            self.attributes(parts, node)
            self.dataset(parts, node)
        else:
            self.attributes(parts, node)
            extra = AxfExtra(parts, "type", node.id.encode())
            self.unread.append(Unread(parts, f"a {type(node).__name__.lower()}", lambda: extra))

    def dataset(self, parts: tuple[str, ...], dataset: h5py.Dataset) -> None:
        if dataset.is_virtual:
            raise InputError(f"{_path(parts)}: virtual dataset; store the data itself in this file")
        if dataset.external:
            raise InputError(f"{_path(parts)}: data in an external file; store the data in this file")
        stored = dataset.id.get_type()
        self.heaps |= not is_plain(stored)
        itemsize = stored.get_size()
        shape = None if dataset.shape is None else tuple(dataset.shape)
        _check_size(parts, dataset, itemsize)

        def load() -> object:
            check_filters(dataset.id)
            return _values(dataset)

        def keep() -> AxfExtra:
            check_filters(dataset.id)
            return kept(parts, "dataset", dataset.id, file=self.file)

        try:
            dtype = dataset.dtype
        except TypeError:
            size = math.prod(shape or ()) * itemsize
            self.unread.append(Unread(parts, "a type that has no counterpart in numpy", keep, size))
        else:
            self.leaves.append(Leaf(parts, shape, dtype, load, keep))

    def attributes(self, parts: tuple[str, ...], node: Any) -> None:
        for name in node.attrs:
            raw = name if isinstance(name, bytes) else name.encode("utf-8", "surrogateescape")
            identifier = h5py.h5a.open(node.id, raw)
            shape = None if identifier.get_space().get_simple_extent_type() == h5py.h5s.NULL else identifier.shape
            stored = identifier.get_type()
            self.heaps |= not is_plain(stored)
            size = math.prod(shape or ()) * stored.get_size()
            at = (*parts, _decoded(name))
            if size > _SMALL:
                raise InputError(f"{_path(at)}: an attribute of {size / 2**20:.0f} MiB; store it as a dataset")

            def keep(at: tuple[str, ...] = at, raw: bytes = raw) -> AxfExtra:
                return kept(at, "attribute", h5py.h5a.open(node.id, raw), file=self.file)

            try:
                dtype = identifier.dtype
            except TypeError:
                self.unread.append(Unread(at, "a type that has no counterpart in numpy", keep, size, attribute=True))
                continue
            # An oversized attribute is never looked into, only kept.
            dtype = np.dtype("V1") if size > MAXIMUM_TEXT else dtype
            self.leaves.append(Leaf(at, shape, dtype, lambda name=name: node.attrs[name], keep, attribute=True))


def _values(dataset: h5py.Dataset) -> object:
    """All values; large numbers in native byte order and outside of memory."""
    dtype = dataset.dtype
    if dtype.kind not in "iuf" or dataset.shape is None or dataset.nbytes < scratch.LARGE:
        return dataset[()]
    values = scratch.empty(dataset.shape, dtype.newbyteorder("="))
    dataset.read_direct(values)
    scratch.let_go(values)
    return values


def _check_size(parts: tuple[str, ...], dataset: h5py.Dataset, itemsize: int) -> None:
    declared = 0 if dataset.shape is None else math.prod(dataset.shape) * itemsize
    if declared > MAXIMUM_BYTES:
        raise InputError(
            f"{_path(parts)}: shape {dataset.shape} declares {declared / 2**30:.1f} GiB; "
            f"at most {MAXIMUM_BYTES / 2**30:g} GiB are read: store a smaller map"
        )
    if declared > _SMALL and dataset.id.get_storage_size() * _MAXIMUM_EXPANSION < declared:
        raise InputError(
            f"{_path(parts)}: shape {dataset.shape} declares {declared / 2**20:.0f} MiB but "
            f"{dataset.id.get_storage_size()} bytes are stored; store the data itself"
        )
    chunk = math.prod(dataset.chunks or (0,)) * itemsize
    if chunk > max(_SMALL, declared):
        raise InputError(
            f"{_path(parts)}: chunks of {chunk / 2**20:.0f} MiB for {declared / 2**20:.0f} MiB of data; "
            "store it in smaller chunks"
        )


def _decoded(name: str | bytes) -> str:
    """A link's or attribute's name as text; bytes that are no UTF-8 become lone surrogates, and come back."""
    return name.decode("utf-8", "surrogateescape") if isinstance(name, bytes) else str(name)


def printable(text: str) -> str:
    """Text on one line: what cannot be printed is escaped."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def one_line(error: BaseException) -> str:
    """The message of an exception on one line of modest length."""
    return printable(" ".join(str(error).split()))[:200] or type(error).__name__


def _path(parts: tuple[str, ...]) -> str:
    return printable("/" + "/".join(parts))
