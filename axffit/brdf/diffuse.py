"""Diffuse reflectance."""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.sampling import Uniforms, cosine_density, cosine_draw
from axffit.numerics import floor_cosine


class Lambert(AbstractBRDF):
    """f = d / pi.

    ``color``: d, linear RGB reflectance (3,).
    """

    color: RGB = eqx.field(converter=as_parameter)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """d / pi."""
        return self.color / jnp.pi

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Cosine-distributed."""
        return cosine_draw(u)

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """cos theta / pi."""
        return cosine_density(wi)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of the color."""
        return jnp.mean(self.color)


class OrenNayar1994(AbstractBRDF):
    """Rough diffuse facets (Oren & Nayar, SIGGRAPH 1994), the paper's qualitative model.

        f = d / pi (A + B max(0, cos dphi) sin(a) tan(b)),   a = max, b = min of the polar angles
        A = 1 - 0.5 r² / (r² + k),   B = 0.45 r² / (r² + 0.09)

    k = 0.33; with ``interreflection`` k = 0.57, the paper's remedy for the light that facets exchange, which HDRP uses
    with r fixed at pi/4 because AxF stores no such roughness. cos dphi sin(a) sin(b) = i_x o_x + i_y o_y: no angle is
    computed.

    ``color``: d, linear RGB reflectance (3,). ``roughness``: r, the facets' slope deviation in radians, >= 0, ().
    """

    color: RGB = eqx.field(converter=as_parameter)
    roughness: Scalar = eqx.field(converter=as_parameter)
    interreflection: bool = eqx.field(static=True, default=False, kw_only=True)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The rough diffuse value."""
        square = self.roughness * self.roughness
        a = 1.0 - 0.5 * square / (square + (0.57 if self.interreflection else 0.33))
        b = 0.45 * square / (square + 0.09)
        along = wi[0] * wo[0] + wi[1] * wo[1]
        towards = jnp.where(along > 0, along, 0.0) / floor_cosine(jnp.maximum(wi[2], wo[2]))
        return self.color * ((a + b * towards) / jnp.pi)

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Cosine-distributed."""
        return cosine_draw(u)

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """cos theta / pi."""
        return cosine_density(wi)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of the color."""
        return jnp.mean(self.color)
