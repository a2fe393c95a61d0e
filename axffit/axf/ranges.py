"""The legal range of every AxF quantity, in one table.

Outside its range a value is an error at the border, except where the target's rules say what becomes of it:
then it is legal to have, and `pack` counts it.
"""

import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


class Outside(enum.Enum):
    """What happens to a value outside its range."""

    ERROR = "refused at the border"
    COUNTED = "kept, replaced as the target says, and counted"


@dataclass(frozen=True)
class Range:
    """The closed interval of legal values of one quantity.

    Attributes:
        minimum: smallest legal value.
        maximum: largest legal value; infinity means no limit.
        unit: the unit, or what the number is.
        outside: what happens to other values.
        open_below: whether `minimum` itself is outside.
        slack: how far beyond an end a value still counts as inside, because storing it rounds.
    """

    minimum: float
    maximum: float
    unit: str
    outside: Outside = Outside.ERROR
    open_below: bool = False
    slack: float = 0.0

    def beyond(self, values: np.ndarray) -> np.ndarray:
        """Where values are outside, as booleans of the same shape; NaN is always outside."""
        low = self.minimum - self.slack
        inside = (values > low if self.open_below else values >= low) & (values <= self.maximum + self.slack)
        return ~inside

    def __str__(self) -> str:
        """The interval as people write it."""
        left = "(" if self.open_below or self.minimum == -math.inf else "["
        right = ")" if self.maximum == math.inf else "]"
        return f"{left}{self.minimum:g}, {self.maximum:g}{right}"


_COLOR = Range(0.0, math.inf, "linear RGB", Outside.COUNTED)
# A component of a unit vector held in half precision may round up to 1 + 2^-10.
_NORMAL = Range(-1.0, 1.0, "tangent-space component", slack=2.0**-10)

TEXTURE_RANGES: Mapping[str, Range] = {
    "diffusecolor": _COLOR,
    "normal": _NORMAL,
    "specularcolor": _COLOR,
    "specularlobe": Range(0.0, 1.0, "roughness", slack=2.0**-10),
    "anisrotation": Range(-math.pi, math.pi, "radians", Outside.COUNTED),
    "fresnel": Range(0.0, math.inf, "F0", Outside.COUNTED),
    "opacity": Range(0.0, 1.0, "opacity", slack=2.0**-10),
    "height": Range(-math.inf, math.inf, "mm"),
    "clearcoatcolor": _COLOR,
    "clearcoatnormal": _NORMAL,
    "clearcoatior": Range(0.0, math.inf, "index of refraction", Outside.COUNTED, open_below=True),
    "brdfcolors": _COLOR,
    "btfflakes": _COLOR,
}
"""Textures by canonical name."""

EXPONENT_RANGE = Range(0.0, 64.0, "n' with exponent 2^n'")
"""The lobe map of the Phong family holds the exponent's logarithm in place of a roughness."""

FRESNEL_MAXIMUM = Range(-math.inf, 1.0, "F0", slack=2.0**-10)
"""Above 1 an F0 is refused; below 0 it is counted as a negative color."""

PROPERTY_RANGES: Mapping[str, Range] = {
    "CT_diffuse": Range(0.0, math.inf, "albedo below the coat"),
    "CT_coeffs": Range(0.0, math.inf, "lobe weight"),
    "CT_F0s": Range(0.0, 1.0, "F0"),
    "CT_spreads": Range(1e-4, math.inf, "Beckmann roughness"),
    "num_thetaF": Range(1, 64, "bins of theta_h"),
    "num_thetaI": Range(1, 64, "bins of theta_d"),
    "max_thetaI": Range(0, 64, "bins of theta_d"),
    "thetaFI_sliceLUT": Range(0, 255, "slice index"),
    "IOR": Range(0.0, math.inf, "index of refraction", open_below=True),
    "cc_no_refraction": Range(-math.inf, math.inf, "0 = the coat refracts"),
}
"""Properties by AxF's own spelling."""

ROUGHNESS_FLOOR = 1e-4
"""Roughness below this is raised to it when a material becomes a BRDF, and counted: the models hold from here."""

DEFAULT_IOR = 1.5
"""What an index of refraction that is NaN, zero or negative becomes."""

MAXIMUM_LOBES = 4
"""Lobes of a car paint that a target can hold."""

MAXIMUM_LUT_ENTRIES = 64
"""Entries of `thetaFI_sliceLUT` that AxF allows."""
