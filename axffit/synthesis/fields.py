"""Repeating patterns beside plain noise: cells, lattices, overlapping discs, and the normals of a height."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .noise import Rng, unit_vectors


class Cells(NamedTuple):
    """Where each texel lies among the cells of a set of points (Worley 1996); lengths in widths of a lattice cell.

    Attributes:
        nearest: distance to the nearest point, (H, W).
        second: distance to the second nearest; ``second - nearest`` is 0 on the border between two cells.
        offset: from the nearest point to the texel, (H, W, 2).
        row: lattice row of the nearest point.
        column: lattice column of the nearest point.
    """

    nearest: np.ndarray
    second: np.ndarray
    offset: np.ndarray
    row: np.ndarray
    column: np.ndarray


def jittered(rng: Rng, counts: tuple[int, int], jitter: float) -> np.ndarray:
    """One point in each cell of a lattice of `counts` (along u, along v), off its center by up to ``jitter / 2``."""
    across, down = counts
    return 0.5 + jitter * (rng.random((down, across, 2)) - 0.5)


def staggered(counts: tuple[int, int]) -> np.ndarray:
    """Points of a brick pattern, every other row shifted by half a cell; the rows must be even in number."""
    across, down = counts
    if down % 2:
        raise ValueError(f"{down} rows; a staggered lattice repeats with an even number only")
    points = np.full((down, across, 2), 0.5)
    points[1::2, :, 0] = 0.0
    return points


def cells(u: np.ndarray, v: np.ndarray, points: np.ndarray) -> Cells:
    """The cells of lattice points (down, across, 2), repeating with period 1 in both coordinates."""
    nearest, second = np.full(u.shape, np.inf), np.full(u.shape, np.inf)
    offset, row, column = np.zeros((*u.shape, 2)), np.zeros(u.shape, int), np.zeros(u.shape, int)
    for step_row, step_column, away in _neighbors(u, v, points, reach=2):
        distance = np.hypot(away[..., 0], away[..., 1])
        closer = distance < nearest
        second = np.where(closer, nearest, np.minimum(second, distance))
        nearest = np.where(closer, distance, nearest)
        offset = np.where(closer[..., None], away, offset)
        row, column = np.where(closer, step_row, row), np.where(closer, step_column, column)
    return Cells(nearest, second, offset, row, column)


def overlapping_discs(u: np.ndarray, v: np.ndarray, counts: tuple[int, int], radius: float) -> Cells:
    """Discs on a square lattice, each laid over those before it (row by row, as in engine turning).

    Returns:
        As `cells`, of the disc on top; ``second`` is the distance left to its edge. Radii from 0.71 leave no gap.
    """
    top = np.zeros((*u.shape, 2))
    row, column = np.zeros(u.shape, int), np.zeros(u.shape, int)
    for step_row, step_column, away in _neighbors(u, v, np.full((counts[1], counts[0], 2), 0.5), reach=1):
        covers = np.hypot(away[..., 0], away[..., 1]) < radius
        top = np.where(covers[..., None], away, top)
        row, column = np.where(covers, step_row, row), np.where(covers, step_column, column)
    distance = np.hypot(top[..., 0], top[..., 1])
    return Cells(distance, radius - distance, top, row, column)


def _neighbors(
    u: np.ndarray, v: np.ndarray, points: np.ndarray, *, reach: int
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Row and column (H, W) of each lattice point near a texel, and the texel's offset from it, row by row."""
    down, across, _ = points.shape
    x, y = u * across, v * down
    column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            r, c = (row + dy) % down, (column + dx) % across
            point = points[r, c]
            away_x, away_y = x - (column + dx) - point[..., 0], y - (row + dy) - point[..., 1]
            # In widths of a cell along both axes, so that circles are round.
            yield r, c, np.stack([away_x, away_y * across / down], axis=-1)


def smooth_step(low: float, high: float, x: np.ndarray) -> np.ndarray:
    """0 below ``low``, 1 above ``high``, 3t² - 2t³ between."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def blend(low: tuple[float, ...], high: tuple[float, ...], share: np.ndarray) -> np.ndarray:
    """Colors (H, W, 3) from ``low`` (share 0) to ``high`` (share 1)."""
    return np.asarray(low) + share[..., None] * (np.asarray(high) - np.asarray(low))


def slopes(height_mm: np.ndarray, extent_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (x, y) of the normal of a repeating height: minus its central differences over two texels."""
    step = 2.0 * extent_mm / height_mm.shape[0]
    along_u = (np.roll(height_mm, -1, axis=1) - np.roll(height_mm, 1, axis=1)) / step
    along_v = (np.roll(height_mm, -1, axis=0) - np.roll(height_mm, 1, axis=0)) / step
    return -along_u, -along_v


def normals_of(height_mm: np.ndarray, extent_mm: float) -> np.ndarray:
    """Unit normals (H, W, 3) of a repeating height (H, W) over a square of side ``extent_mm``."""
    return unit_vectors(*slopes(height_mm, extent_mm))


def halved(values: np.ndarray) -> np.ndarray:
    """A map (H, W, ...) at half the size, each texel the mean of 2x2."""
    height, width = values.shape[:2]
    return values.reshape(height // 2, 2, width // 2, 2, *values.shape[2:]).mean(axis=(1, 3))
