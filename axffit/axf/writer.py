"""Writing .axf files: the evidenced HDF5 layout, and one documented layout of our own for the rest."""

import contextlib
import itertools
import os
import re
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .. import __version__
from ..errors import InputError
from . import layout
from .described import is_own_name
from .extras import AxfExtra, restore
from .hdf5 import MAXIMUM_TEXT, one_line
from .material import AxfFile, AxfMaterial, AxfTexture
from .names import DIFFUSE_MODELS, FILTERS, SPECULAR_MODELS, TEXTURES
from .validation import check


def write(path: str | Path, content: AxfFile | AxfMaterial) -> None:
    """Write materials so that `read` gives them back bit for bit.

    The file appears whole or not at all: it is written beside its place and then moved there.

    Args:
        path: where to; an existing file is replaced.
        content: one material, or a file of several.

    Raises:
        InputError: a material breaks a rule of `validation`, two share an id, something of `extras` lies where a
            material belongs, or the file cannot be written.
    """
    path = Path(path)
    file = AxfFile((content,)) if isinstance(content, AxfMaterial) else content
    _check_file(file)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        # Without "v110" as upper bound a newer HDF5 could write what older readers (an engine's) do not know; what is
        # written back may be of a type that only newer ones have.
        kept = [*file.extras, *(extra for material in file.materials for extra in material.extras)]
        newest = "latest" if any(extra.is_newer_than_1_10 for extra in kept) else "v110"
        with h5py.File(temporary, "x", libver=("earliest", newest)) as target:
            _write_root(target, file)
            for index, material in enumerate(file.materials):
                _write_material(target, material, index)
            # References and hard links of these may lead anywhere, so they come when everything else is there.
            restore(target, file.extras)
            for material in file.materials:
                restore(_group(target, material), material.extras)
        os.replace(temporary, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({one_line(error)}); choose a writable folder") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def _check_file(file: AxfFile) -> None:
    ids = [material.id for material in file.materials]
    for identifier in ids:
        if ids.count(identifier) > 1:
            raise InputError(f"two materials share the id {identifier!r}; give each its own")
        if not identifier:
            raise InputError("a material has an empty id; give it a name")
    if not file.materials:
        raise InputError("no material to write; give at least one")
    if not all(0 <= number < 2**32 for number in file.version):
        raise InputError(f"AxF version {file.version}; give three whole numbers below 2^32")
    for material in file.materials:
        check(material)


def _write_root(target: h5py.File, file: AxfFile) -> None:
    for name, number in zip(layout.VERSION_ATTRIBUTES, file.version, strict=True):
        target.attrs.create(name, np.uint32(number))
    version = _text(__version__)
    target.attrs.create(layout.OWN_VERSION, version, dtype=version.dtype)
    target.attrs.create(layout.OWN_LAYOUT, np.uint32(layout.LAYOUT_NUMBER))


def _group(target: h5py.File, material: AxfMaterial) -> h5py.Group:
    return target.require_group(f"{layout.MATERIALS}/{_name(layout.escape(material.id))}")


def _write_material(target: h5py.File, material: AxfMaterial, index: int) -> None:
    group = _group(target, material)
    pool = _Pool(group, _taken(material))
    for number, entry in enumerate((material, *material.alternatives)):
        name = layout.OWN_GROUP if number == 0 else f"{layout.OWN_GROUP}_{number}"
        nodes = {key: pool.write(key, texture, front=number == 0) for key, texture in entry.textures.items()}
        if number == 0:
            # What stands where AxF has a texture, but is none of this material, would be taken for one.
            taken = [key for key in TEXTURES if key not in nodes and TEXTURES[key].node in pool.taken]
            nodes = {key: node for key, node in nodes.items() if node != TEXTURES[key].node}
            nodes |= dict.fromkeys(taken, "")
        _write_description(group.create_group(f"{layout.REPRESENTATIONS}/{name}"), entry, index, nodes)
    for path, picture in material.previews.items():
        group.create_dataset(_name(path), data=picture, **_packing(picture))


@dataclass
class _Pool:
    """The resources of one material, shared by its representations.

    Attributes:
        group: the material's group.
        taken: the nodes below the resources where something stands that is written back as it is.
        written: the textures by their node below the resources.
    """

    group: h5py.Group
    taken: frozenset[str]
    written: dict[str, AxfTexture] = field(default_factory=dict)

    def write(self, key: str, texture: AxfTexture, *, front: bool) -> str:
        """The node that holds the texture, written unless it is there already.

        AxF's own place is for the representation in front: a reader takes what stands there for that one's.
        """
        base = TEXTURES[key].node
        for number in itertools.count():
            node = base if number == 0 else f"{base}_{number}"
            if node in self.written and self.written[node].identical(texture):
                return node
            if node not in self.written and (front or number) and node not in self.taken:
                _write_texture(self.group.create_group(f"{layout.RESOURCES}/{node}"), texture)
                self.written[node] = texture
                return node
        raise AssertionError("numbers do not end")


def _taken(material: AxfMaterial) -> frozenset[str]:
    """The `Group/Resource` at whose place, or in which, `extras` hold something that a texture would write.

    Raises:
        InputError: one of `extras` stands where the groups of all textures belong, or would be read as a part of our
            own description.
    """
    taken = set()
    for extra in material.extras:
        if _would_describe(extra):
            raise InputError(f"{material.id}: {extra.path} would be read as axffit's own; remove it from `extras`")
        if extra.kind == "attribute" or extra.parts[0] != layout.RESOURCES:
            continue
        if len(extra.parts) < 3 and extra.kind != "group":
            raise InputError(
                f"{material.id}: {extra.path} is a {extra.kind} where AxF has a group; remove it from `extras`"
            )
        if len(extra.parts) == 3 or (len(extra.parts) == 4 and _RESOURCE_PART.fullmatch(extra.parts[3])):
            taken.add("/".join(extra.parts[1:3]))
    return frozenset(taken)


def _would_describe(extra: AxfExtra) -> bool:
    """Whether a reader would take it for our description, since a file that is none of ours held it."""
    if extra.kind != "dataset" or len(extra.parts) < 3 or extra.parts[0] != layout.REPRESENTATIONS:
        return False
    group = layout.OWN_GROUPS.fullmatch(extra.parts[1])
    inside = "/".join(extra.parts[2:])
    return group is not None and (bool(group[1]) or is_own_name(inside))


_RESOURCE_PART = re.compile(
    f"{layout.DATA}|{layout.WIDTH}|{layout.HEIGHT}|{layout.WAVELENGTHS}|{layout.RGB}|"
    f"(?:{layout.RGB})?{layout.LEVEL}[0-9]+",
    re.IGNORECASE,
)


def _write_texture(resource: h5py.Group, texture: AxfTexture) -> None:
    _write_levels(resource, layout.DATA, layout.LEVEL, texture.stored)
    if texture.spectra:
        _write_levels(resource, layout.RGB, layout.RGB + layout.LEVEL, texture.levels)
        if texture.wavelengths is not None:
            resource.create_dataset(layout.WAVELENGTHS, data=texture.wavelengths)
    resource.create_dataset(layout.WIDTH, data=np.float32(texture.width_mm))
    resource.create_dataset(layout.HEIGHT, data=np.float32(texture.height_mm))


def _write_levels(resource: h5py.Group, first: str, further: str, levels: tuple[np.ndarray, ...]) -> None:
    for number, level in enumerate(levels):
        resource.create_dataset(first if number == 0 else f"{further}{number}", data=level, **_packing(level))


def _packing(array: np.ndarray) -> dict[str, Any]:
    """Compression; a filter needs chunks, and below a few hundred values their index outweighs what is saved."""
    return {"compression": "gzip", "compression_opts": 6, "shuffle": True} if array.size > 256 else {}


def _write_description(group: h5py.Group, material: AxfMaterial, index: int, nodes: Mapping[str, str]) -> None:
    group.create_dataset("Index", data=np.uint32(index))
    texts = {
        "Id": material.id,
        "Name": material.name,
        "Class": material.kind.value,
        layout.REPRESENTATION: material.representation or None,
        "DiffuseModel/TypeKey": DIFFUSE_MODELS[material.diffuse_model],
        "SpecularModel/TypeKey": SPECULAR_MODELS[material.specular_model],
        "SpecularModel/Variant": material.specular_variant,
        "SpecularModel/FresnelVariant": material.fresnel_variant,
        **{f"{layout.TEXTURES}/{key}": node for key, node in nodes.items()},
    }
    present = {"ClearCoat": "clearcoat", "Transparency": "opacity", "Displacement": "height"}
    for name, start in present.items():
        if any(key.startswith(start) for key in material.textures):
            texts[f"{name}Filter/TypeKey"] = FILTERS[name]
    for name, text in texts.items():
        if text is not None:
            _write_text(group, name, text)
    group.create_dataset("SpecularModel/IsAnisotropic", data=np.uint8(material.anisotropic))
    for name, value in material.properties.items():
        group.create_dataset(f"Properties/{name}", data=value)
    for name, text in material.metadata.items():
        _write_text(group, f"Metadata/{_name(layout.escape(name))}", text)


def _write_text(group: h5py.Group, name: str, text: str) -> None:
    value = _text(text)
    group.create_dataset(name, data=value, dtype=value.dtype)


def _text(text: str) -> np.ndarray:
    """A text as HDF5's fixed-length UTF-8 string; the array's type says so to h5py."""
    encoded = _name(text).encode("utf-8")
    if len(encoded) > MAXIMUM_TEXT:
        raise InputError(f"a text of {len(encoded)} bytes ({text[:20]!r}…); at most {MAXIMUM_TEXT} are written")
    return np.array(encoded, dtype=h5py.string_dtype("utf-8", max(len(encoded), 1)))


def _name(text: str) -> str:
    """The text itself, if HDF5 can hold it.

    Raises:
        InputError: it holds a NUL, where HDF5 would cut it, or is not valid Unicode.
    """
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(f"{text!r} is not valid Unicode; choose another name") from None
    if "\0" in text:
        raise InputError(f"{text!r} holds a NUL character; choose another name")
    return text
