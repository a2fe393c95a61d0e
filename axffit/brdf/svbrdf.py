"""A reflectance that varies over the surface: a BRDF whose parameters are maps."""

from collections.abc import Callable, Mapping
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import Angles, Channels, Direction, Directions, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.texture import TextureMap


class SVBRDF(eqx.Module):
    """Parameters as maps, and how a texel's parameters make a BRDF.

        f(x, i, o) = build(shared, texel(uv))(i, o),   uv = x / size

    Maps may differ in size, have mip levels, or be constant (1x1). They are filtered as a GPU filters them: each value
    on its own, before ``build`` makes sense of it, so a filtered normal is not of unit length (``Framed`` normalizes)
    and an angle filtered across its wrap-around takes the long way.

    Attributes:
        maps: a map per parameter name.
        build: BRDF of ``shared`` and one texel's parameters: a mapping of name to (channels,), and ``"uv"`` (2,) and
            ``"footprint"`` () for models that have textures of their own, such as flakes.
        shared: what does not vary over the surface: any tree of arrays (a color table, a stack of flakes).
        size_mm: size of the tile (u, v) in millimeters, (2,).
        alpha: opacity in [0, 1], one channel, or None for 1.
        height: height in millimeters, one channel, or None for 0.
    """

    maps: dict[str, TextureMap]
    build: Callable[[Any, Mapping[str, Array]], AbstractBRDF] = eqx.field(static=True)
    shared: Any = None
    size_mm: Float[Array, "2"] = eqx.field(converter=as_parameter, default=(1.0, 1.0))
    alpha: TextureMap | None = None
    height: TextureMap | None = None

    def uv(self, position_mm: Float[Array, "... 2"]) -> Float[Array, "... 2"]:
        """Texture coordinates of positions on the surface (mm)."""
        return position_mm / self.size_mm.reshape((1,) * (position_mm.ndim - 1) + (2,))

    def at(self, uv: Float[Array, "2"], footprint: Scalar | None = None) -> AbstractBRDF:
        """The BRDF at one place; ``footprint`` is the side, in uv, of the area to average (default 0: a point)."""
        footprint = jnp.zeros((), uv.dtype) if footprint is None else footprint
        texel = {name: fetch(texture, uv, footprint) for name, texture in self.maps.items()}
        return self.build(self.shared, texel | {"uv": uv, "footprint": footprint})

    def evaluate(
        self, uv: Float[Array, "... 2"], wi: Directions, wo: Directions, footprint: Angles | None = None
    ) -> Channels:
        """BRDF values, 1/sr, at places ``uv`` (..., 2), with directions and footprints that broadcast against them."""
        footprint = jnp.zeros((), uv.dtype) if footprint is None else footprint
        batch = jnp.broadcast_shapes(uv.shape[:-1], wi.shape[:-1], wo.shape[:-1], footprint.shape)
        uv = jnp.broadcast_to(uv, (*batch, 2)).reshape(-1, 2)
        wi, wo = (jnp.broadcast_to(v, (*batch, 3)).reshape(-1, 3) for v in (wi, wo))
        footprint = jnp.broadcast_to(footprint, batch).reshape(-1)
        values = jax.vmap(lambda uv, i, o, side: self.at(uv, side).evaluate(i, o))(uv, wi, wo, footprint)
        return values.reshape(*batch, 3)

    def opacity(self, uv: Float[Array, "2"], footprint: Scalar | None = None) -> Scalar:
        """Alpha at a place."""
        if self.alpha is None:
            return jnp.ones((), uv.dtype)
        return fetch(self.alpha, uv, jnp.zeros((), uv.dtype) if footprint is None else footprint)[0]

    def parallax(self, uv: Float[Array, "2"], wo: Direction, *, steps: int = 32) -> Float[Array, "2"]:
        """Where a ray to the viewer ``wo`` that meets the flat surface at ``uv`` meets the height map instead.

        The ray enters at the map's highest texel and descends in ``steps`` to its lowest; the crossing is refined
        linearly. For previews: there are no silhouettes and no shadows.
        """
        if self.height is None:
            return uv
        height = self.height
        top, bottom = (f(height.texels).astype(uv.dtype) for f in (jnp.max, jnp.min))
        per_mm = -wo[:2] / jnp.maximum(wo[2], 0.05) / self.size_mm  # the uv that one millimeter of depth moves
        depths = jnp.linspace(0.0, 1.0, steps + 1, dtype=uv.dtype) * (top - bottom)
        start = uv - per_mm * top

        def above(depth: Scalar) -> Scalar:
            return top - depth - height.fetch(start + per_mm * depth)[0]

        gaps = jax.vmap(above)(depths)
        # At the lowest texel's depth the ray has met the surface, whatever rounding says.
        first = jnp.argmax((gaps <= 0.0).at[-1].set(True))
        before = jnp.maximum(first - 1, 0)
        drop = gaps[before] - gaps[first]
        fraction = jnp.where(drop > 0, gaps[before] / jnp.where(drop > 0, drop, 1.0), 0.0)
        depth = depths[before] + fraction * (depths[first] - depths[before])
        return start + per_mm * depth


def fetch(texture: TextureMap, uv: Float[Array, "2"], footprint: Scalar) -> Float[Array, " channels"]:
    """Texel at ``uv``, averaged over about ``footprint``."""
    return texture.fetch(uv, None if len(texture.shapes) == 1 else texture.level_of(footprint))
