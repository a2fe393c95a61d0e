"""Errors of a map in the quantity that matters: degrees for a normal, a relative error for a roughness, dE for a color.

A measure takes AxF values [n, C] and what the shader sees [n, C] and gives one error a texel [n]. Several measures may
apply to one map; the first is the one its picture shows.
"""

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..axf.ranges import DEFAULT_IOR, ROUGHNESS_FLOOR
from ..textures.rerange import IorToF0

Rows = np.ndarray
"""Texel values [n, channels], float64."""


@dataclass(frozen=True)
class Measure:
    """A way to say how far a texel moved.

    Attributes:
        name: short name, used in tolerance files.
        unit: unit of the error; "" for a ratio.
        error: (AxF values, seen values) -> errors [n], not negative; infinite where a value was lost altogether.
        costly: whether a large map is measured at part of its texels.
    """

    name: str
    unit: str
    error: Callable[[Rows, Rows], np.ndarray]
    costly: bool = False


SMALLEST_COLOR = 2.0**-14
"""Relative errors of colors are taken relative to at least this (the smallest normal half): 1/16384 is black."""


def angle_between(before: Rows, after: Rows) -> np.ndarray:
    """Angle between two vectors [n, 3] of any length, in degrees: atan2(|a x b|, a·b), precise at every angle."""
    cross = np.linalg.norm(np.cross(before, after), axis=-1)
    return np.degrees(np.arctan2(cross, np.sum(before * after, axis=-1)))


def axis_angle(before: Rows, after: Rows) -> np.ndarray:
    """Angle between two axes given by angles [n, 1] in radians, modulo pi, in degrees (0 to 90)."""
    turn = np.mod(after[..., 0] - before[..., 0], np.pi)
    return np.degrees(np.minimum(turn, np.pi - turn))


def absolute(before: Rows, after: Rows) -> np.ndarray:
    """Largest |after - before| of a texel's channels."""
    return np.max(np.abs(after - before), axis=-1)


def relative_roughness(before: Rows, after: Rows) -> np.ndarray:
    """Largest |a' - a| / a of a texel's channels, both floored at 1e-4, from where the models hold."""
    before, after = np.maximum(before, ROUGHNESS_FLOOR), np.maximum(after, ROUGHNESS_FLOOR)
    return np.max(np.abs(after - before) / before, axis=-1)


def relative_color(before: Rows, after: Rows) -> np.ndarray:
    """Largest |x' - x| / x of a texel's channels; negative x counts as 0, small x as 2^-14.

    The specification wants negative colors clamped; how many and how negative they are is counted elsewhere.
    """
    wanted = np.maximum(before, 0.0)
    return np.max(np.abs(after - wanted) / np.maximum(wanted, SMALLEST_COLOR), axis=-1)


def absolute_color(before: Rows, after: Rows) -> np.ndarray:
    """Largest |x' - x| of a texel's channels; negative x counts as 0, as in `relative_color`."""
    return absolute(np.maximum(before, 0.0), after)


def usable_ior(values: Rows) -> Rows:
    """Indices of refraction; 1.5, which the specification puts in its place, for what is none (NaN, not positive)."""
    return np.where(values > 0, values, DEFAULT_IOR)


def f0_of_ior(before: Rows, after: Rows) -> np.ndarray:
    """|F0(n') - F0(n)|; an unusable n counts as 1.5."""
    forward = IorToF0().forward
    return absolute(forward(usable_ior(before)), forward(after))


def ior(before: Rows, after: Rows) -> np.ndarray:
    """|n' - n|; an unusable n counts as 1.5. Infinite where F0 = 1 comes back, about |1/n - n| where n < 1 does."""
    before = usable_ior(before)
    with np.errstate(invalid="ignore"):
        difference = np.abs(after - before)
    return np.max(np.where(before == after, 0.0, difference), axis=-1)


def has_color_science() -> bool:
    """Whether the optional package colour-science is installed."""
    return importlib.util.find_spec("colour") is not None


def delta_e_2000(before: Rows, after: Rows) -> np.ndarray:
    """CIE dE2000 between reflectances [n, 3]: linear sRGB primaries, white E, which is the perfect diffuser's white.

    Raises:
        ImportError: colour-science is not installed (`has_color_science`).
    """
    import colour

    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["E"]
    primaries = colour.RGB_COLOURSPACES["sRGB"].primaries
    to_xyz = np.asarray(colour.models.normalised_primary_matrix(primaries, white)).T
    lab = [colour.XYZ_to_Lab(np.maximum(rows, 0.0) @ to_xyz, white) for rows in (before, after)]
    return np.asarray(colour.delta_E(lab[0], lab[1], method="CIE 2000"))


_ANGLE = Measure("angle", "degrees", angle_between)
_RELATIVE = Measure("relative", "", relative_color)
_ABSOLUTE = Measure("absolute", "", absolute)
_DELTA_E = Measure("delta_e_2000", "dE2000", delta_e_2000, costly=True)
_ABSOLUTE_COLOR = Measure("absolute", "", absolute_color)
_COLOR = (_RELATIVE, _ABSOLUTE_COLOR, _DELTA_E)

MEASURES: Mapping[str, tuple[Measure, ...]] = {
    "diffusecolor": _COLOR,
    "specularcolor": _COLOR,
    "normal": (_ANGLE,),
    "specularlobe": (Measure("relative", "", relative_roughness), _ABSOLUTE),
    "opacity": (_ABSOLUTE,),
    "fresnel": (_ABSOLUTE_COLOR, _RELATIVE),
    "anisrotation": (Measure("axis_angle", "degrees", axis_angle),),
    "height": (Measure("absolute", "mm", absolute),),
    "brdfcolors": _COLOR,
    "btfflakes": _COLOR,
    "clearcoatcolor": _COLOR,
    "clearcoatnormal": (_ANGLE,),
    "clearcoatior": (Measure("f0", "", f0_of_ior), Measure("ior", "", ior)),
}
"""The measures of each AxF texture, the one of its picture first."""


COLORS = tuple(name for name, measures in MEASURES.items() if _RELATIVE in measures)
"""Textures that hold colors, which the specification clamps at 0."""


def measures_of(axf_name: str) -> tuple[Measure, ...]:
    """The measures of a texture that can be taken here (dE2000 needs colour-science)."""
    return tuple(m for m in MEASURES[axf_name] if m.name != "delta_e_2000" or has_color_science())
