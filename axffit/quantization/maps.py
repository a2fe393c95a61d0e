"""Map errors: every texel of every level, in blocks, to statistics with the place of the largest."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..axf import AxfTexture
from ..targets import PackedTexture
from ..targets.encoding import blocks, decode_rows
from ..textures.rerange import Reranging
from .measures import Measure, measures_of

COSTLY_TEXELS = 2**18
"""A costly measure takes about this many texels of a map, evenly spread, and besides the worst of each block."""

WORST_OF_BLOCK = 32


@dataclass(frozen=True)
class Place:
    """A texel: mip level, slice of a texture array (else None), row and column."""

    level: int
    slice: int | None
    row: int
    column: int

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {"level": self.level, "slice": self.slice, "row": self.row, "column": self.column}


@dataclass(frozen=True)
class Statistics:
    """One measure over all texels of all levels of a map.

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

    def value(self, statistic: str) -> float:
        """The statistic of that name: mean, p95, p999 or max."""
        return float(getattr(self, statistic))

    def to_json(self) -> dict[str, Any]:
        """As a JSON object; an infinite error is null."""
        numbers = {name: finite_or_none(self.value(name)) for name in STATISTICS}
        place = {"where": self.where.to_json(), "texels": self.texels, "total": self.total}
        return {"quantity": self.measure, "unit": self.unit, **numbers, **place}


STATISTICS = ("mean", "p95", "p999", "max")
"""Names of the statistics, as tolerance files use them."""


def finite_or_none(value: float) -> float | None:
    """JSON knows no infinity: None stands for an error without limit."""
    return float(value) if math.isfinite(value) else None


@dataclass(frozen=True, eq=False)
class MapErrors:
    """All measures of one texture.

    Attributes:
        statistics: one entry a measure, the one of the picture first.
        picture: error map of the first measure, [H, W] float32: level 0, of an array the slice with the largest error.
    """

    statistics: tuple[Statistics, ...]
    picture: np.ndarray


def map_errors(original: AxfTexture, packed: PackedTexture, reading: Reranging) -> MapErrors:
    """Errors of what the shader sees against what AxF says.

    Args:
        original: AxF's texture, as many levels as ``packed``.
        packed: the texture as packed.
        reading: how the target's shader reads it (`targets.<name>.reading`).
    """
    measures = measures_of(packed.axf_name)
    total = sum(level[..., 0].size for level in original.levels)
    stride = max(1, total // COSTLY_TEXELS)
    per_level = [
        _level_errors(before, codes, packed, reading, measures, stride)
        for before, codes in zip(original.levels, packed.levels, strict=True)
    ]
    shapes = [level.shape[:-1] for level in original.levels]
    statistics = tuple(_statistics(m, [errors[m.name] for errors in per_level], shapes) for m in measures)
    picture = per_level[0][measures[0].name].reshape(shapes[0])
    if picture.ndim == 3:
        picture = picture[np.argmax(picture.reshape(len(picture), -1).max(axis=1))]
    return MapErrors(statistics, picture)


def _level_errors(
    before: np.ndarray,
    codes: np.ndarray,
    packed: PackedTexture,
    reading: Reranging,
    measures: tuple[Measure, ...],
    stride: int,
) -> Mapping[str, np.ndarray]:
    """Errors of one level in texel order, float32; NaN where a costly measure was not taken."""
    form = packed.number_format
    flat = before.reshape(-1, before.shape[-1])
    errors = {m.name: np.full(len(flat), np.nan, np.float32) for m in measures}
    for run, rows in blocks(codes):
        seen = decode_rows(rows, reading, form, packed.channels)
        wanted = flat[run].astype(np.float64)
        for measure in measures:
            if measure.costly and stride > 1:
                chosen = _chosen(errors[measures[0].name][run], errors["absolute"][run], stride)
                errors[measure.name][run.start + chosen] = measure.error(wanted[chosen], seen[chosen])
            else:
                errors[measure.name][run] = measure.error(wanted, seen)
    return errors


def _chosen(first: np.ndarray, second: np.ndarray, stride: int) -> np.ndarray:
    """Every ``stride``-th texel of a block and those with the largest errors in two cheap measures."""
    worst = [
        np.argpartition(errors, -WORST_OF_BLOCK)[-WORST_OF_BLOCK:]
        for errors in (first, second)
        if len(errors) > WORST_OF_BLOCK
    ]
    return np.unique(np.concatenate([np.arange(0, len(first), stride), *worst]))


def _statistics(measure: Measure, levels: list[np.ndarray], shapes: list[tuple[int, ...]]) -> Statistics:
    errors = np.concatenate(levels)
    taken = errors[~np.isnan(errors)]
    # "higher" never reports a percentile below the error of a texel that counts.
    p95, p999 = np.quantile(taken, [0.95, 0.999], method="higher")
    worst = int(np.nanargmax(errors))
    return Statistics(
        measure=measure.name,
        unit=measure.unit,
        mean=float(taken.mean(dtype=np.float64)),
        p95=float(p95),
        p999=float(p999),
        max=float(errors[worst]),
        where=_place(worst, shapes),
        texels=int(taken.size),
        total=int(errors.size),
    )


def _place(index: int, shapes: list[tuple[int, ...]]) -> Place:
    """The texel of an index into all levels one after the other."""
    level = 0
    while index >= math.prod(shapes[level]):
        index -= math.prod(shapes[level])
        level += 1
    *slices, row, column = (int(i) for i in np.unravel_index(index, shapes[level]))
    return Place(level, slices[0] if slices else None, row, column)
