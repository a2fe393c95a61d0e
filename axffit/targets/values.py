"""Values of a target by its table: from a material's properties, and back to a material's fields."""

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
    word_from_float,
)
from .table import MAXIMUM_LOBES, SLICE_TABLE, Absent, Role, Tables, ValueRow, ValueType


def material_values(tables: Tables, material: AxfMaterial) -> dict[str, Any]:
    """Every value of the material's kind, as the float32 or integer the shader constant holds; scales are 1."""
    made: dict[Role, Any] = {
        **_sizes(material),
        Role.FLAGS: flags(material),
        Role.BRDF_TYPE: brdf_type(material).pack(),
        Role.BRDF_VARIANTS: brdf_variants(material).pack(),
        Role.LOBES_COUNT: len(material.properties.get("CT_coeffs", ())),
    }
    values: dict[str, Any] = {}
    for row in tables.values:
        if material.kind in row.kinds:
            held = made.get(row.source) if isinstance(row.source, Role) else material.properties.get(row.source)
            values[row.name] = shader_constant(row, held)
    return values


def shader_constant(row: ValueRow, value: Any) -> Any:
    """A value in the type of its shader constant; the default for None, and as the padding of a vector."""
    if row.type is ValueType.UINT:
        return int(row.default if value is None else value)
    if row.type is ValueType.FLOAT:
        return float(np.float32(row.default if value is None else value))
    given = [] if value is None else [float(np.float32(number)) for number in value]
    return tuple(given + [float(np.float32(row.default))] * (row.type.length - len(given)))


def flags(material: AxfMaterial) -> int:
    """The flags all engines share: bit 1 by any clear-coat texture, bit 2 by `cc_no_refraction`, to the letter."""
    svbrdf = material.kind is MaterialKind.SVBRDF
    bits = (
        material.anisotropic and svbrdf,
        bool(coat_textures(material)),
        material.coat_refracts,
        "height" in material.textures and svbrdf,
    )
    return sum(bit << number for number, bit in enumerate(bits))


def brdf_type(material: AxfMaterial) -> BrdfType:
    """The packed models of a material."""
    return BrdfType(DIFFUSE_CODES[material.diffuse_model], SPECULAR_CODES[material.specular_model])


def brdf_variants(material: AxfMaterial) -> BrdfVariants:
    """The packed variants of a material; AxF's defaults where it names no variant."""
    variant = material.specular_variant
    return BrdfVariants(
        fresnel=FRESNEL_CODES[material.fresnel_variant],
        ward=WARD_CODES.get(variant or "", 0),
        blinn_phong=BLINN_PHONG_CODES.get(variant or "", 0),
    )


def coat_textures(material: AxfMaterial) -> list[str]:
    """AxF names of the clear-coat textures a material has."""
    return [key for key in material.textures if key.startswith("clearcoat")]


def word_of(tables: Tables, packed: PackedMaterial, role: Role) -> int:
    """A packed integer of a packed material; 0 where the target has none.

    Raises:
        InputError: the value is no whole number a float32 carries.
    """
    row = tables.value_of(role, packed.kind)
    return 0 if row is None else word_from_float(packed.values.get(row.name, 0))


def material_fields(tables: Tables, packed: PackedMaterial, slices: np.ndarray | None) -> dict[str, Any]:
    """Kind, models, variants and properties of a packed material, as `AxfMaterial` takes them.

    Raises:
        InputError: a packed integer without a meaning, or more lobes than four.
    """
    word = tables.flags(word_of(tables, packed, Role.FLAGS))
    properties: dict[str, Any] = {} if word.coat_refracts else {"cc_no_refraction": 1}
    if packed.kind is MaterialKind.CAR_PAINT:
        held = _paint_properties(tables, packed, coated=word.has_clear_coat)
        if slices is not None:
            held[SLICE_TABLE] = slices
        return {"kind": packed.kind, "properties": properties | held}
    kind = BrdfType.unpack(word_of(tables, packed, Role.BRDF_TYPE))
    variants = BrdfVariants.unpack(word_of(tables, packed, Role.BRDF_VARIANTS))
    for role, field in ((Role.BRDF_TYPE, kind), (Role.BRDF_VARIANTS, variants)):
        if not field.is_known:
            row = tables.value_of(role, packed.kind)
            name = "" if row is None else row.name
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


def common_notes(tables: Tables, material: AxfMaterial) -> Iterator[str]:
    """What a person should know about this material in any target, one sentence each."""
    placed = {row.axf_name for row in tables.textures if material.kind in row.kinds}
    unplaced = [key for key in material.textures if key not in placed]
    if unplaced:
        yield f"not packed, the target has no place for them in a {material.kind.value}: {', '.join(unplaced)}"
    if tables.value_of(Role.SIZE_U, material.kind) is not None:
        yield from _size_notes(material)
    if material.kind is MaterialKind.CAR_PAINT:
        yield from _paint_notes(tables, material)


def size_of(material: AxfMaterial) -> tuple[float, float] | None:
    """Size in mm of the first map that varies over the surface, or None when every map is a constant."""
    maps = _sized_maps(material)
    return (maps[0].width_mm, maps[0].height_mm) if maps else None


def _sized_maps(material: AxfMaterial) -> list[AxfTexture]:
    """The maps that vary over the surface; flakes only when nothing else does, for they have a tiling of their own."""
    maps = {key: texture for key, texture in material.textures.items() if not texture.is_constant}
    others = [texture for key, texture in maps.items() if key not in ("btfflakes", "brdfcolors")]
    return others or [texture for key, texture in maps.items() if key == "btfflakes"]


def _sizes(material: AxfMaterial) -> dict[Role, float]:
    size = size_of(material)
    return {} if size is None else {Role.SIZE_U: size[0], Role.SIZE_V: size[1]}


def _size_notes(material: AxfMaterial) -> Iterator[str]:
    sizes = {(t.width_mm, t.height_mm) for t in _sized_maps(material)}
    if len(sizes) > 1:
        listed = ", ".join(f"{u:g} x {v:g}" for u, v in sorted(sizes))
        yield f"maps of different size in mm ({listed}); the target has one size and stretches the others"
    if not sizes:
        yield "every map is a spatial constant; the material size is 1 x 1 mm"


def _paint_properties(tables: Tables, packed: PackedMaterial, *, coated: bool) -> dict[str, Any]:
    row = tables.value_of(Role.LOBES_COUNT, packed.kind)
    count = 0 if row is None else int(packed.values.get(row.name, 0))
    if not 0 <= count <= MAXIMUM_LOBES:
        raise InputError(f"{packed.id}: {row.name if row else ''} is {count}; allowed: 0 to {MAXIMUM_LOBES}")
    properties: dict[str, Any] = {}
    for row in tables.values:
        if not row.axf_name or row.name not in packed.values:
            continue
        value = packed.values[row.name]
        if row.axf_name in LOBE_ARRAYS:
            if count:
                properties[row.axf_name] = value[:count]
        elif row.axf_name == "IOR" and not coated:
            # A coat that is not drawn equals one of index 1, which is how AxF can say it.
            properties["IOR"] = 1.0
        elif row.type is not ValueType.UINT or value != row.default:
            properties[row.axf_name] = value
    return properties


def _paint_notes(tables: Tables, material: AxfMaterial) -> Iterator[str]:
    if not coat_textures(material) and _coat_needs_texture(tables, material.kind):
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
    if (
        "btfflakes" in material.textures
        and SLICE_TABLE not in material.properties
        and tables.row_of(SLICE_TABLE, material.kind) is not None
    ):
        yield "flakes without thetaFI_sliceLUT: the target cannot find their slices and draws none"


def _coat_needs_texture(tables: Tables, kind: MaterialKind) -> bool:
    """Whether the target draws a coat only by a flag that its clear-coat textures set."""
    return any(row.absent is Absent.COAT_FLAG and kind in row.kinds for row in tables.textures)
