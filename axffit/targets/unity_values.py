"""Values of target `unity_2018`: from a material's properties, and back to a material's fields."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..axf import AxfMaterial, AxfTexture, MaterialKind
from ..axf.validation import LOBE_ARRAYS
from ..errors import InputError
from .base import PackedMaterial
from .bitfields import (
    BLINN_PHONG_CODES,
    DIFFUSE_CODES,
    FRESNEL_CODES,
    SPECULAR_CODES,
    WARD_CODES,
    BrdfType,
    BrdfVariants,
    Flags,
    word_from_float,
)
from .unity_properties import MAXIMUM_LOBES, TEXTURE_ROWS, VALUE_ROWS, VALUES_BY_NAME, ValueType

SUPPORTED_IN_2018 = {"Lambert", "Ward"}
"""Models that the source of the table supports; it defines codes for the others."""

FLAKES_TILING = VALUES_BY_NAME["_CarPaint_FlakesTiling"].default


def material_values(material: AxfMaterial) -> dict[str, Any]:
    """Every value of the material's kind, as the float32 or integer the shader constant holds; scales are 1."""
    made = {**_sizes(material), "_flags": int(flags(material))}
    if material.kind is MaterialKind.SVBRDF:
        made |= {"_SVBRDF_BRDFType": brdf_type(material).pack(), "_SVBRDF_BRDFVariants": brdf_variants(material).pack()}
    else:
        made["_CarPaint_lobesCount"] = len(material.properties.get("CT_coeffs", ()))
    values: dict[str, Any] = {}
    for row in VALUE_ROWS:
        if material.kind not in row.kinds:
            continue
        value = made.get(row.name, material.properties.get(row.axf_name, None))
        if row.type is ValueType.FLOAT4:
            values[row.name] = _float4(value, row.default)
        elif row.type is ValueType.UINT:
            values[row.name] = int(row.default if value is None else value)
        else:
            values[row.name] = float(np.float32(row.default if value is None else value))
    return values


def flags(material: AxfMaterial) -> Flags:
    """`_flags`: bit 1 by any clear-coat texture, bit 2 by `cc_no_refraction`, to the letter of the source."""
    word = Flags(0)
    if material.anisotropic and material.kind is MaterialKind.SVBRDF:
        word |= Flags.ANISOTROPIC
    if _coat_textures(material):
        word |= Flags.CLEAR_COAT
    if material.coat_refracts:
        word |= Flags.CLEAR_COAT_REFRACTS
    if "height" in material.textures and material.kind is MaterialKind.SVBRDF:
        word |= Flags.HEIGHT_MAP
    return word


def brdf_type(material: AxfMaterial) -> BrdfType:
    """`_SVBRDF_BRDFType` of a material."""
    return BrdfType(DIFFUSE_CODES[material.diffuse_model], SPECULAR_CODES[material.specular_model])


def brdf_variants(material: AxfMaterial) -> BrdfVariants:
    """`_SVBRDF_BRDFVariants` of a material; AxF's defaults where it names no variant."""
    variant = material.specular_variant
    return BrdfVariants(
        fresnel=FRESNEL_CODES[material.fresnel_variant],
        ward=WARD_CODES.get(variant or "", 0),
        blinn_phong=BLINN_PHONG_CODES.get(variant or "", 0),
    )


def material_notes(material: AxfMaterial) -> Iterator[str]:
    """What a person should know about this material in this target, one sentence each."""
    for model in (material.diffuse_model, material.specular_model):
        if material.kind is MaterialKind.SVBRDF and model not in SUPPORTED_IN_2018:
            yield f"{model} has a code in the target's table, but the shader of 2018 does not support it"
    placed = {row.axf_name for row in TEXTURE_ROWS if material.kind in row.kinds}
    unplaced = [key for key in material.textures if key not in placed]
    if unplaced:
        yield f"not packed, the target has no place for them in a {material.kind.value}: {', '.join(unplaced)}"
    sizes = {(t.width_mm, t.height_mm) for t in _sized_maps(material)}
    if len(sizes) > 1:
        listed = ", ".join(f"{u:g} x {v:g}" for u, v in sorted(sizes))
        yield f"maps of different size in mm ({listed}); the target has one size and stretches the others"
    if not sizes:
        yield "every map is a spatial constant; the material size is 1 x 1 mm"
    if material.kind is MaterialKind.CAR_PAINT:
        yield from _paint_notes(material)


def material_fields(packed: PackedMaterial, slices: np.ndarray | None) -> dict[str, Any]:
    """Kind, models, variants and properties of a packed material, as `AxfMaterial` takes them.

    Raises:
        InputError: a packed integer without a meaning, or more lobes than four.
    """
    word = Flags(word_from_float(packed.values.get("_flags", 0)))
    properties: dict[str, Any] = {} if word.coat_refracts else {"cc_no_refraction": 1}
    if packed.kind is MaterialKind.CAR_PAINT:
        return {"kind": packed.kind, "properties": properties | _paint_properties(packed, word, slices)}
    kind = BrdfType.unpack(word_from_float(packed.values.get("_SVBRDF_BRDFType", 0)))
    variants = BrdfVariants.unpack(word_from_float(packed.values.get("_SVBRDF_BRDFVariants", 0)))
    for name, field in (("_SVBRDF_BRDFType", kind), ("_SVBRDF_BRDFVariants", variants)):
        if not field.is_known:
            raise InputError(
                f"{packed.id}: {name} is {packed.values[name]}, which has no meaning; see targets.bitfields"
            )
    return {
        "kind": packed.kind,
        "diffuse_model": kind.diffuse_model,
        "specular_model": kind.specular_model,
        "specular_variant": variants.specular_variant(kind.specular_model),
        "fresnel_variant": variants.fresnel_variant,
        "anisotropic": word.is_anisotropic,
        "properties": properties,
    }


def _coat_textures(material: AxfMaterial) -> list[str]:
    return [key for key in material.textures if key.startswith("clearcoat")]


def _sized_maps(material: AxfMaterial) -> list[AxfTexture]:
    """The maps that vary over the surface; flakes only when nothing else does, for they have a tiling of their own."""
    maps = {key: texture for key, texture in material.textures.items() if not texture.is_constant}
    others = [texture for key, texture in maps.items() if key not in ("btfflakes", "brdfcolors")]
    return others or [texture for key, texture in maps.items() if key == "btfflakes"]


def _sizes(material: AxfMaterial) -> dict[str, float]:
    """The size of the first map that has one; the default when every map is a constant."""
    maps = _sized_maps(material)
    if not maps:
        return {}
    return {"_materialSizeU_mm": maps[0].width_mm, "_materialSizeV_mm": maps[0].height_mm}


def _float4(value: Any, padding: float) -> tuple[float, ...]:
    given = [] if value is None else [float(np.float32(number)) for number in value]
    return tuple(given + [float(np.float32(padding))] * (MAXIMUM_LOBES - len(given)))


def _paint_properties(packed: PackedMaterial, word: Flags, slices: np.ndarray | None) -> dict[str, Any]:
    count = int(packed.values.get("_CarPaint_lobesCount", 0))
    if not 0 <= count <= MAXIMUM_LOBES:
        raise InputError(f"{packed.id}: _CarPaint_lobesCount is {count}; allowed: 0 to {MAXIMUM_LOBES}")
    properties: dict[str, Any] = {}
    for row in VALUE_ROWS:
        if not row.axf_name or row.name not in packed.values:
            continue
        value = packed.values[row.name]
        if row.axf_name in LOBE_ARRAYS:
            if count:
                properties[row.axf_name] = value[:count]
        elif row.axf_name == "IOR" and not word.has_clear_coat:
            # A coat that is not drawn equals one of index 1, which is how AxF can say it.
            properties["IOR"] = 1.0
        elif row.type is not ValueType.UINT or value != row.default:
            properties[row.axf_name] = value
    if slices is not None:
        properties["thetaFI_sliceLUT"] = slices
    return properties


def _paint_notes(material: AxfMaterial) -> Iterator[str]:
    if not _coat_textures(material):
        yield (
            "no clear-coat texture, so flag bit 1 stays 0 and the target draws no coat; "
            "add a flat clearcoatnormal map to keep it"
        )
    ior, indices = material.properties.get("IOR"), material.textures.get("clearcoatior")
    if ior is not None and indices is not None:
        data = indices.data
        used = data[np.isfinite(data) & (data > 0)].astype(np.float64)
        worst = float(np.max(np.abs(used - float(ior)), initial=0.0))
        if worst > 1e-3:
            yield f"the clear-coat IOR map differs from the property IOR {float(ior):g} by up to {worst:.3g}; IOR rules"
    flakes = material.textures.get("btfflakes")
    sized = _sized_maps(material)
    if flakes is not None and not flakes.is_constant and sized:
        tiling = sized[0].width_mm / flakes.width_mm
        if abs(tiling - FLAKES_TILING) > 1e-3 * FLAKES_TILING:
            yield (
                f"flakes of {flakes.width_mm:g} mm on a material of {sized[0].width_mm:g} mm keep their size with "
                f"_CarPaint_FlakesTiling {tiling:.4g}; the target's default {FLAKES_TILING:g} is not an AxF value"
            )
    if flakes is not None and "thetaFI_sliceLUT" not in material.properties:
        yield "flakes without thetaFI_sliceLUT: the target cannot find their slices and draws none"
