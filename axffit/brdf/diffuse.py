"""Diffuse reflectance."""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Direction
from axffit.brdf.base import AbstractBRDF, as_parameter


class Lambert(AbstractBRDF):
    """f = d / pi.

    ``color``: d, linear RGB reflectance (3,).
    """

    color: RGB = eqx.field(converter=as_parameter)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """d / pi."""
        return self.color / jnp.pi
