"""Fixed sets of direction pairs for the laws: a seeded sample, and every corner of the hemisphere."""

import numpy as np

Pairs = tuple[np.ndarray, np.ndarray]
"""(wi, wo): unit directions to the light and to the viewer, each (n, 3) float64."""

GRAZING_COSINES = (1e-300, 1e-30, 1e-8, 1e-4)
"""Cosines at and around the limits at which the models stop growing towards the horizon."""


def random_pairs(count: int = 400, *, seed: int = 0, lowest: float = 0.0) -> Pairs:
    """Pairs above the horizon, uniform in both cosines; the first nine hold the lobes' peaks.

    The first three pairs coincide (the first is the normal twice), the next six are mirror pairs.

    Args:
        count: number of pairs, at least 9.
        seed: of the sample.
        lowest: smallest cosine with the normal.
    """
    if count < 9 or not 0 <= lowest < 1:
        raise ValueError(f"count={count}, lowest={lowest}: give at least 9 pairs and 0 <= lowest < 1")
    rng = np.random.default_rng(seed)
    cosine, phi = rng.uniform(lowest, 1, (2, count)), rng.uniform(-np.pi, np.pi, (2, count))
    sine = np.sqrt(1 - cosine**2)
    wi, wo = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
    wi[:3] = wo[:3] = [0, 0, 1], [0.6, 0, 0.8], [0, 0.6, 0.8]
    wo[3:9] = wi[3:9] * [-1, -1, 1]
    return wi, wo


def extreme_pairs() -> Pairs:
    """Every pair of the normal, the horizon, directions below it and directions barely above it."""
    along = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0))
    corners = [
        (0.0, 0.0, 1.0),
        (1.0, 0.0, 0.0),
        (0.0, -1.0, 0.0),
        (0.0, 0.0, -1.0),
        (-0.6, 0.0, -0.8),
        *((np.sqrt(1 - z * z) * x, np.sqrt(1 - z * z) * y, z) for z in (*GRAZING_COSINES, 0.5) for x, y in along),
    ]
    every = np.asarray(corners)
    return np.repeat(every, len(every), axis=0), np.tile(every, (len(every), 1))
