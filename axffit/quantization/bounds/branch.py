"""Branch and bound: a proved upper bound of the two errors of a class, by splitting boxes of directions and texels.

A box that lies outside the domain, or in (c) certainly below a thousandth of its view's peak, is dropped; one whose
bound is below the target is done with; every other is cut into four, along the sides whose collapse to their middles
lower the bound most. What remains when the target or the budget is reached is the bound.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..definitions import RELEVANT
from . import intervals as iv
from .geometry import boxes, fresnel, fresnel_change, fresnel_quotient, geometry
from .intervals import Interval
from .lobes import AbstractLobe
from .peaks import PeakTable
from .texel_class import TexelClass

Ends = np.ndarray
"""Boxes as an array (sides, 2, n), see `Boxes.stack`."""

Function = Callable[[Ends], np.ndarray]
"""Of boxes; an upper bound of an error over each."""

BATCH = 2048
"""Boxes split at once, the worst ones first."""

BUDGET, MOST = 60_000, 240_000
"""Boxes evaluated for one definition, by about a batch: for the target, and where the bound is still loose."""

HELPS = 0.1
"""A side helps whose collapse lowers a box's bound by this part of it."""

_LOG_RELEVANT = float(np.log(RELEVANT)) * (1 + 2.0**-40)
"""Slightly below log 1e-3, so that rounding drops nothing."""


@dataclass(frozen=True)
class Bounds:
    """Proved bounds and the work they took.

    Attributes:
        value: the upper bound.
        boxes: boxes evaluated.
    """

    value: float
    boxes: int


@dataclass(frozen=True, eq=False)
class Rest:
    """What a search for a bound ends with.

    Attributes:
        done: the largest bound of the boxes that were done with.
        ends: the boxes that were not.
        values: their bounds.
        boxes: boxes evaluated.
    """

    done: float
    ends: Ends
    values: np.ndarray
    boxes: int

    @property
    def value(self) -> float:
        """The upper bound."""
        return max(self.done, self.worst)

    @property
    def worst(self) -> float:
        """The largest bound of the boxes that are left."""
        return float(self.values.max(initial=0.0))


class ClassErrors:
    """Upper bounds of a class's errors over boxes.

    Args:
        lobe: the lobe.
        texels: the class.
        y: of a high light for each of `peaks.MIDDLES`, see `PeakTable`.
        v: the same.
    """

    def __init__(self, lobe: AbstractLobe, texels: TexelClass, y: np.ndarray, v: np.ndarray):
        """Prepares the table of peaks."""
        self.lobe, self.texels = lobe, texels
        with np.errstate(all="ignore"):
            self.peaks = PeakTable(lobe, texels, y, v)
            self._log_ratio = iv.log(Interval(*texels.roughness_ratio))
            self._ratio = iv.hull(Interval(1.0, 1.0), Interval(*texels.roughness_ratio))

    def evaluate(self, ends: Ends) -> tuple[np.ndarray, Interval]:
        """Upper bounds of log (f i_z / peak of the view), -inf outside the domain, and enclosures of log f'/f."""
        box = boxes(ends)
        g = geometry(box)
        relative = iv.log(fresnel_quotient(box.f0, g.cos_d, g.o_z)) + self.lobe.log_relief(box.alpha, g)
        absolute = iv.log(fresnel(box.f0, g.cos_d)) + self.lobe.log_shape(box.alpha, g)
        log_height = np.minimum(
            iv.up(relative.hi + self.peaks.log_mirror_share(g.o_z)),
            iv.up(absolute.hi + self.peaks.log_inverse_peak(g.o_z)),
        )
        log_height = np.minimum(log_height, 0.0)
        change = fresnel_change(box.f0, Interval(*self.texels.f0_change), g.cos_d)
        change = change + self._log_ratio * self.lobe.roughness_slope(box.alpha, self._ratio, g)
        tilt = self.lobe.tilt_change(self.texels, box, g)
        return np.where(g.possible, log_height, -np.inf), change + Interval(-tilt, tilt)

    def log_ratio(self, ends: Ends) -> np.ndarray:
        """(c): |log f' - log f| where f i_z may reach 1e-3 of the peak, else 0."""
        log_height, change = self.evaluate(ends)
        return np.where(log_height >= _LOG_RELEVANT, iv.magnitude(change), 0.0)

    def peak_relative(self, ends: Ends) -> np.ndarray:
        """(b): |f' - f| i_z / peak = height · |e^change - 1|; where f' > f it is below f' i_z / peak, too."""
        log_height, change = self.evaluate(ends)
        height = iv.exp(Interval(log_height, log_height)).hi
        rise = iv.expm1(iv.clip(Interval(change.hi, change.hi), 0.0, np.inf)).hi
        product = np.where(height > 0, iv.up(height * rise), np.inf)
        above = np.minimum(product, iv.exp(Interval(log_height, log_height) + Interval(change.hi, change.hi)).hi)
        below = iv.up(height * -iv.expm1(iv.clip(Interval(change.lo, change.lo), -np.inf, 0.0)).lo)
        return np.where(np.isneginf(log_height), 0.0, np.maximum(above, below))


def side_scale(domain: Ends, weights: np.ndarray | float = 1.0) -> np.ndarray:
    """What a side's width is compared with where no side helps alone, (sides, 1): the domain's, over its weight."""
    return np.maximum(domain[:, 1] - domain[:, 0], 1e-300) / np.reshape(weights, (-1, 1))


def bound(
    errors: Function,
    ends: Ends,
    target: float,
    scale: np.ndarray,
    guide: Function | None = None,
    *,
    loose: float = np.inf,
    budget: int = BUDGET,
    batch: int = BATCH,
) -> Rest:
    """Upper bound over boxes, which are split until it is low enough.

    Args:
        errors: upper bound of an error over boxes, `ClassErrors.log_ratio` or `ClassErrors.peak_relative`.
        ends: boxes, which together are the domain.
        target: boxes at or below it are not split further.
        scale: see `side_scale`.
        guide: what boxes are compared by to choose sides; None takes the errors.
        loose: a bound above it is worth up to `MOST` boxes instead of ``budget``.
        budget: boxes to split for beside those given, by about a batch.
        batch: boxes split at once, the worst ones first.
    """
    with np.errstate(all="ignore"):
        values = errors(ends)
        done, count = 0.0, ends.shape[-1]
        budget += count - 1
        while True:
            open_ = values > target
            done = max(done, float(values[~open_].max(initial=0.0)))
            ends, values = ends[..., open_], values[open_]
            if not open_.any() or count >= (MOST if values.max() > loose else budget):
                return Rest(done, ends, values, count)
            worst = np.argsort(-values, kind="stable")[:batch]
            before = values[worst] if guide is None else guide(ends[..., worst])
            children = split(guide or errors, ends[..., worst], before, scale)
            keep = np.ones(len(values), bool)
            keep[worst] = False
            new = errors(children)
            count += (len(ends) + 4 + (guide is not None)) * len(worst)
            alive = new > 0
            ends = np.concatenate([ends[..., keep], children[..., alive]], axis=-1)
            values = np.concatenate([values[keep], new[alive]])


def split(guide: Function, ends: Ends, before: np.ndarray, scale: np.ndarray) -> Ends:
    """Four parts of each box, (sides, 2, 4 n): halved twice, along the sides whose collapse lowers ``before`` most."""
    sides, _, count = ends.shape
    middle = 0.5 * (ends[:, 0] + ends[:, 1])
    collapsed = np.broadcast_to(ends[..., None, :], (sides, 2, sides, count)).copy()
    for side in range(sides):
        collapsed[side, :, side] = middle[side]
    values = guide(collapsed.reshape(sides, 2, -1)).reshape(sides, count)
    width = (ends[:, 1] - ends[:, 0]) / scale
    gain = np.where(np.isfinite(values), 1.0 - values / before, 0.0)
    # Where no side alone helps, the relatively widest is halved; it also decides among equals.
    gain = np.where(gain.max(axis=0) >= HELPS, gain + 1e-9 * width, width)
    gain = np.where(width > 0, gain, -1.0)
    for _ in range(2):
        chosen = np.argmax(gain, axis=0)
        each = np.arange(len(chosen))
        middle = 0.5 * (ends[chosen, 0, each] + ends[chosen, 1, each])
        low, high = ends.copy(), ends.copy()
        low[chosen, 1, each] = middle
        high[chosen, 0, each] = middle
        gain[chosen, each] *= 0.5
        ends, gain = np.concatenate([low, high], axis=-1), np.concatenate([gain, gain], axis=-1)
    return ends
