"""Quadrature and sampling over the upper hemisphere."""

from typing import Protocol, runtime_checkable

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit._types import Channels, Direction, Directions
from axffit.frames import spherical_to_direction


@runtime_checkable
class Reflector(Protocol):
    """Anything with the BRDF contract: value in 1/sr of (wi, wo), without the cosine."""

    def evaluate(self, wi: Directions, wo: Directions) -> Channels:
        """BRDF of the two directions."""
        ...


def gauss_legendre_hemisphere(polar_count: int, azimuth_count: int) -> tuple[Float[Array, "n 3"], Float[Array, " n"]]:
    """Directions and solid-angle weights (sr, summing to 2 pi) of a product rule over the upper hemisphere.

    Gauss-Legendre in cos theta, equal steps in phi (the trapezoidal rule, exact there for periodic functions).
    A lobe of roughness alpha wants ``polar_count`` of about 30 / alpha.
    """
    nodes, node_weights = np.polynomial.legendre.leggauss(polar_count)
    cosine, weight = 0.5 * (nodes + 1.0), 0.5 * node_weights
    phi = 2.0 * np.pi * (np.arange(azimuth_count) + 0.5) / azimuth_count
    theta_grid, phi_grid = np.meshgrid(np.arccos(cosine), phi, indexing="ij")
    weights = np.repeat(weight * 2.0 * np.pi / azimuth_count, azimuth_count)
    directions = spherical_to_direction(jnp.asarray(theta_grid.ravel()), jnp.asarray(phi_grid.ravel()))
    return directions, jnp.asarray(weights)


def sample_uniform(u: Float[Array, "... 2"]) -> Directions:
    """Directions uniform over the hemisphere (density 1 / (2 pi) per sr) from uniforms in [0, 1)²."""
    return spherical_to_direction(jnp.arccos(u[..., 0]), 2.0 * jnp.pi * u[..., 1])


def sample_cosine(u: Float[Array, "... 2"]) -> Directions:
    """Directions of density cos theta / pi per sr from uniforms in [0, 1)² (Malley's method)."""
    return spherical_to_direction(jnp.arcsin(jnp.sqrt(u[..., 0])), 2.0 * jnp.pi * u[..., 1])


def directional_albedo(
    brdf: Reflector, wo: Direction, *, polar_count: int = 256, azimuth_count: int = 256
) -> Float[Array, "3"]:
    """Directional-hemispherical reflectance of ``wo``: the integral of f(wi, wo) cos theta_i over all wi."""
    wi, weights = gauss_legendre_hemisphere(polar_count, azimuth_count)
    return _cosine_integral(brdf, wi.astype(wo.dtype), weights.astype(wo.dtype), wo)


@eqx.filter_jit
def _cosine_integral(brdf: Reflector, wi: Directions, weights: Float[Array, " n"], wo: Direction) -> Channels:
    """Weighted sum of f cos theta_i over the directions ``wi``."""
    return jnp.sum(brdf.evaluate(wi, wo) * (weights * wi[:, 2])[:, None], axis=0)
