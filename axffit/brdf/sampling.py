"""Drawing light directions: densities and transformations of uniforms that the models share.

Every model draws ``wi`` for a given ``wo`` from three uniforms: the first chooses a component where there are several,
the other two a direction. A draw that carries no light (below a horizon, or totally reflected inside a coat) is
``DOWN``; densities are per steradian of ``wi`` and integrate to the share of draws that do carry light.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import Direction, Scalar
from axffit.brdf.geometry import HalfGeometry, Lobes, slope_square
from axffit.frames import dot, reflect
from axffit.hemisphere import sample_cosine
from axffit.numerics import normalize, safe_sqrt

DOWN = (0.0, 0.0, -1.0)
"""The draw that carries no light."""

Uniforms = Float[Array, "3"]
"""Three independent uniforms in [0, 1)."""

MINIMUM_SHARE = 1e-3
"""Smallest share of draws that a component of a mixture gets, so that no part of its density is lost."""


def cosine_draw(u: Uniforms) -> Direction:
    """Direction of density cos theta / pi."""
    return sample_cosine(u[1:])


def cosine_density(wi: Direction) -> Scalar:
    """Density of :func:`cosine_draw`."""
    return wi[2] / jnp.pi


def mirrored(wo: Direction, half: Direction) -> Direction:
    """``wo`` mirrored about ``half``; ``DOWN`` where that lies below the horizon or ``wo`` behind the facet."""
    # Unit also where ``half`` is the difference of nearly equal vectors, which a compiler may round twice and unalike.
    wi = normalize(reflect(wo, half))
    return jnp.where((wi[2] > 0) & (dot(wo, half) > 0), wi, jnp.asarray(DOWN, wo.dtype))


def slope_normal(x: Scalar, y: Scalar) -> Direction:
    """Unit normal of the facet of slopes (x, y) = (h_x / h_z, h_y / h_z)."""
    return normalize(jnp.stack([x, y, jnp.ones_like(x)]))


def gaussian_slopes(u: Uniforms, alpha: Scalar, beta: Scalar) -> tuple[Scalar, Scalar]:
    """Slopes of density exp(-(x²/alpha² + y²/beta²)) / (pi alpha beta)."""
    radius = safe_sqrt(-jnp.log1p(-u[1]))
    phi = 2.0 * jnp.pi * u[2]
    return alpha * radius * jnp.cos(phi), beta * radius * jnp.sin(phi)


def slope_gaussian(half: HalfGeometry, alpha: Lobes, beta: Lobes) -> Lobes:
    """Density of the facets' slopes: exp(-(h_x²/alpha² + h_y²/beta²) / h_z²) / (pi alpha beta)."""
    return jnp.exp(-slope_square(half, alpha, beta)) / (jnp.pi * alpha * beta)


def slope_density_to_direction(density: Lobes, half: HalfGeometry) -> Lobes:
    """Density of ``wi`` from that of the facet's slopes: / cos³ theta_h, then / (4 <h, o>)."""
    inverse_cosine = safe_sqrt(half.square) / half.z
    return density * inverse_cosine**3 / (4.0 * half.cos_d)


def visible_ggx_normal(wo: Direction, u: Uniforms, alpha: Scalar, beta: Scalar) -> Direction:
    """Normal of a GGX facet that ``wo`` sees, by spherical caps (Dupuy & Benyoub, CGF 42(8), 2023)."""
    stretch = jnp.stack([alpha, beta, jnp.ones_like(alpha)])
    view = normalize(wo * stretch)
    phi = 2.0 * jnp.pi * u[2]
    z = (1.0 - u[1]) * (1.0 + view[2]) - view[2]
    sine = safe_sqrt(1.0 - z * z)
    cap = jnp.stack([sine * jnp.cos(phi), sine * jnp.sin(phi), z])
    return normalize((cap + view) * stretch)


def about(axis: Direction, cosine: Scalar, phi: Scalar) -> Direction:
    """Direction at ``cosine`` to the unit ``axis`` (not (0, 0, -1)), at azimuth ``phi`` around it."""
    k = 1.0 / (1.0 + axis[2])
    x, y = axis[0], axis[1]
    tangent = jnp.stack([1.0 - x * x * k, -x * y * k, -x])
    bitangent = jnp.stack([-x * y * k, 1.0 - y * y * k, -y])
    sine = safe_sqrt(1.0 - cosine * cosine)
    return sine * (jnp.cos(phi) * tangent + jnp.sin(phi) * bitangent) + cosine * axis


def shares(weights: Float[Array, " n"]) -> Float[Array, " n"]:
    """Shares of a mixture's components, in proportion to ``weights`` >= 0, none below ``MINIMUM_SHARE``."""
    count = weights.shape[0]
    total = jnp.sum(weights)
    even = jnp.full_like(weights, 1.0 / count)
    shares = jnp.where(total > 0, weights / jnp.where(total > 0, total, 1.0), even)
    return (1.0 - count * MINIMUM_SHARE) * shares + MINIMUM_SHARE


def choose(u: Uniforms, share: Float[Array, " n"]) -> tuple[Array, Uniforms]:
    """Index of the component that the first uniform falls on, and uniforms in which it is fresh again."""
    upper = jnp.cumsum(share)
    index = jnp.minimum(jnp.sum(u[0] >= upper), share.shape[0] - 1)
    fresh = (u[0] - (upper[index] - share[index])) / share[index]
    return index, u.at[0].set(jnp.clip(fresh, 0.0, 1.0))
