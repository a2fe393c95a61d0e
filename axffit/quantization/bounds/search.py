"""The largest errors that can be found: gradient ascent over directions and tilts, with the library's own models.

Nothing here is shared with the intervals of the bound, so that found <= bound tests both. Errors are searched at the
corners of a class: smallest and largest roughness, F0 and their changes, and the largest tilt in every direction.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from ...brdf import AbstractBRDF, Framed, Schlick1994
from ...frames import dot, reflect
from ..definitions import RELEVANT
from ..directions import LOWEST
from ..tolerances import Kind
from .texel_class import TexelClass

Model = Callable[..., AbstractBRDF]
"""A class of `axffit.brdf`: (color, roughness, Fresnel) to a lobe."""

STARTS, STEPS = 512, 120
ZOOMS, ZOOM_GRID, FIRST_GRID = 18, 11, (41, 25)
HIGHEST_PEAK = 6.0
"""Largest y of a peak's half vector that is looked at."""

SEED = 20180608
TINY = 1e-300
ROUNDING = 1e-12
"""Above the error of log f'/f in float64; taken off what was found, so that it is a lower bound."""


@dataclass(frozen=True)
class Peaks:
    """Where views peak, for one roughness and F0.

    Attributes:
        o_z: cosines of the views (n,), rising.
        log_share: log of the mirror direction's f i_z over the peak (n,), <= 0.
        y: asinh(tan theta_h / alpha) of the peak's half vector (n,).
        v: (o_z - i_z) / (o_z + i_z) there (n,).
    """

    o_z: np.ndarray
    log_share: np.ndarray
    y: np.ndarray
    v: np.ndarray


def find_peaks(model: Model, alpha: float, f0: float, o_z: np.ndarray) -> Peaks:
    """The highest lights of views by a grid of half vectors that zooms in; needs JAX with x64 enabled."""
    y, v, height = (np.asarray(x) for x in _find_peaks(model, jnp.float64(alpha), jnp.float64(f0), jnp.asarray(o_z)))
    return Peaks(o_z, -np.maximum(height, 0.0), y, v)


@partial(jax.jit, static_argnums=0)
def _find_peaks(
    model: Model, alpha: jax.Array, f0: jax.Array, o_z: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array]:
    # In u, y = HIGHEST_PEAK u²: peaks close to the mirror direction have an azimuth, too.
    first = [jnp.linspace(0.0, end, count) for end, count in zip((1.0, np.pi), FIRST_GRID, strict=True)]
    line = jnp.linspace(-1.0, 1.0, ZOOM_GRID)
    everywhere, steps = ([s.reshape(-1) for s in jnp.meshgrid(*axes)] for axes in (first, (line, line)))
    spacing = [1.0 / (FIRST_GRID[0] - 1), np.pi / (FIRST_GRID[1] - 1)]

    def single(o_z: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        wo = jnp.stack([jnp.sqrt(1.0 - o_z * o_z), jnp.zeros_like(o_z), o_z])
        mirror = jnp.log(_radiance(model, alpha, f0, wo * jnp.array([-1.0, -1.0, 1.0]), wo))

        def height(u: jax.Array, turn: jax.Array) -> tuple[jax.Array, jax.Array]:
            h = _half(alpha, HIGHEST_PEAK * u * u, jnp.cos(turn), jnp.sin(turn))
            wi = reflect(wo, h)
            lit = (wi[2] >= LOWEST) & (dot(wo, h) > 0)
            value = jnp.log(jnp.maximum(_radiance(model, alpha, f0, wi, wo), TINY)) - mirror
            return jnp.where(lit, value, -jnp.inf), (o_z - wi[2]) / (o_z + wi[2])

        def best_of(u: jax.Array, turn: jax.Array) -> tuple[jax.Array, ...]:
            heights, v = jax.vmap(height)(u, turn)
            best = jnp.argmax(heights)
            return u[best], turn[best], v[best], heights[best]

        def zoom(carry: tuple, scale: jax.Array) -> tuple[tuple, None]:
            u, turn = carry[:2]
            us = jnp.maximum(u + scale * spacing[0] * steps[0], 0.0)
            return best_of(us, turn + scale * spacing[1] * steps[1]), None

        scales = 1.5 * 0.65 ** jnp.arange(ZOOMS, dtype=o_z.dtype)
        (u, _, v, best), _ = jax.lax.scan(zoom, best_of(*everywhere), scales)
        return HIGHEST_PEAK * u * u, v, best

    return jax.vmap(single)(o_z)


def _half(alpha: jax.Array, y: jax.Array, cosine: jax.Array, sine: jax.Array) -> jax.Array:
    t = alpha * jnp.sinh(y)
    return jnp.stack([t * cosine, t * sine, jnp.ones_like(t)]) / jnp.sqrt(1.0 + t * t)


def _radiance(model: Model, alpha: jax.Array, f0: jax.Array, wi: jax.Array, wo: jax.Array) -> jax.Array:
    """F i_z of one channel."""
    return model(jnp.ones(3), alpha, Schlick1994(f0)).masked_value(wi, wo)[0] * wi[2]


@dataclass(frozen=True)
class Texels:
    """Pairs of texels, one a start: arrays (n,) of what stands before and after quantization, and the tilt.

    Attributes:
        alpha: roughness before.
        f0: F0 before.
        alpha_after: roughness after.
        f0_after: F0 after.
        tilt: angle between the normals (radians).
    """

    alpha: np.ndarray
    f0: np.ndarray
    alpha_after: np.ndarray
    f0_after: np.ndarray
    tilt: np.ndarray


def corners(texels: TexelClass) -> list[tuple[float, float]]:
    """Roughness and F0 of the texels that are searched, without repetition."""
    return list(itertools.product(sorted({*texels.roughness}), sorted({*texels.f0})))


def _corner_texels(texels: TexelClass) -> tuple[Texels, np.ndarray]:
    """All corners, in turn for the starts of both definitions; and the number of each start's (roughness, F0)."""
    ends = (sorted({*texels.roughness_ratio}), sorted({*texels.f0_change}))
    changes = list(itertools.product(enumerate(corners(texels)), *ends))
    rows = [(n, a, f, a * ratio, f + change) for (n, (a, f)), ratio, change in changes]
    number, alpha, f0, alpha_after, f0_after = np.array(rows)[np.arange(2 * STARTS) % len(rows)].T
    tilt = np.full(2 * STARTS, texels.tilt)
    return Texels(alpha, f0, alpha_after, f0_after, tilt), number.astype(np.int64)


def find_errors(model: Model, texels: TexelClass, peaks: list[Peaks]) -> dict[Kind, float]:
    """The largest errors found in a class by `STARTS` ascents for each definition; needs JAX with x64 enabled.

    Args:
        model: the lobe.
        texels: the class.
        peaks: the peaks of each of `corners`.
    """
    pairs, number = _corner_texels(texels)
    fields = (pairs.alpha, pairs.f0, pairs.alpha_after, pairs.f0_after, pairs.tilt)
    log_ratio = np.repeat([False, True], STARTS)
    start, highest = _starts(pairs.alpha)
    nodes = np.log(peaks[0].o_z)
    shares = np.stack([p.log_share for p in peaks])[number]
    best = _ascend(model, *(jnp.asarray(x) for x in (start, highest, log_ratio, nodes, shares)), fields)
    values, change, height, o_z = (np.asarray(x) for x in best)
    found: dict[Kind, float] = {}
    searched: dict[Kind, np.ndarray] = {"peak_relative": ~log_ratio, "log_ratio": log_ratio}
    for kind, mine in searched.items():
        # The best few again, with the peak of exactly their views.
        few = np.flatnonzero(mine)[np.argsort(-values[mine])[:4]]
        share = [find_peaks(model, float(pairs.alpha[k]), float(pairs.f0[k]), o_z[k : k + 1]) for k in few]
        exact = height[few] + np.array([peak.log_share[0] for peak in share])
        found[kind] = max(float(np.max(error_value(kind, change[few], exact))) - ROUNDING, 0.0)
    return found


def _starts(alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates (n, 4) of the starts, most of them near the lobe, and the largest y of each."""
    rng = np.random.default_rng(SEED)
    highest = np.arcsinh(1.0 / (LOWEST * alpha))
    spread = np.where(np.arange(len(alpha)) % 4 == 0, 6.0, 2.5)
    share = rng.random((4, len(alpha))) * np.stack(np.broadcast_arrays(spread, 1.0, np.pi, 2 * np.pi))
    share[0] = np.minimum(share[0], highest)
    return share.T, highest


def pair_of_directions(alpha: jax.Array, at: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Light, viewer and the tilt's azimuth from coordinates (4,) that cannot leave the domain.

    (y, share, phi_d, azimuth): theta_d is 1 - (1 - share)² of the largest difference angle that keeps both directions
    at sin 1°, arccos(sin 1° / r) - atan(t |C|) with r² = cos² theta_h + sin² theta_h C².
    """
    y, share, phi, azimuth = at
    t = alpha * jnp.sinh(y)
    cos_h = 1.0 / jnp.sqrt(1.0 + t * t)
    sin_h, c, s = t * cos_h, jnp.cos(phi), jnp.sin(phi)
    radius = jnp.sqrt(cos_h**2 + (sin_h * c) ** 2)
    largest = jnp.arccos(jnp.minimum(LOWEST / radius, 1.0)) - jnp.arctan(t * jnp.abs(c))
    theta_d = jnp.maximum(largest, 0.0) * (1.0 - (1.0 - share) ** 2)
    h = jnp.stack([sin_h, jnp.zeros_like(t), cos_h])
    difference = jnp.stack([c * cos_h, s, -c * sin_h])
    along, across = jnp.cos(theta_d) * h, jnp.sin(theta_d) * difference
    return along - across, along + across, azimuth


def change_and_height(
    model: Model,
    alpha: jax.Array,
    f0: jax.Array,
    after: tuple[jax.Array, jax.Array],
    normal: jax.Array,
    wi: jax.Array,
    wo: jax.Array,
) -> tuple[jax.Array, jax.Array]:
    """Log f'/f, and log of f i_z over the mirror direction's, for one pair of directions."""
    value = _radiance(model, alpha, f0, wi, wo)
    moved = Framed(model(jnp.ones(3), after[0], Schlick1994(after[1])), normal).masked_value(wi, wo)[0] * wi[2]
    mirror = _radiance(model, alpha, f0, wo * jnp.array([-1.0, -1.0, 1.0]), wo)
    log_value = jnp.log(jnp.maximum(value, TINY))
    return jnp.log(jnp.maximum(moved, TINY)) - log_value, log_value - jnp.log(mirror)


def _at(model: Model, fields: tuple[jax.Array, ...], at: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Change, height over the mirror direction, and o_z."""
    alpha, f0, alpha_after, f0_after, tilt = fields
    wi, wo, azimuth = pair_of_directions(alpha, at)
    normal = jnp.stack([jnp.sin(tilt) * jnp.cos(azimuth), jnp.sin(tilt) * jnp.sin(azimuth), jnp.cos(tilt)])
    return *change_and_height(model, alpha, f0, (alpha_after, f0_after), normal, wi, wo), wo[2]


def error_value(kind: Kind, change: np.ndarray, log_height: np.ndarray) -> np.ndarray:
    """(b) or (c), from log f'/f and log (f i_z / peak); 0 where (c) does not look."""
    if kind == "peak_relative":
        return np.exp(log_height) * np.abs(np.expm1(change))
    return np.where(log_height >= np.log(RELEVANT), np.abs(change), 0.0)


@partial(jax.jit, static_argnums=0)
def _ascend(
    model: Model,
    start: jax.Array,
    highest: jax.Array,
    log_ratio: jax.Array,
    nodes: jax.Array,
    shares: jax.Array,
    fields: tuple[jax.Array, ...],
) -> tuple[jax.Array, ...]:
    """Adam on the logarithm of the error; in (c) a penalty holds the ascent where f i_z >= 1e-3 of the peak.

    Returns:
        The best value of each start, and there: log f'/f, the height over the mirror direction, o_z.
    """
    relevant = np.log(RELEVANT)

    def objective(
        at: jax.Array, log_ratio: jax.Array, share: jax.Array, fields: tuple[jax.Array, ...]
    ) -> tuple[jax.Array, jax.Array]:
        change, height, o_z = _at(model, fields, at)
        log_height = height + jnp.interp(jnp.log(o_z), nodes, share)
        size = jnp.where(log_ratio, jnp.abs(change), jnp.abs(jnp.expm1(change)))
        add = jnp.where(log_ratio, 3.0 * jnp.minimum(log_height - relevant, 0.0), log_height)
        looks = ~log_ratio | (log_height >= relevant)
        value = jnp.where(looks, size * jnp.where(log_ratio, 1.0, jnp.exp(log_height)), 0.0)
        return jnp.log(size + TINY) + add, jnp.stack([value, change, height, o_z])

    slope = jax.vmap(jax.grad(objective, has_aux=True))

    def step(carry: tuple, rate: jax.Array) -> tuple[tuple, None]:
        at, first, second, best = carry
        gradient, here = slope(at, log_ratio, shares, fields)
        gradient = jnp.nan_to_num(gradient, posinf=0.0, neginf=0.0)
        best = jnp.where(here[:, :1] > best[:, :1], here, best)
        first, second = 0.8 * first + 0.2 * gradient, 0.95 * second + 0.05 * gradient**2
        at = at + rate * first / (jnp.sqrt(second) + 1e-12)
        most = jnp.stack([highest, jnp.ones_like(highest)], axis=-1)
        at = jnp.concatenate([jnp.clip(at[:, :2], 0.0, most), at[:, 2:]], axis=-1)
        return (at, first, second, best), None

    zero = jnp.zeros_like(start)
    rates = 0.1 * (2e-3 ** (jnp.arange(STEPS, dtype=start.dtype) / STEPS))
    (_, _, _, best), _ = jax.lax.scan(step, (start, zero, zero, zero), rates)
    return tuple(best.T)
