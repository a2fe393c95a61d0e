"""The half-vector quantities that the lobes share, in forms without cancellation or division by a length."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import Direction, Scalar
from axffit.numerics import floor_cosine, safe_norm, safe_sqrt

Lobes = Float[Array, "*lobes"]
"""One value, or one for each of several lobes."""


class HalfGeometry(NamedTuple):
    """What a lobe needs of a pair of directions above the horizon.

    With h' = i + o of unit vectors, <h, i> = <h, o> = |h'| / 2 and 1 - <h, o>² = |i - o|² / 4: nothing has to be
    normalized, and 1 - <h, o> keeps its digits when the directions coincide.
    """

    i_z: Scalar
    """Cosine of the light direction, floored for use in denominators."""
    o_z: Scalar
    """Cosine of the viewer direction, floored for use in denominators."""
    x: Scalar
    """h'_x."""
    y: Scalar
    """h'_y."""
    z: Scalar
    """h'_z, from the floored cosines."""
    square: Scalar
    """<h', h'>."""
    cos_d: Scalar
    """Cosine of the difference angle, <h, i> = <h, o>."""
    one_minus_cos_d: Scalar
    """1 - cos_d, accurate near 0."""
    sin_d: Scalar
    """Sine of the difference angle, |i - o| / 2."""


def half_geometry(wi: Direction, wo: Direction) -> HalfGeometry:
    """Half-vector quantities of unit directions above the horizon."""
    i_z, o_z = floor_cosine(wi[2]), floor_cosine(wo[2])
    x, y, z = wi[0] + wo[0], wi[1] + wo[1], i_z + o_z
    square = x * x + y * y + z * z
    cos_d = 0.5 * jnp.sqrt(square)
    difference = wi - wo
    sin_d_square = 0.25 * jnp.sum(difference * difference)
    return HalfGeometry(i_z, o_z, x, y, z, square, cos_d, sin_d_square / (1.0 + cos_d), safe_sqrt(sin_d_square))


def slope_square(half: HalfGeometry, alpha: Lobes, beta: Lobes) -> Lobes:
    """(h_x²/alpha² + h_y²/beta²) / h_z²: the facet's slope in units of the roughnesses, squared."""
    x, y = half.x / half.z / alpha, half.y / half.z / beta
    return x * x + y * y


def half_angles(half: HalfGeometry) -> tuple[Scalar, Scalar]:
    """Sine-like and cosine-like sides (|h'_xy|, h'_z) whose arc tangent is theta_h."""
    return safe_norm(jnp.stack([half.x, half.y])), half.z
