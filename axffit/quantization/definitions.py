"""The two BRDF errors and where they look, at given texels, viewers and lights.

    (b)  max |f' - f| i_z / max_i (f i_z), the peak taken per view and over the three channels
    (c)  max |log f' - log f| where f i_z >= 1e-3 of that view's peak

f is the original's value, f' the packed one's; horizon and cosines are those of the original's outermost normal
(`local`). Both look where light and viewer stand at least 1° above the horizon and, under a coat, enter at least 1°
above the base's, in views whose mirror direction does so, too. (b) in what is left is the strip.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..frames import dot, refract
from ..numerics import normalize
from .directions import LOWEST, LobeFrames, half_vectors, lobe_lights
from .local import Texels

RINGS, SPOKES = 24, 12
BATCH = 32
"""Texels evaluated at once."""

RELEVANT = 1e-3
"""Definition (c) looks where f i_z is at least this part of the view's peak."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of light and viewer at texels, in the texels' own frames.

    Attributes:
        texel: which texel (n,).
        wi: to the light (n, 3).
        wo: to the viewer (n, 3).
        brightest: light that reflects most towards this viewer, of those looked at (n, 3).
        error: the error (n,).
    """

    texel: np.ndarray
    wi: np.ndarray
    wo: np.ndarray
    brightest: np.ndarray
    error: np.ndarray

    @classmethod
    def concatenate(cls, parts: Sequence["Pairs"]) -> "Pairs":
        """Several as one."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))

    def take(self, chosen: np.ndarray) -> "Pairs":
        """Some of the pairs."""
        return Pairs(*(values[chosen] for values in vars(self).values()))

    def largest(self, count: int) -> "Pairs":
        """Those with the largest errors, the largest first."""
        return self.take(np.argsort(-self.error, kind="stable")[:count])


def lights_of(frames: LobeFrames, texels: np.ndarray, wo: np.ndarray, even: np.ndarray) -> jax.Array:
    """Lights (n, views, lights, 3) where the lobes of texels are steep, the mirror direction first, and even ones.

    Args:
        frames: what shapes the lobes.
        texels: which texels (n,).
        wo: viewers (n, views, 3).
        even: other lights (m, 3), for what is broad.
    """
    h = half_vectors(frames.roughness[texels], RINGS, SPOKES)
    crowded = lobe_lights(
        *(jnp.asarray(x) for x in (wo, h)),
        *(jnp.asarray(x[texels]) for x in (frames.normal, frames.rotation, frames.coat_normal, frames.coat_ior)),
    )
    spread = jnp.broadcast_to(jnp.asarray(even), (*crowded.shape[:2], *even.shape))
    return jnp.concatenate([crowded, spread], axis=2)


Normals = tuple[jax.Array, jax.Array, jax.Array]
"""Base normals (..., 3), those of the coat (the base's again without one), and its indices (1 where nothing bends)."""


def lowest_cosine(v: jax.Array, normals: Normals) -> jax.Array:
    """The smaller cosine of directions (..., 3) with the outermost normal, and of what enters with the base's."""
    base, coat, ior = normals
    return jnp.minimum(v[..., 2], dot(normalize(refract(v, coat, ior)), base))


def normals_of(frames: LobeFrames, texels: np.ndarray) -> Normals:
    """Those of texels (n), for `lowest_cosine`."""
    unit = [x / np.linalg.norm(x, axis=-1, keepdims=True) for x in (frames.normal[texels], frames.coat_normal[texels])]
    return jnp.asarray(unit[0]), jnp.asarray(unit[1]), jnp.asarray(frames.coat_ior[texels])


@eqx.filter_jit
def errors_at(
    before: Texels,
    after: Texels,
    normals: Normals,
    wi: jax.Array,
    wo: jax.Array,
) -> tuple[dict[str, jax.Array], jax.Array, tuple[jax.Array, jax.Array, jax.Array]]:
    """The errors at every (texel, view, light), 0 where a definition does not look, and each view's brightest light.

    Last come f i_z and f' i_z (n, views, lights, 3), and where (b) and (c) look.

    Args:
        before: the original's texels (n).
        after: what the shader sees.
        normals: of the original, see `normals_of`.
        wi: lights (n, views, lights, 3), the first of each view its mirror direction.
        wo: viewers (n, views, 3).
    """
    wo = jnp.broadcast_to(wo[:, :, None], wi.shape)
    f, g = (side.reflect(wi, wo) for side in (before, after))
    base, coat = (jnp.broadcast_to(n[:, None, None], wi.shape) for n in normals[:2])
    at = (base, coat, jnp.broadcast_to(normals[2][:, None, None], wi.shape[:-1]))
    clear = (lowest_cosine(wi, at) >= LOWEST) & (lowest_cosine(wo, at) >= LOWEST)
    clear = clear & clear[:, :, :1]
    high = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    difference = jnp.max(jnp.abs(g - f), axis=-1)
    bright = [jnp.where(where, jnp.max(f, axis=-1), 0.0) for where in (clear, high)]
    peak, strip_peak = (jnp.max(values, axis=-1, keepdims=True) for values in bright)
    relevant = (peak > 0)[..., None] & (f >= RELEVANT * peak[..., None])
    both = relevant & (g > 0)
    ratio = jnp.abs(jnp.log(jnp.where(both, g, 1.0)) - jnp.log(jnp.where(both, f, 1.0)))
    ratio = jnp.max(jnp.where(relevant & ~(g > 0), jnp.inf, ratio), axis=-1)
    errors = {
        "peak_relative": _over_peak(difference, peak, clear),
        "log_ratio": jnp.where(clear, ratio, 0.0),
        "strip": _over_peak(difference, strip_peak, high & ~clear),
    }
    brightest = jnp.argmax(bright[0], axis=-1)
    return errors, jnp.take_along_axis(wi, brightest[..., None, None], axis=2)[:, :, 0], (f, g, clear)


def _over_peak(difference: jax.Array, peak: jax.Array, where: jax.Array) -> jax.Array:
    """|f' - f| i_z over the view's peak; 0 elsewhere and where the view sees no light at all."""
    return jnp.where(where & (peak > 0), difference / jnp.where(peak > 0, peak, 1.0), 0.0)
