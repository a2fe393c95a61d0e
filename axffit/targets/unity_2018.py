"""Unity's AxF material as specified in 2018: `pack`, `unpack`, `validate`.

The tables are in `unity_properties`, the packed integers in `bitfields`; this module turns one AxF material into the
textures and values those tables ask for, and back into what the shader will see. It knows no reflectance formula.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..axf import AxfMaterial, AxfTexture, MaterialKind
from ..axf.ranges import ROUGHNESS_FLOOR
from ..axf.validation import check
from ..errors import InputError
from ..textures import Counts, format_named
from ..textures.codec import check_rounding
from ..textures.rerange import Chain, Reranging, Scale, texels
from .base import PackedMaterial, PackedTexture
from .encoding import decode_level, encode_level, spread
from .unity_properties import TEXTURE_ROWS, TEXTURES_BY_NAME, Absent, FormatChoice, TextureRow
from .unity_validate import validate as validate
from .unity_values import material_fields, material_notes, material_values

NAME = "unity_2018"


def pack(
    material: AxfMaterial, *, formats: Mapping[str, str] | None = None, rounding: str = "nearest_even"
) -> PackedMaterial:
    """The textures and values that Unity's AxF material expects for this material.

    Args:
        material: SVBRDF or car paint, in AxF's ranges.
        formats: AxF texture name to one of the formats its row allows; the advised format for the rest.
        rounding: rounding mode of every encoder.

    Returns:
        Every texture of the table that the material's kind has: re-ranged, clamped and counted, quantized, all mip
        levels kept; 4x4 defaults for absent ones, none for those a flag switches off.

    Raises:
        InputError: the material breaks a rule of AxF (`axf.validation`), or a format or rounding is not allowed.
    """
    check(material)
    check_rounding(rounding)
    chosen = _chosen_formats(formats or {})
    values = material_values(material)
    textures = {}
    for row in TEXTURE_ROWS:
        if material.kind not in row.kinds:
            continue
        source = _source(row, material)
        if source is None:
            if _default_wanted(row, material):
                textures[row.name] = _default_texture(row, material, chosen.get(row.axf_name), rounding)
            continue
        choice = _choice(row, source.channels, chosen.get(row.axf_name))
        form = format_named(choice.format)
        transform = choice.reranging
        if row.scale is not None:
            scale = 1.0 if form.is_float else _largest(source, transform)
            values[row.scale] = scale
            transform = Chain((transform, Scale(scale)))
        textures[row.name] = _texture(row, source, transform, choice.format, rounding, material)
    return PackedMaterial(
        target=NAME,
        id=material.id,
        name=material.name,
        kind=material.kind,
        textures=textures,
        values=values,
        metadata=material.metadata,
        notes=tuple(material_notes(material)),
    )


def reading(texture: PackedTexture, values: Mapping[str, Any]) -> Reranging:
    """How this target's shader reads a texture: its inverse turns decoded texels into AxF's values.

    It follows from the texture's name, its format and the packed values, never from what the packer says it did, so
    that a texture packed wrongly, or for another target, is read as this target would read it.

    Raises:
        InputError: the target has no such texture, or not in that format.
    """
    row = TEXTURES_BY_NAME.get(texture.name)
    if row is None:
        raise InputError(f"{NAME} has no texture {texture.name!r}; it has {', '.join(TEXTURES_BY_NAME)}")
    channels = texture.channels if texture.channels in row.choices else max(row.choices)
    choice = _choice(row, channels, texture.format)
    scale = 1.0 if row.scale is None else float(values.get(row.scale, 1.0))
    return choice.reranging if scale == 1.0 else Chain((choice.reranging, Scale(scale)))


def texture_name(axf_name: str, kind: MaterialKind) -> str | None:
    """The target's name of an AxF texture in a material of that kind, or None where the target has no place for it."""
    return next((row.name for row in TEXTURE_ROWS if row.axf_name == axf_name and kind in row.kinds), None)


def default_values(name: str) -> np.ndarray:
    """The default of a texture in AxF's range, [channels]: what its 4x4 stand-in is meant to say.

    Raises:
        InputError: the target has no such texture.
    """
    row = TEXTURES_BY_NAME.get(name)
    if row is None:
        raise InputError(f"{NAME} has no texture {name!r}; it has {', '.join(TEXTURES_BY_NAME)}")
    channels = max(row.choices)
    return row.choices[channels][0].reranging.inverse(np.array(row.default))[:channels]


def unpack(packed: PackedMaterial, *, defaults: bool = True) -> AxfMaterial:
    """The material the shader will see, in AxF's ranges again.

    Args:
        packed: a packed material, not necessarily packed by `pack`.
        defaults: whether textures that are only the target's defaults become textures of the material, too.

    Returns:
        A material whose textures are decoded and re-ranged back (float32). What packing lost stays lost. A car paint
        without the clear-coat flag comes back with a coat of index 1, which is none.

    Raises:
        InputError: a texture, format or packed integer the target does not know.
    """
    textures = {}
    slices = None
    for texture in packed.textures.values():
        if texture.defaulted and not defaults:
            continue
        read = reading(texture, packed.values)
        form = format_named(texture.format)
        levels = tuple(decode_level(codes, read, form, texture.channels) for codes in texture.levels)
        if texture.axf_name == "thetaFI_sliceLUT":
            slices = np.rint(levels[0].reshape(-1)).astype(np.int32)
        else:
            textures[texture.axf_name] = AxfTexture(levels, texture.width_mm, texture.height_mm, texture.source)
    return AxfMaterial(
        id=packed.id,
        name=packed.name,
        textures=textures,
        metadata=packed.metadata,
        **material_fields(packed, slices),
    )


def _chosen_formats(formats: Mapping[str, str]) -> dict[str, str]:
    known = {row.axf_name for row in TEXTURE_ROWS}
    for name in formats:
        if name not in known:
            raise InputError(f"{NAME}: a format is given for {name!r}; allowed names: {', '.join(sorted(known))}")
    return dict(formats)


def _choice(row: TextureRow, channels: int, format: str | None) -> FormatChoice:
    """The choice of that format (the advised one for None) for a texture of so many AxF channels."""
    if format is None:
        return row.choices[channels][0]
    choice = row.choice(channels, format)
    if choice is None:
        allowed = ", ".join(choice.format for choice in row.choices[channels])
        raise InputError(f"{NAME}: {row.name} of {channels} channels cannot be {format}; allowed: {allowed}")
    return choice


def _source(row: TextureRow, material: AxfMaterial) -> AxfTexture | None:
    """What AxF has for a row; the slice table is a property, made a texture of one row here."""
    if row.axf_name == "thetaFI_sliceLUT":
        table = material.properties.get("thetaFI_sliceLUT")
        return None if table is None else AxfTexture((np.asarray(table, dtype=np.float32).reshape(1, -1, 1),))
    return material.textures.get(row.axf_name)


def _default_wanted(row: TextureRow, material: AxfMaterial) -> bool:
    if row.absent is Absent.COAT_FLAG:
        return any(key.startswith("clearcoat") for key in material.textures)
    return row.absent is Absent.DEFAULT


def _default_texture(row: TextureRow, material: AxfMaterial, format: str | None, rounding: str) -> PackedTexture:
    channels = max(row.choices)
    if row.axf_name == "specularlobe":
        channels = 2 if material.anisotropic else 1
    choice = _choice(row, channels, format)
    form = format_named(choice.format)
    color = spread(np.array(row.default[: form.channels]), form.channels)
    shape = (1, 4, 4, form.channels) if row.array else (4, 4, form.channels)
    codes = form.encode(np.broadcast_to(color, shape), rounding)
    return PackedTexture(
        row.name, row.axf_name, choice.format, rounding, (codes,), channels, choice.reranging.formula, defaulted=True
    )


def _largest(source: AxfTexture, transform: Reranging) -> float:
    """The scale of an integer format: the largest value of any level, so that every code is used."""
    largest = max(float(transform.forward(level.max(keepdims=True)).max()) for level in source.levels)
    return float(np.float32(largest)) if largest > 0 else 1.0


def _texture(
    row: TextureRow, source: AxfTexture, transform: Reranging, format: str, rounding: str, material: AxfMaterial
) -> PackedTexture:
    form = format_named(format)
    # A Fresnel map of one channel is a gray color; other maps of one channel use the first channel alone.
    gray = source.channels == 1 and 3 in row.choices
    encoded = [encode_level(level, transform, form, rounding, gray=gray) for level in source.levels]
    codes = tuple(level for level, _ in encoded)
    counts = sum((count for _, count in encoded), Counts())
    if row.axf_name == "specularlobe" and material.specular_model not in ("BlinnPhong", "Phong"):
        counts += Counts(floored=sum(_floored(level, form.decode, source.channels) for level in codes))
    return PackedTexture(
        name=row.name,
        axf_name=row.axf_name,
        format=format,
        rounding=rounding,
        levels=codes,
        channels=source.channels,
        transform=transform.formula,
        counts=counts,
        width_mm=source.width_mm,
        height_mm=source.height_mm,
        source=source.source,
    )


def _floored(codes: np.ndarray, decode: Any, channels: int) -> int:
    return texels(decode(codes)[..., :channels] < ROUGHNESS_FLOOR)
