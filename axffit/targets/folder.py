"""Folders of packed textures: one sub-folder a material, its image files and its `material.json`; written and read.

What a target packs goes to the disk as codes, so nothing is lost beyond what the target's formats lose. A folder that
cannot be written whole leaves the one before it as it was.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from ..axf import AxfFile, AxfMaterial, MaterialKind
from ..axf.names import TEXTURE_KEYS, canonical_texture
from ..axf.properties import PROPERTY_TYPES
from ..errors import InputError
from ..textures import format_named
from ..textures.files import (
    AUTO,
    CONTAINERS,
    MAXIMUM_BYTES,
    TextureImage,
    check_bytes,
    container_for,
    load,
    save,
)
from . import target_named
from .base import PackedMaterial, PackedTexture, Problem
from .folder_errors import texture_errors
from .folder_json import FILE, Origin, Stored, content, text
from .folder_names import distinct_names
from .folder_parse import Described, parse
from .folder_swap import PREFIX, publish, staging

Progress = Callable[[str, float], None]
"""Called with what is being done and how much of it is (0 to 1)."""


@dataclass(frozen=True, eq=False)
class Exported:
    """One material that was written.

    Attributes:
        folder: its sub-folder.
        packed: what was packed.
        problems: obligations of the target that it breaks.
        content: what its `material.json` says.
    """

    folder: Path
    packed: PackedMaterial
    problems: tuple[Problem, ...]
    content: Mapping[str, Any]


def write(
    file: AxfFile | AxfMaterial,
    folder: Path,
    *,
    target: str = "unity_2018",
    material: str | None = None,
    container: str = AUTO,
    formats: Mapping[str, str] | None = None,
    rounding: str | None = None,
    progress: Progress | None = None,
) -> tuple[Exported, ...]:
    """Pack materials for a target and write each into a sub-folder of its own.

    All sub-folders are written beside their places first and moved there at the end. One of that name that an earlier
    export wrote is replaced as a whole; other content of ``folder`` stays.

    Args:
        file: the materials.
        folder: where the sub-folders go; made where it is missing.
        target: name of the target.
        material: id of the only material to write; None writes all.
        container: kind of image file for all textures: "exr", "png", "dds", "ktx2", or "auto" for the usual one.
        formats: AxF's or the target's texture name to one of the formats the target allows.
        rounding: rounding mode of the encoders; None takes the target's own.
        progress: told what is being done.

    Raises:
        InputError: a name, format or material that cannot be used, a texture the container cannot hold, or a
            sub-folder that holds anything else than an earlier export.
        OSError: the disk.
    """
    file = AxfFile((file,)) if isinstance(file, AxfMaterial) else file
    module = target_named(target)
    say = progress or (lambda stage, fraction: None)
    _check_container(container)
    chosen = [file.material(material)] if material is not None else list(file.materials)
    if not chosen:
        file.material(None)  # says that there is none
    names = distinct_names(entry.id for entry in file.materials)
    for entry in chosen:
        _check_replaceable(folder / names[entry.id])
    options: dict[str, Any] = {"formats": _by_axf_name(module, formats or {})}
    if rounding is not None:
        options["rounding"] = rounding
    exported = []
    with staging(folder) as place:
        for entry in chosen:
            say(f"packing {entry.name or entry.id}", 0.0)
            packed = module.pack(entry, **options)
            origin = Origin(Path(file.source).name, file.version, file.materials.index(entry))
            sub = place / names[entry.id]
            described = _write_material(sub, packed, container, texture_errors(entry, packed, module), origin, say)
            problems = tuple(module.validate(packed))
            exported.append(Exported(folder / names[entry.id], packed, problems, described))
        publish(place, folder, [names[entry.id] for entry in chosen])
    return tuple(exported)


def read(folder: Path, *, progress: Progress | None = None) -> AxfFile:
    """The materials of a folder that `write` wrote (or of one sub-folder of it), as the target's shader sees them.

    Textures that are only the target's defaults are left out.

    Raises:
        InputError: nothing was exported there, a `material.json` or image is damaged, or names what its target does
            not know.
    """
    say = progress or (lambda stage, fraction: None)
    found = []
    for path in material_folders(folder):
        described = parse(path / FILE)
        module = target_named(described.target)
        _check_names(path, described, module)
        material = _unpacked(path, module, _load_material(path, described, say))
        found.append((described.origin, material))
    found.sort(key=lambda pair: pair[0].index)
    version = max(origin.version for origin, _ in found)
    return AxfFile(tuple(material for _, material in found), version=version, source=str(folder))


def read_packed(folder: Path) -> PackedMaterial:
    """The packed material of one sub-folder, every code as it was.

    Raises:
        InputError: as `read`.
    """
    return _load_material(folder, parse(folder / FILE), lambda stage, fraction: None)


def _check_container(container: str) -> None:
    if container not in (AUTO, *CONTAINERS):
        raise InputError(f"unknown image format {container!r}; allowed: {', '.join((AUTO, *CONTAINERS))}")


def _by_axf_name(module: ModuleType, formats: Mapping[str, str]) -> dict[str, str]:
    """Formats by AxF's names, given by AxF's or the target's."""
    axf_names = {
        module.texture_name(key, kind): key
        for key in (*TEXTURE_KEYS, *(name for name, type in PROPERTY_TYPES.items() if type.array))
        for kind in MaterialKind
    }
    return {axf_names.get(name) or canonical_texture(name) or name: format for name, format in formats.items()}


def _check_replaceable(folder: Path) -> None:
    """Refuses a sub-folder that holds anything else than an earlier export."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise InputError(f"{folder}: is no folder; choose another --out or move it away")
    if not folder.exists():
        return
    here = {path.name for path in folder.iterdir()}
    if not here:
        return
    known = {FILE}
    if FILE in here:
        stored = parse(folder / FILE).stored
        known |= {file.file for texture in stored.values() for file in texture.files}
    if FILE not in here or here - known:
        foreign = sorted(here - known)[:3]
        raise InputError(
            f"{folder}: holds {', '.join(foreign)}, which axffit export did not write; it would be lost: move it away "
            "or choose another folder"
        )


def _write_material(
    folder: Path, packed: PackedMaterial, container: str, errors: Mapping[str, Any], origin: Origin, say: Progress
) -> dict[str, Any]:
    folder.mkdir()
    stems = distinct_names(packed.textures)
    stored = {}
    for number, (name, texture) in enumerate(packed.textures.items()):
        say(f"writing {packed.name or packed.id}", number / len(packed.textures))
        image = TextureImage(texture.format, texture.levels)
        try:
            kind = container_for(image, container)
        except InputError as error:
            raise InputError(f"{packed.id}: {name}: {error}") from error
        stored[name] = Stored(kind.name, save(folder, stems[name], image, kind))
    described = content(packed, stored, errors, origin)
    (folder / FILE).write_text(text(described), encoding="ascii")
    return described


def material_folders(folder: Path) -> Sequence[Path]:
    """The folder itself, or its sub-folders, that hold a `material.json`.

    Raises:
        InputError: none does.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; give the one that axffit export wrote")
    if (folder / FILE).is_file():
        return [folder]
    found = [path for path in sorted(folder.iterdir()) if not path.name.startswith(PREFIX) and (path / FILE).is_file()]
    if not found:
        raise InputError(f"{folder}: neither it nor a folder in it holds a {FILE}; give one that axffit export wrote")
    return found


def _check_declared(folder: Path, described: Described) -> None:
    """Refuses, before any image is read, more texels than the files can hold, and files that are named twice."""
    names = [file.file for texture in described.stored.values() for file in texture.files]
    for name, times in Counter(names).items():
        if times > 1:
            raise InputError(f"{folder / FILE}: names {name!r} twice; each texture has files of its own")
        if not (folder / name).is_file():
            raise InputError(f"{folder / name}: no such file, but {FILE} names it; add it or export again")
    declared = sum(
        math.prod(shape) * format_named(fields["format"]).bytes_per_texel
        for fields in described.textures
        for shape in described.shapes[fields["name"]]
    )
    check_bytes(folder, declared, stored=sum((folder / name).stat().st_size for name in names), most=4 * MAXIMUM_BYTES)


def _check_names(folder: Path, described: Described, module: ModuleType) -> None:
    """Refuses, before any image is read, a texture that the target has not or makes from something else."""
    for fields in described.textures:
        name, axf_name = fields["name"], fields["axf_name"]
        if module.texture_name(axf_name, described.fields["kind"]) != name:
            raise InputError(
                f"{folder / FILE}: {described.target} has no texture {name!r} made from {axf_name!r} for a "
                f"{described.fields['kind'].value}; export the material again"
            )


def _unpacked(folder: Path, module: ModuleType, packed: PackedMaterial) -> AxfMaterial:
    try:
        return module.unpack(packed, defaults=False)
    except InputError as error:
        raise InputError(f"{folder / FILE}: {error}") from error
    except (TypeError, KeyError, IndexError, ValueError, OverflowError, ArithmeticError) as error:
        # Values of types and numbers that no packing makes: `unpack` has no reason to expect them.
        raise InputError(f"{folder / FILE}: its values do not fit {packed.target} ({error})") from error


def _load_material(folder: Path, described: Described, say: Progress) -> PackedMaterial:
    _check_declared(folder, described)
    textures = {}
    for number, fields in enumerate(described.textures):
        name = fields["name"]
        say(f"reading {described.fields['name'] or described.fields['id']}", number / len(described.textures))
        stored = described.stored[name]
        image = load(folder, stored.files, CONTAINERS[stored.container], fields["format"], described.shapes[name])
        textures[name] = PackedTexture(levels=image.levels, **fields)
    return PackedMaterial(target=described.target, textures=textures, **described.fields)
