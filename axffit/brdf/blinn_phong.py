"""Blinn-Phong lobes: a power of the half vector's cosine.

AxF stores an exponent as n' with n = 2^n'; HDRP reads the same map as a roughness a with n = 2/a² - 2. Both decodings
stand here as functions: they belong to the material, the lobes take the exponent itself.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import AbstractFresnel, NoFresnel
from axffit.brdf.geometry import HalfGeometry, half_geometry
from axffit.brdf.lobe import PerAxis, alpha_xy, lobe_value, lobe_weight
from axffit.brdf.sampling import Uniforms, mirrored
from axffit.numerics import log_cosine_over_sine_square, safe_sqrt, times_exp


def exponent_from_axf(stored: Float[Array, "..."]) -> Float[Array, "..."]:
    """n = 2^n' (AxF SDK)."""
    return jnp.exp2(stored)


def exponent_from_roughness(roughness: Float[Array, "..."]) -> Float[Array, "..."]:
    """n = 2/a² - 2 (HDRP); a = 1 is the exponent 0."""
    return 2.0 / (roughness * roughness) - 2.0


def _log_cosine_h(half: HalfGeometry) -> Scalar:
    """log h_z = -½ log1p(tan² theta_h)."""
    x, y = half.x / half.z, half.y / half.z
    return -0.5 * jnp.log1p(x * x + y * y)


def _power_density(half: HalfGeometry, nu: Scalar, nv: Scalar, scale: Scalar) -> Scalar:
    """Density of facets, sqrt((nu + 1)(nv + 1)) / (2 pi) h_z^((nu h_x² + nv h_y²) / (1 - h_z²)), times ``scale``."""
    x2, y2 = half.x * half.x / half.square, half.y * half.y / half.square
    x_slope, y_slope = half.x / half.z, half.y / half.z
    tan2 = x_slope * x_slope + y_slope * y_slope
    peak = scale * (jnp.sqrt((nu + 1.0) * (nv + 1.0)) / (2.0 * jnp.pi))
    return times_exp(peak, (nu * x2 + nv * y2) * log_cosine_over_sine_square(tan2))


def _power_normal(u: Uniforms, nu: Scalar, nv: Scalar) -> Direction:
    """Facet normal of :func:`_power_density` (Ashikhmin & Shirley 2000, with their four quadrants in one)."""
    phi = 2.0 * jnp.pi * u[2]
    x, y = jnp.sqrt(nv + 1.0) * jnp.cos(phi), jnp.sqrt(nu + 1.0) * jnp.sin(phi)
    length = safe_sqrt(x * x + y * y)
    x, y = x / length, y / length
    log_cosine = jnp.log1p(-u[1]) / (nu * x * x + nv * y * y + 1.0)
    sine = safe_sqrt(-jnp.expm1(2.0 * log_cosine))
    return jnp.stack([sine * x, sine * y, jnp.exp(log_cosine)])


class AbstractBlinnPhong(AbstractBRDF):
    """A Blinn-Phong lobe with one exponent; the variants differ in what stands before h_z^n.

    Attributes:
        specular_color: s, linear RGB (3,).
        exponent: n >= 0, ().
        fresnel: F at <h, o>.
    """

    specular_color: RGB = eqx.field(converter=as_parameter)
    exponent: Scalar = eqx.field(converter=as_parameter)
    fresnel: AbstractFresnel = NoFresnel()

    @abc.abstractmethod
    def normalization(self, half: HalfGeometry) -> Scalar:
        """What stands before h_z^n, in 1/sr."""

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The lobe's value."""
        half = half_geometry(wi, wo)
        density = times_exp(self.normalization(half), self.exponent * _log_cosine_h(half))
        return lobe_value(self.specular_color, self.fresnel, half, density)

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Mirrored about a facet of density (n + 1) / (2 pi) h_z^n."""
        return mirrored(wo, _power_normal(u, self.exponent, self.exponent))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Density of that facet's mirror direction."""
        half = half_geometry(wi, wo)
        return _power_density(half, self.exponent, self.exponent, 0.25 / half.cos_d)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of s F at the mirror direction."""
        return lobe_weight(self.specular_color, self.fresnel, wo)


class BlinnPhong1977(AbstractBlinnPhong):
    """Blinn's lobe (SIGGRAPH 1977): s F (n + 2) / (8 pi) h_z^n; AxF's ``Blinn1977`` and ``Lewis1993``.

    AxF's ``Lewis1993`` is undocumented; Lewis's normalization (CGF 13(2), 1994) with the half vector,
    (n + 2) / (2 pi) · 1/4 · h_z^n, is this same function.
    """

    def normalization(self, half: HalfGeometry) -> Scalar:
        """(n + 2) / (8 pi)."""
        return (self.exponent + 2.0) / (8.0 * jnp.pi)


class BlinnPhongVRay(AbstractBlinnPhong):
    """The Blinn lobe of V-Ray's material as Chaos publishes it (2020): s F (n + 1) / (8 pi) h_z^n / <h, o>.

    That AxF's variant ``VRay`` means this lobe is an inference from the name.
    """

    def normalization(self, half: HalfGeometry) -> Scalar:
        """(n + 1) / (8 pi <h, o>)."""
        return (self.exponent + 1.0) / (8.0 * jnp.pi * half.cos_d)


class BlinnPhongAshikhminShirley2000(AbstractBRDF):
    """Ashikhmin & Shirley's anisotropic Phong lobe (Journal of Graphics Tools 5(2), 2000), AxF's ``Ashikhmin2000``.

        density = sqrt((nu + 1)(nv + 1)) / (8 pi) · h_z^((nu h_x² + nv h_y²) / (1 - h_z²)) / (<h,o> max(i_z, o_z))

    The exponent has no limit at h = n, but the power is exp((nu h_x² + nv h_y²) L), L = log(h_z) / (1 - h_z²), and L is
    smooth there (-1/2).

    ``specular_color`` s (3,), linear RGB; ``exponents``: n (shape ()) or (nu, nv) (shape (2,)), >= 0; ``fresnel``.
    """

    specular_color: RGB = eqx.field(converter=as_parameter)
    exponents: PerAxis = eqx.field(converter=as_parameter)
    fresnel: AbstractFresnel = NoFresnel()

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The lobe without color and Fresnel."""
        half = half_geometry(wi, wo)
        scale = 0.25 / (half.cos_d * jnp.maximum(half.i_z, half.o_z))
        density = _power_density(half, *alpha_xy(self.exponents), scale)
        return lobe_value(self.specular_color, self.fresnel, half, density)

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Mirrored about a facet of density sqrt((nu + 1)(nv + 1)) / (2 pi) h_z^(nu cos² phi + nv sin² phi)."""
        return mirrored(wo, _power_normal(u, *alpha_xy(self.exponents)))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Density of that facet's mirror direction."""
        half = half_geometry(wi, wo)
        return _power_density(half, *alpha_xy(self.exponents), 0.25 / half.cos_d)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of s F at the mirror direction."""
        return lobe_weight(self.specular_color, self.fresnel, wo)
