"""Errors between texels: a GPU filters what a texture stores, and the shader turns the mean into AxF's quantity.

Between four texels of a level lies a sample with weights w. It should see the mean of AxF's quantity,

    q(sum w_k t(a_k)),     t: unit vectors of normals, (cos 2 a, sin 2 a) of axes, n of an index of refraction,

and sees ``reading.inverse(sum w_k stored_k)``. Where both are affine (colors in linear textures, roughness, heights,
opacity), the second differs from the first by no more than the texels do: |sum w (s - a)| <= max |s - a|, so nothing is
measured. What is not affine, and is measured:

- axes: a filter across the angle's wrap-around passes through every angle there is;
- normals: the mean of unit vectors is shorter than 1 (``filtered_length``, for shaders that do not normalize), and a
  rebuilt z is not the mean of the z (``filtered_angle``);
- the coat's index: F0 is filtered in place of n;
- colors stored as a power of themselves, where the hardware does not know of the power.

Weights are multiples of 1/4, which GPUs have exactly (D3D11_SUBTEXEL_FRACTIONAL_BIT_COUNT is 8). Maps repeat, the color
table is clamped at its edges.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..axf.scratch import empty, let_go
from ..targets import PackedTexture
from ..targets.encoding import BLOCK_TEXELS
from ..textures.rerange import Reranging
from .measures import (
    COLORS,
    Measure,
    Rows,
    absolute,
    angle_between,
    f0_of_ior,
    ior,
    relative_color,
    usable_ior,
)

_MIDDLES = ((0.5, 0.0), (0.0, 0.5), (0.5, 0.5))
_QUARTERS = (*((f, 0.0) for f in (0.25, 0.5, 0.75)), *((0.0, f) for f in (0.25, 0.5, 0.75)), (0.5, 0.5))

UNDEFINED = 1e-6
"""Axes whose mean (cos 2 a, sin 2 a) is shorter than this have no mean axis: every axis is as good."""


@dataclass(frozen=True)
class _Filter:
    """What is measured between texels of one kind of map.

    Attributes:
        averaged: t: AxF values [..., C] to what their mean is taken of.
        positions: the samples, as fractions (fx, fy) of a texel's width from the texel's center to the next ones.
        measures: errors of (mean of t, what the shader sees).
        needs_curve: whether only a reading that is not affine is measured.
    """

    averaged: Callable[[Rows], Rows]
    positions: tuple[tuple[float, float], ...]
    measures: tuple[Measure, ...]
    needs_curve: bool = False


def _unit(normals: Rows) -> Rows:
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return normals / np.where(length > 0, length, 1.0)


def _doubled(angles: Rows) -> Rows:
    return np.concatenate([np.cos(2 * angles), np.sin(2 * angles)], axis=-1)


def _shortness(before: Rows, after: Rows) -> np.ndarray:
    return np.abs(1.0 - np.linalg.norm(after, axis=-1))


def _axis(before: Rows, after: Rows) -> np.ndarray:
    """Degrees between the axis of a mean (cos 2 a, sin 2 a) and one given by its angle."""
    seen = _doubled(after)
    cross = before[..., 0] * seen[..., 1] - before[..., 1] * seen[..., 0]
    angle = np.degrees(np.arctan2(np.abs(cross), np.sum(before * seen, axis=-1))) / 2
    return np.where(np.linalg.norm(before, axis=-1) > UNDEFINED, angle, 0.0)


def _not_negative(colors: Rows) -> Rows:
    return np.maximum(colors, 0.0)


_NORMAL = _Filter(
    _unit,
    _MIDDLES,
    (Measure("filtered_angle", "degrees", angle_between), Measure("filtered_length", "", _shortness)),
)
_COLOR = _Filter(
    _not_negative,
    _MIDDLES,
    (Measure("filtered_relative", "", relative_color), Measure("filtered_absolute", "", absolute)),
    needs_curve=True,
)
_FILTERS: Mapping[str, _Filter] = {
    "normal": _NORMAL,
    "clearcoatnormal": _NORMAL,
    "anisrotation": _Filter(_doubled, _QUARTERS, (Measure("filtered_axis_angle", "degrees", _axis),)),
    "clearcoatior": _Filter(
        usable_ior, _MIDDLES, (Measure("filtered_f0", "", f0_of_ior), Measure("filtered_ior", "", ior))
    ),
    **dict.fromkeys(COLORS, _COLOR),
}

FILTERED_MEASURES: Mapping[str, tuple[str, ...]] = {
    name: tuple(measure.name for measure in each.measures) for name, each in _FILTERS.items()
}
"""AxF names to the measures between texels they may have."""


def is_affine(reading: Reranging, channels: int) -> bool:
    """Whether the shader's reading of numbers in [0, 1] keeps means: 33 steps of equal size, to one part in 10^9."""
    steps = np.linspace(0.0, 1.0, 33)
    values = reading.inverse(np.broadcast_to(steps[:, None], (33, channels)))
    straight = values[0] + steps[:, None] * (values[-1] - values[0])
    return bool(np.allclose(values, straight, rtol=1e-9, atol=1e-12))


def measures_between(packed: PackedTexture, reading: Reranging) -> tuple[Measure, ...]:
    """What is measured between the texels of a texture."""
    used = _filter(packed, reading)
    return () if used is None else used.measures


def _filter(packed: PackedTexture, reading: Reranging) -> _Filter | None:
    used = _FILTERS.get(packed.axf_name)
    return None if used is None or (used.needs_curve and is_affine(reading, packed.channels)) else used


def filtered_errors(
    before: np.ndarray, codes: np.ndarray, packed: PackedTexture, reading: Reranging
) -> Mapping[str, np.ndarray]:
    """Largest error of the samples between a texel and the next of its row and column, by measure, [n] float32.

    Args:
        before: AxF's level, [..., H, W, C].
        codes: the same level as packed.
        packed: the texture it belongs to.
        reading: how the target's shader reads it.
    """
    used = _filter(packed, reading)
    if used is None:
        return {}
    height, width = before.shape[-3:-1]
    maps = [level.reshape(-1, height, width, level.shape[-1]) for level in (before, codes)]
    errors = {measure.name: empty((before[..., 0].size,), np.float32) for measure in used.measures}
    clamped = packed.axf_name == "brdfcolors"
    for run, wanted, stored in _bands(*maps, clamped=clamped):
        averaged = used.averaged(wanted.astype(np.float64))
        decoded = packed.number_format.decode(stored)[..., : packed.channels]
        largest: dict[str, np.ndarray] = {}
        for position in used.positions:
            with np.errstate(over="ignore", invalid="ignore"):
                mean = _mean(averaged, position)
                seen = reading.inverse(_mean(decoded, position))
                for measure in used.measures:
                    found = measure.error(mean, seen)
                    found = np.where(np.isnan(found), np.inf, found)
                    largest[measure.name] = np.maximum(largest.get(measure.name, found), found)
        for name, values in largest.items():
            errors[name][run] = values.reshape(-1)
    let_go(*errors.values())
    return errors


def _bands(before: np.ndarray, codes: np.ndarray, *, clamped: bool) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
    """Bands of rows of maps [D, H, W, C] with one more row and column: (their texels, the rows of each)."""
    slices, height, width, _ = before.shape
    rows = max(1, BLOCK_TEXELS // max(width, 1))
    columns = _next(width, clamped=clamped)
    for number in range(slices):
        for start in range(0, height, rows):
            stop = min(start + rows, height)
            band = _next(height, clamped=clamped)[start : stop + 1]
            first = (number * height + start) * width
            wanted, stored = (level[number, band][:, columns] for level in (before, codes))
            yield slice(first, first + (stop - start) * width), wanted, stored
            let_go(before, codes)


def _next(count: int, *, clamped: bool) -> np.ndarray:
    """Indices 0 ... count: the last is the neighbor of the texel at the edge."""
    return np.append(np.arange(count), count - 1 if clamped else 0)


def _mean(values: Rows, position: tuple[float, float]) -> Rows:
    """Bilinear mean of [h + 1, w + 1, C] at a fraction of the way to the next column and row, [h, w, C]."""
    right, down = position
    along = values[:, :-1] + right * (values[:, 1:] - values[:, :-1]) if right else values[:, :-1]
    return along[:-1] + down * (along[1:] - along[:-1]) if down else along[:-1]
