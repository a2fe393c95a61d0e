"""Directions for the BRDF error: views spread over the hemisphere, lights crowded where a texel's lobe is steep.

A lobe of roughness alpha lives within a few alpha of the mirror direction, far below any fixed grid of directions.
Lights are therefore placed by their half vector in the frame of the texel's own normal and rotation,

    h = (alpha_x sinh(y) cos(phi), alpha_y sinh(y) sin(phi), 1) / |...|,

evenly in y: linear near the peak, geometric in the tail, the same for every roughness. With a refracting coat, h
belongs to the directions below it. An even grid of lights covers the diffuse part.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from ..frames import dot, reflect, refract, tangent_frame, to_world

GOLDEN_ANGLE = np.pi * (3 - 5**0.5)
LOWEST = float(np.sin(np.radians(1.0)))
"""Views and lights stand at least 1° above the horizon."""

VIEW_POLAR = np.radians([0.0, 12.0, 25.0, 38.0, 50.0, 60.0, 70.0, 78.0, 84.0, 88.5])
"""Polar angles of the views; each texel gets its own azimuths."""


@dataclass(frozen=True)
class LobeFrames:
    """What shapes the lobes of n texels.

    Attributes:
        normal: base normals (n, 3), any length.
        rotation: anisotropy angles (n,), radians.
        roughness: (n, lobes, 2) along the lobe's axes.
        coat_normal: (n, 3).
        coat_ior: (n,); 1 where directions do not bend.
    """

    normal: np.ndarray
    rotation: np.ndarray
    roughness: np.ndarray
    coat_normal: np.ndarray
    coat_ior: np.ndarray


def views(texels: int) -> np.ndarray:
    """Unit directions to the viewer (texels, views, 3), azimuths by the golden angle so that none repeats."""
    number = np.arange(texels)[:, None] * len(VIEW_POLAR) + np.arange(len(VIEW_POLAR))
    azimuth = number * GOLDEN_ANGLE
    sine, cosine = np.sin(VIEW_POLAR), np.cos(VIEW_POLAR)
    parts = np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), cosine)
    return np.stack(parts, axis=-1)


def even_lights(count: int) -> np.ndarray:
    """Unit directions (count, 3) spread evenly over the hemisphere above 1° (Fibonacci spiral)."""
    index = np.arange(count) + 0.5
    z = LOWEST + (1 - LOWEST) * index / count
    sine = np.sqrt(1 - z**2)
    azimuth = index * GOLDEN_ANGLE
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), z], axis=-1)


def half_vectors(roughness: np.ndarray, rings: int, spokes: int) -> np.ndarray:
    """Half vectors (n, 1 + lobes · rings · spokes, 3) in the lobe's own frame, for roughness (n, lobes, 2).

    The first is the normal, which gives the mirror direction. Along a spoke tan(theta_h) = alpha sinh(y): half of the
    rings lie evenly in y up to 2.2, where a Gaussian lobe has fallen to 2e-9, the others from there to 57 (89°) along
    the wider axis.
    """
    y, _ = _rings(roughness, rings)
    x, z = _slopes(roughness, y, spokes)
    vectors = np.stack([x, z, np.ones_like(x)], axis=-1)
    vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
    normal = np.broadcast_to([0.0, 0.0, 1.0], (len(roughness), 1, 3))
    return np.concatenate([normal, vectors.reshape(len(roughness), -1, 3)], axis=1)


def ring_solid_angles(roughness: np.ndarray, rings: int, spokes: int) -> np.ndarray:
    """Solid angle (n, 1 + lobes · rings · spokes) that each of `half_vectors` stands for; 0 for the normal.

    d omega = dx dz / (1 + x² + z²)^(3/2) for slopes x, z. Every lobe's rings cover the whole hemisphere; each gets its
    share of it.
    """
    y, width = _rings(roughness, rings)
    x, z = _slopes(roughness, y, spokes)
    area = np.prod(roughness, axis=-1)[..., None, None] * np.sinh(y) * np.cosh(y) * width * 2 * np.pi / spokes
    solid = area / (1.0 + x * x + z * z) ** 1.5 / roughness.shape[1]
    return np.concatenate([np.zeros((len(roughness), 1)), solid.reshape(len(roughness), -1)], axis=1)


def _rings(roughness: np.ndarray, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """y of the rings and the widths of y they stand for, (n, lobes, rings, 1)."""
    widest = roughness.max(axis=-1)[..., None, None]
    last = np.arcsinh(57.0 / widest)
    inner = np.minimum(2.2, 0.5 * last)
    count = rings // 2
    step = ((np.arange(count) + 0.5) / count)[:, None]
    y = np.concatenate([inner * step, inner + (last - inner) * step], axis=-2)
    width = np.concatenate(
        [np.broadcast_to(part / count, (*y.shape[:2], count, 1)) for part in (inner, last - inner)], -2
    )
    return y, width


def _slopes(roughness: np.ndarray, y: np.ndarray, spokes: int) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (n, lobes, rings, spokes) of half vectors along the lobe's axes."""
    # Spokes of neighboring rings are set off against each other.
    phi = 2 * np.pi * (np.arange(spokes) + 0.5 * (np.arange(y.shape[-2])[:, None] % 2)) / spokes
    x = roughness[..., 0, None, None] * np.sinh(y) * np.cos(phi)
    return x, roughness[..., 1, None, None] * np.sinh(y) * np.sin(phi)


@jax.jit
def lobe_lights(
    wo: jax.Array, h: jax.Array, normal: jax.Array, rotation: jax.Array, coat_normal: jax.Array, coat_ior: jax.Array
) -> jax.Array:
    """Lights (n, views, k, 3) that see the views (n, views, 3) through the half vectors (n, k, 3).

    Below the coat: o* = refract(o), i* = 2 <h, o*> h - o*, and i is i* refracted out again; where i* cannot leave the
    coat, i lies at the horizon and the caller drops it.
    """
    shape = (*wo.shape[:2], h.shape[1])
    n, v, k = shape

    def everywhere(vectors: jax.Array, axes: tuple[int, ...]) -> jax.Array:
        return jnp.broadcast_to(jnp.expand_dims(vectors, axes), (*shape, 3))

    frame = jnp.broadcast_to(tangent_frame(normal, rotation)[:, None], (n, k, 3, 3))
    half = everywhere(to_world(frame, h), (1,))
    coat = everywhere(coat_normal / jnp.linalg.norm(coat_normal, axis=-1, keepdims=True), (1, 2))
    index = jnp.broadcast_to(coat_ior[:, None, None], shape)
    light = reflect(refract(everywhere(wo, (2,)), coat, index), half)
    leaving = refract(light, coat, 1.0 / index)
    leaving = leaving / jnp.maximum(jnp.linalg.norm(leaving, axis=-1, keepdims=True), 1e-30)
    return jnp.where(dot(light, coat)[..., None] > 0, leaving, jnp.zeros_like(leaving))
