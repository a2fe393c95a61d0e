"""Writing .axf files: the evidenced HDF5 layout, and one documented layout of our own for the rest."""

import contextlib
import os
import secrets
from pathlib import Path

import h5py
import numpy as np

from .. import __version__
from ..errors import InputError
from . import layout
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
        InputError: a material breaks a rule of `validation`, two share an id, or the file cannot be written.
    """
    path = Path(path)
    file = AxfFile((content,)) if isinstance(content, AxfMaterial) else content
    _check_file(file)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        # Without "v110" as upper bound a newer HDF5 could write what older readers (an engine's) do not know.
        with h5py.File(temporary, "x", libver=("earliest", "v110")) as target:
            _write_root(target, file)
            for index, material in enumerate(file.materials):
                _write_material(target, material, index)
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


def _write_material(target: h5py.File, material: AxfMaterial, index: int) -> None:
    group = target.require_group(layout.MATERIALS).create_group(_name(layout.escape(material.id)))
    for key, texture in material.textures.items():
        _write_texture(group.create_group(f"{layout.RESOURCES}/{TEXTURES[key].node}"), texture)
    _write_description(group.create_group(f"{layout.REPRESENTATIONS}/{layout.OWN_GROUP}"), material, index)


def _write_texture(resource: h5py.Group, texture: AxfTexture) -> None:
    for number, level in enumerate(texture.levels):
        name = layout.DATA if number == 0 else f"{layout.LEVEL}{number}"
        # A filter needs chunks; below a few hundred values their index outweighs what is saved.
        packing = {"compression": "gzip", "compression_opts": 6, "shuffle": True} if level.size > 256 else {}
        resource.create_dataset(name, data=level, **packing)
    resource.create_dataset(layout.WIDTH, data=np.float32(texture.width_mm))
    resource.create_dataset(layout.HEIGHT, data=np.float32(texture.height_mm))


def _write_description(group: h5py.Group, material: AxfMaterial, index: int) -> None:
    group.create_dataset("Index", data=np.uint32(index))
    texts = {
        "Id": material.id,
        "Name": material.name,
        "Class": material.kind.value,
        "DiffuseModel/TypeKey": DIFFUSE_MODELS[material.diffuse_model],
        "SpecularModel/TypeKey": SPECULAR_MODELS[material.specular_model],
        "SpecularModel/Variant": material.specular_variant,
        "SpecularModel/FresnelVariant": material.fresnel_variant,
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
