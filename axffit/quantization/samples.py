"""Which texels the BRDF error is measured at: the most extreme ones of every map, and others at random."""

from collections.abc import Iterator, Mapping

import numpy as np

from ..axf import AxfMaterial, AxfTexture
from ..axf.maps import SPATIAL_KEYS, grid_shape, reference_map
from ..axf.scratch import let_go
from .maps import MapErrors

SEED = 20180608
EXTREMES = 4
"""Texels taken at each end of each channel of each map."""

_RUN = 2**18


def sample_texels(material: AxfMaterial, errors: Mapping[str, MapErrors], count: int) -> np.ndarray:
    """Texture coordinates (n, 2), n <= count, of texels of the material's grid.

    First the texels with the largest error of every map, then those with the smallest and largest values of every
    channel, then others at random (a fixed seed), without repetition; all of them where the grid has no more.

    Args:
        material: the original material.
        errors: its map errors by AxF name.
        count: how many texels at most.
    """
    height, width = grid_shape(material)
    cells = height * width
    if cells <= count:
        chosen = np.arange(cells)
    else:
        rng = np.random.default_rng(SEED)
        ends = np.concatenate([np.zeros(1, np.int64), *_extremes(material, errors, (height, width))])
        # In the order of extremity, so that a short sample keeps something of every map.
        first = ends[np.sort(np.unique(ends, return_index=True)[1])]
        others = rng.choice(cells, size=min(cells, 4 * count), replace=False)
        chosen = np.concatenate([first, others[~np.isin(others, first)]])[:count]
    rows, columns = np.divmod(chosen, width)
    return np.stack([(columns + 0.5) / width, (rows + 0.5) / height], axis=-1)


def _extremes(material: AxfMaterial, errors: Mapping[str, MapErrors], grid: tuple[int, int]) -> Iterator[np.ndarray]:
    """Grid indices of the extreme texels of each map, one rank of extremity after the other."""
    reference = reference_map(material)
    ranked: list[tuple[AxfTexture, np.ndarray]] = []
    for key in SPATIAL_KEYS:
        texture = material.textures.get(key)
        if texture is None or texture.is_constant or key not in errors:
            continue
        channels = [errors[key].picture.reshape(-1), *np.moveaxis(texture.data.reshape(-1, texture.channels), -1, 0)]
        for values in channels:
            ranked.append((texture, _ends(values)))
    for rank in range(2 * EXTREMES):
        yield from (
            _on_grid(texture, order[rank : rank + 1], reference, grid) for texture, order in ranked if len(order) > rank
        )


def _ends(values: np.ndarray) -> np.ndarray:
    """Indices of the largest and of the smallest values, the most extreme first; NaN counts as 0."""
    found: list[tuple[np.ndarray, np.ndarray]] = []
    top, bottom = -np.inf, np.inf
    for start in range(0, values.size, _RUN):
        run = np.nan_to_num(values[start : start + _RUN].astype(np.float64))
        if run.max() <= top and run.min() >= bottom:
            continue
        count = min(EXTREMES, run.size)
        ends = np.union1d(np.argpartition(run, -count)[-count:], np.argpartition(run, count - 1)[:count])
        found.append((start + ends, run[ends]))
        extreme = np.sort(np.concatenate([numbers for _, numbers in found]))
        if extreme.size >= 2 * EXTREMES:
            top, bottom = extreme[-EXTREMES], extreme[EXTREMES - 1]
    let_go(values)
    indices, numbers = (np.concatenate(parts) for parts in zip(*found, strict=True))
    upward = np.argsort(numbers, kind="stable")
    count = min(EXTREMES, values.size)
    return np.concatenate([indices[upward[-count:][::-1]], indices[upward[:count]]])


def _on_grid(
    texture: AxfTexture, indices: np.ndarray, reference: AxfTexture | None, grid: tuple[int, int]
) -> np.ndarray:
    """Indices of a map's texels to indices of the grid's texels at the same place in millimeters."""
    height, width, _ = texture.data.shape
    rows, columns = np.divmod(indices, width)
    stretch = (1.0, 1.0)
    if reference is not None:
        stretch = (texture.width_mm / reference.width_mm, texture.height_mm / reference.height_mm)
    u, v = (columns + 0.5) / width * stretch[0], (rows + 0.5) / height * stretch[1]
    return np.floor(v * grid[0]).astype(np.int64) % grid[0] * grid[1] + np.floor(u * grid[1]).astype(np.int64) % grid[1]
