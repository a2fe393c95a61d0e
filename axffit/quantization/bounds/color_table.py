"""A car paint's color table over boxes: its range, how fast it changes, and what quantization does to it."""

import numpy as np

from . import intervals as iv
from .extremes import Extremes
from .intervals import Interval
from .pairs import Pairs

SMALL = 2.0**-14
"""Texels below it change by less than any ratio says."""


class _Channel:
    """One channel's values (H, W) between their texels, texel centers at whole numbers."""

    def __init__(self, values: np.ndarray):
        """Extremes of all rectangles of texels."""
        self._values = values
        self._lowest, self._highest = Extremes(values, np.minimum), Extremes(values, np.maximum)

    def _at(self, column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """The table between its texels, up to a relative error of 1e-14."""
        height, width = self._values.shape
        left = np.minimum(column.astype(np.int64), width - 2)
        top = np.minimum(row.astype(np.int64), height - 2)
        x, y = column - left, row - top
        upper = (1.0 - x) * self._values[top, left] + x * self._values[top, left + 1]
        lower = (1.0 - x) * self._values[top + 1, left] + x * self._values[top + 1, left + 1]
        return (1.0 - y) * upper + y * lower

    def log(self, column: Interval, row: Interval, where: tuple[np.ndarray, ...]) -> Interval:
        """Log of the value.

        Bilinear functions are largest and smallest at corners: of the box where it lies between two texels, or of the
        two parts of a side that holds a texel inside; over longer sides the texels themselves bound the value.
        """
        low, high = self._lowest(*where), self._highest(*where)
        near = (where[1] - where[0] <= 2) & (where[3] - where[2] <= 2)
        if near.any():
            sides = [_corners(side[near]) for side in (column, row)]
            values = [self._at(x, y) for x in sides[0] for y in sides[1]]
            low[near], high[near] = np.minimum.reduce(values), np.maximum.reduce(values)
        return iv.log(Interval(low * (1 - 1e-14), high * (1 + 1e-14)))


class TableBounds:
    """One channel of a bilinear table over theta_h (along the width) and theta_d, texel centers at (k + 1/2) / size.

    Args:
        before: values (H, W), >= 0.
        after: the same after quantization.
        channels: all channels before (H, W, C).
    """

    def __init__(self, before: np.ndarray, after: np.ndarray, channels: np.ndarray):
        """Extremes of all rectangles of texels."""
        self._shape = before.shape
        self._own = _Channel(before)
        self._channels = [_Channel(channel) for channel in np.moveaxis(channels, -1, 0)]
        # sum w (b' - b) / sum w b of texels b, b' with weights w: where b is large enough by their ratios, and the few
        # others (a half float of less than 2^-14 has no relative error) by their differences.
        large = before >= SMALL
        log = np.log(np.where(large, after, 1.0)) - np.log(np.where(large, before, 1.0))
        pad = 1e-14 * np.maximum(np.abs(log), 1e-4)
        self._least = Extremes(np.minimum(log - pad, 0.0), np.minimum)
        self._most = Extremes(np.maximum(log + pad, 0.0), np.maximum)
        self._difference = Extremes(np.where(large, 0.0, np.abs(after - before)), np.maximum)
        across, along = (np.abs(np.diff(before, axis=axis)) for axis in (1, 0))
        self._across = Extremes(np.pad(across, ((0, 0), (0, 1))), np.maximum)
        self._along = Extremes(np.pad(along, ((0, 1), (0, 0))), np.maximum)

    def _places(self, t2: Interval, cos_d: Interval) -> tuple[Interval, Interval, tuple[np.ndarray, ...]]:
        """Where along the width and the height boxes lie, in steps of texels from the first texel's center.

        Also the first and last column and row that enter the interpolation.
        """
        theta_h = _arctan(iv.sqrt(t2))
        theta_d = _arctan(iv.sqrt(iv.clip(1.0 / iv.square(cos_d) - 1.0, 0.0, np.inf)))
        height, width = self._shape
        sides = [
            iv.clip(iv.around(theta * (2.0 / np.pi * size) - 0.5, 1e-11), 0.0, size - 1.0)
            for theta, size in ((theta_h, width), (theta_d, height))
        ]
        ends = np.broadcast_arrays(*(end for side in sides for end in (side.lo, side.hi)))
        column, row = Interval(ends[0], ends[1]), Interval(ends[2], ends[3])
        where: list[np.ndarray] = []
        for place, size in ((column, width), (row, height)):
            last = np.minimum(np.floor(place.hi) + 1, size - 1)
            where += [np.floor(place.lo).astype(np.int64), last.astype(np.int64)]
        return column, row, tuple(where)

    def log(self, t2: Interval, cos_d: Interval) -> Interval:
        """Log of the channel's value."""
        return self._own.log(*self._places(t2, cos_d))

    def brightest(self, t2: Interval, cos_d: Interval) -> Interval:
        """Log of the largest channel's value, which views of a paint are compared with."""
        places = self._places(t2, cos_d)
        log, *others = (channel.log(*places) for channel in self._channels)
        for other in others:
            log = iv.greater(log, other)
        return log

    def change(self, moved: Pairs, travel_h: np.ndarray, travel_d: np.ndarray) -> tuple[Interval, np.ndarray]:
        """What quantization and moving angles do: a change of the log, and an absolute one beside it.

        Args:
            moved: the pairs wherever they may go.
            travel_h: how far theta_h moves at most.
            travel_d: the same of theta_d.
        """
        _, _, where = self._places(moved.t2, moved.cos_d)
        height, width = self._shape
        steps = [travel * (2 / np.pi * size) for travel, size in ((travel_h, width), (travel_d, height))]
        travel = (self._across(*where) * steps[0] + self._along(*where) * steps[1]) * (1 + 1e-12)
        relative = Interval(self._least(*where), self._most(*where))
        return relative, iv.up(self._difference(*where) * (1 + 1e-14) + travel)


def _arctan(x: Interval) -> Interval:
    lo, hi = np.arctan(x.lo), np.arctan(x.hi)
    return Interval(np.maximum(lo * (1 - 2.0**-48), 0.0), hi * (1 + 2.0**-48))


def _corners(side: Interval) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends of a side, and the texel between them or else one of them."""
    return side.lo, np.clip(np.ceil(side.lo), side.lo, side.hi), side.hi
