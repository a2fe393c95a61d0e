"""Synthetic samples that the fitting tests share."""

import jax.numpy as jnp
import numpy as np

from axffit.brdf import AbstractBRDF, CarPaint, ColorTable
from axffit.measured import REC709_LUMINANCE, Measurements, reference_grid

SPREADS, COEFFICIENTS, F0S, DIFFUSE = (0.06, 0.17, 0.5), (0.012, 0.06, 0.2), (0.6, 0.3, 0.15), 0.05
"""Three lobes in the ranges of measured paints."""

TRUTH = {"diffuse": DIFFUSE}
for _k in range(3):
    TRUTH |= {
        f"coefficient {_k + 1}": COEFFICIENTS[_k],
        f"f0 {_k + 1}": F0S[_k],
        f"spread {_k + 1}": SPREADS[_k],
        f"coefficient x f0 {_k + 1}": COEFFICIENTS[_k] * F0S[_k],
    }

GRID = reference_grid(24, 12, 10)


def colored_table(size: int = 8, seed: int = 0) -> ColorTable:
    """Random hues, luminance 1 in every texel."""
    values = np.random.default_rng(seed).uniform(0.4, 1.6, (size, size, 3))
    return ColorTable(jnp.asarray(values / (values @ REC709_LUMINANCE)[..., None]))


def paint(table: ColorTable | None = None) -> CarPaint:
    """The base of a paint with these lobes."""
    table = colored_table() if table is None else table
    return CarPaint(DIFFUSE, jnp.array(COEFFICIENTS), jnp.array(F0S), jnp.array(SPREADS), table)


def sampled(brdf: AbstractBRDF, *, noise: float = 0.0, seed: int = 0, grid=GRID) -> Measurements:
    """``brdf`` on a grid, with Gaussian noise of a share ``noise`` of each value, which the samples state."""
    values = np.asarray(brdf.evaluate(jnp.asarray(grid.wi), jnp.asarray(grid.wo)))
    if noise == 0.0:
        return Measurements(grid.wi, grid.wo, values, np.ones(len(values), bool), grid.weights, name="synthetic")
    sigma = noise * values + 1e-12
    noisy = values + sigma * np.random.default_rng(seed).normal(size=values.shape)
    return Measurements(grid.wi, grid.wo, noisy, np.ones(len(values), bool), grid.weights, sigma, name="synthetic")
