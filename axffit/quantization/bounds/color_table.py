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

    def _positions(self, t2: Interval, cos_d: Interval) -> tuple[Interval, Interval]:
        """Where along the width and the height boxes lie, in steps of texels from the first texel's center."""
        theta_h = _arctan(iv.sqrt(t2))
        theta_d = _arctan(iv.sqrt(iv.clip(1.0 / iv.square(cos_d) - 1.0, 0.0, np.inf)))
        height, width = self.before.shape
        column, row = (
            iv.clip(iv.around(theta * (2.0 / np.pi * size) - 0.5, 1e-11), 0.0, size - 1.0)
            for theta, size in ((theta_h, width), (theta_d, height))
        )
        ends = np.broadcast_arrays(column.lo, column.hi, row.lo, row.hi)
        return Interval(ends[0], ends[1]), Interval(ends[2], ends[3])

    def _texels(self, column: Interval, row: Interval) -> tuple[np.ndarray, ...]:
        """First and last column and row that enter the interpolation."""
        result = []
        for place, size in ((column, self.before.shape[1]), (row, self.before.shape[0])):
            result += [
                np.floor(place.lo).astype(np.int64),
                np.minimum(np.floor(place.hi) + 1, size - 1).astype(np.int64),
            ]
        return tuple(result)

    def _at(self, column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """The table between its texels, up to a relative error of 1e-14."""
        height, width = self.before.shape
        left = np.minimum(column.astype(np.int64), width - 2)
        top = np.minimum(row.astype(np.int64), height - 2)
        x, y = column - left, row - top
        upper = (1.0 - x) * self.before[top, left] + x * self.before[top, left + 1]
        lower = (1.0 - x) * self.before[top + 1, left] + x * self.before[top + 1, left + 1]
        return (1.0 - y) * upper + y * lower

    def log(self, t2: Interval, cos_d: Interval) -> Interval:
        """Log of the table's value.

        Bilinear functions are largest and smallest at corners: of the box where it lies between two texels, or of the
        two parts of a side that holds a texel inside; over longer sides the texels themselves bound the value.
        """
        column, row = self._positions(t2, cos_d)
        where = self._texels(column, row)
        low, high = self.lowest(*where), self.highest(*where)
        near = (where[1] - where[0] <= 2) & (where[3] - where[2] <= 2)
        if near.any():
            sides = [_corners(side[near]) for side in (column, row)]
            values = [self._at(x, y) for x in sides[0] for y in sides[1]]
            low[near], high[near] = np.minimum.reduce(values), np.maximum.reduce(values)
        return iv.log(Interval(low * (1 - 1e-14), high * (1 + 1e-14)))

    def change(self, moved: Pairs, travel_h: np.ndarray, travel_d: np.ndarray) -> tuple[Interval, np.ndarray]:
        """What quantization and moving angles do: a change of the log, and an absolute one beside it.

        Args:
            moved: the pairs wherever they may go.
            travel_h: how far theta_h moves at most.
            travel_d: the same of theta_d.
        """
        where = self._texels(*self._positions(moved.t2, moved.cos_d))
        height, width = self.before.shape
        steps = [travel * (2 / np.pi * size) for travel, size in ((travel_h, width), (travel_d, height))]
        travel = (self.across(*where) * steps[0] + self.along(*where) * steps[1]) * (1 + 1e-12)
        return Interval(self.least(*where), self.most(*where)), iv.up(self.difference(*where) * (1 + 1e-14) + travel)


class Brightest:
    """The brightest channel of a table: what views of a paint are compared with.

    Args:
        channels: values (H, W, C), >= 0.
    """

    def __init__(self, channels: np.ndarray):
        """A table for each channel."""
        self._tables = [TableBounds(channel, channel) for channel in np.moveaxis(channels, -1, 0)]

    def log(self, t2: Interval, cos_d: Interval) -> Interval:
        """Log of the largest channel's value."""
        log = self._tables[0].log(t2, cos_d)
        for table in self._tables[1:]:
            log = iv.greater(log, table.log(t2, cos_d))
        return log


def _arctan(x: Interval) -> Interval:
    lo, hi = np.arctan(x.lo), np.arctan(x.hi)
    return Interval(np.maximum(lo * (1 - 2.0**-48), 0.0), hi * (1 + 2.0**-48))


def _corners(side: Interval) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends of a side, and the texel between them or else one of them."""
    return side.lo, np.clip(np.ceil(side.lo), side.lo, side.hi), side.hi
