"""The two errors of a whole material over boxes: terms, coat and color table put together.

The value of a channel is f = sum_j f_j; every f_j changes by a factor e^(d_j), d_j in an interval. Then

    (c)  log f'/f = log(1 + sum_j f_j expm1(d_j) / sum_j f_j), largest where each f_j is at one of its ends
    (b)  (f' - f) i_z / peak = sum_j (f_j i_z / peak) expm1(d_j)

d_j is the sum, over everything that moves, of how far it moves times the range of the derivative of log f_j anywhere on
the way (mean value theorem): tilting the base's frame by w turns both directions by -w, which changes log f_j by
w · (i × g_i + o × g_o), g the gradients by the directions.
"""

from copy import copy
from typing import NamedTuple

import numpy as np

from ..definitions import RELEVANT
from . import intervals as iv
from .coat import Coat, CoatFrame, Motion, Side
from .color_table import TableBounds
from .form import Form, NoBound
from .geometry import HORIZON
from .intervals import Interval
from .pairs import (
    ONE,
    ZERO,
    Pairs,
    Vector,
    cross,
    dot,
    inflated,
    pairs_of_boxes,
    pairs_of_views,
    plus,
    times,
    vector_around,
)
from .parts import Relief
from .terms import Model, Parameters, Term
from .texel_class import TexelClass
from .views import Grid, Peaks, light_factor, log_sum

PARAMETERS = ("roughness", "roughness_y", "f0", "specular", "diffuse", "gap", "gap_azimuth", "ior")
"""What a box may be split along beside the directions."""

_LOG_RELEVANT = float(np.log(RELEVANT)) * (1 + 2.0**-40)
_ROUND_TURN = np.pi * (1 + 2.0**-50)
LARGEST_MOTION = 0.05
"""Of a direction below the coat, on its own (radians)."""

MOST_HEIGHT = 50.0
"""Where boxes are compared, to see which sides are too wide, logarithms of heights reach to here.

Where several sides are wide, no height falls below 1 when one of them is collapsed, but all come nearer to it.
"""

HEIGHTS_COUNT = 0.3
"""There, what (c) counts a height's logarithm: a box is done with, too, when it falls below 1e-3."""

PARAMETERS_COUNT = 0.1
"""Where no side alone matters, how a parameter's share of its range compares to a direction's."""


class Evaluated(NamedTuple):
    """What is known of boxes."""

    log_height: np.ndarray
    """Upper bounds of log (f i_z / peak); -inf outside the domain."""
    heights: list[np.ndarray]
    """The same of each term."""
    logs: list[Interval]
    """Each term's log f_j, up to what all have in common."""
    changes: list[Interval]
    """Each term's d_j."""
    latest: list[np.ndarray]
    """Upper bounds of each term's log height after, over the peak before."""
    colors: Interval
    """What quantization of a color table adds to every change, where its values are large enough."""
    added: np.ndarray
    """What a change of the table's value that is absolute adds to (b), whatever the value."""
    all_colors: Interval
    """What both add to every change in the relevant part."""


class WholeErrors:
    """Upper bounds of a class's errors over boxes.

    Args:
        form: the models.
        texels: the class.

    Raises:
        NoBound: what is not covered.
    """

    def __init__(self, form: Form, texels: TexelClass):
        """Everything but the peaks, see `prove_peaks`."""
        aligned = form.coat is None or texels.gap == (0.0, 0.0)
        self._set_lowest(form, texels, aligned=aligned)
        self.coat = Coat(form.coat, aligned=aligned, lowest=self.lowest_below)
        self._set_texels(form, texels)
        paint = form.paint
        self.table = None if paint is None else TableBounds(paint.colors, paint.colors_after, paint.channels)
        self.turning = self.model.isotropic and aligned
        self.sides = [name for name, (low, high) in self.ranges.items() if high - low > 1e-9 * max(abs(high), 1e-3)]
        self.grid = Grid(256, 1) if self.turning else Grid(64, 48)
        self.weights = np.array([1.0] * 4 + [PARAMETERS_COUNT] * len(self.sides))
        self.peaks: Peaks | None = None

    def narrowed(self, texels: TexelClass) -> "WholeErrors":
        """The same for a class within this one: with its sides and peaks, which hold for every part of it."""
        part = copy(self)
        part._set_texels(self.model.form, texels)
        return part

    def _set_texels(self, form: Form, texels: TexelClass) -> None:
        """The class's ranges, and how far directions below the coat may move: each on its own, and both together."""
        self.texels, self.model = texels, Model(form, texels)
        self.ranges = {name: getattr(texels, name) for name in PARAMETERS if getattr(texels, name) is not None}
        if self.model.isotropic or self.coat.aligned:
            # Without axes of the lobe the coat's normal may lie at azimuth 0.
            self.ranges["gap_azimuth"] = (0.0, 0.0)
        if form.coat == "refracting" and texels.ior[0] <= 1.0001:
            raise NoBound(f"a refracting coat of index {texels.ior[0]}: covered are indices above 1.0001")
        self.rigid = float(np.nextafter(texels.tilt + texels.twist, np.inf))
        self.loose = 0.0
        if form.coat == "refracting":
            least = min(texels.ior[0], texels.ior[0] + texels.ior_change[0])
            change = max(abs(end) for end in texels.ior_change)
            # |kappa| + |kappa'| <= sqrt(1 - 1/n²) + 1/n <= sqrt 2; |di*/dn| = tan(theta*) / n.
            steepest = 1.0 / np.sqrt(max(least**2 - 1.0, 0.0) + 1e-4)
            self.loose = float(1.4143 * texels.coat_tilt + change * steepest * 1.001)
            if self.loose > LARGEST_MOTION:
                raise NoBound(f"directions below the coat move by up to {self.loose:.3f} radians; covered are 0.05")

    def _set_lowest(self, form: Form, texels: TexelClass, *, aligned: bool) -> None:
        """Below which cosines nothing of the domain lies: below the coat with its normal, and with the base's."""
        self.lowest_below = self.lowest = HORIZON
        if form.coat == "refracting":
            square = 1.0 - (1.0 - HORIZON**2) / texels.ior[0] ** 2
            self.lowest_below = max(HORIZON, float(np.sqrt(square)) * (1 - 1e-12))
        gap = 0.0 if aligned else texels.gap[1]
        self.lowest = max(HORIZON, float(np.cos(np.arccos(self.lowest_below) + gap)) - 1e-12)

    def given(self, ends: np.ndarray | None = None) -> Parameters:
        """The ranges of the parameters of boxes; without boxes the class's."""
        values = {name: Interval(*pair) for name, pair in self.ranges.items()}
        if ends is not None:
            for number, name in enumerate(self.sides):
                values[name] = Interval(ends[4 + number, 0], ends[4 + number, 1])
        return values

    def domain(self) -> np.ndarray:
        """The box of all directions and texels, (4 + sides, 2, 1)."""
        steepest = 1.0 / HORIZON * (1 + 2.0**-50)
        a_x, a_y = self.model.roughness(self.given())
        narrowest = float(np.minimum(a_x.lo, a_y.lo)[0])
        y, x = (float(np.arcsinh(steepest / scale)) * (1 + 2.0**-48) for scale in (narrowest, 1.0))
        turn = _ROUND_TURN
        if self.turning:
            psi, phi = (0.0, 0.0), (0.0, turn)
        elif self.coat.aligned:
            psi, phi = (0.0, 0.5 * turn), (-turn, turn)
        else:
            psi, phi = (0.0, turn) if self.model.isotropic else (-turn, turn), (-turn, turn)
        return np.array([(0.0, y), psi, (0.0, x), phi, *(self.ranges[name] for name in self.sides)])[:, :, None]

    def prove_peaks(self, slopes: tuple[np.ndarray, np.ndarray]) -> None:
        """The table of peaks from slopes of half vectors for the middles of all cells of `grid`."""
        with np.errstate(all="ignore"):
            self.peaks = Peaks(self.model, self.coat, self.given(), self.grid, slopes, self.table)

    def evaluate(self, ends: np.ndarray, most: float = 0.0) -> Evaluated:
        """Heights and changes over boxes; logarithms of heights are cut off at ``most``."""
        assert self.peaks is not None
        given = self.given(ends)
        y, psi, x, phi = (Interval(*ends[k]) for k in range(4))
        a = self.model.roughness(given)
        g = pairs_of_boxes(y, psi, x, phi, *a, self.lowest)
        frame, n = self.coat.frame(given), given["ior"]
        light, viewer = (self.coat.side(self.coat.cosine_below(w, frame), n) for w in (g.wi, g.wo))
        possible = g.possible & (light.cosine.hi >= HORIZON) & (viewer.cosine.hi >= HORIZON)
        if not self.coat.aligned:
            # <i + o, m> is twice cos theta_d <h, m>.
            along = (g.p * frame.normal[0] + g.s * frame.normal[1] + frame.normal[2]) * g.cos_h * g.cos_d
            possible &= along.hi >= self.lowest_below
        mirror = viewer
        if not self.coat.aligned:
            mirror = self.coat.side(self.coat.cosine_below((-g.wo[0], -g.wo[1], g.wo[2]), frame), n)
            possible &= mirror.cosine.hi >= HORIZON
        light, viewer, mirror = (self.coat.cut(side) for side in (light, viewer, mirror))
        peak = self.peaks(viewer.cosine, dot(g.wo, frame.first), dot(g.wo, frame.second))
        peak = np.fmax(peak, self._mirrored(g, given, a, mirror))
        factor = light_factor(self.coat, given, light)
        over = factor - Interval(peak, np.full_like(peak, np.inf))
        if self.coat.kind is None:
            over_mirror = Relief(ZERO, -1.0, 1.0)
        else:
            over_mirror = Relief(factor - light_factor(self.coat, given, mirror))
        color = ZERO
        if self.table is not None:
            color = self.table.log(g.t2, g.cos_d)
            over_mirror = over_mirror + Relief(-self.table.brightest(ZERO, g.wo[2]))
        moved = inflated(g, self.rigid, self.loose, *a, self.model.ratio_hulls())
        motion = self._motion(moved, (light, viewer), frame, n)
        terms = self.model.terms(g, moved, given)
        changes = [self._change(term, moved, motion) for term in terms]
        logs = [term.log for term in terms]
        # A term's own value at the mirror direction is a lower bound of the peak, too.
        plain = [np.fmin(iv.up(t.log.hi + over.hi), (t.relief + over_mirror).log(g.v).hi) for t in terms]
        heights = [np.fmin(iv.up(height + color.hi), most) for height in plain]
        total = np.fmin(
            iv.up(iv.up(log_sum(logs).hi + over.hi) + color.hi), log_sum([Interval(h, h) for h in heights]).hi
        )
        latest = [iv.up(t.after + over.hi) if self.coat.kind is None else np.full_like(peak, np.inf) for t in terms]
        total = np.where(possible, np.fmin(total, most), -np.inf)
        colors, added, all_colors = ZERO, np.zeros(1), ZERO
        if self.table is not None:
            colors, absolute = self.table.change(moved, *self._travels(motion))
            added = _added(absolute, color, colors, plain, changes)
            all_colors = colors + _by_absolute(absolute, color, colors, total)
        return Evaluated(total, heights, logs, changes, latest, colors, added, all_colors)

    def _mirrored(self, g: Pairs, given: Parameters, a: tuple[Interval, Interval], mirror: Side) -> np.ndarray:
        """Lower bounds of the log of the peak with the boxes' own parameters: f i_z at the views' mirror directions."""
        pairs, _ = pairs_of_views((np.zeros(1), np.zeros(1)), g.wo, *a)
        log = log_sum(self.model.values(pairs, given)) + light_factor(self.coat, given, mirror)
        return (log if self.table is None else log + self.table.brightest(pairs.t2, pairs.cos_d)).lo

    def _motion(self, g: Pairs, sides: tuple[Side, Side], frame: CoatFrame, n: Interval) -> Motion | None:
        """What a coat that moves does, wherever directions, normal and index may go."""
        texels = self.texels
        if self.coat.kind is None or (texels.coat_tilt == 0 and texels.ior_change == (0.0, 0.0)):
            return None
        n = n + iv.hull(ZERO, Interval(*texels.ior_change))
        step = float(np.nextafter(self.loose + self.rigid + texels.coat_tilt, np.inf)) * (1 + 2.0**-50)
        if not self.coat.aligned or texels.coat_tilt > 0:
            frame = CoatFrame(*(vector_around(axis, texels.coat_tilt) for axis in frame))
        moved = self._moved_side(sides[0], step), self._moved_side(sides[1], step)
        return self.coat.motion(moved, n, g, frame)

    def _travels(self, motion: Motion | None) -> tuple[np.ndarray, np.ndarray]:
        """How far theta_h and theta_d move at most."""
        travels = np.full(1, self.rigid), np.zeros(1)
        if motion is None or not motion.refracting:
            return travels
        texels = self.texels
        most = max(abs(end) for end in texels.ior_change)
        one, other = (
            iv.up(start + iv.up(iv.up(texels.coat_tilt * normal) + iv.up(most * index)))
            for start, (normal, index) in zip(travels, motion.angles(), strict=True)
        )
        return one, other

    def _change(self, term: Term, g: Pairs, motion: Motion | None) -> Interval:
        """Range of the change of log f_j."""
        texels = self.texels
        slopes = term.slopes
        if term.isotropic:
            radial = 2.0 * (slopes.along_q / iv.square(term.a_x) + slopes.along_t2)
            along = (radial * g.p, radial * g.s)
            out = radial * g.t2
            steep = radial * (1.0 + g.t2)
            turned: Vector = (-(steep * g.s), steep * g.p, ZERO)
        else:
            along = tuple(
                2.0 * (slopes.along_q * c / a + slopes.along_t2 * b)
                for c, a, b in ((g.px, term.a_x, g.p), (g.sy, term.a_y, g.s))
            )
            out = 2.0 * (slopes.along_q * g.q + slopes.along_t2 * g.t2)
            across = 2.0 * slopes.along_q * g.px * g.sy * (term.a_x / term.a_y - term.a_y / term.a_x)
            turned = (-(g.s * out) - along[1], along[0] + g.p * out, across)
        turned = plus(turned, plus(cross(g.wi, slopes.light), cross(g.wo, slopes.viewer)))
        turned = plus(turned, times(4.0 * slopes.along_mirror, (g.mixed[1], -g.mixed[0], ZERO)))
        change = term.change + _within(texels.tilt, iv.sqrt(iv.square(turned[0]) + iv.square(turned[1])))
        change = change + _within(texels.twist, turned[2])
        if motion is None:
            return change
        below = 1.0 / (2.0 * g.middle)
        half = times(slopes.along_cos_d * g.cos_h / (2.0 * g.cos_d), (g.p, g.s, ONE))
        shared = plus(half, (along[0] * below, along[1] * below, -(out * below)))
        gradients = tuple(
            plus(plus(shared, own), times(slopes.along_mirror, (-w[0], -w[1], w[2])))
            for own, w in ((slopes.light, g.wo), (slopes.viewer, g.wi))
        )
        one, other, by_index = motion.changes((gradients[0], gradients[1]))
        change = change + _within(texels.coat_tilt, iv.sqrt(iv.square(one) + iv.square(other)))
        return change + Interval(*texels.ior_change) * by_index

    def _moved_side(self, side: Side, step: float) -> Side:
        """A side of the coat wherever it may go."""
        cosine = iv.clip(iv.around(side.cosine, self.texels.coat_tilt), 2.0**-12, 1.0)
        if self.coat.kind == "straight":
            return Side(cosine, cosine)
        return Side(iv.clip(iv.around(side.below, step), 0.5 * self.lowest_below, 1.0), cosine)

    def log_ratio(self, ends: np.ndarray, most: float = 0.0) -> np.ndarray:
        """(c): |log f' - log f| where f i_z may reach 1e-3 of the peak, else 0."""
        known = self.evaluate(ends, most)
        log_height, logs = known.log_height, known.logs
        changes = [known.all_colors + change for change in known.changes]
        if len(changes) == 1:
            size = iv.magnitude(changes[0])
        else:
            rise = _largest_mean([c.hi for c in changes], logs)
            fall = _largest_mean([-c.lo for c in changes], logs, falling=True)
            size = np.maximum(iv.log1p(Interval(rise, rise)).hi, -iv.log1p(Interval(-fall, -fall)).lo)
        size = np.where(np.isnan(size), np.inf, size)
        if most > 0:
            size = size * np.exp(HEIGHTS_COUNT * (log_height - _LOG_RELEVANT))
        return np.where(log_height >= _LOG_RELEVANT, np.broadcast_to(size, log_height.shape), 0.0)

    def peak_relative(self, ends: np.ndarray, most: float = 0.0) -> np.ndarray:
        """(b): |f' - f| i_z / peak, upwards and downwards; at most the height times the largest relative change."""
        known = self.evaluate(ends, most)
        log_height = known.log_height
        rises = [iv.up(np.maximum(c.hi, 0.0) + known.colors.hi) for c in known.changes]
        falls = [iv.down(np.minimum(c.lo, 0.0) + known.colors.lo) for c in known.changes]
        result = np.zeros_like(log_height)
        for limits, pick in ((rises, np.maximum), (falls, np.minimum)):
            cap = _product(log_height, pick.reduce(np.stack(np.broadcast_arrays(*limits))))
            each = [_product(h, end) for h, end in zip(known.heights, limits, strict=True)]
            if pick is np.maximum:
                each = [
                    np.fmin(one, iv.exp(Interval(late, late)).hi) for one, late in zip(each, known.latest, strict=True)
                ]
            total = np.sum(np.stack(np.broadcast_arrays(*each)), axis=0)
            result = np.maximum(result, np.minimum(iv.up(total * (1 + 1e-14)), cap))
        result = iv.up(result + known.added)
        result = np.where(np.isnan(result), np.inf, result)
        return np.where(np.isneginf(log_height), 0.0, result)


def _added(
    absolute: np.ndarray, color: Interval, relative: Interval, plain: list[np.ndarray], changes: list[Interval]
) -> np.ndarray:
    """What chi' = F (chi + e) adds to (b) by |e| <= ``absolute``: F |e| sum_j e^(d_j) (f_j / chi) i_z / peak.

    F, within ``relative``, counts where it is above 1: e holds the change of chi by moved angles, and small texels'
    own, which F does not multiply. ``plain`` are logs of upper bounds of (f_j / chi) i_z / peak; their sum is at most
    1 / chi.
    """
    parts = [iv.exp(Interval(log, log) + Interval(c.hi, c.hi)).hi for log, c in zip(plain, changes, strict=True)]
    total = np.sum(np.stack(np.broadcast_arrays(*parts)), axis=0) * (1 + 1e-14)
    most = np.maximum.reduce(np.broadcast_arrays(*(c.hi for c in changes)))
    cap = iv.exp(Interval(most, most) - Interval(color.lo, color.lo)).hi
    enlarged = iv.up(absolute * iv.exp(Interval(relative.hi, relative.hi)).hi)
    return np.where(absolute > 0, iv.up(enlarged * np.fmin(total, cap)), 0.0)


def _by_absolute(absolute: np.ndarray, color: Interval, relative: Interval, log_height: np.ndarray) -> Interval:
    """What chi' = F chi + e adds to the change of the log by |e| <= ``absolute``, in the relevant part.

    |e| counts the more the smaller chi is, which may be 0 somewhere in a box. But where f i_z >= 1e-3 of the peak, chi
    is at least 1e-3 / height of its largest value, which the height was taken with.
    """
    least = np.fmax(color.lo, iv.down(iv.down(color.hi + _LOG_RELEVANT) - np.minimum(log_height, 0.0)))
    least = np.where(log_height >= _LOG_RELEVANT, least, 0.0)
    share = iv.up(absolute * iv.exp(Interval(-least, -least) + Interval(-relative.lo, -relative.lo)).hi)
    share = np.where(absolute > 0, share, 0.0)
    return iv.log1p(Interval(-np.minimum(share, 1.0), share))


def _within(size: float, rate: Interval) -> Interval:
    """[-1, 1] · size · sup |rate|."""
    if size == 0:
        return ZERO
    most = iv.up(size * iv.magnitude(rate))
    return Interval(-most, most)


def _product(log_height: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Upper bound of height · |e^change - 1|, where the change rises (or falls) by up to this.

    It is never more than height · e^change, which stays small far from a lobe, where the change is large.
    """
    height, step = Interval(log_height, log_height), Interval(change, change)
    product = iv.exp(height).hi * iv.magnitude(iv.expm1(step))
    whole = np.where(change > 0, iv.exp(height + step).hi, np.inf)
    return np.where(
        np.isneginf(log_height), 0.0, np.minimum(iv.up(np.where(np.isnan(product), np.inf, product)), whole)
    )


def _largest_mean(changes: list[np.ndarray], logs: list[Interval], *, falling: bool = False) -> np.ndarray:
    """Sup of sum_j f_j r_j / sum_j f_j with r = expm1(change), or 1 - e^-change; each f_j between its ends.

    The quotient is linear-fractional in each f_j: the terms with the largest r stand at their upper ends, the others
    at their lower ones, for some number of the former.
    """
    sign = -1.0 if falling else 1.0
    exact = [iv.expm1(Interval(sign * c, sign * c)) for c in changes]
    rates = np.stack(np.broadcast_arrays(*(-r.lo if falling else r.hi for r in exact), logs[0].hi)[:-1])
    highs = np.stack(np.broadcast_arrays(*(log.hi for log in logs)))
    lows = np.stack(np.broadcast_arrays(*(log.lo for log in logs)))
    largest = np.maximum(highs.max(axis=0), -1e308)
    upper = np.stack([iv.exp(Interval(h, h) - Interval(largest, largest)).hi for h in highs])
    lower = np.stack([iv.exp(Interval(x, x) - Interval(largest, largest)).lo for x in lows])
    order = np.argsort(-rates, axis=0)
    rates, upper, lower = (np.take_along_axis(x, order, axis=0) for x in (rates, upper, lower))
    best = np.full(largest.shape, -np.inf)
    for count in range(1, len(logs) + 1):
        weights = np.concatenate([upper[:count], lower[count:]])
        parts = np.where(weights > 0, weights * rates, 0.0)
        # Rounding of the sums, of at most six terms.
        mean = parts.sum(axis=0) + 1e-14 * np.abs(parts).sum(axis=0)
        best = np.maximum(best, mean / weights.sum(axis=0))
    return best
