"""Textures as a GPU reads them: bilinear within a level, trilinear between levels, arrays of slices."""

from collections.abc import Sequence

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from axffit._types import Scalar
from axffit.brdf.base import as_parameter


class TextureMap(eqx.Module):
    """A texture, or an array of equal textures (slices), with its mip levels.

    A texture coordinate u runs along the width and v along the height; texel k of n covers [k/n, (k+1)/n), its center
    lies at (k + 1/2) / n, and row 0 is v = 0. Outside [0, 1) the texture repeats, or repeats mirrored.

    Attributes:
        texels: all levels, one after the other, each slice by slice and row by row, (texels, channels).
        shapes: (slices, height, width) of each level, largest first.
        tiles: how often the texture repeats while u and v run from 0 to 1, (2,); maps of one material may cover
            different areas.
        mirrored: whether every other tile is mirrored, which hides the tiling of textures that do not close.
    """

    texels: Float[Array, "texels channels"] = eqx.field(converter=as_parameter)
    shapes: tuple[tuple[int, int, int], ...] = eqx.field(static=True)
    tiles: Float[Array, "2"] = eqx.field(converter=as_parameter, default=(1.0, 1.0), kw_only=True)
    mirrored: bool = eqx.field(static=True, default=False, kw_only=True)

    def __check_init__(self):
        total = sum(s * h * w for s, h, w in self.shapes)
        if not self.shapes or total != self.texels.shape[0]:
            raise ValueError(f"{self.texels.shape[0]} texels do not fill levels of shapes {self.shapes}: {total} do")

    def fetch(
        self, uv: Float[Array, "2"], level: Scalar | None = None, slice_index: Int[Array, ""] | None = None
    ) -> Float[Array, " channels"]:
        """Filtered texel at ``uv``; ``level`` (default 0) is clamped to the levels that exist."""
        uv = uv * self.tiles.astype(uv.dtype)
        zero = jnp.zeros((), jnp.int32)
        slice_index = zero if slice_index is None else slice_index
        if level is None or len(self.shapes) == 1:
            return self._bilinear(uv, zero, slice_index)
        level = jnp.clip(level, 0.0, len(self.shapes) - 1.0)
        lower = jnp.floor(level)
        weight = level - lower
        index = lower.astype(jnp.int32)
        upper = jnp.minimum(index + 1, len(self.shapes) - 1)
        fine, coarse = self._bilinear(uv, index, slice_index), self._bilinear(uv, upper, slice_index)
        return (1.0 - weight) * fine + weight * coarse

    def level_of(self, footprint: Scalar) -> Scalar:
        """Mip level at which a texel is as large as ``footprint``, the side of the area looked at in uv, ()."""
        _, height, width = self.shapes[0]
        texels = footprint * jnp.max(self.tiles.astype(footprint.dtype) * jnp.asarray([width, height], footprint.dtype))
        return jnp.log2(jnp.maximum(texels, 1.0))

    def _bilinear(
        self, uv: Float[Array, "2"], level: Int[Array, ""], slice_index: Int[Array, ""]
    ) -> Float[Array, " channels"]:
        counts = np.array([s * h * w for s, h, w in self.shapes])
        start = jnp.asarray(np.cumsum(counts) - counts, jnp.int32)[level]
        height = jnp.asarray([h for _, h, _ in self.shapes], jnp.int32)[level]
        width = jnp.asarray([w for _, _, w in self.shapes], jnp.int32)[level]
        column, next_column, u = self._axis(uv[0], width)
        row, next_row, v = self._axis(uv[1], height)

        def texel(row: Array, column: Array) -> Array:
            return self.texels[start + (slice_index * height + row) * width + column].astype(uv.dtype)

        low = (1.0 - u) * texel(row, column) + u * texel(row, next_column)
        high = (1.0 - u) * texel(next_row, column) + u * texel(next_row, next_column)
        return (1.0 - v) * low + v * high

    def _axis(self, coordinate: Scalar, size: Int[Array, ""]) -> tuple[Array, Array, Scalar]:
        """The two texels along an axis that a coordinate lies between, and the weight of the second."""
        if self.mirrored:
            coordinate = 1.0 - jnp.abs(jnp.mod(coordinate, 2.0) - 1.0)
        position = coordinate * size.astype(coordinate.dtype) - 0.5
        lower = jnp.floor(position)
        first = lower.astype(jnp.int32)
        if self.mirrored:
            return jnp.maximum(first, 0), jnp.minimum(first + 1, size - 1), position - lower
        return jnp.mod(first, size), jnp.mod(first + 1, size), position - lower


def texture_map(
    levels: Sequence[Float[Array | np.ndarray, "..."]], *, tiles=(1.0, 1.0), mirrored: bool = False
) -> TextureMap:
    """A :class:`TextureMap` of levels [H, W, C] or, for arrays of slices, [D, H, W, C], largest first."""
    arrays = [level[None] if level.ndim == 3 else level for level in map(jnp.asarray, levels)]
    if any(a.ndim != 4 or 0 in a.shape for a in arrays):
        raise ValueError(f"levels of shapes {[np.shape(level) for level in levels]}: give [H, W, C] or [D, H, W, C]")
    shapes = tuple((a.shape[0], a.shape[1], a.shape[2]) for a in arrays)
    return TextureMap(
        jnp.concatenate([a.reshape(-1, a.shape[-1]) for a in arrays]), shapes, tiles=tiles, mirrored=mirrored
    )


def constant_map(value: Float[Array | np.ndarray, " channels"]) -> TextureMap:
    """The 1x1 map that has ``value`` everywhere."""
    return texture_map([jnp.asarray(value)[None, None, :]])
