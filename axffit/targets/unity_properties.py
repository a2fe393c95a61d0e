"""Target `unity_2018`: every texture and value its AxF material expects, as data.

Source: "Connecting the AxF Format to the AxF Material Implementation in Unity" (2018-08-06), names to the letter.
The source was machine-read; three names are mended here (`_SVBRDF_BRDFType`, `_CarPaint_maxThetaI`,
`_CarPaint_numThetaI`). `_sRGB` in a name says how an 8-bit format stores the color; float formats hold it linear.
"""

import enum
from collections.abc import Mapping
from dataclasses import dataclass

from ..axf import MaterialKind
from ..textures.rerange import ClampNegative, Identity, IorToF0, Reranging, SignedAngle, SliceIndex, UnitOffset

_SVBRDF = frozenset({MaterialKind.SVBRDF})
_CAR_PAINT = frozenset({MaterialKind.CAR_PAINT})
_COMMON = _SVBRDF | _CAR_PAINT


class Absent(enum.Enum):
    """What the target gets when AxF has no such texture."""

    DEFAULT = "a 4x4 texture of the default color"
    HEIGHT_FLAG = "nothing: flag bit 3 says it is not sampled"
    COAT_FLAG = "nothing without any clear-coat texture (flag bit 1), otherwise a 4x4 texture of the default color"
    FLAKES = "nothing when there are no flakes"


@dataclass(frozen=True)
class FormatChoice:
    """A number format a texture may have, and the re-ranging that belongs to it.

    Attributes:
        format: its name.
        reranging: from AxF's range to the texture's, before any scale.
        announced: whether the source only announces it ("in the future"), so that no shader of 2018 reads it.
    """

    format: str
    reranging: Reranging
    announced: bool = False


@dataclass(frozen=True)
class TextureRow:
    """One texture of the target.

    Attributes:
        name: the target's name.
        axf_name: canonical AxF name of the texture (or of the property it is made from).
        kinds: the materials it belongs to.
        choices: for each number of AxF channels the formats allowed, the advised one first.
        default: what the shader samples when AxF has none, in the target's range, padded to the format's channels.
        absent: when that default is made.
        scale: the value the texture is divided by, or None.
        array: whether it is a Texture2DArray.
        provenance: the heading of the source, and what it says.
    """

    name: str
    axf_name: str
    kinds: frozenset[MaterialKind]
    choices: Mapping[int, tuple[FormatChoice, ...]]
    default: tuple[float, ...]
    absent: Absent = Absent.DEFAULT
    scale: str | None = None
    array: bool = False
    provenance: str = ""

    def choice(self, channels: int, format: str) -> FormatChoice | None:
        """The choice of that format, or None if it is not allowed for so many channels."""
        return next((choice for choice in self.choices[channels] if choice.format == format), None)


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
        "_SVBRDF_DiffuseColorMap_sRGB", "diffusecolor", _SVBRDF, {3: _color()}, _BLACK,
        provenance="SVBRDF-Only Textures: RGB diffuse color",
    ),
    TextureRow(
        "_SVBRDF_SpecularColorMap_sRGB", "specularcolor", _SVBRDF, {3: _color()}, _WHITE,
        provenance="SVBRDF-Only Textures: RGB specular color",
    ),
    TextureRow(
        "_SVBRDF_NormalMap", "normal", _SVBRDF, {3: _NORMAL}, _FLAT,
        provenance="SVBRDF-Only Textures: tangent-space normal with offset; float values directly announced",
    ),
    TextureRow(
        "_SVBRDF_SpecularLobeMap", "specularlobe", _SVBRDF, _LOBE, _WHITE,
        provenance="SVBRDF-Only Textures: roughness; one channel isotropic, two anisotropic",
    ),
    TextureRow(
        "_SVBRDF_OpacityMap", "opacity", _SVBRDF, {1: _scalar(Identity(), "R8_UNORM")}, (1.0,),
        provenance="SVBRDF-Only Textures: alpha in [0, 1]",
    ),
    TextureRow(
        "_SVBRDF_FresnelMap_sRGB", "fresnel", _SVBRDF, {1: _color(), 3: _color()}, _BLACK,
        provenance="SVBRDF-Only Textures: RGB F0 in [0, 1]",
    ),
    TextureRow(
        "_SVBRDF_AnisotropicRotationAngleMap", "anisrotation", _SVBRDF, {1: _ANGLE}, (0.5,),
        provenance="SVBRDF-Only Textures: angle in [-pi, pi]; float values directly announced; default 0 rad is ours",
    ),
    TextureRow(
        "_SVBRDF_HeightMap", "height", _SVBRDF, {1: _scalar(Identity(), "R16F", "R32F", "R16_UNORM")}, (0.0,),
        absent=Absent.HEIGHT_FLAG, scale="_SVBRDF_heightMapMax_mm",
        provenance="SVBRDF-Only Textures: millimeters, rescaled by _SVBRDF_heightMapMax_mm",
    ),
    TextureRow(
        "_CarPaint_BRDFColorMap_sRGB", "brdfcolors", _CAR_PAINT, {3: _color()}, _WHITE,
        scale="_CarPaint_BRDFColorMap_Scale",
        provenance="Car-Paint-Only Textures: RGB over (theta_h, theta_d)",
    ),
    TextureRow(
        "_CarPaint_BTFFlakesMap_sRGB", "btfflakes", _CAR_PAINT, {3: _color()}, _BLACK,
        scale="_CarPaint_BTFFlakesMap_Scale", array=True,
        provenance="Car-Paint-Only Textures: Texture2DArray, every mip level as AxF gives it",
    ),
    TextureRow(
        "_CarPaint_thetaFI_sliceLUTMap", "thetaFI_sliceLUT", _CAR_PAINT,
        {1: (FormatChoice("R8_UNORM", SliceIndex()), FormatChoice("R8_UINT", Identity(), announced=True))},
        (0.0,), absent=Absent.FLAKES,
        provenance="Car-Paint-Only Textures: made from the property, divided by 255; R8_UINT announced",
    ),
    TextureRow(
        "_SVBRDF_ClearCoatColorMap_sRGB", "clearcoatcolor", _COMMON, {3: _color()}, _WHITE,
        absent=Absent.COAT_FLAG, provenance=f"Common Textures: RGB coat color, {_REFRACTING}",
    ),
    TextureRow(
        "_SVBRDF_ClearCoatNormalMap", "clearcoatnormal", _COMMON, {3: _NORMAL}, _FLAT,
        absent=Absent.COAT_FLAG, provenance=f"Common Textures: normal with offset, {_REFRACTING}",
    ),
    TextureRow(
        "_SVBRDF_ClearCoatIORMap_sRGB", "clearcoatior", _COMMON, {1: _scalar(IorToF0(), "R16F", "R32F")}, (0.04,),
        absent=Absent.COAT_FLAG, provenance=f"Common Textures: IOR as F0, {_REFRACTING}; default IOR 1.5",
    ),
)  # fmt: skip
"""The texture table, in the order of the source."""

TEXTURES_BY_NAME: Mapping[str, TextureRow] = {row.name: row for row in TEXTURE_ROWS}


class ValueType(enum.Enum):
    """Type of a shader constant."""

    FLOAT = "float"
    UINT = "uint"
    FLOAT4 = "float4"


@dataclass(frozen=True)
class ValueRow:
    """One value of the target.

    Attributes:
        name: the target's name.
        type: type of the shader constant.
        kinds: the materials it belongs to.
        axf_name: the AxF property it comes from, or "" when it is made otherwise.
        default: used when the property is absent; for a float4 also the padding of unused components.
        exposed: whether the user of the engine may change it.
        unit: unit, or what the number is.
        provenance: the heading of the source, and what it says.
    """

    name: str
    type: ValueType
    kinds: frozenset[MaterialKind]
    axf_name: str
    default: float
    exposed: bool = False
    unit: str = ""
    provenance: str = ""


_F, _U, _F4 = ValueType.FLOAT, ValueType.UINT, ValueType.FLOAT4
_SIZE = "Common Values: size of the range, the uv scale factor"
_PAINT = "Car-Paint-Only Values: "
_ONE = "1 for a float format"
_FLAKES = "Flakes Descriptors"
_LOBES = "Cook-Torrance Lobes Descriptors: up to four components"

VALUE_ROWS: tuple[ValueRow, ...] = (
    ValueRow("_materialSizeU_mm", _F, _COMMON, "", 1.0, exposed=True, unit="mm", provenance=_SIZE),
    ValueRow("_materialSizeV_mm", _F, _COMMON, "", 1.0, exposed=True, unit="mm", provenance=_SIZE),
    ValueRow("_flags", _U, _COMMON, "", 0, unit="bits", provenance="Common Values: bitfields.Flags"),
    ValueRow("_SVBRDF_BRDFType", _U, _SVBRDF, "", 0, unit="bits", provenance="SVBRDF-Only Values: bitfields.BrdfType"),
    ValueRow("_SVBRDF_BRDFVariants", _U, _SVBRDF, "", 0, unit="bits", provenance="SVBRDF-Only Values: BrdfVariants"),
    ValueRow("_SVBRDF_heightMapMax_mm", _F, _SVBRDF, "", 1.0, unit="mm", provenance=f"SVBRDF-Only Values: {_ONE}"),
    ValueRow("_CarPaint_CT_diffuse", _F, _CAR_PAINT, "CT_diffuse", 0.0, provenance=_PAINT + "diffuse factor"),
    ValueRow("_CarPaint_IOR", _F, _CAR_PAINT, "IOR", 1.5, provenance=_PAINT + "clear-coat IOR"),
    ValueRow("_CarPaint_BRDFColorMap_Scale", _F, _CAR_PAINT, "", 1.0, provenance=_PAINT + _ONE),
    ValueRow("_CarPaint_BTFFlakesMap_Scale", _F, _CAR_PAINT, "", 1.0, provenance=_PAINT + _ONE),
    ValueRow("_CarPaint_lobesCount", _U, _CAR_PAINT, "", 0, unit="lobes", provenance=_LOBES),
    ValueRow("_CarPaint_CT_F0s", _F4, _CAR_PAINT, "CT_F0s", 0.0, provenance=_LOBES),
    ValueRow("_CarPaint_CT_coefs", _F4, _CAR_PAINT, "CT_coeffs", 0.0, provenance=_LOBES),
    ValueRow("_CarPaint_CT_spreads", _F4, _CAR_PAINT, "CT_spreads", 1.0, provenance=_LOBES),
    ValueRow("_CarPaint_FlakesTiling", _F, _CAR_PAINT, "", 10.0, exposed=True, provenance=_FLAKES + ": not AxF"),
    ValueRow("_CarPaint_maxThetaI", _U, _CAR_PAINT, "max_thetaI", 0, unit="bins", provenance=_FLAKES),
    ValueRow("_CarPaint_numThetaF", _U, _CAR_PAINT, "num_thetaF", 0, unit="bins", provenance=_FLAKES),
    ValueRow("_CarPaint_numThetaI", _U, _CAR_PAINT, "num_thetaI", 0, unit="bins", provenance=_FLAKES),
)  # fmt: skip
"""The value table, in the order of the source."""

VALUES_BY_NAME: Mapping[str, ValueRow] = {row.name: row for row in VALUE_ROWS}

MAXIMUM_LOBES = 4
"""Components of the lobe descriptors."""
