"""Gradient ascent to the largest BRDF errors of given texels.

A pair of directions is four numbers without bounds that matter: the half vector below the coat in the base's own axes,
tan theta_h = (alpha_x sinh a, alpha_y sinh b), and the viewer's polar angle and azimuth. The view's peak is followed at
the same time by two more, the half vector of its brightest light, which climb f i_z while the pair climbs the error. A
peak that is followed can only be too low; so the best pairs are evaluated again, beside all lights of their view.
"""

from collections.abc import Mapping
from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..brdf import AbstractBRDF
from ..frames import refract, spherical_to_direction, tangent_frame, to_local
from ..numerics import normalize
from .definitions import BATCH, RELEVANT, Pairs, errors_at, lights_of, lowest_cosine, normals_of
from .directions import LOWEST, VIEW_POLAR, LobeFrames, lobe_lights
from .local import LocalTexels, Texels

STEPS = 60
FIRST_RATE, LAST_RATE = 0.1, 1e-3

AGAIN = 16
"""Pairs evaluated again for each definition, the best ones."""

STEEPEST = float(np.arccos(LOWEST))
TINY = 1e-300
LOG_RELEVANT = float(np.log(RELEVANT))

Frame = tuple[jax.Array, jax.Array, jax.Array, jax.Array, jax.Array]
"""Base normal (3,), coat normal (3,), coat index, rotation, roughness (2,) of a texel, in its own frame."""


def ascend(texels: LocalTexels, starts: Mapping[str, Pairs], even: np.ndarray) -> dict[str, Pairs]:
    """The best pairs reached from some, with their errors, largest first; needs JAX with x64 enabled.

    Args:
        texels: the texels.
        starts: where to start, by the names of `definitions.KINDS`.
        even: the lights beside those of the lobes that were looked at, see `definitions.lights_of`.
    """
    pairs = Pairs.concatenate(list(starts.values()))
    is_ratio = np.repeat([kind == "log_ratio" for kind in starts], [len(part.texel) for part in starts.values()])
    light, view, followed, value = _climb(
        texels.before.take(pairs.texel),
        texels.after.take(pairs.texel),
        _frames(texels.frames, pairs.texel),
        (jnp.asarray(pairs.wi), jnp.asarray(pairs.wo), jnp.asarray(pairs.brightest)),
        jnp.asarray(is_ratio),
    )
    reached = Pairs(pairs.texel, *(np.asarray(x) for x in (light, view, followed, value)))
    best = {kind: reached.take(is_ratio == (kind == "log_ratio")).largest(AGAIN - 1) for kind in starts}
    # A start that is best already is not lost.
    return _again(texels, {kind: Pairs.concatenate([best[kind], starts[kind].largest(1)]) for kind in starts}, even)


def _frames(frames: LobeFrames, part: np.ndarray) -> Frame:
    return *normals_of(frames, part), jnp.asarray(frames.rotation[part]), jnp.asarray(frames.roughness[part, 0])


def _again(texels: LocalTexels, kept: Mapping[str, Pairs], even: np.ndarray) -> dict[str, Pairs]:
    """The errors with the peak over all lights of each pair's view and the light that was followed."""
    pairs = Pairs.concatenate(list(kept.values()))
    # Of the shapes that were evaluated before, so that nothing is compiled again.
    part = np.resize(pairs.texel, BATCH)
    wo = np.repeat(np.resize(pairs.wo, (BATCH, 1, 3)), len(VIEW_POLAR), axis=1)
    dense = lights_of(texels.frames, part, wo, even[:-2])
    own, followed = (
        jnp.broadcast_to(jnp.asarray(np.resize(x, (BATCH, 1, 1, 3))), (*wo.shape[:2], 1, 3))
        for x in (pairs.wi, pairs.brightest)
    )
    wi = jnp.concatenate([dense, followed, own], axis=2)
    normals = normals_of(texels.frames, part)
    errors, _, _ = errors_at(texels.before.take(part), texels.after.take(part), normals, wi, jnp.asarray(wo))
    found, first = {}, 0
    for kind, mine in kept.items():
        run = slice(first, first := first + len(mine.texel))
        found[kind] = replace(mine, error=np.asarray(errors[kind])[run, 0, -1]).largest(AGAIN)
    return found


def _light(at: jax.Array, wo: jax.Array, frame: Frame) -> jax.Array:
    """The light that a viewer sees through the half vector of coordinates (2,)."""
    normal, coat, ior, rotation, roughness = frame
    slope = roughness * jnp.sinh(at)
    h = normalize(jnp.concatenate([slope, jnp.ones_like(slope[:1])]))
    arrays = (wo[None, None], h[None, None], normal[None], rotation[None], coat[None], ior[None])
    return lobe_lights(*arrays)[0, 0, 0]


def _half(wi: jax.Array, wo: jax.Array, frame: Frame) -> jax.Array:
    """Inverse of `_light`."""
    normal, coat, ior, rotation, roughness = frame
    h = to_local(tangent_frame(normal, rotation), refract(wi, coat, ior) + refract(wo, coat, ior))
    return jnp.arcsinh(h[:2] / jnp.maximum(h[2], 1e-9) / roughness)


def _bent(x: jax.Array, factor: jax.Array) -> jax.Array:
    """x, with its gradient multiplied by a factor."""
    still = jax.lax.stop_gradient(x)
    return still + factor * (x - still)


@eqx.filter_jit
def _climb(
    before: Texels,
    after: Texels,
    frames: Frame,
    start: tuple[jax.Array, jax.Array, jax.Array],
    is_ratio: jax.Array,
) -> tuple[jax.Array, ...]:
    """Best light, view, followed light and error (with the followed peak) of each start (wi, wo, brightest light)."""

    def objective(
        at: jax.Array, is_ratio: jax.Array, own: tuple[AbstractBRDF, AbstractBRDF], frame: Frame
    ) -> tuple[jax.Array, tuple[jax.Array, ...]]:
        """What climbs: the error's logarithm for the pair, f i_z for the followed light."""
        sides = zip(own, (before, after), strict=True)
        first, second = (eqx.combine(mine, side.shared).astype(jnp.dtype(at.dtype)) for mine, side in sides)
        view = spherical_to_direction(jnp.clip(at[2], 0.0, STEEPEST), at[3])
        # The followed light, the pair's and the mirror's; a factor of -1 lets the view climb away from a high peak.
        views = jnp.stack([_bent(view, jnp.where(is_ratio, 0.0, -1.0)), view, view])
        halves = jnp.stack([at[4:], at[:2], jnp.zeros_like(at[:2])])
        lights = jax.vmap(lambda half, wo: _light(half, wo, frame))(halves, views)
        f = jnp.maximum(jax.vmap(first.masked_value)(lights[:2], views[:2]) * lights[:2, 2:], TINY)
        g = jnp.maximum(second.masked_value(lights[1], view) * lights[1, 2], TINY)
        log_peak = jnp.log(jnp.max(f[0]))
        log_f = jnp.log(f[1])
        change = jnp.log(g) - log_f
        height = log_f - jax.lax.stop_gradient(jnp.maximum(log_peak, jnp.max(log_f)))
        cosines = jax.vmap(lambda v: lowest_cosine(v, frame[:3]))(jnp.concatenate([lights, view[None]]))
        outside = jnp.minimum(cosines / LOWEST - 1.0, 0.0)
        ratio, relative = jnp.abs(change), jnp.abs(jnp.expm1(change))
        score = jnp.where(
            is_ratio,
            jnp.log(ratio + TINY) + 3.0 * jnp.minimum(height - LOG_RELEVANT, 0.0),
            jnp.log(relative + TINY) + height,
        )
        value = jnp.where(is_ratio, jnp.where(height >= LOG_RELEVANT, ratio, 0.0), relative * jnp.exp(height))
        value = jnp.where(jnp.all(outside[1:] >= 0), jnp.max(value), 0.0)
        return jnp.max(score) + log_peak + 30.0 * jnp.sum(outside), (value, lights[1], view, lights[0])

    slope = jax.vmap(jax.grad(objective, has_aux=True))
    wi, wo, brightest = start
    theta, phi = jnp.arccos(jnp.clip(wo[:, 2:], -1.0, 1.0)), jnp.arctan2(wo[:, 1:2], wo[:, :1])
    halves = [jax.vmap(_half)(light, wo, frames) for light in (wi, brightest)]
    first_at = jnp.concatenate([halves[0], theta, phi, halves[1]], axis=-1)
    own = (before.own, after.own)

    def step(carry: tuple, rate: jax.Array) -> tuple[tuple, None]:
        at, first, second, best = carry
        gradient, here = slope(at, is_ratio, own, frames)
        better = here[0] > best[0]
        best = tuple(jnp.where(better.reshape(-1, *(1,) * (b.ndim - 1)), h, b) for h, b in zip(here, best, strict=True))
        gradient = jnp.nan_to_num(gradient, posinf=0.0, neginf=0.0)
        first, second = 0.8 * first + 0.2 * gradient, 0.95 * second + 0.05 * gradient**2
        at = at + rate * first / (jnp.sqrt(second) + 1e-12)
        return (at.at[:, 2].set(jnp.clip(at[:, 2], 0.0, STEEPEST)), first, second, best), None

    zero = jnp.zeros_like(first_at)
    nothing = (jnp.zeros_like(theta[:, 0]), wi, wo, brightest)
    rates = FIRST_RATE * (LAST_RATE / FIRST_RATE) ** (jnp.arange(STEPS, dtype=zero.dtype) / STEPS)
    (_, _, _, best), _ = jax.lax.scan(step, (first_at, zero, zero, nothing), rates)
    return *best[1:], best[0]
