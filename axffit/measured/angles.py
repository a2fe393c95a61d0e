"""Directions and solid angles of the grids that sample files use; NumPy float64, radians."""

import numpy as np


def direction(theta: np.ndarray | float, phi: np.ndarray | float) -> np.ndarray:
    """Unit vectors (..., 3) of polar angle and azimuth; a negative polar angle lies on the opposite side."""
    theta, phi = np.broadcast_arrays(np.asarray(theta, np.float64), np.asarray(phi, np.float64))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def about_mirror(incidence: np.ndarray, radial: np.ndarray, azimuth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions (wi, wo) where the viewer is given about the mirror direction.

    The light stands at azimuth 0. The viewer is ``radial`` away from its mirror direction s = (-sin i, 0, cos i), at
    ``azimuth`` 0 toward the normal and the light: wo = cos r s + sin r (cos a t + sin a b) with t = (cos i, 0, sin i)
    and b = (0, 1, 0).
    """
    incidence, radial, azimuth = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (incidence, radial, azimuth)))
    zero = np.zeros_like(incidence)
    mirror = direction(-incidence, zero)
    toward = np.stack([np.cos(incidence), zero, np.sin(incidence)], axis=-1)
    side = np.stack([zero, np.ones_like(zero), zero], axis=-1)
    away = np.cos(azimuth)[..., None] * toward + np.sin(azimuth)[..., None] * side
    wo = np.cos(radial)[..., None] * mirror + np.sin(radial)[..., None] * away
    return direction(incidence, zero), wo


def polar_cells(theta: np.ndarray, end: float = np.pi / 2) -> np.ndarray:
    """Solid angle per azimuth, cos(lower) - cos(upper), of the cells about rising polar angles up to ``end``.

    Cells meet half-way; the first reaches as far below its angle as above it (not beyond 0), the last likewise.
    """
    edges = cell_edges(theta, 0.0, end)
    return np.cos(edges[:-1]) - np.cos(edges[1:])


def cell_edges(nodes: np.ndarray, low: float, high: float) -> np.ndarray:
    """Edges (n + 1,) of the cells about rising ``nodes`` (n,), within [low, high]; a single node has all of it."""
    nodes = np.asarray(nodes, np.float64)
    if len(nodes) == 1:
        return np.array([low, high])
    middle = 0.5 * (nodes[1:] + nodes[:-1])
    ends = 2.0 * nodes[[0, -1]] - middle[[0, -1]]
    return np.clip(np.concatenate([ends[:1], middle, ends[1:]]), low, high)
