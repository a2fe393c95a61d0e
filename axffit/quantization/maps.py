"""Map errors: every texel of every level, and the samples between them, to statistics with the place of the largest."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..axf import AxfTexture
from ..axf.scratch import empty, let_go
from ..targets import PackedTexture
from ..targets.encoding import blocks, decode_rows
from ..textures.rerange import Reranging, texels
from .filtered import filtered_errors, measures_between
from .measures import Measure, measures_of
from .statistics import LevelErrors, Statistics, statistics

COSTLY_TEXELS = 2**18
"""A costly measure takes about this many texels of a map, evenly spread, and besides the worst of each block."""

WORST_OF_BLOCK = 32


@dataclass(frozen=True, eq=False)
class MapErrors:
    """All measures of one texture.

    Attributes:
        statistics: one entry a measure, the one of the picture first, those between texels (`filtered`) last; where
            levels are judged apart, the rest together and then each of them.
        picture: error map of the first measure, [H, W] float32: level 0, of an array the slice with the largest error.
        non_finite: texels of which the shader sees a NaN or an infinity in some channel.
    """

    statistics: tuple[Statistics, ...]
    picture: np.ndarray
    non_finite: int


def map_errors(
    original: AxfTexture,
    packed: PackedTexture,
    reading: Reranging,
    apart: Mapping[str, Collection[int]] | None = None,
) -> MapErrors:
    """Errors of what the shader sees against what AxF says.

    Args:
        original: AxF's texture, as many levels as ``packed``.
        packed: the texture as packed.
        reading: how the target's shader reads it (`targets.<name>.reading`).
        apart: measures to the mip levels that have a tolerance of their own.
    """
    measures = measures_of(packed.axf_name)
    total = sum(level[..., 0].size for level in original.levels)
    stride = max(1, total // COSTLY_TEXELS)
    found: dict[str, list[LevelErrors]] = {}
    non_finite = 0
    for level, (before, codes) in enumerate(zip(original.levels, packed.levels, strict=True)):
        errors, lost = _level_errors(before, codes, packed, reading, measures, stride)
        non_finite += lost
        for name, values in errors.items():
            found.setdefault(name, []).append(LevelErrors(level, before.shape[:-1], values))
        for name, values in filtered_errors(before, codes, packed, reading).items():
            found.setdefault(name, []).append(LevelErrors(level, before.shape[:-1], values, corners=True))
    units = {m.name: m.unit for m in (*measures, *measures_between(packed, reading))}
    judged = tuple(
        each
        for name, unit in units.items()
        for each in _statistics(name, unit, found[name], frozenset((apart or {}).get(name, ())))
    )
    return MapErrors(judged, _picture(found[measures[0].name][0]), non_finite)


def _picture(finest: LevelErrors) -> np.ndarray:
    picture = finest.errors.reshape(finest.shape)
    if picture.ndim == 3:
        picture = picture[int(np.argmax([float(each.max(initial=0.0)) for each in picture]))]
    let_go(picture)
    return picture


def _statistics(name: str, unit: str, levels: list[LevelErrors], apart: frozenset[int]) -> Iterator[Statistics]:
    together = [level for level in levels if level.level not in apart]
    if together:
        yield statistics(name, unit, together)
    yield from (statistics(name, unit, [level], level.level) for level in levels if level.level in apart)


def _level_errors(
    before: np.ndarray,
    codes: np.ndarray,
    packed: PackedTexture,
    reading: Reranging,
    measures: tuple[Measure, ...],
    stride: int,
) -> tuple[Mapping[str, np.ndarray], int]:
    """Errors of one level in texel order, float32, NaN where a costly measure was not taken; non-finite texels seen."""
    form = packed.number_format
    count = before[..., 0].size
    errors = {m.name: empty((count,), np.float32) for m in measures}
    non_finite = 0
    for (run, wanted), (_, rows) in zip(blocks(before), blocks(codes), strict=True):
        wanted = wanted.astype(np.float64)
        with np.errstate(over="ignore", invalid="ignore"):
            seen = decode_rows(rows, reading, form, packed.channels)
            non_finite += texels(~np.isfinite(seen))
            for measure in measures:
                if measure.costly and stride > 1:
                    chosen = _chosen(errors[measures[0].name][run], errors["absolute"][run], stride)
                    errors[measure.name][run] = np.nan
                    errors[measure.name][run.start + chosen] = _lost(measure.error(wanted[chosen], seen[chosen]))
                else:
                    errors[measure.name][run] = _lost(measure.error(wanted, seen))
    let_go(*errors.values())
    return errors, non_finite


def _lost(errors: np.ndarray) -> np.ndarray:
    """A texel that is no number any more is as wrong as can be."""
    return np.where(np.isnan(errors), np.inf, errors)


def _chosen(first: np.ndarray, second: np.ndarray, stride: int) -> np.ndarray:
    """Every ``stride``-th texel of a block and those with the largest errors in two cheap measures."""
    worst = [
        np.argpartition(errors, -WORST_OF_BLOCK)[-WORST_OF_BLOCK:]
        for errors in (first, second)
        if len(errors) > WORST_OF_BLOCK
    ]
    return np.unique(np.concatenate([np.arange(0, len(first), stride), *worst]))
