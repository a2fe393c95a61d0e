"""Sixteen-bit PNG files: what a public extractor of AxF textures writes for tools that read nothing else.

- colors: x^(1/2.2) of [0, 1]; negative and brighter values are clamped and counted;
- normals: 0.5 (1 + n);
- the color table and the flakes: divided by their maximum when it exceeds 1, then x^(1/2.2);
- indices of refraction: as F0, then x^(1/2.2);
- the slice table: an 8-bit PNG of the indices themselves.

Inferred, since the extractor's rules for them are not known: opacity and roughness are stored as they are (exponents
of the Phong family divided by their maximum), heights divided by their maximum, angles as 0.5 (1 + x/pi), the first
of three names AxF's SDK gives. Absent textures make no file. Properties are kept beside the files under AxF's names.
"""

from ..axf import AxfMaterial
from ..textures.rerange import ClampNegative, Identity, IorToF0, Reranging, SignedAngle, UnitOffset
from .bitfields import Flags
from .engine import Engine, Prepared
from .record import LOBES_ROW, RECORD_ROWS, record_flags
from .rerangings import Gamma
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

NAME = "png16"


def _png(format: str, reranging: Reranging, curve: Reranging | None = None) -> tuple[FormatChoice, ...]:
    return (FormatChoice(format, reranging, curve=curve or Identity()),)


_COLOR = {3: _png("RGB16_UNORM", ClampNegative(), Gamma())}
_F0 = {1: _png("RGB16_UNORM", ClampNegative(), Gamma()), **_COLOR}
_NORMAL = {3: _png("RGB16_UNORM", UnitOffset())}
_LINEAR = _png("R16_UNORM", Identity())
_FLAT = (0.5, 0.5, 1.0)
_WHITE = (1.0, 1.0, 1.0)
_BLACK = (0.0, 0.0, 0.0)
_NO_FILE = Absent.NOTHING

TEXTURE_ROWS: tuple[TextureRow, ...] = (
    TextureRow("DiffuseColor", "diffusecolor", SVBRDF, _COLOR, _BLACK, _NO_FILE, provenance="x^(1/2.2)"),
    TextureRow("SpecularColor", "specularcolor", SVBRDF, _COLOR, _WHITE, _NO_FILE, provenance="x^(1/2.2)"),
    TextureRow("Normal", "normal", SVBRDF, _NORMAL, _FLAT, _NO_FILE, provenance="0.5 (1 + n)"),
    TextureRow(
        "SpecularLobe", "specularlobe", SVBRDF, {1: _LINEAR, 2: _png("RG16_UNORM", Identity())}, _WHITE, _NO_FILE,
        scale="SpecularLobe_scale", scaling=Scaling.ABOVE_ONE, provenance="inferred",
    ),
    TextureRow("Alpha", "opacity", SVBRDF, {1: _LINEAR}, (1.0,), _NO_FILE, provenance="inferred"),
    TextureRow("Fresnel", "fresnel", SVBRDF, _F0, _BLACK, _NO_FILE, provenance="x^(1/2.2)"),
    TextureRow(
        "AnisoRotation", "anisrotation", SVBRDF, {1: _png("R16_UNORM", SignedAngle())}, (0.5,), _NO_FILE,
        provenance="inferred",
    ),
    TextureRow(
        "Height", "height", SVBRDF, {1: _LINEAR}, (0.0,), _NO_FILE, scale="Height_max_mm", provenance="inferred"
    ),
    TextureRow(
        "BRDFcolors", "brdfcolors", CAR_PAINT, _COLOR, _WHITE, _NO_FILE,
        scale="BRDFcolors_scale", scaling=Scaling.ABOVE_ONE, provenance="divided by a maximum above 1, x^(1/2.2)",
    ),
    TextureRow(
        "BTFflakes", "btfflakes", CAR_PAINT, _COLOR, _BLACK, _NO_FILE,
        scale="BTFflakes_scale", scaling=Scaling.ABOVE_ONE, array=True,
        provenance="divided by a maximum above 1, x^(1/2.2)",
    ),
    TextureRow(
        SLICE_TABLE, SLICE_TABLE, CAR_PAINT, {1: _png("R8_UINT", Identity())}, (0.0,), Absent.FLAKES,
        provenance="8-bit PNG",
    ),
    TextureRow("ClearcoatColor", "clearcoatcolor", COMMON, _COLOR, _WHITE, _NO_FILE, provenance="x^(1/2.2)"),
    TextureRow("ClearcoatNormal", "clearcoatnormal", COMMON, _NORMAL, _FLAT, _NO_FILE, provenance="0.5 (1 + n)"),
    TextureRow(
        "ClearcoatIOR", "clearcoatior", COMMON, {1: _png("R16_UNORM", IorToF0(), Gamma())},
        (0.04 ** (1 / 2.2),), _NO_FILE, provenance="F0, x^(1/2.2)",
    ),
)  # fmt: skip
"""The texture table."""

_F, _U, _F4 = ValueType.FLOAT, ValueType.UINT, ValueType.FLOAT4
_AS_AXF = "the AxF property"

VALUE_ROWS: tuple[ValueRow, ...] = (
    *RECORD_ROWS,
    ValueRow("width_mm", _F, COMMON, Role.SIZE_U, 1.0, unit="mm", provenance="size of the maps"),
    ValueRow("height_mm", _F, COMMON, Role.SIZE_V, 1.0, unit="mm", provenance="size of the maps"),
    ValueRow("SpecularLobe_scale", _F, SVBRDF, Role.SCALE, 1.0, provenance="inferred"),
    ValueRow("Height_max_mm", _F, SVBRDF, Role.SCALE, 1.0, unit="mm", provenance="inferred"),
    ValueRow("BRDFcolors_scale", _F, CAR_PAINT, Role.SCALE, 1.0, provenance="the maximum, or 1"),
    ValueRow("BTFflakes_scale", _F, CAR_PAINT, Role.SCALE, 1.0, provenance="the maximum, or 1"),
    LOBES_ROW,
    ValueRow("CT_diffuse", _F, CAR_PAINT, "CT_diffuse", 0.0, provenance=_AS_AXF),
    ValueRow("CT_coeffs", _F4, CAR_PAINT, "CT_coeffs", 0.0, provenance=_AS_AXF),
    ValueRow("CT_F0s", _F4, CAR_PAINT, "CT_F0s", 0.0, provenance=_AS_AXF),
    ValueRow("CT_spreads", _F4, CAR_PAINT, "CT_spreads", 1.0, provenance=_AS_AXF),
    ValueRow("IOR", _F, CAR_PAINT, "IOR", 1.5, provenance=_AS_AXF),
    ValueRow("max_thetaI", _U, CAR_PAINT, "max_thetaI", 0, unit="bins", provenance=_AS_AXF),
    ValueRow("num_thetaF", _U, CAR_PAINT, "num_thetaF", 0, unit="bins", provenance=_AS_AXF),
    ValueRow("num_thetaI", _U, CAR_PAINT, "num_thetaI", 0, unit="bins", provenance=_AS_AXF),
)
"""The value table."""

TABLES = Tables(NAME, TEXTURE_ROWS, VALUE_ROWS, Flags)


def _prepare(material: AxfMaterial) -> Prepared:
    return Prepared(material, record_flags(material))


ENGINE = Engine(TABLES, prepare=_prepare)
pack, unpack, validate, reading = ENGINE.pack, ENGINE.unpack, ENGINE.validate, ENGINE.reading
texture_name, default_values = ENGINE.texture_name, ENGINE.default_values
values_of, scale_of = ENGINE.values_of, ENGINE.scale_of
