"""The map from the unit square to itself that turns a uniform density into a tabulated one (Dupuy and Jakob 2018)."""

import numpy as np

_NEARLY_EQUAL = 1e-4
"""Relative difference of two densities below which a segment counts as constant, as in the format's loader."""


def bilinear(table: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """``table`` [row y, column x] on a grid over [0, 1]², interpolated at ``x``, ``y`` (held at the edges)."""
    rows, columns = table.shape
    column, across = _cell(x, columns)
    row, up = _cell(y, rows)
    low = (1.0 - across) * table[row, column] + across * table[row, column + 1]
    high = (1.0 - across) * table[row + 1, column] + across * table[row + 1, column + 1]
    return (1.0 - up) * low + up * high


def _cell(position: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    scaled = np.clip(position, 0.0, 1.0) * (size - 1)
    index = np.minimum(scaled.astype(np.int64), size - 2)
    return index, scaled - index


def sample(density: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions whose density follows a table, from uniform ones.

    Args:
        density: (rows, columns) >= 0 on a grid over [0, 1]², rows along y, bilinear between; of any scale.
        x: uniform numbers in [0, 1], (N,), that choose the column within the row.
        y: uniform numbers in [0, 1], (N,), that choose the row.

    Returns:
        x and y of the positions, (N,), and the density there, scaled so that its integral over the square is 1.
    """
    rows, columns = density.shape
    along = np.zeros((rows, columns))
    along[:, 1:] = np.cumsum(0.5 * (density[:, 1:] + density[:, :-1]), axis=1)
    totals = along[:, -1]
    marginal = np.concatenate([[0.0], np.cumsum(0.5 * (totals[1:] + totals[:-1]))])
    target = np.asarray(y, np.float64) * marginal[-1]
    row = np.clip(np.searchsorted(marginal, target, side="right") - 1, 0, rows - 2)
    up = _invert(target - marginal[row], totals[row], totals[row + 1])
    # The row between two tabulated ones: linear, so its own integral along x is too.
    line = (1.0 - up)[:, None] * along[row] + up[:, None] * along[row + 1]
    target = np.asarray(x, np.float64) * line[:, -1]
    column = np.clip((line <= target[:, None]).sum(axis=1) - 1, 0, columns - 2)
    rest = target - np.take_along_axis(line, column[:, None], axis=1)[:, 0]
    left = (1.0 - up) * density[row, column] + up * density[row + 1, column]
    right = (1.0 - up) * density[row, column + 1] + up * density[row + 1, column + 1]
    across = _invert(rest, left, right)
    scale = (rows - 1) * (columns - 1) / marginal[-1]
    return (
        (column + across) / (columns - 1),
        (row + up) / (rows - 1),
        ((1.0 - across) * left + across * right) * scale,
    )


def _invert(integral: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Where in [0, 1] the integral of a line from ``start`` to ``end`` reaches ``integral``."""
    flat = np.abs(start - end) < _NEARLY_EQUAL * (start + end)
    slope = np.where(flat, 1.0, start - end)
    root = np.sqrt(np.maximum(start * start - 2.0 * integral * (start - end), 0.0))
    total = np.maximum(start + end, 1e-300)
    return np.clip(np.where(flat, 2.0 * integral / total, (start - root) / slope), 0.0, 1.0)
