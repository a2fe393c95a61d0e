"""A car paint's color table over boxes: its range, how fast it changes, and what quantization does to it."""

import numpy as np

from . import intervals as iv
from .extremes import Extremes
from .intervals import Interval
from .pairs import Pairs

SMALL = 2.0**-14
"""Texels below it change by less than any ratio says."""


class TableBounds:
    """One channel of a bilinear table over theta_h (along the width) and theta_d, texel centers at (k + 1/2) / size.

    Args:
        before: values (H, W), >= 0.
        after: the same after quantization.
    """

    def __init__(self, before: np.ndarray, after: np.ndarray):
        """Extremes of all rectangles of texels."""
        self.before, self.after = before, after
        self.lowest, self.highest = Extremes(before, np.minimum), Extremes(before, np.maximum)
        # sum w (b' - b) / sum w b of texels b, b' with weights w: where b is large enough by their ratios, and the few
        # others (a half float of less than 2^-14 has no relative error) by their differences.
        large = before >= SMALL
        log = np.log(np.where(large, after, 1.0)) - np.log(np.where(large, before, 1.0))
        pad = 1e-14 * np.maximum(np.abs(log), 1e-4)
        self.least = Extremes(np.minimum(log - pad, 0.0), np.minimum)
        self.most = Extremes(np.maximum(log + pad, 0.0), np.maximum)
        self.difference = Extremes(np.where(large, 0.0, np.abs(after - before)), np.maximum)
        across, along = (np.abs(np.diff(before, axis=axis)) for axis in (1, 0))
        self.across = Extremes(np.pad(across, ((0, 0), (0, 1))), np.maximum)
        self.along = Extremes(np.pad(along, ((0, 1), (0, 0))), np.maximum)

    def _texels(self, t2: Interval, cos_d: Interval) -> tuple[np.ndarray, ...]:
        """First and last column and row that enter the interpolation."""
        theta_h = _arctan(iv.sqrt(t2))
        theta_d = _arctan(iv.sqrt(iv.clip(1.0 / iv.square(cos_d) - 1.0, 0.0, np.inf)))
        result = []
        for theta, size in ((theta_h, self.before.shape[1]), (theta_d, self.before.shape[0])):
            positions = [np.clip(end * (2.0 / np.pi) * size - 0.5, 0.0, size - 1) for end in (theta.lo, theta.hi)]
            first = np.floor(positions[0] - 1e-9)
            last = np.floor(positions[1] + 1e-9) + 1
            result += [np.clip(x, 0, size - 1).astype(np.int64) for x in (first, last)]
        return tuple(np.broadcast_arrays(*result))

    def log(self, t2: Interval, cos_d: Interval) -> Interval:
        """Log of the table's value."""
        where = self._texels(t2, cos_d)
        return iv.log(Interval(self.lowest(*where) * (1 - 1e-14), self.highest(*where) * (1 + 1e-14)))

    def change(self, moved: Pairs, rigid: float, loose: float) -> tuple[Interval, np.ndarray]:
        """What quantization and moving angles do: a change of the log, and an absolute one beside it.

        theta_h moves by at most rigid + loose / cos theta_d, theta_d by loose / cos theta_d (1.01 for the arcs).
        """
        where = self._texels(moved.t2, moved.cos_d)
        height, width = self.before.shape
        slow = 1.01 * loose / moved.cos_d.lo
        steps = [(1.01 * rigid + slow) * (2 / np.pi) * width, slow * (2 / np.pi) * height]
        travel = (self.across(*where) * steps[0] + self.along(*where) * steps[1]) * (1 + 1e-12)
        return Interval(self.least(*where), self.most(*where)), iv.up(self.difference(*where) * (1 + 1e-14) + travel)


def _arctan(x: Interval) -> Interval:
    lo, hi = np.arctan(x.lo), np.arctan(x.hi)
    return Interval(np.maximum(lo * (1 - 2.0**-48), 0.0), hi * (1 + 2.0**-48))
