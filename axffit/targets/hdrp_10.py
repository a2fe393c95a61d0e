"""Unity's High Definition Render Pipeline 10: what its AxF shader reads, and how.

Source: the public shader (`AxF.shader`, `AxFProperties.hlsl`, `AxFData.hlsl`) and `AxFAPI.cs`. The importer is a
closed package; what it writes is inferred from what the shader reads, and so marked.

What differs from `unity_2018`:

- the angle is read as (pi/2)(2 x - 1): an angle packed by the specification of 2018 turns by half of itself;
- every texture is a half float, colors linear sRGB; the scales are 1;
- normals are unpacked from two components with z rebuilt, or from three, by platform: RG16F or RGBA16F;
- bit 4 of the flags makes theta_d stop at pi/2 - theta_h in the color table. The shader's comment says that the
  importer sets it for tables that are black beyond the diagonal; inferred: exactly for those whose every texel
  beyond it is 0. The uv scale (for tables black in even more than half) stays (1, 1, 0, 0);
- flake angles are binned with num_thetaF for both;
- the index of a clear coat is at least 1.001;
- the slice table is read as 255 x, like that of 2018, but from a half (inferred from "every texture a half");
- absent textures are the shader's own default colors (the rotation map's is black, which is -pi/2, and matters to
  anisotropic materials only). That the importer leaves them to the shader is inferred;
- a size in millimeters has no place; tiling is `_Material_SO`.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..axf import AxfMaterial, MaterialKind
from ..textures.rerange import Chain, ClampNegative, Identity, IorToF0, Reranging, SignedAngle, SliceIndex, UnitOffset
from .base import PackedMaterial
from .bitfields import HdrpFlags
from .engine import Engine, Prepared
from .rerangings import AtLeast, TwoComponents
from .table import (
    CAR_PAINT,
    COMMON,
    SLICE_TABLE,
    SVBRDF,
    Absent,
    FormatChoice,
    Role,
    Tables,
    TextureRow,
    ValueRow,
    ValueType,
)
from .values import flags, shader_constant

NAME = "hdrp_10"

LOWEST_IOR = 1.001
"""The shader's smallest index of a clear coat: the exact Fresnel formula divides by n - 1."""

_LOWEST_F0 = float(IorToF0().forward(np.array([LOWEST_IOR]))[0])


def _half(format: str, reranging: Reranging) -> tuple[FormatChoice, ...]:
    return (FormatChoice(format, reranging),)


_COLOR = {3: _half("RGBA16F", ClampNegative())}
_F0 = {1: _half("RGBA16F", ClampNegative()), **_COLOR}
_NORMAL = {3: (FormatChoice("RG16F", TwoComponents()), FormatChoice("RGBA16F", UnitOffset()))}
_LOBE = {1: _half("R16F", Identity()), 2: _half("RG16F", Identity())}
_COAT_IOR = {1: _half("R16F", Chain((IorToF0(), AtLeast(_LOWEST_F0))))}
_BUMP = (0.5, 0.5, 1.0, 1.0)
_WHITE = (1.0, 1.0, 1.0, 1.0)
_BLACK = (0.0, 0.0, 0.0, 0.0)
_SHADER = "AxF.shader, Properties"
_COAT = f"{_SHADER}: without any clear-coat texture none is made"

TEXTURE_ROWS: tuple[TextureRow, ...] = (
    TextureRow("_SVBRDF_DiffuseColorMap", "diffusecolor", SVBRDF, _COLOR, _WHITE, provenance=_SHADER),
    TextureRow("_SVBRDF_SpecularColorMap", "specularcolor", SVBRDF, _COLOR, _WHITE, provenance=_SHADER),
    TextureRow("_SVBRDF_NormalMap", "normal", SVBRDF, _NORMAL, _BUMP, provenance=_SHADER),
    TextureRow(
        "_SVBRDF_SpecularLobeMap", "specularlobe", SVBRDF, _LOBE, _WHITE,
        scale="_SVBRDF_SpecularLobeMapScale", provenance=_SHADER,
    ),
    TextureRow("_SVBRDF_AlphaMap", "opacity", SVBRDF, {1: _half("R16F", Identity())}, _WHITE, provenance=_SHADER),
    TextureRow("_SVBRDF_FresnelMap", "fresnel", SVBRDF, _F0, _WHITE, provenance=_SHADER),
    TextureRow(
        "_SVBRDF_AnisoRotationMap", "anisrotation", SVBRDF,
        {1: _half("R16F", SignedAngle(half_range=float(np.pi / 2)))}, _BLACK,
        provenance="AxFData.hlsl: HALF_PI (2 x - 1), for angles in [-pi/2, pi/2)",
    ),
    TextureRow(
        "_SVBRDF_HeightMap", "height", SVBRDF, {1: _half("R16F", Identity())}, _BLACK,
        absent=Absent.HEIGHT_FLAG, scale="_SVBRDF_HeightMapMaxMM", provenance=_SHADER,
    ),
    TextureRow(
        "_CarPaint2_BRDFColorMap", "brdfcolors", CAR_PAINT, _COLOR, _WHITE,
        scale="_CarPaint2_BRDFColorMapScale", provenance=_SHADER,
    ),
    TextureRow(
        "_CarPaint2_BTFFlakeMap", "btfflakes", CAR_PAINT, _COLOR, _BLACK,
        scale="_CarPaint2_BTFFlakeMapScale", array=True, provenance=_SHADER,
    ),
    TextureRow(
        "_CarPaint2_FlakeThetaFISliceLUTMap", SLICE_TABLE, CAR_PAINT, {1: _half("R16F", SliceIndex())}, _BLACK,
        absent=Absent.FLAKES, provenance=f"{_SHADER}; the shader multiplies the texel by 255",
    ),
    TextureRow(
        "_SVBRDF_ClearcoatColorMap", "clearcoatcolor", SVBRDF, _COLOR, _WHITE,
        absent=Absent.COAT_FLAG, provenance=_COAT,
    ),
    TextureRow(
        "_ClearcoatNormalMap", "clearcoatnormal", COMMON, _NORMAL, _BUMP, absent=Absent.COAT_FLAG, provenance=_COAT
    ),
    TextureRow(
        "_SVBRDF_ClearcoatIORMap", "clearcoatior", SVBRDF, _COAT_IOR, _BLACK, absent=Absent.COAT_FLAG, provenance=_COAT
    ),
)  # fmt: skip
"""The texture table, in the order of the shader."""

_F, _U, _F4 = ValueType.FLOAT, ValueType.UINT, ValueType.FLOAT4
_USELESS = f"{_SHADER}: useless for half floats, 1"

VALUE_ROWS: tuple[ValueRow, ...] = (
    ValueRow("_AxF_BRDFType", _U, COMMON, Role.NONE, 0, provenance=f"{_SHADER}: 0 SVBRDF, 1 CarPaint"),
    ValueRow("_Flags", _U, COMMON, Role.FLAGS, 0, unit="bits", provenance="AxF.cs: bitfields.HdrpFlags"),
    ValueRow("_SVBRDF_BRDFType", _U, SVBRDF, Role.BRDF_TYPE, 0, unit="bits", provenance="AxFAPI.cs"),
    ValueRow("_SVBRDF_BRDFVariants", _U, SVBRDF, Role.BRDF_VARIANTS, 0, unit="bits", provenance="AxFAPI.cs"),
    ValueRow("_SVBRDF_SpecularLobeMapScale", _F, SVBRDF, Role.SCALE, 1.0, provenance=_USELESS),
    ValueRow("_SVBRDF_HeightMapMaxMM", _F, SVBRDF, Role.SCALE, 1.0, unit="mm", provenance=_USELESS),
    ValueRow("_CarPaint2_CTDiffuse", _F, CAR_PAINT, "CT_diffuse", 0.0, provenance=_SHADER),
    ValueRow("_CarPaint2_ClearcoatIOR", _F, CAR_PAINT, "IOR", 1.5, provenance="AxFData.hlsl: at least 1.001"),
    ValueRow("_CarPaint2_BRDFColorMapScale", _F, CAR_PAINT, Role.SCALE, 1.0, provenance=_USELESS),
    ValueRow("_CarPaint2_BRDFColorMapUVScale", _F4, CAR_PAINT, Role.NONE, 0.0, provenance=f"{_SHADER}: (1, 1, 0, 0)"),
    ValueRow("_CarPaint2_BTFFlakeMapScale", _F, CAR_PAINT, Role.SCALE, 1.0, provenance=_USELESS),
    ValueRow("_CarPaint2_LobeCount", _U, CAR_PAINT, Role.LOBES_COUNT, 0, unit="lobes", provenance=_SHADER),
    ValueRow("_CarPaint2_CTF0s", _F4, CAR_PAINT, "CT_F0s", 0.0, provenance="padding as in 2018: inferred"),
    ValueRow("_CarPaint2_CTCoeffs", _F4, CAR_PAINT, "CT_coeffs", 0.0, provenance="padding as in 2018: inferred"),
    ValueRow("_CarPaint2_CTSpreads", _F4, CAR_PAINT, "CT_spreads", 1.0, provenance=f"{_SHADER}: (1, 1, 1, 1)"),
    ValueRow("_CarPaint2_FlakeMaxThetaI", _U, CAR_PAINT, "max_thetaI", 0, unit="bins", provenance=_SHADER),
    ValueRow("_CarPaint2_FlakeNumThetaF", _U, CAR_PAINT, "num_thetaF", 0, unit="bins", provenance=_SHADER),
    ValueRow("_CarPaint2_FlakeNumThetaI", _U, CAR_PAINT, "num_thetaI", 0, unit="bins", provenance=_SHADER),
)  # fmt: skip
"""The value table, in the order of the shader."""

TABLES = Tables(NAME, TEXTURE_ROWS, VALUE_ROWS, HdrpFlags)


def is_black_beyond_diagonal(table: np.ndarray) -> bool:
    """Whether a color table [H, W, 3] is 0 wherever theta_h + theta_d > pi/2, and not 0 everywhere.

    Texel (row, column) stands for theta_d = (pi/2) row / (H - 1), theta_h = (pi/2) column / (W - 1).
    """
    height, width, _ = table.shape
    if height < 2 or width < 2:
        return False
    rows, columns = np.mgrid[:height, :width]
    beyond = rows * (width - 1) + columns * (height - 1) > (height - 1) * (width - 1)
    return bool(np.any(table != 0) and not np.any(table[beyond]))


def _prepare(material: AxfMaterial) -> Prepared:
    word = HdrpFlags(flags(material))
    values: dict[str, Any] = {"_AxF_BRDFType": int(material.kind is MaterialKind.CAR_PAINT)}
    if material.kind is MaterialKind.CAR_PAINT:
        colors = material.textures.get("brdfcolors")
        if colors is not None and is_black_beyond_diagonal(colors.data):
            word |= HdrpFlags.COLOR_TABLE_DIAGONAL_CLAMP
        values["_CarPaint2_BRDFColorMapUVScale"] = (1.0, 1.0, 0.0, 0.0)
        index = TABLES.value_of("IOR", material.kind)
        assert index is not None
        values[index.name] = max(
            shader_constant(index, material.properties.get("IOR")), shader_constant(index, LOWEST_IOR)
        )
    return Prepared(material, {**values, "_Flags": int(word)}, notes=tuple(_notes(material, word)))


def _notes(material: AxfMaterial, word: HdrpFlags) -> Iterator[str]:
    if word.clamps_color_table:
        yield "the color table is black beyond theta_h + theta_d = pi/2: bit 4 makes the shader stop at that diagonal"
    if float(material.properties.get("IOR", LOWEST_IOR)) < LOWEST_IOR:
        yield f"IOR {float(material.properties['IOR']):g} is raised to {LOWEST_IOR}, the shader's smallest"
    bins = material.properties.get("num_thetaF"), material.properties.get("num_thetaI")
    if None not in bins and bins[0] != bins[1]:
        yield f"flakes are binned with num_thetaF {bins[0]} for both angles; num_thetaI is {bins[1]}"


def _restore(packed: PackedMaterial, fields: dict[str, Any]) -> dict[str, Any]:
    # The shader raises the index when it reads it, whoever packed it.
    if "IOR" in fields["properties"] and fields["properties"]["IOR"] != 1.0:
        fields["properties"]["IOR"] = max(np.float32(LOWEST_IOR), np.float32(fields["properties"]["IOR"]))
    return fields


ENGINE = Engine(TABLES, prepare=_prepare, restore=_restore)
pack, unpack, validate, reading = ENGINE.pack, ENGINE.unpack, ENGINE.validate, ENGINE.reading
texture_name, default_values = ENGINE.texture_name, ENGINE.default_values
values_of, scale_of = ENGINE.values_of, ENGINE.scale_of
