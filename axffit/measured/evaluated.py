"""Measured data as a BRDF: what all of them share."""

import jax.numpy as jnp

from axffit._types import Direction, Scalar
from axffit.brdf.base import AbstractBRDF
from axffit.brdf.sampling import Uniforms, cosine_density, cosine_draw


class AbstractMeasuredBRDF(AbstractBRDF):
    """A BRDF whose values are measured. They name no lobe to follow, so draws are cosine-distributed."""

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Cosine-distributed."""
        return cosine_draw(u)

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """cos theta / pi."""
        return cosine_density(wi)

    def weight(self, wo: Direction) -> Scalar:
        """One: an estimate is not worth an integral."""
        return jnp.ones_like(wo[2])
