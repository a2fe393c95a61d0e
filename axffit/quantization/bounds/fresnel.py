"""Fresnel factors of lobes, and what a coat lets through, as intervals."""

from typing import NamedTuple

import numpy as np

from . import intervals as iv
from .geometry import fresnel as schlick
from .intervals import Interval


def schlick_slope(f0: Interval, cosine: Interval) -> Interval:
    """d log F / d log c = -5 c (1 - F0) (1 - c)⁴ / F."""
    rest = iv.clip(1.0 - cosine, 0.0, 1.0)
    return -5.0 * cosine * (1.0 - f0) * iv.square(iv.square(rest)) / schlick(f0, cosine)


def index_of(f0: Interval) -> Interval:
    """n = (1 + sqrt F0) / (1 - sqrt F0)."""
    return iv.rising(lambda f: (1.0 + iv.sqrt(f)) / (1.0 - iv.sqrt(f)), f0)


def _amplitude(quotient: Interval) -> Interval:
    """(k - 1) / (k + 1), rising in k >= 0."""
    return iv.rising(lambda k: 1.0 - 2.0 / (1.0 + k), iv.clip(quotient, 0.0, np.inf))


def exact(f0: Interval, cosine: Interval) -> tuple[Interval, Interval, Interval]:
    """log F, d log F / d log c and d log F / d F0 of the exact dielectric form, 0 < F0 < 1."""
    n = index_of(f0)
    square = iv.square(n)
    g = iv.sqrt(square - 1.0 + iv.square(cosine))
    quotient = cosine / g
    rs, rp = _amplitude(quotient), _amplitude(square * quotient)
    value = 0.5 * (iv.square(rs) + iv.square(rp))
    # d r / d quotient-like: (k - 1) / (k + 1) has the slope 2 k' / (k + 1)².
    strength = (square - 1.0) / (iv.square(g) * g)
    ds = 2.0 * strength / iv.square(1.0 + quotient)
    dp = 2.0 * square * strength / iv.square(1.0 + square * quotient)
    by_cosine = cosine * (rs * ds + rp * dp) / value
    # k = c / G: dk/dn = -c n / G³; k = n² c / G: dk/dn = n c (2 G² - n²) / G³.
    below = cosine * n / (iv.square(g) * g)
    ns = -2.0 * below / iv.square(1.0 + quotient)
    np_ = 2.0 * below * (2.0 * iv.square(g) - square) / iv.square(1.0 + square * quotient)
    root = iv.sqrt(f0)
    by_f0 = (rs * ns + rp * np_) / value / (root * iv.square(1.0 - root))
    return iv.log(value), by_cosine, by_f0


class Passing(NamedTuple):
    """1 - F of a coat at a cosine outside."""

    log: Interval
    by_cosine: Interval
    """d log(1 - F) / dc."""
    by_index: Interval
    """d log(1 - F) / dn."""


def passing(n: Interval, cosine: Interval) -> Passing:
    """1 - F = ½ (1 - r_s²) + ½ (1 - r_p²), r_s = (q - 1) / (q + 1), r_p = (n² q - 1) / (n² q + 1), q = c / G.

    G² = n² - 1 + c². d log(1 - F)/dc is the mean, weighted by 1 - r², of (1 - q)² / c and of -r_p (n² - 1) / (c G²);
    d/dn likewise of r_s n / G² and of r_p (n / G² - 2 / n). q rises with c and falls with n, and so on: ranges are
    taken at ends, for a box next to the horizon holds c of very different sizes.
    """
    square = iv.square(n)
    q = quotient(n, cosine)
    rs, rp = _amplitude(q), _amplitude(square * q)
    ws, wp = (iv.clip(1.0 - iv.square(r), 0.0, 1.0) for r in (rs, rp))
    # (1 - r_p²) / (1 - r_s²) = n² ((1 + q) / (1 + n² q))², where (1 + q) / (1 + n² q) falls with q.
    fall = iv.falling(lambda x: (1.0 + x) / (1.0 + square * x), q)
    share = iv.clip(1.0 / (1.0 + square * iv.square(fall)), 0.0, 1.0)
    inside = square - 1.0 + iv.square(cosine)
    by_cosine = _mean(
        share,
        iv.square(iv.clip(1.0 - q, 0.0, 1.0)) / cosine,
        -rp * ((square - 1.0) / (cosine * inside)),
    )
    over = n / inside
    return Passing(iv.log(0.5 * (ws + wp)), by_cosine, _mean(share, rs * over, rp * (over - 2.0 / n)))


def quotient(n: Interval, cosine: Interval) -> Interval:
    """c / sqrt(n² - 1 + c²) = 1 / sqrt(1 + (n² - 1) / c²): rises with c, falls with n."""

    def corner(n: np.ndarray, c: np.ndarray) -> Interval:
        return 1.0 / iv.sqrt(1.0 + (iv.square(Interval(n, n)) - 1.0) / iv.square(Interval(c, c)))

    return iv.clip(Interval(corner(n.hi, cosine.lo).lo, corner(n.lo, cosine.hi).hi), 0.0, 1.0)


def _mean(share: Interval, a: Interval, b: Interval) -> Interval:
    """share · a + (1 - share) · b, linear in each."""

    def end(a: np.ndarray, b: np.ndarray) -> list[Interval]:
        return [Interval(b, b) + Interval(s, s) * (Interval(a, a) - Interval(b, b)) for s in (share.lo, share.hi)]

    low, high = end(a.lo, b.lo), end(a.hi, b.hi)
    return Interval(np.minimum(low[0].lo, low[1].lo), np.maximum(high[0].hi, high[1].hi))
