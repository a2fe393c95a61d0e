"""Which directions a preview asks for: a fixed ladder of lobes, the cosine hemisphere and the lights.

Every pixel uses the same points, so a smooth surface gives a smooth picture without noise. The techniques are combined
by the power heuristic (Veach 1997): sum f L cos n_k p_k / sum_j (n_j p_j)² over the samples of all, where n_k is the
number of samples and p_k the density of technique k. A ladder of roughnesses, instead of the model's own, serves every
BRDF: a table, a neural network or a lobe below a refracting coat.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit._types import Angles, Direction, Directions
from axffit.frames import reflect
from axffit.numerics import normalize
from axffit.preview.lights import Uniforms


def fibonacci_points(count: int) -> np.ndarray:
    """``count`` points of the unit square, (count, 2): the Fibonacci lattice, evenly spread in both coordinates."""
    index = np.arange(count)
    golden = (np.sqrt(5.0) - 1.0) / 2.0
    return np.stack([(index + 0.5) / count, np.mod(index * golden + 0.5, 1.0)], axis=-1).astype(np.float32)


class Samples(eqx.Module):
    """Numbers of samples and points of the unit square for each technique."""

    lobe_roughness: tuple[float, ...] = eqx.field(static=True)
    lobe: Uniforms
    cosine: Uniforms
    light: Uniforms

    def __init__(
        self,
        *,
        lobe_roughness: tuple[float, ...] = (0.012, 0.04, 0.13, 0.4),
        lobe: int = 34,
        cosine: int = 55,
        light: int = 55,
    ):
        """``lobe`` samples for each roughness, ``cosine`` over the hemisphere, ``light`` for each light."""
        self.lobe_roughness = lobe_roughness
        self.lobe = jnp.asarray(fibonacci_points(lobe))
        self.cosine = jnp.asarray(fibonacci_points(cosine))
        self.light = jnp.asarray(fibonacci_points(light))


def sample_cosine(uniforms: Uniforms) -> Float[Array, "count 3"]:
    """Directions of density cos / pi about (0, 0, 1)."""
    radius, phi = jnp.sqrt(uniforms[:, 0]), 2.0 * jnp.pi * uniforms[:, 1]
    z = jnp.sqrt(jnp.maximum(1.0 - uniforms[:, 0], 0.0))
    return jnp.stack([radius * jnp.cos(phi), radius * jnp.sin(phi), z], axis=-1)


def sample_visible_lobe(wo: Direction, roughness: float, uniforms: Uniforms) -> Float[Array, "count 3"]:
    """Light directions mirrored in visible GGX normals (spherical caps; Dupuy and Benyoub 2023).

    ``wo`` (3,) is the view in the lobe's frame, wo_z > 0.
    """
    stretch = jnp.array([roughness, roughness, 1.0], wo.dtype)
    view = normalize(wo * stretch)
    phi = 2.0 * jnp.pi * uniforms[:, 1]
    z = (1.0 - uniforms[:, 0]) * (1.0 + view[2]) - view[2]
    sine = jnp.sqrt(jnp.clip(1.0 - z * z, 0.0, 1.0))
    cap = jnp.stack([sine * jnp.cos(phi), sine * jnp.sin(phi), z], axis=-1)
    half = normalize((cap + view[None, :]) * stretch[None, :])
    return reflect(jnp.broadcast_to(wo, half.shape), half)


def lobe_density(wi: Directions, wo: Direction, roughness: float) -> Angles:
    """Density (1/sr) of :func:`sample_visible_lobe`, G1(wo) D(h) / (4 wo_z) with Walter's (2007) GGX.

    That is D / (2 (wo_z + sqrt(alpha² + (1 - alpha²) wo_z²))).
    """
    x, y, z = wi[..., 0] + wo[0], wi[..., 1] + wo[1], wi[..., 2] + wo[2]
    tangential, normal = x * x + y * y, z * z
    a2 = roughness * roughness
    # Unnormalized half vector: h_z rounds to 1 for the narrowest lobe in float32, the tangential part does not.
    ratio = jnp.maximum(tangential + normal, 1e-12) / jnp.maximum(a2 * normal + tangential, 1e-12)
    slope = 2.0 * jnp.pi * (wo[2] + jnp.sqrt(a2 + (1.0 - a2) * wo[2] * wo[2]))
    return jnp.where(z > 0.0, ratio * ratio * (a2 / slope), 0.0)
