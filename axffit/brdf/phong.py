"""Phong's lobe: a power of the cosine with the mirror direction."""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import AbstractFresnel, NoFresnel
from axffit.brdf.geometry import half_geometry
from axffit.brdf.lobe import lobe_value, lobe_weight
from axffit.brdf.sampling import Uniforms, about
from axffit.numerics import positive_power


class PhongLewis1994(AbstractBRDF):
    """Phong's lobe (CACM 18(6), 1975) with Lewis's normalization (CGF 13(2), 1994); AxF's ``Phong``, "unofficial".

        density = (n + 2) / (2 pi) max(0, <reflect(i), o>)^n

    ``specular_color`` s (3,), linear RGB; ``exponent`` n >= 0, (); ``fresnel`` F at <h, o>.
    """

    specular_color: RGB = eqx.field(converter=as_parameter)
    exponent: Scalar = eqx.field(converter=as_parameter)
    fresnel: AbstractFresnel = NoFresnel()

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """(n + 2) / (2 pi) c^n, times s F."""
        half = half_geometry(wi, wo)
        density = (self.exponent + 2.0) / (2.0 * jnp.pi) * _mirror_power(wi, wo, self.exponent)
        return lobe_value(self.specular_color, self.fresnel, half, density)

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """About the mirror direction, of density (n + 1) / (2 pi) c^n."""
        mirror = jnp.stack([-wo[0], -wo[1], wo[2]])
        cosine = jnp.exp(jnp.log1p(-u[1]) / (self.exponent + 1.0))
        return about(mirror, cosine, 2.0 * jnp.pi * u[2])

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """(n + 1) / (2 pi) c^n."""
        return (self.exponent + 1.0) / (2.0 * jnp.pi) * _mirror_power(wi, wo, self.exponent)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of s F at the mirror direction."""
        return lobe_weight(self.specular_color, self.fresnel, wo)


def _mirror_power(wi: Direction, wo: Direction, exponent: Scalar) -> Scalar:
    """max(0, c)^n, c = <reflect(i), o>; near 1 by 1 - c = |reflect(i) - o|² / 2."""
    x, y, z = wi[0] + wo[0], wi[1] + wo[1], wi[2] - wo[2]
    cosine = wi[2] * wo[2] - wi[0] * wo[0] - wi[1] * wo[1]
    return positive_power(cosine, 0.5 * (x * x + y * y + z * z), exponent)
