"""Lacquered walnut: growth rings, pores, a refracting coat."""

import numpy as np

from ..axf import AxfMaterial
from .coat import clear_coat
from .fields import blend, halved, smooth_step
from .material import SEED, labels, svbrdf_material, with_dark_noise
from .noise import fractal_noise, unit_grid, unit_vectors, value_noise

RINGS = 7
"""Growth rings across the board."""


def lacquered_walnut(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Walnut with the grain along u, under glossy lacquer: isotropic Ward, exact Fresnel, refracting coat."""
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    drift = 1.1 * value_noise(rng, u, v, (2, 3)) + 0.25 * fractal_noise(rng, u, v, (4, 8), octaves=3, size=size)
    phase = RINGS * v + drift
    ring = phase - np.floor(phase)
    # Early wood darkens slowly into late wood, and breaks off at the next year.
    late = smooth_step(0.0, 0.85, ring) * (1.0 - smooth_step(0.88, 1.0, ring))
    fibers = fractal_noise(rng, u, v, (4, 56), octaves=3, size=8 * size)
    streaks = value_noise(rng, u, v, (10, 90))
    pores = smooth_step(0.45, 0.75, streaks) * (1.0 - 0.5 * late)
    figure = fractal_noise(rng, u, v, (3, 2), octaves=2, size=size)
    light = np.clip(0.72 - 0.50 * late + 0.13 * fibers + 0.12 * figure, 0.0, 1.0) * (1.0 - 0.65 * pores)
    maps = {
        "diffusecolor": with_dark_noise(rng, blend((0.030, 0.012, 0.005), (0.27, 0.120, 0.046), light)),
        "normal": unit_vectors(0.004 * fibers, 0.03 * fibers - 0.05 * pores),
        "specularcolor": (0.5 + 0.2 * light - 0.2 * pores)[..., None] * np.array([1.0, 0.93, 0.84]),
        "specularlobe": halved((0.30 + 0.05 * fibers + 0.05 * pores)[..., None]),
        "fresnel": np.full(3, 0.05),
        **clear_coat(rng, u, v, size, peel=0.008, ior=1.52),
    }
    return svbrdf_material(
        "lacquered_walnut",
        "Lacquered walnut",
        maps,
        extent_mm=60.0,
        metadata=labels("lacquered_walnut", size, seed),
        fresnel_variant="Fresnel1818",
    )
