"""Pairs of directions below the coat as boxes of four coordinates, and everything that lobes and coats need of them.

In the base's own frame (its normal n = z, the lobe's axes x and y), with a reference roughness (a_x, a_y):

    slopes of h:  p = h_x / h_z = a_x sinh(y) cos(psi),   s = h_y / h_z = a_y sinh(y) sin(psi),   t² = p² + s²
    T = tan theta_d = sinh(x),   d = cos(phi) e_1 + sin(phi) e_2,   i = cos theta_d h + sin theta_d d,   o = … - …

e_1, e_2 are x and y turned with the smallest rotation that takes n to h, which is smooth at h = n. With u = h_x cos phi
+ h_y sin phi, P = cos theta_d h_z and v = T u / h_z: i_z = P (1 - v), o_z = P (1 + v). Where neither roughness nor coat
tell azimuths apart, psi = 0.
"""

from typing import NamedTuple

import numpy as np

from . import intervals as iv
from .geometry import HORIZON, cosine_of_tangent
from .intervals import Interval

Vector = tuple[Interval, Interval, Interval]

ZERO = Interval(0.0, 0.0)
ONE = Interval(1.0, 1.0)
UP: Vector = (ZERO, ZERO, ONE)


def dot(a: Vector, b: Vector) -> Interval:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


ROOM = 2e-7
"""Angles from arccosines near 1 may be wrong by this, rounding included."""


def cosine_between(a: Vector, b: Vector) -> Interval:
    """<a, b> of unit vectors: the inner product, and where it is tighter the cosine of the angle between two caps.

    The inner product of wide boxes counts vectors that are none of length 1.
    """
    product, (one, reach), (other, further) = dot(a, b), _cap(a), _cap(b)
    angle = np.arccos(np.clip(sum(x * y for x, y in zip(one, other, strict=True)), -1.0, 1.0))
    reach = reach + further + ROOM
    low, high = np.cos(np.minimum(angle + reach, np.pi)), np.cos(np.maximum(angle - reach, 0.0))
    return iv.meet(product, Interval(low - 1e-15, high + 1e-15))


def _cap(a: Vector) -> tuple[list[np.ndarray], np.ndarray]:
    """Middle and angle of a cap that holds all unit vectors of a box.

    With the box's middle w, |a - w| <= r: the cosine of the angle from w is (1 + |w|² - |a - w|²) / (2 |w|).
    """
    middle = [0.5 * (c.lo + c.hi) for c in a]
    square = sum(w * w for w in middle)
    length = np.sqrt(np.maximum(square, 1e-6))
    radius = sum((0.5 * (c.hi - c.lo)) ** 2 for c in a)
    cosine = (1.0 + square - radius) / (2.0 * length) - 1e-14
    reach = np.where(square > 1e-6, np.arccos(np.clip(cosine, -1.0, 1.0)), np.pi)
    return [w / length for w in middle], reach


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plus(a: Vector, b: Vector) -> Vector:
    """Sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def times(factor: Interval, a: Vector) -> Vector:
    """Multiple."""
    return (factor * a[0], factor * a[1], factor * a[2])


def vector_around(a: Vector, radius: float) -> Vector:
    """Everything whose components are within a distance."""
    return (iv.around(a[0], radius), iv.around(a[1], radius), iv.around(a[2], radius))


class Pairs(NamedTuple):
    """Directions below the coat; see the module's formulas."""

    q: Interval
    """(p / a_x)² + (s / a_y)² = sinh² y."""
    px: Interval
    """p / a_x."""
    sy: Interval
    """s / a_y."""
    p: Interval
    """h_x / h_z."""
    s: Interval
    """h_y / h_z."""
    t2: Interval
    """tan² theta_h."""
    cos_h: Interval
    """h_z."""
    cos_d: Interval
    """cos theta_d."""
    middle: Interval
    """P = cos theta_d cos theta_h = (i_z + o_z) / 2."""
    v: Interval
    """(o_z - i_z) / (o_z + i_z)."""
    wi: Vector
    """Light."""
    wo: Vector
    """Viewer."""
    mixed: tuple[Interval, Interval]
    """(i_x o_z + i_z o_x) / 2 and (i_y o_z + i_z o_y) / 2: how far o is from the mirror direction of i."""
    possible: np.ndarray
    """Whether the box may hold a pair at least 1° above the base's horizon."""


def pairs_of_boxes(
    y: Interval, psi: Interval, x: Interval, phi: Interval, a_x: Interval, a_y: Interval, lowest: float
) -> Pairs:
    """Enclosures over boxes, cut down to cosines with the base's normal of at least ``lowest``."""
    slope, tangent = (iv.clip(iv.sinh(c), 0.0, np.inf) for c in (y, x))
    cosine, sine = iv.cos(psi), iv.sin(psi)
    px, sy = slope * cosine, slope * sine
    p, s, q = a_x * px, a_y * sy, iv.square(slope)
    t2 = q * (iv.square(a_x * cosine) + iv.square(a_y * sine))
    cos_h, cos_d = cosine_of_tangent(iv.sqrt(t2)), cosine_of_tangent(tangent)
    hx, hy = p * cos_h, s * cos_h
    sin_d = iv.clip(tangent * cos_d, 0.0, 1.0)
    c, w = iv.cos(phi), iv.sin(phi)
    reach = p * c + s * w
    u = reach * cos_h
    share = u / (1.0 + cos_h)
    d = (c - hx * share, w - hy * share, -u)
    middle = iv.clip(cos_d * cos_h, 0.0, 1.0)
    possible = middle.hi >= lowest
    middle = iv.clip(middle, lowest, 1.0)
    most = iv.clip(1.0 - lowest / middle, 0.0, 1.0).hi
    v = tangent * reach
    possible &= (v.lo <= most) & (v.hi >= -most)
    v = iv.clip(v, -most, most)
    i_z, o_z = (iv.clip(middle * side, lowest, 1.0) for side in (1.0 - v, 1.0 + v))
    along, across = (cos_d * hx, cos_d * hy), (sin_d * d[0], sin_d * d[1])
    wi = (_unit(along[0] + across[0]), _unit(along[1] + across[1]), i_z)
    wo = (_unit(along[0] - across[0]), _unit(along[1] - across[1]), o_z)
    # With i = a + b, o = a - b: i_x o_z + i_z o_x = 2 (a_x a_z - b_x b_z).
    low = iv.square(sin_d) * u
    mixed = (p * iv.square(middle) + low * d[0], s * iv.square(middle) + low * d[1])
    return Pairs(q, px, sy, p, s, t2, cos_h, cos_d, middle, v, wi, wo, mixed, possible)


def pairs_of_views(
    slopes: tuple[np.ndarray, np.ndarray], wo: Vector, a_x: Interval, a_y: Interval
) -> tuple[Pairs, np.ndarray]:
    """Lights that see views through given slopes of h, and where they exist for certain above the base's horizon.

    Through the slopes (0, 0) a view sees its mirror direction, which always exists.
    """
    p, s = (Interval(c, c) for c in slopes)
    t2 = iv.square(p) + iv.square(s)
    cos_h = 1.0 / iv.sqrt(1.0 + t2)
    h = (p * cos_h, s * cos_h, cos_h)
    flat = (slopes[0] == 0) & (slopes[1] == 0)
    cos_d = _choose(flat, wo[2], iv.clip(dot(h, wo), -1.0, 1.0))
    exists = cos_d.lo > 0
    twice = 2.0 * cos_d
    wi = tuple(
        _choose(flat, sign * b if sign < 0 else b, _unit(twice * a - b))
        for sign, a, b in zip((-1.0, -1.0, 1.0), h, wo, strict=True)
    )
    exists &= flat | (wi[2].lo >= HORIZON)
    cos_d, i_z = iv.clip(cos_d, HORIZON / 2, 1.0), iv.clip(wi[2], HORIZON, 1.0)
    middle = iv.clip(cos_d * cos_h, HORIZON, 1.0)
    v = _choose(flat, ZERO, iv.clip((wo[2] - i_z) / (wo[2] + i_z), -1.0, 1.0))
    px, sy = p / a_x, s / a_y
    q = iv.square(px) + iv.square(sy)
    mixed = (0.5 * (wi[0] * wo[2] + i_z * wo[0]), 0.5 * (wi[1] * wo[2] + i_z * wo[1]))
    return Pairs(q, px, sy, p, s, t2, cos_h, cos_d, middle, v, (wi[0], wi[1], i_z), wo, mixed, exists), exists


def _choose(where: np.ndarray, a: Interval, b: Interval) -> Interval:
    return Interval(np.where(where, a.lo, b.lo), np.where(where, a.hi, b.hi))


def _unit(x: Interval) -> Interval:
    return iv.clip(x, -1.0, 1.0)


def inflated(
    g: Pairs, rigid: float, loose: float, a_x: Interval, a_y: Interval, ratios: tuple[Interval, Interval]
) -> Pairs:
    """What pairs may become when both directions turn together by ``rigid`` and each by up to ``loose`` on its own.

    h' = i + o moves by at most |h'| rigid + 2 loose, so h turns by at most a with tan a <= 1.01 (rigid + loose /
    cos theta_d), and a slope by at most tan(theta_h + a) - tan theta_h. The roughnesses go up to ``ratios`` times
    their own.
    """
    t = iv.sqrt(g.t2)
    turn = iv.up(1.01 * iv.up(rigid + iv.up(loose / g.cos_d.lo)))
    rest = iv.down(1.0 - iv.up(t.hi * turn))
    shift = np.where(
        rest > 0, iv.up(iv.up(iv.up(1.0 + g.t2.hi) * turn) / np.where(rest > 0, rest, 1.0) * (1 + 1e-15)), np.inf
    )
    p, s = iv.around(g.p, shift), iv.around(g.s, shift)
    t2 = iv.square(iv.clip(iv.around(t, shift), 0.0, np.inf))
    px, sy = (
        iv.around(c, iv.up(shift / a.lo)) / ratio for c, a, ratio in zip((g.px, g.sy), (a_x, a_y), ratios, strict=True)
    )
    narrowest = np.minimum(a_x.lo, a_y.lo)
    both = iv.hull(*ratios)
    q = iv.square(iv.clip(iv.around(iv.sqrt(g.q), iv.up(shift / narrowest)), 0.0, np.inf) / both)
    step = float(np.nextafter(rigid + loose, np.inf))
    cos_d = iv.clip(iv.around(g.cos_d, loose), 2.0**-20, 1.0)
    cos_h = iv.clip(iv.around(g.cos_h, turn), 2.0**-20, 1.0)
    wi, wo = (
        (_unit(iv.around(w[0], step)), _unit(iv.around(w[1], step)), iv.clip(iv.around(w[2], step), 2.0**-20, 1.0))
        for w in (g.wi, g.wo)
    )
    middle = iv.clip(iv.around(g.middle, step), 2.0**-20, 1.0)
    v = iv.clip((wo[2] - wi[2]) / (wo[2] + wi[2]), -1.0, 1.0)
    v = iv.meet(iv.around(g.v, iv.up(2.0 * iv.up(step / middle.lo))), v)
    mixed = (iv.around(g.mixed[0], 2.0 * step), iv.around(g.mixed[1], 2.0 * step))
    return Pairs(q, px, sy, p, s, t2, cos_h, cos_d, middle, v, wi, wo, mixed, g.possible)
