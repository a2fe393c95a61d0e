"""`material.json`: every name and value of a packed material, and where each texture came from.

Numbers JSON has no word for are the texts "NaN", "Infinity" and "-Infinity". The schema is
``schemas/material.schema.json``; `folder_parse` reads it back.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

import numpy as np

from .. import __version__
from ..textures.files import StoredFile
from .base import PackedMaterial, PackedTexture
from .folder_errors import TextureError

FILE = "material.json"
SCHEMA = "axffit.material"
SCHEMA_VERSION = 1

ROWS = {"first": "v = 0", "flipped": False}
"""Row 0 of every image file is v = 0, as in AxF; nothing is flipped."""


@dataclass(frozen=True)
class Stored:
    """The files of one texture.

    Attributes:
        container: their kind.
        files: their names.
    """

    container: str
    files: tuple[StoredFile, ...]


@dataclass(frozen=True)
class Origin:
    """Where an exported material came from.

    Attributes:
        file: name of the .axf file, "" when it was made in memory.
        version: its AxF version.
        index: the material's place in it.
    """

    file: str
    version: tuple[int, int, int]
    index: int


def schema() -> dict[str, Any]:
    """The JSON schema of `material.json`."""
    text = resources.files("axffit.targets").joinpath("schemas/material.schema.json").read_text(encoding="utf-8")
    return json.loads(text)


def content(
    packed: PackedMaterial, stored: Mapping[str, Stored], errors: Mapping[str, TextureError | str], origin: Origin
) -> dict[str, Any]:
    """What `material.json` says of a packed material; validates against `schema`."""
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "axffit_version": __version__,
        "target": packed.target,
        "material": {"id": packed.id, "name": packed.name, "kind": packed.kind.value},
        "axf": {"file": origin.file, "version": list(origin.version), "index": origin.index},
        "rows": ROWS,
        "values": {name: _plain(value) for name, value in packed.values.items()},
        "textures": [_texture(texture, stored[name], errors[name]) for name, texture in packed.textures.items()],
        "metadata": dict(packed.metadata),
        "notes": list(packed.notes),
    }


def text(value: Mapping[str, Any]) -> str:
    """The file's text: ASCII, so that ids with broken Unicode survive."""
    return json.dumps(value, indent=2, allow_nan=False) + "\n"


def _texture(texture: PackedTexture, stored: Stored, error: TextureError | str) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "name": texture.name,
        "axf_name": texture.axf_name,
        "container": stored.container,
        "files": [_without_none(asdict(file)) for file in stored.files],
        "format": texture.format,
        "channels": texture.channels,
        "levels": [list(level.shape[:-1]) for level in texture.levels],
        "width_mm": _plain(texture.width_mm),
        "height_mm": _plain(texture.height_mm),
        "source": texture.source,
        "defaulted": texture.defaulted,
        "transform": texture.transform,
        "rounding": texture.rounding,
        "counts": {name: _plain(value) for name, value in asdict(texture.counts).items()},
    }
    if isinstance(error, str):
        return entry | {"error": None, "error_reason": error}
    return entry | {"error": {name: _plain(value) for name, value in error.to_json().items()}}


def _without_none(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in entry.items() if value is not None}


def _plain(value: Any) -> Any:
    """A value of Python's own types, without the floats that JSON has no word for."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")
    if isinstance(value, tuple | list | np.ndarray):
        return [_plain(item) for item in value]
    return value
