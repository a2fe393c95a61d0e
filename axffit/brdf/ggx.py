"""The GGX lobe: Trowbridge-Reitz facets behind Smith's masking."""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import AbstractFresnel, NoFresnel
from axffit.brdf.geometry import HalfGeometry, half_geometry
from axffit.brdf.lobe import (
    Normalization,
    PerAxis,
    alpha_xy,
    check_normalization,
    lobe_value,
    lobe_weight,
    normalization_factor,
)
from axffit.brdf.sampling import Uniforms, mirrored, visible_ggx_normal


def trowbridge_reitz(half: HalfGeometry, alpha: Scalar, beta: Scalar) -> Scalar:
    """D = 1 / (alpha beta (h_x²/alpha² + h_y²/beta² + h_z²)²), without its 1 / pi."""
    x, y = half.x / alpha, half.y / beta
    stretched = half.square / (x * x + y * y + half.z * half.z)
    return stretched * stretched / (alpha * beta)


def _smith_denominator(v: Direction, v_z: Scalar, alpha: Scalar, beta: Scalar) -> Scalar:
    """2 v_z / G1(v): v_z + sqrt(v_z² + alpha² v_x² + beta² v_y²)."""
    x, y = alpha * v[0], beta * v[1]
    return v_z + jnp.sqrt(v_z * v_z + x * x + y * y)


class GGX(AbstractBRDF):
    """The GGX lobe (Walter et al., EGSR 2007) as the AxF SDK documents it, AxF >= 1.5.

        f = s / pi · D F G1(i) G1(o) / (i_z o_z),   G1(v) = 2 v_z / (v_z + sqrt(v_z² + alpha² v_x² + beta² v_y²))

    with D of :func:`trowbridge_reitz`; times 1/4 with ``normalization="microfacet"``. For alpha = beta, G1 is
    2 v_z / (v_z + sqrt(alpha² + (1 - alpha²) v_z²)); for two roughnesses it is the roughness projected on the
    direction's own azimuth (Heitz, JCGT 3(2), 2014). ``specular_color`` s (3,), linear RGB; ``roughness`` alpha, shape
    () or (2,), > 0: the microfacet roughness itself, not its root; ``fresnel`` F at <h, o>.
    """

    specular_color: RGB = eqx.field(converter=as_parameter)
    roughness: PerAxis = eqx.field(converter=as_parameter)
    fresnel: AbstractFresnel = NoFresnel()
    normalization: Normalization = eqx.field(static=True, default="sdk", kw_only=True)

    def __check_init__(self):
        check_normalization(self.normalization)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """D G / (pi i_z o_z), times the normalization; G / (i_z o_z) = 4 / (the two Smith denominators)."""
        half = half_geometry(wi, wo)
        alpha, beta = alpha_xy(self.roughness)
        smith = _smith_denominator(wi, half.i_z, alpha, beta) * _smith_denominator(wo, half.o_z, alpha, beta)
        scale = normalization_factor(self.normalization) / jnp.pi
        density = scale * trowbridge_reitz(half, alpha, beta) * (4.0 / smith)
        return lobe_value(self.specular_color, self.fresnel, half, density)

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Mirrored about a facet that the viewer sees."""
        return mirrored(wo, visible_ggx_normal(wo, u, *alpha_xy(self.roughness)))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """G1(o) D / (4 pi o_z) = D / (2 pi (the viewer's Smith denominator))."""
        half = half_geometry(wi, wo)
        alpha, beta = alpha_xy(self.roughness)
        smith = _smith_denominator(wo, half.o_z, alpha, beta)
        return trowbridge_reitz(half, alpha, beta) / (2.0 * jnp.pi * smith)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of s F at the mirror direction, times the albedo of the normalization."""
        return 4.0 * normalization_factor(self.normalization) * lobe_weight(self.specular_color, self.fresnel, wo)
