"""A `material.json` read back: every entry checked before anything is made from it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..axf import MaterialKind
from ..errors import InputError
from ..textures import FORMATS, Counts
from ..textures.codec import ROUNDINGS
from ..textures.files import CONTAINERS, StoredFile
from .folder_entry import Entry
from .folder_json import ROWS, SCHEMA, SCHEMA_VERSION, Origin, Stored
from .folder_names import safe_name

_LARGEST = 2**26
_COUNTS = {name: type(value) for name, value in asdict(Counts()).items()}


@dataclass(frozen=True, eq=False)
class Described:
    """What a `material.json` says: all of a packed material but the codes of its textures.

    Attributes:
        target: name of the target.
        fields: those of the packed material, by name, without the textures.
        textures: for each texture its fields by name, without the levels.
        stored: files by texture name.
        shapes: [H, W] or [D, H, W] of each level by texture name.
        origin: where it was exported from.
    """

    target: str
    fields: Mapping[str, Any]
    textures: tuple[Mapping[str, Any], ...]
    stored: Mapping[str, Stored]
    shapes: Mapping[str, tuple[tuple[int, ...], ...]]
    origin: Origin


def parse(path: Path) -> Described:
    """Read and check a `material.json`.

    Raises:
        InputError: it is missing, no JSON, of another schema, or an entry is not what it must be; the message names
            the entry.
    """
    whole = Entry(_load(path), str(path))
    if whole.get("schema", str) != SCHEMA or whole.get("schema_version", int) != SCHEMA_VERSION:
        raise InputError(f"{path}: no {SCHEMA} of version {SCHEMA_VERSION}; export the material again")
    if whole.get("rows", dict) != ROWS:
        raise InputError(f"{path}: rows are {whole.get('rows', dict)}; those read are {ROWS}")
    material, axf = whole.entry("material"), whole.entry("axf")
    kind = material.one_of("kind", [kind.value for kind in MaterialKind])
    version = axf.numbers("version", int)
    if len(version) != 3:
        raise InputError(f"{path}: axf.version has {len(version)} numbers; it needs 3")
    fields = {
        "id": material.get("id", str),
        "name": material.get("name", str),
        "kind": MaterialKind(kind),
        "values": {name: whole.entry("values").value(name) for name in whole.get("values", dict)},
        "metadata": {name: whole.entry("metadata").get(name, str) for name in whole.get("metadata", dict)},
        "notes": tuple(whole.texts("notes")),
    }
    textures = [_described_texture(entry) for entry in whole.entries("textures")]
    names = [fields["name"] for fields, _, _ in textures]
    if len(set(names)) < len(names):
        raise InputError(f"{path}: two textures share a name; each must have its own")
    return Described(
        target=whole.get("target", str),
        fields=fields,
        textures=tuple(fields for fields, _, _ in textures),
        stored={fields["name"]: stored for fields, stored, _ in textures},
        shapes={fields["name"]: shapes for fields, _, shapes in textures},
        origin=Origin(axf.get("file", str), (version[0], version[1], version[2]), axf.get("index", int)),
    )


def _load(path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"{path}: no such file; give a folder that axffit export wrote")
    if path.stat().st_size > _LARGEST:
        raise InputError(f"{path}: {path.stat().st_size} bytes; at most {_LARGEST} are read")
    try:
        return json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: no JSON ({error}); export the material again") from error


def _described_texture(entry: Entry) -> tuple[dict[str, Any], Stored, tuple[tuple[int, ...], ...]]:
    """The fields of a packed texture but its levels, its files, and the shapes of its levels."""
    counts = entry.entry("counts")
    fields = {
        "name": entry.get("name", str),
        "axf_name": entry.get("axf_name", str),
        "format": entry.one_of("format", FORMATS),
        "rounding": entry.one_of("rounding", ROUNDINGS),
        "channels": entry.get("channels", int),
        "transform": entry.get("transform", str),
        "counts": Counts(**{name: counts.get(name, kind) for name, kind in _COUNTS.items()}),
        "defaulted": entry.get("defaulted", bool),
        "width_mm": entry.get("width_mm", float),
        "height_mm": entry.get("height_mm", float),
        "source": entry.get("source", str),
    }
    if not 1 <= fields["channels"] <= FORMATS[fields["format"]].channels:
        raise InputError(f"{entry.where}.channels is {fields['channels']}; {fields['format']} does not have so many")
    shapes = [tuple(level) for level in entry.get("levels", list) if isinstance(level, list)]
    whole = all(isinstance(size, int) and size > 0 for shape in shapes for size in shape)
    if not shapes or not whole or {len(shape) for shape in shapes} not in ({2}, {3}):
        raise InputError(f"{entry.where}.levels: each must be [height, width] or [slices, height, width] in texels")
    files = []
    for file in entry.entries("files"):
        name = file.get("file", str)
        if name != safe_name(name):
            raise InputError(f"{file.where}.file is {name!r}; it must name a file in the material's own folder")
        files.append(StoredFile(name, file.maybe("level", int), file.maybe("slice", int)))
    if not files:
        raise InputError(f"{entry.where}.files: names no file; give at least one")
    return fields, Stored(entry.one_of("container", CONTAINERS), tuple(files)), tuple(shapes)
