"""The color table as unknowns of a fit: bilinear design, neighborhood smoothing, and banded normal equations.

A table of H x W texels is linear in its texels. Its normal matrix couples a texel with its eight neighbors only, so in
row order it is a band of W + 1 off-diagonals, and Cholesky's factor costs H W³ operations instead of (H W)³.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse

_MEASURED = 1e-6


def _axis(theta: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Lower texel and weight of the upper one, as :class:`axffit.brdf.ColorTable` with texel centers."""
    position = np.clip(theta * (2.0 / np.pi) * size - 0.5, 0.0, size - 1)
    lower = np.minimum(np.floor(position), size - 1).astype(np.int64)
    return lower, position - lower


def _pruned(matrix: Any) -> Any:
    """``matrix`` by rows without the columns that all samples together touch with less than 1e-6 of one."""
    touched = matrix.T @ np.ones(matrix.shape[0]) > _MEASURED
    pruned = scipy.sparse.csr_array(matrix @ scipy.sparse.diags_array(touched.astype(np.float64)))
    pruned.eliminate_zeros()
    return pruned


@dataclass(frozen=True, eq=False)
class TableDesign:
    """Where N samples look into a table of ``size`` x ``size`` texels (rows theta_d, columns theta_h).

    ``matrix``, a sparse array (N, size²) by rows: the bilinear weights, four a row.
    """

    size: int
    matrix: Any

    @classmethod
    def of(cls, theta_h: np.ndarray, theta_d: np.ndarray, size: int) -> "TableDesign":
        """Design of samples at these angles (N,), radians, below the coat."""
        column, u = _axis(theta_h, size)
        row, v = _axis(theta_d, size)
        right, down = np.minimum(column + 1, size - 1), np.minimum(row + 1, size - 1)
        texels = np.stack([row * size + column, row * size + right, down * size + column, down * size + right], axis=1)
        weights = np.stack([(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u], axis=1)
        n = len(theta_h)
        entries = (weights.ravel(), (np.repeat(np.arange(n), 4), texels.ravel()))
        return cls(size, _pruned(scipy.sparse.csr_array(entries, shape=(n, size * size))))

    def keeping(self, chosen: np.ndarray) -> "TableDesign":
        """The same design in which samples with ``chosen`` (N,) 0 touch no texel."""
        return TableDesign(self.size, _pruned(scipy.sparse.diags_array(chosen) @ self.matrix))

    @cached_property
    def transposed(self) -> Any:
        """The transpose, by rows."""
        return self.matrix.T.tocsr()

    @cached_property
    def measured(self) -> np.ndarray:
        """Which texels any sample touches, (size²,) bool."""
        return self.transposed @ np.ones(self.matrix.shape[0]) > 0

    @cached_property
    def _band_map(self) -> Any:
        """Linear map from sample weights (N,) to the band of matrix^T diag(weights) matrix, ((size + 2) size²,).

        Band layout of LAPACK's lower form: entry [k, j] is element (j + k, j).
        """
        n, texels = self.matrix.shape
        wide: Any = self.matrix.copy()
        wide.sum_duplicates()
        wide.sort_indices()
        lengths = np.diff(wide.indptr)
        rows, columns, values = [], [], []
        for length in np.unique(lengths[lengths > 0]):
            of_length = np.flatnonzero(lengths == length)
            positions = wide.indptr[of_length][:, None] + np.arange(length)
            index, weight = wide.indices[positions].astype(np.int64), wide.data[positions]
            for low in range(length):
                for high in range(low, length):
                    offset = index[:, high] - index[:, low]
                    rows.append(offset * texels + index[:, low])
                    columns.append(of_length)
                    values.append(weight[:, low] * weight[:, high])
        entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return scipy.sparse.csr_array(entries, shape=((self.size + 2) * texels, n))

    def normal_band(self, weights: np.ndarray) -> np.ndarray:
        """Bands of matrix^T diag(w) matrix for each column w of ``weights`` (N, C): (C, size + 2, size²)."""
        band = self._band_map @ weights
        return np.ascontiguousarray(band.T).reshape(weights.shape[1], self.size + 2, self.size**2)

    @cached_property
    def smoothness_band(self) -> np.ndarray:
        """Band of the squared first differences between neighboring measured texels, (size + 2, size²)."""
        size, measured = self.size, self.measured.reshape(self.size, self.size)
        band = np.zeros((size + 2, size, size))
        right = measured[:, :-1] & measured[:, 1:]
        below = measured[:-1] & measured[1:]
        band[0, :, :-1] += right
        band[0, :, 1:] += right
        band[1, :, :-1] -= right
        band[0, :-1] += below
        band[0, 1:] += below
        band[size, :-1] -= below
        return band.reshape(size + 2, size * size)

    def factor(self, band: np.ndarray) -> "BandFactor":
        """Cholesky factor of a band in which unmeasured texels are held at 0."""
        band = band.copy()
        band[0, ~self.measured] = 1.0
        return BandFactor(scipy.linalg.cholesky_banded(band, lower=True, overwrite_ab=True, check_finite=False))


@dataclass(frozen=True, eq=False)
class BandFactor:
    """A banded Cholesky factor in LAPACK's lower form."""

    lower: np.ndarray

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for one or several right-hand sides (size²,) or (size², k)."""
        return scipy.linalg.cho_solve_banded((self.lower, True), right, check_finite=False)


def band_product(band: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Symmetric banded matrix (lower form) times x (n, C)."""
    result = band[0][:, None] * x
    for offset in np.flatnonzero(np.any(band[1:] != 0, axis=1)) + 1:
        entries = band[offset, : len(x) - offset][:, None]
        result[offset:] += entries * x[: len(x) - offset]
        result[: len(x) - offset] += entries * x[offset:]
    return result
