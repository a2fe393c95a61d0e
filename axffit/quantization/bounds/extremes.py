"""Smallest and largest values of rectangles of a table, in constant time."""

import numpy as np


class Extremes:
    """Of rectangles of an array, from those of all runs of 2^k by 2^l.

    Args:
        values: (rows, columns).
        pick: `np.minimum` or `np.maximum`.
    """

    def __init__(self, values: np.ndarray, pick: np.ufunc):
        """All runs."""
        rows, columns = (int(np.log2(n)) + 1 for n in values.shape)
        self._pick = pick
        self._runs = np.empty((rows, columns, *values.shape))
        for k in range(rows):
            if k == 0:
                self._runs[0, 0] = values
            else:
                half = 2 ** (k - 1)
                self._runs[k, 0] = self._runs[k - 1, 0]
                self._runs[k, 0, :-half] = pick(self._runs[k - 1, 0, :-half], self._runs[k - 1, 0, half:])
            for m in range(1, columns):
                half = 2 ** (m - 1)
                self._runs[k, m] = self._runs[k, m - 1]
                self._runs[k, m, :, :-half] = pick(self._runs[k, m - 1, :, :-half], self._runs[k, m - 1, :, half:])

    def __call__(self, start: np.ndarray, stop: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Columns start to stop, rows first to last."""
        k, m = (np.int64(np.log2(b - a + 1)) for a, b in ((first, last), (start, stop)))
        rows, columns = (first, last + 1 - 2**k), (start, stop + 1 - 2**m)
        ends = [self._runs[k, m, row, column] for row in rows for column in columns]
        return self._pick(self._pick(ends[0], ends[1]), self._pick(ends[2], ends[3]))
