"""The peak of each view, which (b) divides by and (c) compares with: proved from below.

The views are cut into cells of o_z. For each cell a light is known from a search; it is written relative to the view,
as (y, v) of `geometry`, and interval arithmetic proves that it exists for every view of the cell and how high the lobe
stands there. Any light that exists bounds the peak from below, so that nothing rests on the search.
"""

import numpy as np

from . import intervals as iv
from .geometry import HORIZON, Geometry, cosine_of_tangent, fresnel, fresnel_quotient
from .intervals import Interval
from .lobes import AbstractLobe
from .texel_class import TexelClass

CELLS = 256
SHRINK = (1.0, 0.999, 0.995, 0.98, 0.95, 0.9, 0.8, 0.6, 0.3, 0.0)
"""A light found may not exist for all views of its cell: v is tried at these parts of what was found."""

EDGES = np.concatenate([[HORIZON], HORIZON ** (1 - np.arange(1, CELLS) / CELLS), [1.0]])
"""The cells' ends in o_z."""

MIDDLES = np.sqrt(EDGES[:-1] * EDGES[1:])
"""The views for which a light has to be given."""


def _height(
    lobe: AbstractLobe, texels: TexelClass, y: Interval, v: Interval, o_z: Interval
) -> tuple[np.ndarray, np.ndarray]:
    """Lower bound of log of f i_z over the mirror direction's, and where such a light exists for certain.

    From (y, v) and the view: cos theta_d = o_z / (cos theta_h (1 + v)); the light exists where cos theta_d <= 1,
    |v| <= tan theta_h tan theta_d and i_z = o_z (1 - v) / (1 + v) >= sin 1°.
    """
    alpha, f0 = Interval(*texels.roughness), Interval(*texels.f0)
    slope = iv.clip(iv.sinh(y), 0.0, np.inf)
    t = alpha * slope
    cos_h = cosine_of_tangent(t)
    cos_d = o_z / (cos_h * (1.0 + v))
    tangent_square = iv.clip(1.0 / iv.square(cos_d) - 1.0, 0.0, np.inf)
    i_z = o_z * ((1.0 - v) / (1.0 + v))
    exists = (cos_d.hi <= 1) & (iv.square(v).hi <= (iv.square(t) * tangent_square).lo) & (i_z.lo >= HORIZON)
    cos_d, i_z, p = (iv.clip(side, HORIZON / 2, 1.0) for side in (cos_d, i_z, o_z / (1.0 + v)))
    g = Geometry(slope, t, iv.sqrt(tangent_square), cos_d, p, v, i_z, o_z, exists)
    return (iv.log(fresnel_quotient(f0, cos_d, o_z)) + lobe.log_relief(alpha, g)).lo, exists


class PeakTable:
    """Lower bounds of the peaks of all views of a class, twice: relative to the mirror direction, and absolute.

    Args:
        lobe: the lobe.
        texels: the class.
        y: asinh(tan theta_h / alpha) of a high light for each of `MIDDLES`.
        v: (o_z - i_z) / (o_z + i_z) of it.
    """

    def __init__(self, lobe: AbstractLobe, texels: TexelClass, y: np.ndarray, v: np.ndarray):
        """Proof over all cells; the mirror direction itself always exists."""
        o_z = Interval(EDGES[:-1], EDGES[1:])
        over_mirror = np.zeros(CELLS)
        for part in SHRINK:
            shrunk = v * part
            height, exists = _height(lobe, texels, Interval(y, y), Interval(shrunk, shrunk), o_z)
            over_mirror = np.maximum(over_mirror, np.where(exists, height, 0.0))
        mirror = iv.log(fresnel(Interval(*texels.f0), o_z)) + lobe.log_mirror_shape(Interval(*texels.roughness), o_z)
        self._over_mirror = _RangeMaximum(-over_mirror)
        self._absolute = _RangeMaximum(-iv.down(over_mirror + mirror.lo))

    def log_mirror_share(self, o_z: Interval) -> np.ndarray:
        """Upper bound of log (mirror direction's value / peak) over ranges of o_z."""
        return self._over_mirror(*_cells(o_z))

    def log_inverse_peak(self, o_z: Interval) -> np.ndarray:
        """Upper bound of log (1 / peak), in the unit of `AbstractLobe.log_shape` and with s = 1."""
        return self._absolute(*_cells(o_z))


def _cells(o_z: Interval) -> tuple[np.ndarray, np.ndarray]:
    """First and last cell that ranges of o_z touch."""
    first = np.searchsorted(EDGES, o_z.lo, side="left") - 1
    last = np.searchsorted(EDGES, o_z.hi, side="right") - 1
    return np.clip(first, 0, CELLS - 1), np.clip(last, 0, CELLS - 1)


class _RangeMaximum:
    """The largest of values[first : last + 1], from the maxima of all runs of 2^k."""

    def __init__(self, values: np.ndarray):
        self._runs = [values]
        while (step := 2 ** (len(self._runs) - 1)) < len(self._runs[-1]):
            self._runs.append(np.maximum(self._runs[-1][:-step], self._runs[-1][step:]))

    def __call__(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        level = np.int64(np.log2(last - first + 1))
        result = np.empty(level.shape)
        for number, runs in enumerate(self._runs):
            here = level == number
            result[here] = np.maximum(runs[first[here]], runs[last[here] + 1 - 2**number])
        return result
