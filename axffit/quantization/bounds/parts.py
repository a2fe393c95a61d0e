"""What lobes are made of, as intervals: logarithms, and the slopes of the logarithm along everything that can move.

A lobe's log f is a sum of parts: how its facets (or its power of a cosine) are distributed, what stands before them,
and the Fresnel factor. With q = (p / a_x)² + (s / a_y)² and t² = p² + s², each part gives its `Slopes`.
"""

import math
from typing import NamedTuple

import numpy as np

from . import intervals as iv
from .intervals import Interval
from .pairs import ONE, ZERO, Pairs, Vector, plus, times

NONE: Vector = (ZERO, ZERO, ZERO)


class Slopes(NamedTuple):
    """Derivatives of log f, each with all the others held."""

    along_q: Interval = ZERO
    """By q."""
    along_t2: Interval = ZERO
    """By t²."""
    along_cos_d: Interval = ZERO
    """By log cos theta_d."""
    light: Vector = NONE
    """By the light direction's components, where not through h."""
    viewer: Vector = NONE
    """By the viewer's."""
    along_mirror: Interval = ZERO
    """By <reflect(i), o>."""

    def __add__(self, other: "Slopes") -> "Slopes":  # pyright: ignore[reportIncompatibleMethodOverride]
        return Slopes(
            self.along_q + other.along_q,
            self.along_t2 + other.along_t2,
            self.along_cos_d + other.along_cos_d,
            plus(self.light, other.light),
            plus(self.viewer, other.viewer),
            self.along_mirror + other.along_mirror,
        )


class Relief(NamedTuple):
    """log f(i, o) - log f(m, o) for the mirror direction m of o: base + plus · log(1 + v) + minus · log(1 - v)."""

    base: Interval
    plus: float = 0.0
    minus: float = 0.0

    def __add__(self, other: "Relief") -> "Relief":  # pyright: ignore[reportIncompatibleMethodOverride]
        return Relief(self.base + other.base, self.plus + other.plus, self.minus + other.minus)

    def log(self, v: Interval) -> Interval:
        """The whole as one interval."""
        total = self.base
        for factor, side in ((self.plus, v), (self.minus, -v)):
            if factor != 0:
                total = total + factor * iv.log1p(side)
        return total


NO_RELIEF = Relief(ZERO)


class Part(NamedTuple):
    """A part of log f, and its derivatives by log a_x and log a_y; of an isotropic part the first is by log a."""

    log: Interval
    slopes: Slopes
    relief: Relief = NO_RELIEF
    by_x: Interval = ZERO
    by_y: Interval = ZERO


def gaussian(g: Pairs, a_x: Interval, a_y: Interval, *, isotropic: bool) -> Part:
    """exp(-q) (1 + t²)² / (a_x a_y)."""
    log = 2.0 * iv.log1p(g.t2) - g.q - iv.log(a_x * a_y)
    slopes, relief = Slopes(Interval(-1.0, -1.0), 2.0 / (1.0 + g.t2)), Relief(2.0 * iv.log1p(g.t2) - g.q)
    if isotropic:
        return Part(log, slopes, relief, 2.0 * g.q - 2.0)
    return Part(log, slopes, relief, 2.0 * iv.square(g.px) - 1.0, 2.0 * iv.square(g.sy) - 1.0)


def trowbridge_reitz(g: Pairs, a_x: Interval, a_y: Interval, flattening: Interval, *, isotropic: bool) -> Part:
    """((1 + t²) / (1 + q))² / (a_x a_y); the quotient is A + (1 - A) / (1 + q), A = t² / q."""
    below = 1.0 / (1.0 + g.q)
    fall = 2.0 * iv.log(flattening + (1.0 - flattening) * below)
    log, slopes = fall - iv.log(a_x * a_y), Slopes(-2.0 * below, 2.0 / (1.0 + g.t2))
    if isotropic:
        return Part(log, slopes, Relief(fall), 2.0 - 4.0 * below)
    by_x, by_y = (4.0 * iv.clip(iv.square(c) * below, 0.0, 1.0) - 1.0 for c in (g.px, g.sy))
    return Part(log, slopes, Relief(fall), by_x, by_y)


def power(g: Pairs, exponent: Interval, offset: float) -> Part:
    """(n + offset) h_z^n; by log n."""
    fall = 0.5 * iv.log1p(g.t2)
    log = iv.log(exponent + offset) - exponent * fall
    by = exponent * (1.0 / (exponent + offset) - fall)
    return Part(log, Slopes(ZERO, -0.5 * exponent / (1.0 + g.t2)), Relief(-(exponent * fall)), by)


def ashikhmin_power(g: Pairs, n_x: Interval, n_y: Interval, *, isotropic: bool) -> Part:
    """sqrt((n_x + 1)(n_y + 1)) exp(-q l(t²)), l(z) = log(1 + z) / z, a² = 2 / n.

    The exponential is h_z to the power (n_x h_x² + n_y h_y²) / (1 - h_z²).
    """
    ratio = iv.falling(_log_over, g.t2)
    bend = iv.falling(_bend, g.t2)
    log = 0.5 * (iv.log(n_x + 1.0) + iv.log(n_y + 1.0)) - g.q * ratio
    slopes = Slopes(-ratio, g.q * bend)
    relief = Relief(-(g.q * ratio))
    if isotropic:
        return Part(log, slopes, relief, 1.0 / (1.0 + 1.0 / n_x) - g.q * ratio)
    by_x, by_y = (0.5 * n / (n + 1.0) - iv.square(c) * ratio for n, c in ((n_x, g.px), (n_y, g.sy)))
    return Part(log, slopes, relief, by_x, by_y)


def _log_over(z: Interval) -> Interval:
    """log(1 + z) / z = 1 - z/2 + …, falling from 1."""
    small = z.hi < 1e-6
    safe = Interval(np.where(small, 1.0, z.lo), np.where(small, 1.0, z.hi))
    value = iv.clip(iv.log1p(safe) / safe, 0.0, 1.0)
    return Interval(np.where(small, iv.down(1.0 - z.hi), value.lo), np.where(small, 1.0, value.hi))


def _bend(z: Interval) -> Interval:
    """-d/dz of `_log_over` = (l - 1 / (1 + z)) / z = 1/2 - 2z/3 + …, falling."""
    small = z.hi < 1e-3
    safe = Interval(np.where(small, 1.0, z.lo), np.where(small, 1.0, z.hi))
    value = iv.clip((iv.log1p(safe) / safe - 1.0 / (1.0 + safe)) / safe, 0.0, 0.5)
    return Interval(np.where(small, iv.down(0.5 - z.hi), value.lo), np.where(small, 0.5, value.hi))


def mirror_power(g: Pairs, exponent: Interval) -> Part:
    """(n + 2) c^n, c = <reflect(i), o> = 1 - 2 P² (t² + v²)."""
    away = 2.0 * iv.square(g.middle) * (g.t2 + iv.square(g.v))
    cosine = iv.clip(1.0 - away, 0.0, 1.0)
    log_cosine = iv.log1p(-iv.clip(away, 0.0, 1.0))
    by = exponent * (1.0 / (exponent + 2.0) + log_cosine)
    fall = exponent * log_cosine
    return Part(iv.log(exponent + 2.0) + fall, Slopes(along_mirror=exponent / cosine), Relief(fall), by)


def cosines_to_minus(g: Pairs, half: float) -> Part:
    """(i_z o_z)^-half."""
    i_z, o_z = g.wi[2], g.wo[2]
    light, viewer = ((ZERO, ZERO, -half / z) for z in (i_z, o_z))
    log = -half * (iv.log(i_z) + iv.log(o_z))
    return Part(log, Slopes(light=light, viewer=viewer), Relief(ZERO, half, -half))


def cos_d_to_minus(g: Pairs, exponent: float) -> Part:
    """(cos theta_d)^-exponent."""
    # At the mirror direction cos theta_d = o_z = cos theta_d (1 + v) / sqrt(1 + t²).
    relief = Relief(-0.5 * exponent * iv.log1p(g.t2), exponent)
    return Part(-exponent * iv.log(g.cos_d), Slopes(along_cos_d=Interval(-exponent, -exponent)), relief)


def larger_cosine_to_minus(g: Pairs) -> Part:
    """1 / max(i_z, o_z); where the larger is not known, both slopes."""
    i_z, o_z = g.wi[2], g.wo[2]
    light, viewer = ((ZERO, ZERO, _if_larger(-1.0 / a, a, b)) for a, b in ((i_z, o_z), (o_z, i_z)))
    # o_z / max(i_z, o_z) = (1 + v) / (1 + |v|) = (1 - |v|) / (1 - v), the smaller of 1 and (1 + v) / (1 - v).
    smaller = iv.log1p(-Interval(np.maximum(np.maximum(g.v.lo, -g.v.hi), 0.0), iv.magnitude(g.v)))
    return Part(-iv.log(iv.greater(i_z, o_z)), Slopes(light=light, viewer=viewer), Relief(smaller, 0.0, -1.0))


def _if_larger(value: Interval, a: Interval, b: Interval) -> Interval:
    """The value where a > b, 0 where a < b, both where that is not known."""
    certain, never = a.lo > b.hi, a.hi < b.lo
    lo = np.where(certain, value.lo, np.where(never, 0.0, np.minimum(value.lo, 0.0)))
    hi = np.where(certain, value.hi, np.where(never, 0.0, np.maximum(value.hi, 0.0)))
    return Interval(lo, hi)


def v_groove(g: Pairs) -> Part:
    """G / (i_z o_z) = min(1 / (i_z o_z), 2 h_z / (cos theta_d max(i_z, o_z)))."""
    free = cosines_to_minus(g, 1.0)
    larger = larger_cosine_to_minus(g)
    groove = math.log(2.0) - 0.5 * iv.log1p(g.t2) - iv.log(g.cos_d) + larger.log
    groove = Part(iv.around(groove, 1e-15), larger.slopes + Slopes(ZERO, -0.5 / (1.0 + g.t2), Interval(-1.0, -1.0)))
    first, second = free.log.hi < groove.log.lo, groove.log.hi < free.log.lo

    def either(a: Interval, b: Interval) -> Interval:
        both = iv.hull(a, b)
        lo = np.where(first, a.lo, np.where(second, b.lo, both.lo))
        return Interval(lo, np.where(first, a.hi, np.where(second, b.hi, both.hi)))

    one, two = free.slopes, groove.slopes
    slopes = Slopes(
        ZERO,
        either(one.along_t2, two.along_t2),
        either(one.along_cos_d, two.along_cos_d),
        (ZERO, ZERO, either(one.light[2], two.light[2])),
        (ZERO, ZERO, either(one.viewer[2], two.viewer[2])),
    )
    log = iv.lesser(free.log, groove.log)
    # At the mirror direction it is 1 / o_z²; G = it times i_z o_z.
    open_ = iv.clip(groove.log - free.log, -np.inf, 0.0)
    return Part(log, slopes, Relief(open_, 1.0, -1.0))


def smith(g: Pairs, a_x: Interval, a_y: Interval, *, isotropic: bool) -> Part:
    """4 / (A(i) A(o)), A(v) = v_z + S, S² = v_z² + a_x² v_x² + a_y² v_y²."""
    one, other = (_smith_side(w, a_x, a_y, isotropic=isotropic) for w in (g.wi, g.wo))
    log = math.log(4.0) - one[0] - other[0]
    by_x, by_y = -(one[2] + other[2]), -(one[3] + other[3])
    slopes = Slopes(light=times(-ONE, one[1]), viewer=times(-ONE, other[1]))
    return Part(iv.around(log, 1e-15), slopes, Relief(other[0] - one[0]), by_x, by_y)


def _smith_side(
    w: Vector, a_x: Interval, a_y: Interval, *, isotropic: bool
) -> tuple[Interval, Vector, Interval, Interval]:
    """log A, its gradient, and its derivatives by log a_x and log a_y."""
    z2 = iv.square(w[2])
    if isotropic:
        # By z alone: for unit vectors S² = a² + (1 - a²) z².
        alpha = iv.square(a_x)
        rest = alpha * iv.clip(1.0 - z2, 0.0, 1.0)
        root = iv.sqrt(z2 + rest)
        whole = w[2] + root
        by = iv.square(_over_root(iv.sqrt(rest), z2)) / (1.0 + _over_root(w[2], rest))
        return iv.log(whole), (ZERO, ZERO, (1.0 + (1.0 - alpha) * _over_root(w[2], rest)) / whole), by, ZERO
    slant = (a_x * w[0], a_y * w[1])
    x, y = iv.square(slant[0]), iv.square(slant[1])
    root = iv.sqrt(z2 + x + y)
    whole = w[2] + root
    # Each of S's parts over S, at ends: they are at most 1, which a quotient of intervals is not.
    steep = [_over_root(one, z2 + rest) for one, rest in zip(slant, (y, x), strict=True)]
    below = 1.0 / whole
    gradient = (a_x * steep[0] * below, a_y * steep[1] * below, iv.clip(1.0 / root, 0.0, np.inf))
    # S / A = 1 / (1 + z / S)
    part = 1.0 / (1.0 + _over_root(w[2], x + y))
    return iv.log(whole), gradient, iv.square(steep[0]) * part, iv.square(steep[1]) * part


def _over_root(x: Interval, rest: Interval) -> Interval:
    """x / sqrt(x² + r): rises with x, and towards 0 as r grows."""

    def at(x: np.ndarray, rest: np.ndarray) -> Interval:
        x_, r_ = Interval(x, x), Interval(rest, rest)
        return iv.clip(x_ / iv.sqrt(iv.square(x_) + r_), -1.0, 1.0)

    lo = at(x.lo, np.where(x.lo >= 0, rest.hi, rest.lo)).lo
    hi = at(x.hi, np.where(x.hi >= 0, rest.lo, rest.hi)).hi
    return Interval(lo, hi)


def oren_nayar(g: Pairs, roughness: float) -> Part:
    """A + B max(0, i_x o_x + i_y o_y) / max(i_z, o_z), with interreflection."""
    square = roughness * roughness
    a, b = 1.0 - 0.5 * square / (square + 0.57), 0.45 * square / (square + 0.09)
    a, b = (iv.around(Interval(c, c), 1e-15) for c in (a, b))
    i_z, o_z = g.wi[2], g.wo[2]
    along = 2.0 * iv.square(g.cos_d) - 1.0 - i_z * o_z
    along = iv.meet(along, g.wi[0] * g.wo[0] + g.wi[1] * g.wo[1])
    most = iv.greater(i_z, o_z)
    towards = iv.clip(iv.clip(along, 0.0, 1.0) / most, 0.0, np.inf)
    value = a + b * towards
    outer = b / (value * most)
    outer = _if_larger(outer, along, ZERO)
    sides = []
    for other, mine, his in ((g.wo, i_z, o_z), (g.wi, o_z, i_z)):
        sides.append((outer * other[0], outer * other[1], -(outer * _if_larger(towards, mine, his))))
    # At the mirror direction i_x o_x + i_y o_y is negative: A alone is left.
    return Part(iv.log(value), Slopes(light=sides[0], viewer=sides[1]), Relief(iv.log(value) - iv.log(a)))
