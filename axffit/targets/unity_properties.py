"""Target `unity_2018`: every texture and value its AxF material expects, as data.

Source: "Connecting the AxF Format to the AxF Material Implementation in Unity" (2018-08-06), names to the letter.
The source was machine-read; three names are mended here (`_SVBRDF_BRDFType`, `_CarPaint_maxThetaI`,
`_CarPaint_numThetaI`). `_sRGB` in a name says how an 8-bit format stores the color; float formats hold it linear.
"""

from ..textures.rerange import ClampNegative, Identity, IorToF0, Reranging, SignedAngle, SliceIndex, UnitOffset
from .bitfields import Flags
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


def _color(*more: str) -> tuple[FormatChoice, ...]:
    formats = ("RGBA16F", "RGBA32F", "RGBA8_UNORM_SRGB", *more)
    return tuple(FormatChoice(name, ClampNegative()) for name in formats)


def _scalar(reranging: Reranging, *formats: str) -> tuple[FormatChoice, ...]:
    return tuple(FormatChoice(name, reranging) for name in formats)


_NORMAL = (
    FormatChoice("RGBA16_UNORM", UnitOffset()),
    FormatChoice("RGBA16F", Identity(), announced=True),
    FormatChoice("RGBA32F", Identity(), announced=True),
)
_ANGLE = (
    FormatChoice("RGBA16_UNORM", SignedAngle()),
    FormatChoice("R16F", Identity(), announced=True),
    FormatChoice("R32F", Identity(), announced=True),
)
_LOBE = {
    1: _scalar(Identity(), "R16F", "R32F"),
    2: _scalar(Identity(), "RG16F", "RG32F"),
}
_FLAT = (0.5, 0.5, 1.0, 1.0)
_WHITE = (1.0, 1.0, 1.0, 1.0)
_BLACK = (0.0, 0.0, 0.0, 0.0)
_REFRACTING = "usually provided if cc_no_refraction is absent or 0"

TEXTURE_ROWS: tuple[TextureRow, ...] = (
    TextureRow(
        "_SVBRDF_DiffuseColorMap_sRGB", "diffusecolor", SVBRDF, {3: _color()}, _BLACK,
        provenance="SVBRDF-Only Textures: RGB diffuse color",
    ),
    TextureRow(
        "_SVBRDF_SpecularColorMap_sRGB", "specularcolor", SVBRDF, {3: _color()}, _WHITE,
        provenance="SVBRDF-Only Textures: RGB specular color",
    ),
    TextureRow(
        "_SVBRDF_NormalMap", "normal", SVBRDF, {3: _NORMAL}, _FLAT,
        provenance="SVBRDF-Only Textures: tangent-space normal with offset; float values directly announced",
    ),
    TextureRow(
        "_SVBRDF_SpecularLobeMap", "specularlobe", SVBRDF, _LOBE, _WHITE,
        provenance="SVBRDF-Only Textures: roughness; one channel isotropic, two anisotropic",
    ),
    TextureRow(
        "_SVBRDF_OpacityMap", "opacity", SVBRDF, {1: _scalar(Identity(), "R8_UNORM")}, (1.0,),
        provenance="SVBRDF-Only Textures: alpha in [0, 1]",
    ),
    TextureRow(
        "_SVBRDF_FresnelMap_sRGB", "fresnel", SVBRDF, {1: _color(), 3: _color()}, _BLACK,
        provenance="SVBRDF-Only Textures: RGB F0 in [0, 1]",
    ),
    TextureRow(
        "_SVBRDF_AnisotropicRotationAngleMap", "anisrotation", SVBRDF, {1: _ANGLE}, (0.5,),
        provenance="SVBRDF-Only Textures: angle in [-pi, pi]; float values directly announced; default 0 rad is ours",
    ),
    TextureRow(
        "_SVBRDF_HeightMap", "height", SVBRDF, {1: _scalar(Identity(), "R16F", "R32F", "R16_UNORM")}, (0.0,),
        absent=Absent.HEIGHT_FLAG, scale="_SVBRDF_heightMapMax_mm",
        provenance="SVBRDF-Only Textures: millimeters, rescaled by _SVBRDF_heightMapMax_mm",
    ),
    TextureRow(
        "_CarPaint_BRDFColorMap_sRGB", "brdfcolors", CAR_PAINT, {3: _color()}, _WHITE,
        scale="_CarPaint_BRDFColorMap_Scale",
        provenance="Car-Paint-Only Textures: RGB over (theta_h, theta_d)",
    ),
    TextureRow(
        "_CarPaint_BTFFlakesMap_sRGB", "btfflakes", CAR_PAINT, {3: _color()}, _BLACK,
        scale="_CarPaint_BTFFlakesMap_Scale", array=True,
        provenance="Car-Paint-Only Textures: Texture2DArray, every mip level as AxF gives it",
    ),
    TextureRow(
        "_CarPaint_thetaFI_sliceLUTMap", SLICE_TABLE, CAR_PAINT,
        {1: (FormatChoice("R8_UNORM", SliceIndex()), FormatChoice("R8_UINT", Identity(), announced=True))},
        (0.0,), absent=Absent.FLAKES,
        provenance="Car-Paint-Only Textures: made from the property, divided by 255; R8_UINT announced",
    ),
    TextureRow(
        "_SVBRDF_ClearCoatColorMap_sRGB", "clearcoatcolor", COMMON, {3: _color()}, _WHITE,
        absent=Absent.COAT_FLAG, provenance=f"Common Textures: RGB coat color, {_REFRACTING}",
    ),
    TextureRow(
        "_SVBRDF_ClearCoatNormalMap", "clearcoatnormal", COMMON, {3: _NORMAL}, _FLAT,
        absent=Absent.COAT_FLAG, provenance=f"Common Textures: normal with offset, {_REFRACTING}",
    ),
    TextureRow(
        "_SVBRDF_ClearCoatIORMap_sRGB", "clearcoatior", COMMON, {1: _scalar(IorToF0(), "R16F", "R32F")}, (0.04,),
        absent=Absent.COAT_FLAG, provenance=f"Common Textures: IOR as F0, {_REFRACTING}; default IOR 1.5",
    ),
)  # fmt: skip
"""The texture table, in the order of the source."""

_F, _U, _F4 = ValueType.FLOAT, ValueType.UINT, ValueType.FLOAT4
_SIZE = "Common Values: size of the range, the uv scale factor"
_PACKED = "SVBRDF-Only Values: bitfields.BrdfType, BrdfVariants"
_PAINT = "Car-Paint-Only Values: "
_ONE = "1 for a float format"
_MAXIMUM = f"SVBRDF-Only Values: {_ONE}"
_FLAKES = "Flakes Descriptors"
_LOBES = "Cook-Torrance Lobes Descriptors: up to four components"

VALUE_ROWS: tuple[ValueRow, ...] = (
    ValueRow("_materialSizeU_mm", _F, COMMON, Role.SIZE_U, 1.0, exposed=True, unit="mm", provenance=_SIZE),
    ValueRow("_materialSizeV_mm", _F, COMMON, Role.SIZE_V, 1.0, exposed=True, unit="mm", provenance=_SIZE),
    ValueRow("_flags", _U, COMMON, Role.FLAGS, 0, unit="bits", provenance="Common Values: bitfields.Flags"),
    ValueRow("_SVBRDF_BRDFType", _U, SVBRDF, Role.BRDF_TYPE, 0, unit="bits", provenance=_PACKED),
    ValueRow("_SVBRDF_BRDFVariants", _U, SVBRDF, Role.BRDF_VARIANTS, 0, unit="bits", provenance=_PACKED),
    ValueRow("_SVBRDF_heightMapMax_mm", _F, SVBRDF, Role.SCALE, 1.0, unit="mm", provenance=_MAXIMUM),
    ValueRow("_CarPaint_CT_diffuse", _F, CAR_PAINT, "CT_diffuse", 0.0, provenance=_PAINT + "diffuse factor"),
    ValueRow("_CarPaint_IOR", _F, CAR_PAINT, "IOR", 1.5, provenance=_PAINT + "clear-coat IOR"),
    ValueRow("_CarPaint_BRDFColorMap_Scale", _F, CAR_PAINT, Role.SCALE, 1.0, provenance=_PAINT + _ONE),
    ValueRow("_CarPaint_BTFFlakesMap_Scale", _F, CAR_PAINT, Role.SCALE, 1.0, provenance=_PAINT + _ONE),
    ValueRow("_CarPaint_lobesCount", _U, CAR_PAINT, Role.LOBES_COUNT, 0, unit="lobes", provenance=_LOBES),
    ValueRow("_CarPaint_CT_F0s", _F4, CAR_PAINT, "CT_F0s", 0.0, provenance=_LOBES),
    ValueRow("_CarPaint_CT_coefs", _F4, CAR_PAINT, "CT_coeffs", 0.0, provenance=_LOBES),
    ValueRow("_CarPaint_CT_spreads", _F4, CAR_PAINT, "CT_spreads", 1.0, provenance=_LOBES),
    ValueRow("_CarPaint_FlakesTiling", _F, CAR_PAINT, Role.NONE, 10.0, exposed=True, provenance=_FLAKES + ": not AxF"),
    ValueRow("_CarPaint_maxThetaI", _U, CAR_PAINT, "max_thetaI", 0, unit="bins", provenance=_FLAKES),
    ValueRow("_CarPaint_numThetaF", _U, CAR_PAINT, "num_thetaF", 0, unit="bins", provenance=_FLAKES),
    ValueRow("_CarPaint_numThetaI", _U, CAR_PAINT, "num_thetaI", 0, unit="bins", provenance=_FLAKES),
)  # fmt: skip
"""The value table, in the order of the source."""

TABLES = Tables("unity_2018", TEXTURE_ROWS, VALUE_ROWS, Flags)
"""The target."""
