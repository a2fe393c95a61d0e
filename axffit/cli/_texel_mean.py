"""A textured material as an instrument sees it whose spot covers many texels."""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit import axf
from axffit._types import RGB, Direction, Scalar
from axffit.brdf import AbstractBRDF

TEXELS = 1024
"""Texels that the mean is taken over, spread evenly. The bundled 64x64 SVBRDF's mean is met to 2 % RMS; single
directions that few texels reflect in can be off by more."""

# 1/g and 1/g² of the plastic number g, g³ = g + 1: steps that fill the square evenly (Roberts' R2 sequence).
_STEP = np.array([0.7548776662466927, 0.5698402909980532])


class TexelMean(AbstractBRDF):
    """f = mean over the texels of f_texel; every array leaf of ``texels`` has the texels' axis first."""

    texels: AbstractBRDF

    @property
    def count(self) -> int:
        """Number of texels."""
        return jax.tree.leaves(eqx.filter(self.texels, eqx.is_inexact_array))[0].shape[0]

    def _mean(self, of: Callable[[AbstractBRDF], Array], like: Float[Array, "..."]) -> Float[Array, "..."]:
        """Mean of ``of(texel)``, one texel after the other to need no memory for all at once."""
        arrays, rest = eqx.partition(self.texels, eqx.is_inexact_array)

        def add(total: Array, texel: AbstractBRDF) -> tuple[Array, None]:
            return total + of(eqx.combine(texel, rest)), None

        return jax.lax.scan(add, jnp.zeros_like(like), arrays)[0] / self.count

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The mean of the texels' values."""
        return self._mean(lambda texel: texel.masked_value(wi, wo), wi)

    def draw(self, wo: Direction, u: Float[Array, "3"]) -> Direction:
        """A draw of one texel; all are as likely."""
        position = u[0] * self.count
        index = jnp.minimum(position.astype(jnp.int32), self.count - 1)
        texel = jax.tree.map(lambda leaf: leaf[index] if eqx.is_inexact_array(leaf) else leaf, self.texels)
        return texel.masked_draw(wo, u.at[0].set(position - index.astype(u.dtype)))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """The mean of the texels' densities."""
        return self._mean(lambda texel: texel.masked_density(wi, wo), wi[2])

    def weight(self, wo: Direction) -> Scalar:
        """The mean of the texels' weights."""
        return self._mean(lambda texel: texel.weight(wo), wo[2])


def brdf_of(material: axf.AxfMaterial) -> AbstractBRDF:
    """What a material reflects on the whole: a car paint's BRDF, or the mean over 1024 texels of a textured one."""
    if material.kind is axf.MaterialKind.CAR_PAINT:
        return axf.to_brdf(material)
    uv = np.mod(0.5 + np.arange(1, TEXELS + 1)[:, None] * _STEP, 1.0)
    return TexelMean(axf.to_brdf(material, uv=uv))
