"""Maps as a GPU filters them: bilinear and repeating within a level, linear between mip levels; NumPy, many at once.

What is averaged decides what is seen. AxF's own maps are averaged in the quantity they mean: unit vectors of normals,
(cos 2 a, sin 2 a) of axes, everything else as it is. A packed texture is averaged as the hardware does it, in the
values its codes stand for, and the shader makes AxF's quantity of the mean: an angle filtered across its wrap-around
passes through every angle there is, F0 is averaged in place of an index, a gamma the hardware does not know of counts
as linear. The mean of normals keeps its length below 1; the shading frame normalizes it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axffit.axf import AxfTexture
from axffit.targets import PackedTexture
from axffit.textures.rerange import Reranging

Values = np.ndarray


@dataclass(frozen=True, eq=False)
class SampledTexture:
    """A texture, and what becomes of its filtered values.

    Attributes:
        levels: values [H, W, C] that are averaged, the finest level first.
        meaning: means (P, C) to AxF's values.
        tiles: how often the texture repeats while u and v run from 0 to 1, (2,).
    """

    levels: tuple[Values, ...]
    meaning: Callable[[Values], Values]
    tiles: Values

    def fetch(self, uv: Values, footprint: Values) -> Values:
        """AxF's values (P, C) at ``uv`` (P, 2), averaged over about ``footprint`` (P,), the side of an area in uv."""
        at = uv * self.tiles
        texels = footprint * np.max(self.tiles * self.levels[0].shape[1::-1])
        level = np.clip(np.log2(np.maximum(texels, 1.0)), 0.0, len(self.levels) - 1.0)
        lower = level.astype(int)
        weight = (level - lower)[:, None]
        mean = np.empty((len(uv), self.levels[0].shape[-1]))
        for k in np.unique(lower):
            here = lower == k
            fine, coarse = (_bilinear(self.levels[j], at[here]) for j in (k, min(k + 1, len(self.levels) - 1)))
            mean[here] = (1.0 - weight[here]) * fine + weight[here] * coarse
        return self.meaning(mean)


def _bilinear(level: Values, uv: Values) -> Values:
    """Means of the four texels around coordinates (P, 2); texel k of n has its center at (k + 0.5) / n."""
    height, width, _ = level.shape
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - column)[:, None], (y - row)[:, None]
    left, right, low, high = column % width, (column + 1) % width, row % height, (row + 1) % height
    lower = (1.0 - fx) * level[low, left] + fx * level[low, right]
    upper = (1.0 - fx) * level[high, left] + fx * level[high, right]
    return (1.0 - fy) * lower + fy * upper


def _halved(level: Values) -> Values:
    """Means of 2x2 texels; an odd side, 1 included, keeps its rest by repeating the last texel."""
    padded = np.pad(level, ((0, level.shape[0] % 2), (0, level.shape[1] % 2), (0, 0)), mode="edge")
    height, width, channels = padded.shape
    return padded.reshape(height // 2, 2, width // 2, 2, channels).mean(axis=(1, 3))


def _pyramid(finest: Values, stored: Callable[[Values], Values] = lambda level: level) -> tuple[Values, ...]:
    levels = [finest]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(stored(_halved(levels[-1])))
    return tuple(levels)


def original_texture(name: str, texture: AxfTexture, tiles: Values) -> SampledTexture:
    """AxF's map ``name``, averaged in the quantity it means."""
    texels = (texture.data[:1, :1] if texture.is_constant else texture.data).astype(np.float64)
    if name == "anisrotation":
        doubled = np.concatenate([np.cos(2 * texels), np.sin(2 * texels)], axis=-1)
        return SampledTexture(_pyramid(doubled), lambda m: 0.5 * np.arctan2(m[:, 1:], m[:, :1]), tiles)
    if name in ("normal", "clearcoatnormal"):
        length = np.linalg.norm(texels, axis=-1, keepdims=True)
        texels = texels / np.where(length > 0, length, 1.0)
    return SampledTexture(_pyramid(texels), lambda mean: mean, tiles)


def packed_texture(packed: PackedTexture, reading: Reranging, tiles: Values) -> SampledTexture:
    """A packed texture as the hardware filters it; levels it does not have are made as engines do, and stored again."""
    form, used = packed.number_format, packed.channels

    def decoded(codes: Values) -> Values:
        return form.decode(codes)

    def stored(mean: Values) -> Values:
        return decoded(form.encode(mean, packed.rounding))

    finest = decoded(packed.levels[0])
    rest = tuple(decoded(codes) for codes in packed.levels[1:])
    levels = (finest, *rest) if rest else _pyramid(finest, stored)
    return SampledTexture(tuple(level[..., :used] for level in levels), reading.inverse, tiles)
