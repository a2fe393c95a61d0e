"""Unreal Engine's AxF importer: what its textures keep.

Source: the importer's public C++ code. What it does:

- every texture is read as half floats, the finest level only; mip levels are made anew by the engine;
- diffuse color, specular color and color table become RGBA16: each channel divided by max(its maximum, 0.1), clamped
  at 0, multiplied by 65535 and **floored** (the code calls that incorrect itself); the shader multiplies by the three
  maxima. The others stay half floats;
- normals are made unit vectors, green is flipped, then 0.5 (n + 1);
- anisotropy is dropped: the shader takes the mean of both roughnesses and ignores the rotation map. The mean is taken
  before packing here, which differs by a rounding;
- an index of refraction stays as it is;
- the slice table becomes 8-bit integers by a cast that wraps above 255; here larger entries are refused;
- black texels that end a row of the color table take the color of the last other one (tables valid up to the diagonal);
- a car paint becomes one metallic GGX lobe (`unreal_lobe`); flakes are shown as light that the surface emits under
  one fixed light direction.

Not reproduced: maps whose sides are no powers of two are resampled to smaller ones; a 1x1 map becomes a constant of
the shader; flakes lie in one atlas. What the shader makes of the textures beyond (a metallic blend of diffuse and
specular color by F0, always GGX) is the engine's model, not a texture's loss: `unpack` keeps AxF's models, and a note
says so. A reduced paint comes back as one lobe of the AxF car paint with the same roughness and F0.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ..axf import AxfMaterial, AxfTexture, MaterialKind
from ..axf.validation import LOBE_ARRAYS
from ..textures.rerange import Chain, ClampNegative, Identity, Reranging
from .base import PackedMaterial
from .bitfields import Flags
from .engine import Engine, Prepared
from .record import RECORD_ROWS, record_flags
from .rerangings import FlippedNormal, ThroughHalf, UsableIor
from .table import (
    CAR_PAINT,
    COMMON,
    SLICE_TABLE,
    SVBRDF,
    Absent,
    FormatChoice,
    Role,
    Scaling,
    Tables,
    TextureRow,
    ValueRow,
    ValueType,
)
from .unreal_lobe import COEFFICIENT, Lobe, reduce_paint
from .values import shader_constant

NAME = "unreal"


def _half(*steps: Reranging) -> tuple[FormatChoice, ...]:
    return (FormatChoice("RGBA16F", Chain((*steps, ThroughHalf()))),)


_FIXED = {3: (FormatChoice("RGBA16_UNORM", Chain((ThroughHalf(), ClampNegative()))),)}
_COLOR = {3: _half(ClampNegative())}
_NORMAL = {3: _half(ThroughHalf(), FlippedNormal())}
_SCALAR = {1: _half(Identity())}
_FLAT = (0.5, 0.5, 1.0, 1.0)
_WHITE = (1.0, 1.0, 1.0, 1.0)
_BLACK = (0.0, 0.0, 0.0, 0.0)
_NOTHING = Absent.NOTHING
_FLOORED = "RGBA16, a scale a channel, floored"
_KEPT = "RGBA16F"

TEXTURE_ROWS: tuple[TextureRow, ...] = (
    TextureRow(
        "DiffuseColor", "diffusecolor", SVBRDF, _FIXED, _BLACK, _NOTHING,
        scale="DiffuseColor_Scale", scaling=Scaling.PER_CHANNEL, provenance=_FLOORED,
    ),
    TextureRow(
        "SpecularColor", "specularcolor", SVBRDF, _FIXED, _WHITE, _NOTHING,
        scale="SpecularColor_Scale", scaling=Scaling.PER_CHANNEL, provenance=_FLOORED,
    ),
    TextureRow("Normal", "normal", SVBRDF, _NORMAL, _FLAT, _NOTHING, provenance=f"{_KEPT}, green flipped"),
    TextureRow("SpecularLobe", "specularlobe", SVBRDF, _SCALAR, _WHITE, _NOTHING, provenance=_KEPT),
    TextureRow("Alpha", "opacity", SVBRDF, _SCALAR, _WHITE, _NOTHING, provenance=_KEPT),
    TextureRow("Fresnel", "fresnel", SVBRDF, {1: _half(ClampNegative()), **_COLOR}, _BLACK, _NOTHING, provenance=_KEPT),
    TextureRow("Height", "height", SVBRDF, _SCALAR, _BLACK, _NOTHING, provenance=_KEPT),
    TextureRow(
        "BRDFcolors", "brdfcolors", CAR_PAINT, _FIXED, _WHITE, _NOTHING,
        scale="BRDFcolors_Scale", scaling=Scaling.PER_CHANNEL, provenance=_FLOORED,
    ),
    TextureRow("BTFflakes", "btfflakes", CAR_PAINT, _COLOR, _BLACK, _NOTHING, array=True, provenance=_KEPT),
    TextureRow(
        SLICE_TABLE, SLICE_TABLE, CAR_PAINT, {1: (FormatChoice("R8_UINT", Identity()),)}, (0.0,), Absent.FLAKES,
        provenance="8-bit integers",
    ),
    TextureRow("ClearcoatColor", "clearcoatcolor", COMMON, _COLOR, _WHITE, _NOTHING, provenance=_KEPT),
    TextureRow("ClearcoatNormal", "clearcoatnormal", COMMON, _NORMAL, _FLAT, _NOTHING, provenance=_KEPT),
    TextureRow(
        "ClearcoatIOR", "clearcoatior", COMMON, {1: _half(UsableIor())}, (1.5, 0.0, 0.0, 1.0), _NOTHING,
        provenance=_KEPT,
    ),
)  # fmt: skip
"""The texture table."""

_F, _U, _F3 = ValueType.FLOAT, ValueType.UINT, ValueType.FLOAT3
_MAXIMA = "max(channel's maximum, 0.1)"
_PROPERTY = "the AxF property"

VALUE_ROWS: tuple[ValueRow, ...] = (
    *RECORD_ROWS,
    ValueRow("SizeU_mm", _F, COMMON, Role.SIZE_U, 1.0, unit="mm", provenance="tiling = meters per uv unit / size"),
    ValueRow("SizeV_mm", _F, COMMON, Role.SIZE_V, 1.0, unit="mm", provenance="tiling = meters per uv unit / size"),
    ValueRow("DiffuseColor_Scale", _F3, SVBRDF, Role.SCALE, 1.0, provenance=_MAXIMA),
    ValueRow("SpecularColor_Scale", _F3, SVBRDF, Role.SCALE, 1.0, provenance=_MAXIMA),
    ValueRow("BRDFcolors_Scale", _F3, CAR_PAINT, Role.SCALE, 1.0, provenance=_MAXIMA),
    ValueRow("Roughness", _F, CAR_PAINT, Role.NONE, 1.0, provenance="unreal_lobe"),
    ValueRow("Specularity", _F, CAR_PAINT, Role.NONE, 0.0, unit="F0", provenance="unreal_lobe"),
    ValueRow("IOR", _F, CAR_PAINT, "IOR", 1.5, provenance=_PROPERTY),
    ValueRow("FlakesMaxThetaI", _U, CAR_PAINT, "max_thetaI", 0, unit="bins", provenance=_PROPERTY),
    ValueRow("FlakesNumThetaF", _U, CAR_PAINT, "num_thetaF", 0, unit="bins", provenance=_PROPERTY),
    ValueRow("FlakesNumThetaI", _U, CAR_PAINT, "num_thetaI", 0, unit="bins", provenance=_PROPERTY),
)
"""The value table."""

TABLES = Tables(NAME, TEXTURE_ROWS, VALUE_ROWS, Flags)


def filled_rows(table: np.ndarray) -> np.ndarray:
    """A color table [H, W, 3] whose rows continue their last color where they end in black.

    A row that is black throughout takes the first color of the row before it.
    """
    filled = table.copy()
    width = table.shape[1]
    for number, row in enumerate(filled):
        lit = np.flatnonzero(np.any(row != 0, axis=-1))
        start = int(lit[-1]) + 1 if lit.size else 0
        if start == width:
            continue
        if start > 0:
            row[start:] = row[start - 1]
        elif number > 0:
            row[:] = filled[number - 1, 0]
    return filled


def _prepare(material: AxfMaterial) -> Prepared:
    if material.kind is MaterialKind.CAR_PAINT:
        return _prepare_paint(material)
    notes = ["the shader draws GGX and blends diffuse and specular color by F0, whatever AxF's models are"]
    lobe = material.textures.get("specularlobe")
    textures = {key: texture for key, texture in material.textures.items() if key != "anisrotation"}
    if material.anisotropic or "anisrotation" in material.textures:
        notes.append("anisotropy is dropped: the roughness is the mean of both, the rotation map is ignored")
    if lobe is not None and lobe.channels == 2:
        textures["specularlobe"] = replace(lobe, levels=tuple(_mean(level) for level in lobe.levels))
    material = replace(material, textures=textures, anisotropic=False)
    return Prepared(material, record_flags(material), notes=tuple(notes))


def _mean(lobe: np.ndarray) -> np.ndarray:
    return lobe.mean(axis=-1, keepdims=True, dtype=np.float32)


def _prepare_paint(material: AxfMaterial) -> Prepared:
    textures, lobe = dict(material.textures), reduce_paint(material)
    notes = list(_paint_notes(material, lobe))
    colors, flakes = textures.get("brdfcolors"), textures.get("btfflakes")
    if colors is not None:
        textures["brdfcolors"] = replace(colors, levels=tuple(filled_rows(level) for level in colors.levels))
    if flakes is not None and len(flakes.levels) > 1:
        textures["btfflakes"] = _finest(flakes)
        notes.append(f"of {len(flakes.levels)} levels of the flakes the finest is kept; the engine makes its own")
    values = {name: shader_constant(_ROWS[name], getattr(lobe, name.lower())) for name in ("Roughness", "Specularity")}
    material = replace(material, textures=textures)
    return Prepared(material, {**values, **record_flags(material)}, notes=tuple(notes))


_ROWS = {row.name: row for row in VALUE_ROWS}


def _finest(texture: AxfTexture) -> AxfTexture:
    return replace(texture, levels=texture.levels[:1])


def _paint_notes(material: AxfMaterial, lobe: Lobe) -> Iterator[str]:
    if lobe.residual:
        yield (
            f"the paint is reduced to one GGX lobe of roughness {lobe.roughness:.3g} and specularity "
            f"{lobe.specularity:.3g}, which misses {100 * lobe.residual:.3g} % of it"
        )
        yield "the lobe comes back as one of AxF's own, which are Beckmann's: its tail is shorter"
    if "btfflakes" in material.textures:
        yield "flakes are emitted light under one fixed light direction"


def _restore(packed: PackedMaterial, fields: dict[str, Any]) -> dict[str, Any]:
    if packed.kind is not MaterialKind.CAR_PAINT:
        return fields
    roughness = np.float32(packed.values.get("Roughness", 1.0))
    # The square of the smallest roughness may round to less than AxF's smallest spread.
    spread = max(roughness * roughness, np.float32(1.00001e-4))
    lobe = (COEFFICIENT, packed.values.get("Specularity", 0.0), spread)
    one = {name: [number] for name, number in zip(LOBE_ARRAYS, lobe, strict=True)}
    return {**fields, "properties": {**fields["properties"], "CT_diffuse": 0.0, **one}}


ENGINE = Engine(TABLES, rounding="floor", prepare=_prepare, restore=_restore)
pack, unpack, validate, reading = ENGINE.pack, ENGINE.unpack, ENGINE.validate, ENGINE.reading
texture_name, default_values = ENGINE.texture_name, ENGINE.default_values
values_of, scale_of = ENGINE.values_of, ENGINE.scale_of
