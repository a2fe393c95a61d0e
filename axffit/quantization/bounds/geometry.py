"""The coordinates of the branch and bound, and the quantities that lobes need, as intervals over boxes.

A pair of directions i, o is given relative to the original normal n by the half vector h and the difference angle:

    tan theta_h = t = alpha sinh y,     tan theta_d = T = sinh x,     C = cos(phi_d)

with y, x >= 0 and -1 <= C <= 1. With p = cos theta_d cos theta_h and v = t T C the cosines are

    i_z = p (1 - v),    o_z = p (1 + v),

and i_z, o_z >= sin 1° is the same as p (1 - |v|) >= sin 1°. For a fixed h the azimuth of h does not matter to an
isotropic lobe, so that these three coordinates are all there is. In y a lobe looks alike for every roughness; in x the
grazing angles are spread out.
"""

from typing import NamedTuple

import numpy as np

from ..directions import LOWEST
from . import intervals as iv
from .intervals import Interval
from .texel_class import TexelClass

HORIZON = float(np.nextafter(LOWEST, 0.0))
"""Below sin 1° by a rounding, so that the domain is not smaller than stated."""


class Boxes(NamedTuple):
    """Boxes of directions and texels; every field is of shape (n,) or (1,)."""

    y: Interval
    """asinh(tan theta_h / alpha)."""
    x: Interval
    """asinh(tan theta_d)."""
    turn: Interval
    """C = cos(phi_d)."""
    alpha: Interval
    """Roughness."""
    f0: Interval
    """Reflectance at normal incidence."""

    def stack(self) -> np.ndarray:
        """As an array (5, 2, n) of ends."""
        return np.stack([np.stack(np.broadcast_arrays(side.lo, side.hi)) for side in self])


def boxes(ends: np.ndarray) -> Boxes:
    """Inverse of `Boxes.stack`."""
    return Boxes(*(Interval(side[0], side[1]) for side in ends))


def whole_domain(texels: TexelClass) -> np.ndarray:
    """The box of all directions and all texels of a class, (5, 2, 1); rounded outwards.

    i_z + o_z = 2 cos theta_d cos theta_h, so neither angle exceeds 89°.
    """
    steepest = 1.0 / HORIZON * (1 + 2.0**-50)
    y, x = (float(np.arcsinh(steepest / scale)) * (1 + 2.0**-48) for scale in (texels.roughness[0], 1.0))
    ends = [(0.0, y), (0.0, x), (-1.0, 1.0), texels.roughness, texels.f0]
    return np.array(ends)[:, :, None]


class Geometry(NamedTuple):
    """What follows from a box; see the module's formulas."""

    slope: Interval
    """sinh y = tan theta_h / alpha."""
    t: Interval
    """tan theta_h."""
    tangent_d: Interval
    """tan theta_d."""
    cos_d: Interval
    """cos theta_d."""
    p: Interval
    """cos theta_d cos theta_h."""
    v: Interval
    """(o_z - i_z) / (o_z + i_z)."""
    i_z: Interval
    """Cosine of the light."""
    o_z: Interval
    """Cosine of the viewer."""
    possible: np.ndarray
    """Whether the box may hold a pair of directions of the domain."""


def cosine_of_tangent(t: Interval) -> Interval:
    """1 / sqrt(1 + t²) for t >= 0."""
    return iv.falling(lambda s: 1.0 / iv.sqrt(1.0 + iv.square(s)), t)


def geometry(box: Boxes) -> Geometry:
    """Enclosures over boxes; the cosines are cut down to the domain."""
    slope, tangent_d = iv.sinh(box.y), iv.sinh(box.x)
    slope, tangent_d = (iv.clip(side, 0.0, np.inf) for side in (slope, tangent_d))
    t = box.alpha * slope
    cos_h, cos_d = cosine_of_tangent(t), cosine_of_tangent(tangent_d)
    p = iv.clip(cos_d * cos_h, 0.0, 1.0)
    possible = p.hi >= HORIZON
    p = iv.clip(p, HORIZON, 1.0)
    v = t * tangent_d * box.turn
    most = iv.clip(1.0 - HORIZON / p, 0.0, 1.0).hi
    possible &= (v.lo <= most) & (v.hi >= -most)
    v = iv.clip(v, -most, most)
    i_z, o_z = (iv.clip(p * side, HORIZON, 1.0) for side in (1.0 - v, 1.0 + v))
    return Geometry(slope, t, tangent_d, cos_d, p, v, i_z, o_z, possible)


def power5_of_complement(cosine: Interval) -> Interval:
    """(1 - c)⁵ for cosines, the shape of Schlick's Fresnel factor."""

    def shape(c: Interval) -> Interval:
        rest = iv.clip(1.0 - c, 0.0, 1.0)
        return iv.square(iv.square(rest)) * rest

    return iv.clip(iv.falling(shape, cosine), 0.0, 1.0)


def fresnel(f0: Interval, cosine: Interval) -> Interval:
    """Schlick's F0 + (1 - F0) (1 - c)⁵: rises in F0, falls in c."""

    def value(f0: np.ndarray, a: np.ndarray) -> Interval:
        return Interval(f0, f0) + (1.0 - Interval(f0, f0)) * Interval(a, a)

    a = power5_of_complement(cosine)
    return Interval(value(f0.lo, a.lo).lo, value(f0.hi, a.hi).hi)


def fresnel_quotient(f0: Interval, cos_d: Interval, o_z: Interval) -> Interval:
    """F(theta_d) / F(theta_o) = (a + F0 (1 - a)) / (b + F0 (1 - b)), a = (1 - cos theta_d)⁵, b = (1 - o_z)⁵.

    One Möbius function of F0, rising in a, falling in b and monotone in F0: its range is taken at corners.
    """
    a, b = power5_of_complement(cos_d), power5_of_complement(o_z)

    def corner(a: np.ndarray, b: np.ndarray, f0: np.ndarray) -> Interval:
        exact = [Interval(end, end) for end in (a, b, f0)]
        return (exact[0] + exact[2] * (1.0 - exact[0])) / (exact[1] + exact[2] * (1.0 - exact[1]))

    ends = (f0.lo, f0.hi)
    lo = np.minimum(*(corner(a.lo, b.hi, end).lo for end in ends))
    hi = np.maximum(*(corner(a.hi, b.lo, end).hi for end in ends))
    return Interval(np.maximum(lo, 0.0), hi)


def fresnel_change(f0: Interval, change: Interval, cosine: Interval) -> Interval:
    """log F' / F = log(1 + (F0' - F0) (1 - a) / (F0 + (1 - F0) a)), a = (1 - c)⁵, by Schlick.

    The quotient falls in a and in F0: its range is taken at corners.
    """
    a = power5_of_complement(cosine)

    def weight(a: np.ndarray, f0: np.ndarray) -> Interval:
        a_, f_ = Interval(a, a), Interval(f0, f0)
        return (1.0 - a_) / (f_ + (1.0 - f_) * a_)

    weights = Interval(np.maximum(weight(a.hi, f0.hi).lo, 0.0), weight(a.lo, f0.lo).hi)
    return iv.log1p(change * weights)
