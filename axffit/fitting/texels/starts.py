"""Where the solver begins: for each texel the best of a fixed set of roughnesses and normals.

The normals are the surface's own, the half vectors of the brightest samples (a mirror-like lobe peaks there) and the
mean of half vectors weighted by powers of the brightness. The linear parts are the best ones for each, so nothing
else has to be guessed; an anisotropic lobe begins round.
"""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit.fitting.texels.problem import Samples, TexelModel, cost_at

ROUGHNESSES = (0.03, 0.06, 0.1, 0.16, 0.25, 0.4, 0.65)
_STEEPEST = 1.5
"""Slopes of a normal beyond it are no start."""


def _slopes(x: Array, y: Array, z: Array) -> Float[Array, "2 lanes"]:
    slopes = jnp.stack([x, y]) / jnp.where(z > 0, z, 1.0)[None]
    length = jnp.sqrt(jnp.sum(slopes * slopes, axis=0))
    return jnp.where(((z > 0) & (length < _STEEPEST))[None], slopes, 0.0)


def normal_starts(samples: Samples) -> Float[Array, "m 2 lanes"]:
    """Slopes of the normals to begin with."""
    light = samples.light
    seen = samples.precisions > 0
    # Seen channels only, so that a texel is not bright for having lost none.
    count = jnp.sum(seen, axis=0).astype(samples.values.dtype)
    level = jnp.sum(jnp.where(seen, samples.values, 0.0), axis=0) / jnp.maximum(count, 1.0)
    level = jnp.maximum(level, 0.0)
    length = jax.lax.rsqrt(light.square)
    half = [jnp.broadcast_to(component * length, level.shape) for component in light.h]
    starts = [jnp.zeros((2, level.shape[1]), level.dtype)]
    left = level
    for _ in range(2):
        brightest = jnp.argmax(left, axis=0)[None]
        starts.append(_slopes(*[jnp.take_along_axis(component, brightest, axis=0)[0] for component in half]))
        left = jnp.where(jnp.arange(len(level))[:, None] == brightest, -1.0, left)
    relative = level / jnp.maximum(jnp.max(level, axis=0, keepdims=True), 1e-300)
    for power in (1, 3):
        weight = relative**power
        starts.append(_slopes(*[jnp.sum(weight * component, axis=0) for component in half]))
    return jnp.stack(starts)


@partial(jax.jit, static_argnums=0)
def best_starts(model: TexelModel, samples: Samples) -> Float[Array, "m p lanes"]:
    """One start a normal, with its roughness of least cost; in each lane the starts of least cost come first."""
    lanes = samples.values.shape[-1]
    dtype = samples.values.dtype
    round_lobe = jnp.zeros((2 * model.anisotropic, lanes), dtype)
    normals = normal_starts(samples) if model.normal else jnp.zeros((1, 0, lanes), dtype)
    logs = jnp.broadcast_to(jnp.log(jnp.asarray(ROUGHNESSES, dtype))[:, None, None], (len(ROUGHNESSES), 1, lanes))

    def best_of(normal: Float[Array, "n lanes"]) -> tuple[Array, Array]:
        starts = jax.vmap(lambda log: jnp.concatenate([log, round_lobe, normal]))(logs)
        costs = jax.lax.map(lambda theta: cost_at(model, samples, theta), starts)
        costs = jnp.where(jnp.isfinite(costs), costs, jnp.inf)
        best = jnp.argmin(costs, axis=0)
        return jnp.take_along_axis(starts, best[None, None], axis=0)[0], jnp.min(costs, axis=0)

    starts, costs = jax.lax.map(best_of, normals)
    return jnp.take_along_axis(starts, jnp.argsort(costs, axis=0)[:, None], axis=0)
