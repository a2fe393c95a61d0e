"""What an engine's importer turns into shader code, kept as values so that `unpack` knows AxF's models again.

These are no constants of the engine's: `unity_2018` has them as packed integers, other importers choose a shader by
them. Their names begin with ``axf_``, and their meaning is that of `bitfields`.
"""

from ..axf import AxfMaterial
from .table import CAR_PAINT, COMMON, SVBRDF, Role, ValueRow, ValueType
from .values import flags

_KEPT = "not the engine's: what the importer chooses a shader by"

RECORD_ROWS: tuple[ValueRow, ...] = (
    ValueRow("axf_flags", ValueType.UINT, COMMON, Role.FLAGS, 0, unit="bits", provenance=_KEPT),
    ValueRow("axf_brdf_type", ValueType.UINT, SVBRDF, Role.BRDF_TYPE, 0, unit="bits", provenance=_KEPT),
    ValueRow("axf_brdf_variants", ValueType.UINT, SVBRDF, Role.BRDF_VARIANTS, 0, unit="bits", provenance=_KEPT),
)

LOBES_ROW = ValueRow("axf_lobes_count", ValueType.UINT, CAR_PAINT, Role.LOBES_COUNT, 0, unit="lobes", provenance=_KEPT)


def record_flags(material: AxfMaterial) -> dict[str, int]:
    """`axf_flags`: bit 1 wherever AxF has a coat, since these importers need no clear-coat texture to draw one."""
    return {"axf_flags": flags(material) | 2 * material.has_clear_coat}
