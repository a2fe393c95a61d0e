"""Unity's AxF material as specified in 2018: `pack`, `unpack`, `validate`.

The tables are in `unity_properties`, the packed integers in `bitfields`; `engine` turns one AxF material into the
textures and values those tables ask for, and back into what the shader will see.
"""

from collections.abc import Iterator

from ..axf import AxfMaterial, MaterialKind
from .engine import Engine, Prepared
from .unity_properties import TABLES, VALUE_ROWS
from .values import size_of

NAME = TABLES.name

SUPPORTED_IN_2018 = {"Lambert", "Ward"}
"""Models that the source of the table supports; it defines codes for the others."""

FLAKES_TILING = next(row.default for row in VALUE_ROWS if row.name == "_CarPaint_FlakesTiling")


def _notes(material: AxfMaterial) -> Iterator[str]:
    for model in (material.diffuse_model, material.specular_model):
        if material.kind is MaterialKind.SVBRDF and model not in SUPPORTED_IN_2018:
            yield f"{model} has a code in the target's table, but the shader of 2018 does not support it"
    flakes, size = material.textures.get("btfflakes"), size_of(material)
    if material.kind is MaterialKind.CAR_PAINT and flakes is not None and not flakes.is_constant and size is not None:
        tiling = size[0] / flakes.width_mm
        if abs(tiling - FLAKES_TILING) > 1e-3 * FLAKES_TILING:
            yield (
                f"flakes of {flakes.width_mm:g} mm on a material of {size[0]:g} mm keep their size with "
                f"_CarPaint_FlakesTiling {tiling:.4g}; the target's default {FLAKES_TILING:g} is not an AxF value"
            )


def _prepare(material: AxfMaterial) -> Prepared:
    return Prepared(material, notes=tuple(_notes(material)))


ENGINE = Engine(TABLES, prepare=_prepare)
pack, unpack, validate, reading = ENGINE.pack, ENGINE.unpack, ENGINE.validate, ENGINE.reading
texture_name, default_values = ENGINE.texture_name, ENGINE.default_values
values_of, scale_of = ENGINE.values_of, ENGINE.scale_of
