"""Errors of a map's texels to a few numbers: mean, percentiles, largest and where it is, a level and all together."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..axf.scratch import empty, let_go

STATISTICS = ("mean", "p95", "p999", "max")
"""Names of the statistics, as tolerance files use them."""

_RUN = 2**20


@dataclass(frozen=True)
class Place:
    """A texel, or the sample between four of them.

    Attributes:
        level: mip level.
        slice: slice of a texture array, else None.
        row: row of the texel; of the upper one for a sample.
        column: column of the texel; of the left one for a sample.
        u: texture coordinate along the row in (0, 1]: the texel's center, or the corner it shares with the next.
        v: texture coordinate along the column.
    """

    level: int
    slice: int | None
    row: int
    column: int
    u: float
    v: float

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        place = {"level": self.level, "slice": self.slice, "row": self.row, "column": self.column}
        return {**place, "uv": [self.u, self.v]}


@dataclass(frozen=True, eq=False)
class LevelErrors:
    """The errors of one mip level by one measure.

    Attributes:
        level: number of the level.
        shape: its shape without the channels, (H, W) or (D, H, W).
        errors: errors in texel order, float32, [n]; NaN where none was taken.
        corners: whether they belong to the samples between texels instead of texels.
    """

    level: int
    shape: tuple[int, ...]
    errors: np.ndarray
    corners: bool = False

    def place(self, index: int) -> Place:
        """Where the texel of an index is."""
        *slices, row, column = (int(i) for i in np.unravel_index(index, self.shape))
        offset = 1.0 if self.corners else 0.5
        height, width = self.shape[-2:]
        return Place(
            self.level, slices[0] if slices else None, row, column, (column + offset) / width, (row + offset) / height
        )


@dataclass(frozen=True)
class Statistics:
    """One measure over texels of a map.

    Attributes:
        measure: name of the measure.
        unit: its unit.
        mean: mean error.
        p95: the error that 95 % of the texels do not exceed.
        p999: the error that 99.9 % do not exceed.
        max: largest error.
        where: a texel that has it.
        texels: how many texels were measured.
        total: how many there are.
        level: the mip level it is of, or None for several together.
        levels: the same of each level, where it is of several.
    """

    measure: str
    unit: str
    mean: float
    p95: float
    p999: float
    max: float
    where: Place
    texels: int
    total: int
    level: int | None = None
    levels: tuple["Statistics", ...] = ()

    def value(self, statistic: str) -> float:
        """The statistic of that name: mean, p95, p999 or max."""
        return float(getattr(self, statistic))

    def numbers(self) -> dict[str, Any]:
        """The numbers and their place as a JSON object; an infinite error is null."""
        numbers = {name: finite_or_none(self.value(name)) for name in STATISTICS}
        return {**numbers, "where": self.where.to_json(), "texels": self.texels, "total": self.total}

    def to_json(self) -> dict[str, Any]:
        """As a JSON object, each level's numbers in it."""
        levels = [{"level": each.level, **each.numbers()} for each in self.levels]
        return {"quantity": self.measure, "unit": self.unit, "level": self.level, **self.numbers(), "by_level": levels}


def finite_or_none(value: float) -> float | None:
    """JSON knows no infinity: None stands for an error without limit."""
    return float(value) if math.isfinite(value) else None


def statistics(measure: str, unit: str, levels: Sequence[LevelErrors], level: int | None = None) -> Statistics:
    """Statistics of one or more levels; of several also each one's.

    Args:
        measure: name of the measure.
        unit: its unit.
        levels: errors of each level, at least one taken in all.
        level: the number to give it, where it stands for one level of several.
    """
    each = tuple(statistics(measure, unit, [one], one.level) for one in levels) if len(levels) > 1 else ()
    total = sum(one.errors.size for one in levels)
    taken = empty((total,), np.float32)
    count, whole, where, largest = 0, 0.0, levels[0].place(0), -math.inf
    for one, start, run in _runs(levels):
        kept = run[~np.isnan(run)]
        if not kept.size:
            continue
        taken[count : count + kept.size] = kept
        count += kept.size
        whole += float(kept.sum(dtype=np.float64))
        if float(kept.max()) > largest:
            index = int(np.nanargmax(run))
            largest, where = float(run[index]), one.place(start + index)
    # Rounding up never reports a percentile below the error of a texel that counts.
    ranks = [math.ceil(share * (count - 1)) for share in (0.95, 0.999)]
    ordered = taken[:count]
    ordered.partition(ranks)
    p95, p999 = (float(ordered[rank]) for rank in ranks)
    return Statistics(measure, unit, whole / count, p95, p999, largest, where, count, total, level, each)


def _runs(levels: Sequence[LevelErrors]) -> Iterator[tuple[LevelErrors, int, np.ndarray]]:
    """Runs of errors: (level, index of the first, errors)."""
    for level in levels:
        for start in range(0, level.errors.size, _RUN):
            yield level, start, level.errors[start : start + _RUN]
        let_go(level.errors)
