"""The color table of AxF's car paint: chi(theta_h, theta_d)."""

from typing import Literal

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Scalar
from axffit.brdf.base import as_parameter

TexelConvention = Literal["center", "corner"]


class ColorTable(eqx.Module):
    """Bilinear table over theta_h (along the width) and theta_d (along the height), both over [0, pi/2].

    Attributes:
        values: linear RGB (H, W, 3), may exceed 1. Row 0 is theta_d = 0.
        texel_convention: ``"center"`` (plain texture coordinates, texel k at (k + 1/2) / size, held constant beyond the
            outer centers; AxF SDK) or ``"corner"`` (texel k at k / (size - 1); HDRP).
        flipped: whether the rows are stored upside down, row 0 being theta_d = pi/2 (HDRP).
        diagonal_clamp: for tables measured only where theta_h + theta_d <= pi/2: theta_d stops at pi/2 - theta_h.
    """

    values: Float[Array, "height width 3"] = eqx.field(converter=as_parameter)
    texel_convention: TexelConvention = eqx.field(static=True, default="center", kw_only=True)
    flipped: bool = eqx.field(static=True, default=False, kw_only=True)
    diagonal_clamp: bool = eqx.field(static=True, default=False, kw_only=True)

    def __check_init__(self):
        if self.texel_convention not in ("center", "corner"):
            raise ValueError(f"texel_convention={self.texel_convention!r}: use 'center' or 'corner'")

    def lookup(self, theta_h: Scalar, theta_d: Scalar) -> RGB:
        """chi at a pair of angles (radians)."""
        height, width, _ = self.values.shape
        if self.diagonal_clamp:
            theta_d = jnp.minimum(theta_d, 0.5 * jnp.pi - theta_h)
        if self.flipped:
            theta_d = 0.5 * jnp.pi - theta_d
        column, u = self._texel(theta_h, width)
        row, v = self._texel(theta_d, height)
        next_column, next_row = jnp.minimum(column + 1, width - 1), jnp.minimum(row + 1, height - 1)
        low = (1.0 - u) * self.values[row, column] + u * self.values[row, next_column]
        high = (1.0 - u) * self.values[next_row, column] + u * self.values[next_row, next_column]
        return (1.0 - v) * low + v * high

    def _texel(self, theta: Scalar, size: int) -> tuple[Array, Scalar]:
        """Lower texel index and weight of the upper one along an axis of ``size`` texels."""
        unit = theta * (2.0 / jnp.pi)
        position = unit * (size - 1) if self.texel_convention == "corner" else unit * size - 0.5
        position = jnp.clip(position, 0.0, size - 1)
        lower = jnp.floor(position)
        return lower.astype(jnp.int32), position - lower


def white_color_table() -> ColorTable:
    """The table that changes nothing."""
    return ColorTable(jnp.ones((1, 1, 3)))
