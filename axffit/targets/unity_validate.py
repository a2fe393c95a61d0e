"""Obligations of target `unity_2018`: what a packed material must fulfil, whoever packed it."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ..axf import MaterialKind
from ..textures import FORMATS
from .base import PackedMaterial, PackedTexture, Problem
from .bitfields import FLOAT32_WORD, BrdfType, BrdfVariants, Flags
from .unity_properties import (
    MAXIMUM_LOBES,
    TEXTURE_ROWS,
    TEXTURES_BY_NAME,
    VALUE_ROWS,
    VALUES_BY_NAME,
    Absent,
    TextureRow,
    ValueType,
)


def validate(packed: PackedMaterial) -> tuple[Problem, ...]:
    """Every broken obligation of a packed material, by name; empty when it may be handed to the shader."""
    rules: tuple[Callable[[PackedMaterial], Iterator[Problem]], ...] = (
        _values,
        _textures,
        _flags,
        _models,
        _lobes,
        _slices,
    )
    return tuple(problem for rule in rules for problem in rule(packed))


def _number(values: Mapping[str, Any], name: str) -> int:
    """A packed integer, 0 where it is missing or no whole number (another rule says so)."""
    value = values.get(name, 0)
    return int(value) if _is_word(value) else 0


def _is_word(value: Any) -> bool:
    return np.ndim(value) == 0 and np.isfinite(value) and 0 <= value < FLOAT32_WORD and int(value) == value


def _values(packed: PackedMaterial) -> Iterator[Problem]:
    """All values of the kind are there, of the right type, finite; packed integers survive float32."""
    for row in VALUE_ROWS:
        if packed.kind not in row.kinds:
            continue
        if row.name not in packed.values:
            yield Problem("value.missing", row.name, f"give a {row.type.value}; the default is {row.default:g}")
            continue
        value = packed.values[row.name]
        if row.type is ValueType.UINT and not _is_word(value):
            yield Problem(
                "value.uint",
                row.name,
                f"{value!r} does not survive a float32; give a whole number below {FLOAT32_WORD}",
            )
        elif row.type is ValueType.FLOAT and not (np.ndim(value) == 0 and np.isfinite(value)):
            yield Problem("value.float", row.name, f"{value!r} is no finite number")
        elif row.type is ValueType.FLOAT4 and not (np.shape(value) == (MAXIMUM_LOBES,) and np.all(np.isfinite(value))):
            yield Problem(
                "value.float4", row.name, f"{value!r} is not {MAXIMUM_LOBES} finite numbers; pad with {row.default:g}"
            )
        elif row.name.startswith("_materialSize") and value <= 0:
            yield Problem("value.size", row.name, f"{value:g} mm; uv = position / size needs a positive size")
    for name in packed.values:
        if name not in VALUES_BY_NAME or packed.kind not in VALUES_BY_NAME[name].kinds:
            yield Problem(
                "value.unknown", name, f"the target has no such value for a {packed.kind.value}; leave it out"
            )


def _textures(packed: PackedMaterial) -> Iterator[Problem]:
    """Each texture is known, in an allowed format, of the right rank; scales fit the format; needed ones are there."""
    for name, texture in packed.textures.items():
        row = TEXTURES_BY_NAME.get(name)
        if row is None or packed.kind not in row.kinds:
            yield Problem(
                "texture.unknown", name, f"the target has no such texture for a {packed.kind.value}; leave it out"
            )
        else:
            yield from _texture(row, texture, packed.values)
    for row in TEXTURE_ROWS:
        needed = packed.kind in row.kinds and row.absent is Absent.DEFAULT
        if needed and row.name not in packed.textures:
            color = ", ".join(f"{number:g}" for number in row.default)
            yield Problem("texture.missing", row.name, f"the shader samples it; give a 4x4 texture of ({color})")


def _texture(row: TextureRow, texture: PackedTexture, values: Mapping[str, Any]) -> Iterator[Problem]:
    if texture.channels not in row.choices:
        allowed = " or ".join(str(channels) for channels in row.choices)
        yield Problem("texture.channels", row.name, f"{texture.channels} channels carry data; it must be {allowed}")
        return
    if texture.format not in FORMATS or row.choice(texture.channels, texture.format) is None:
        allowed = ", ".join(choice.format for choice in row.choices[texture.channels])
        yield Problem("texture.format", row.name, f"{texture.format} is not read by the shader; allowed: {allowed}")
        return
    rank = 4 if row.array else 3
    form = FORMATS[texture.format]
    for number, level in enumerate(texture.levels):
        if level.ndim != rank or level.shape[-1] != form.channels or level.dtype != form.codecs[0].code_type:
            yield Problem(
                "texture.codes",
                row.name,
                f"level {number} is {level.dtype} of shape {level.shape}; {texture.format} needs "
                f"{np.dtype(form.codecs[0].code_type)} of rank {rank} with {form.channels} channels",
            )
    if not texture.levels:
        yield Problem("texture.codes", row.name, "no level; give at least one")
    if row.scale is not None:
        scale = values.get(row.scale, 1.0)
        if not (np.isfinite(scale) and scale > 0):
            yield Problem("scale", row.scale, f"{scale!r}; the scale of {row.name} must be positive")
        elif form.is_float and scale != 1.0:
            yield Problem(
                "scale", row.scale, f"{scale:g}; {row.name} is {texture.format}, which needs no scale: give 1"
            )


def _flags(packed: PackedMaterial) -> Iterator[Problem]:
    """Each flag bit is backed by the textures it promises, and the other way round."""
    word = Flags(_number(packed.values, "_flags"))
    if word.unknown:
        yield Problem("flags", "_flags", f"bits {word.unknown:#b} have no meaning; leave them 0")
    svbrdf = packed.kind is MaterialKind.SVBRDF
    lobe = packed.textures.get("_SVBRDF_SpecularLobeMap")
    if word.is_anisotropic and not svbrdf:
        yield Problem("flags.bit0", "_flags", "anisotropic is set, but only an SVBRDF has a lobe map; clear bit 0")
    if word.is_anisotropic and svbrdf:
        if lobe is None or lobe.channels != 2:
            yield Problem("flags.bit0", "_SVBRDF_SpecularLobeMap", "anisotropic is set; the lobe map needs 2 channels")
        if "_SVBRDF_AnisotropicRotationAngleMap" not in packed.textures:
            yield Problem(
                "flags.bit0", "_SVBRDF_AnisotropicRotationAngleMap", "anisotropic is set; give the rotation map"
            )
    if svbrdf and not word.is_anisotropic and lobe is not None and lobe.channels == 2:
        yield Problem("flags.bit0", "_flags", "the lobe map has 2 channels; set bit 0, or give 1 channel")
    if word.has_clear_coat and "_SVBRDF_ClearCoatNormalMap" not in packed.textures:
        yield Problem(
            "flags.bit1", "_SVBRDF_ClearCoatNormalMap", "clear coat is set; give the normal map (4x4 of 0.5, 0.5, 1, 1)"
        )
    coat_textures = [t for t in packed.textures.values() if t.axf_name.startswith("clearcoat") and not t.defaulted]
    if coat_textures and not word.has_clear_coat:
        yield Problem(
            "flags.bit1", "_flags", f"{coat_textures[0].name} is given, but bit 1 is 0: the coat is not drawn"
        )
    if word.has_clear_coat and word.coat_refracts and "_SVBRDF_ClearCoatIORMap_sRGB" not in packed.textures:
        if svbrdf or packed.values.get("_CarPaint_IOR") is None:
            yield Problem(
                "flags.bit2", "_SVBRDF_ClearCoatIORMap_sRGB", "the coat refracts; give the IOR map (4x4 of F0 = 0.04)"
            )
    if word.has_height_map and "_SVBRDF_HeightMap" not in packed.textures:
        yield Problem("flags.bit3", "_SVBRDF_HeightMap", "height map is set; give the map, or clear bit 3")
    if "_SVBRDF_HeightMap" in packed.textures and not word.has_height_map:
        yield Problem("flags.bit3", "_flags", "a height map is given, but bit 3 is 0: it is not sampled")


def _models(packed: PackedMaterial) -> Iterator[Problem]:
    """The packed model integers mean something."""
    if packed.kind is not MaterialKind.SVBRDF:
        return
    kind = BrdfType.unpack(_number(packed.values, "_SVBRDF_BRDFType"))
    variants = BrdfVariants.unpack(_number(packed.values, "_SVBRDF_BRDFVariants"))
    for name, known in (("_SVBRDF_BRDFType", kind.is_known), ("_SVBRDF_BRDFVariants", variants.is_known)):
        if not known:
            yield Problem("models", name, f"{packed.values[name]} has no meaning; see the codes in targets.bitfields")


def _lobes(packed: PackedMaterial) -> Iterator[Problem]:
    """At most four lobes, and the padding the target expects behind them."""
    if packed.kind is not MaterialKind.CAR_PAINT:
        return
    count = _number(packed.values, "_CarPaint_lobesCount")
    if count > MAXIMUM_LOBES:
        yield Problem("lobes", "_CarPaint_lobesCount", f"{count} lobes; at most {MAXIMUM_LOBES}")
        return
    for row in VALUE_ROWS:
        value = packed.values.get(row.name)
        if row.type is ValueType.FLOAT4 and np.shape(value) == (MAXIMUM_LOBES,) and value is not None:
            wrong = [number for number in value[count:] if number != row.default]
            if wrong:
                yield Problem("lobes.padding", row.name, f"{wrong[0]:g} behind {count} lobes; pad with {row.default:g}")


def _slices(packed: PackedMaterial) -> Iterator[Problem]:
    """The slice table is long enough and points at slices that exist."""
    flakes = packed.textures.get("_CarPaint_BTFFlakesMap_sRGB")
    table = packed.textures.get("_CarPaint_thetaFI_sliceLUTMap")
    if packed.kind is not MaterialKind.CAR_PAINT or flakes is None or flakes.defaulted:
        return
    if table is None:
        yield Problem(
            "slices", "_CarPaint_thetaFI_sliceLUTMap", "flakes are given; give the table that finds their slices"
        )
        return
    entries = table.levels[0].reshape(-1).astype(int)
    bins = _number(packed.values, "_CarPaint_maxThetaI")
    if entries.size < bins:
        yield Problem("slices", table.name, f"{entries.size} texels for _CarPaint_maxThetaI {bins}; give one a bin")
    depth = flakes.levels[0].shape[0]
    if entries.size and entries.max() > depth:
        yield Problem("slices", table.name, f"it points at slice {entries.max()} of {depth}; give all slices")
