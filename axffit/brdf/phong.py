"""Phong's lobe: a power of the cosine with the mirror direction."""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import AbstractFresnel, NoFresnel
from axffit.brdf.geometry import half_geometry
from axffit.brdf.lobe import lobe_value
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
        """(n + 2) / (2 pi) c^n with 1 - c² = |reflect(i) - o|² (1 - |reflect(i) - o|² / 4)."""
        half = half_geometry(wi, wo)
        x, y, z = wi[0] + wo[0], wi[1] + wo[1], wi[2] - wo[2]
        chord2 = x * x + y * y + z * z
        density = (
            (self.exponent + 2.0) / (2.0 * jnp.pi) * positive_power(1.0 - 0.5 * chord2, 0.5 * chord2, self.exponent)
        )
        return lobe_value(self.specular_color, self.fresnel, half, density)
