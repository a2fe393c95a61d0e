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


def passing(n: Interval, cosine: Interval, inside: Interval) -> Passing:
    """1 - F = ½ (1 - r_s²) + ½ (1 - r_p²), r_s = (c - G) / (c + G), r_p = (n² c - G) / (n² c + G), G = ``inside``.

    d log(1 - F)/dc = -(n² - 1) / (c G²) · the mean of r_s and r_p, weighted by 1 - r²; d/dn likewise, of r_s n / G² and
    of r_p (n / G² - 2 / n).
    """
    square = iv.square(n)
    quotient = cosine / inside
    rs, rp = _amplitude(quotient), _amplitude(square * quotient)
    ws, wp = (iv.clip(1.0 - iv.square(r), 0.0, 1.0) for r in (rs, rp))
    whole = ws + wp
    share = iv.clip(ws / whole, 0.0, 1.0)
    share = iv.meet(iv.clip(1.0 / (1.0 + wp / ws), 0.0, 1.0), share)
    below = iv.square(inside)

    def mean(a: Interval, b: Interval) -> Interval:
        return b + share * (a - b)

    by_cosine = -(square - 1.0) / (cosine * below) * mean(rs, rp)
    over = n / below
    return Passing(iv.log(0.5 * whole), by_cosine, mean(rs * over, rp * (over - 2.0 / n)))
