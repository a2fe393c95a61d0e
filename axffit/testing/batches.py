"""BRDFs evaluated in batches of one fixed size, so that every law shares one compilation a model."""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit.brdf import AbstractBRDF
from axffit.numerics import compute_dtype

BATCH = 1024

Rays = Float[Array | np.ndarray, "... 3"]
"""Unit directions, of JAX or NumPy."""


def pairs(wi: Rays, wo: Rays) -> tuple[np.ndarray, np.ndarray]:
    """The directions, broadcast, as two arrays (n, 3) of the floating type a computation on them has."""
    first, second = jnp.asarray(wi), jnp.asarray(wo)
    dtype = compute_dtype(first, second)
    shape = np.broadcast_shapes(first.shape, second.shape)
    one, other = (np.broadcast_to(np.asarray(v).astype(dtype), shape).reshape(-1, 3) for v in (first, second))
    return one, other


def in_batches(function: Callable, brdf: AbstractBRDF, a: np.ndarray, b: np.ndarray, *, batch: int = BATCH):
    """``function(brdf, a, b)`` of rows ``a`` and ``b``, ``batch`` rows at a time; a tree of arrays (n, ...)."""
    parts = []
    for start in range(0, len(a), batch):
        rows = [v[start : start + batch] for v in (a, b)]
        count = len(rows[0])
        padded = [np.concatenate([v, np.repeat(v[-1:], batch - count, axis=0)]) for v in rows]
        parts.append(jax.tree.map(lambda leaf, count=count: np.asarray(leaf)[:count], function(brdf, *padded)))
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *parts)


@eqx.filter_jit
def _evaluate(brdf: AbstractBRDF, wi: jax.Array, wo: jax.Array) -> jax.Array:
    return brdf.evaluate(wi, wo)


@eqx.filter_jit
def _sample(brdf: AbstractBRDF, wo: jax.Array, u: jax.Array) -> jax.Array:
    return brdf.sample(wo, u)


@eqx.filter_jit
def _pdf(brdf: AbstractBRDF, wi: jax.Array, wo: jax.Array) -> jax.Array:
    return brdf.pdf(wi, wo)


def evaluate(brdf: AbstractBRDF, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """``brdf.evaluate`` of rows (n, 3), (n, 3)."""
    return in_batches(_evaluate, brdf, wi, wo)


def sample(brdf: AbstractBRDF, wo: np.ndarray, u: np.ndarray) -> np.ndarray:
    """``brdf.sample`` of rows (n, 3), (n, 3)."""
    return in_batches(_sample, brdf, wo, u)


def pdf(brdf: AbstractBRDF, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """``brdf.pdf`` of rows (n, 3), (n,)."""
    return in_batches(_pdf, brdf, wi, wo)


def viewers(wo: Rays, most: int) -> np.ndarray:
    """At most ``most`` of the directions above the horizon, evenly spread over the list, (n, 3)."""
    every, _ = pairs(wo, wo)
    above = every[every[:, 2] > 0]
    if not len(above):
        raise ValueError("every viewer is below the horizon: give at least one above it")
    return above[np.unique(np.linspace(0, len(above) - 1, most).round().astype(int))]
