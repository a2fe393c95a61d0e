"""Cook and Torrance's lobe: Beckmann facets behind V-grooves."""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import AbstractFresnel, NoFresnel
from axffit.brdf.geometry import HalfGeometry, Lobes, half_geometry, slope_square
from axffit.brdf.lobe import (
    Normalization,
    PerAxis,
    alpha_xy,
    check_normalization,
    lobe_value,
    lobe_weight,
    normalization_factor,
)
from axffit.brdf.sampling import (
    Uniforms,
    gaussian_slopes,
    mirrored,
    slope_density_to_direction,
    slope_gaussian,
    slope_normal,
)
from axffit.numerics import times_exp


def beckmann(half: HalfGeometry, alpha: Lobes, beta: Lobes, scale: Scalar) -> Lobes:
    """D · ``scale``, D = exp(-(h_x²/alpha² + h_y²/beta²) / h_z²) / (alpha beta h_z⁴): Beckmann's without its 1 / pi."""
    inverse_cosine_square = half.square / (half.z * half.z)
    peak = scale * (inverse_cosine_square * inverse_cosine_square) / (alpha * beta)
    return times_exp(peak, -slope_square(half, alpha, beta))


def v_groove_over_cosines(half: HalfGeometry) -> Scalar:
    """G / (i_z o_z), G = min(1, 2 h_z o_z / <h,o>, 2 h_z i_z / <h,o>).

    2 h_z / <h,o> = 4 h'_z / <h',h'>, so the lesser of the last two over i_z o_z is 4 h'_z / (<h',h'> max(i_z, o_z)).
    """
    shadowed = 4.0 * half.z / (half.square * jnp.maximum(half.i_z, half.o_z))
    return jnp.minimum(1.0 / (half.i_z * half.o_z), shadowed)


class CookTorrance(AbstractBRDF):
    """Cook & Torrance's lobe (ACM TOG 1(1), 1982) as the AxF SDK documents it.

        f = s / pi · D F G / (i_z o_z)

    with D and G of :func:`beckmann` and :func:`v_groove_over_cosines`; times 1/4 with ``normalization="microfacet"``.
    ``specular_color`` s (3,), linear RGB; ``roughness`` alpha, shape () or (2,), > 0 (the AxF model is isotropic, two
    values are the natural extension); ``fresnel`` F at <h, o>.
    """

    specular_color: RGB = eqx.field(converter=as_parameter)
    roughness: PerAxis = eqx.field(converter=as_parameter)
    fresnel: AbstractFresnel = NoFresnel()
    normalization: Normalization = eqx.field(static=True, default="sdk", kw_only=True)

    def __check_init__(self):
        check_normalization(self.normalization)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """D G / (pi i_z o_z), times the normalization."""
        half = half_geometry(wi, wo)
        scale = normalization_factor(self.normalization) / jnp.pi * v_groove_over_cosines(half)
        density = beckmann(half, *alpha_xy(self.roughness), scale)
        return lobe_value(self.specular_color, self.fresnel, half, density)

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Mirrored about a facet of Gaussian slopes."""
        return mirrored(wo, slope_normal(*gaussian_slopes(u, *alpha_xy(self.roughness))))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Density of that facet's mirror direction."""
        half = half_geometry(wi, wo)
        return slope_density_to_direction(slope_gaussian(half, *alpha_xy(self.roughness)), half)

    def weight(self, wo: Direction) -> Scalar:
        """Mean of s F at the mirror direction, times the albedo of the normalization."""
        return 4.0 * normalization_factor(self.normalization) * lobe_weight(self.specular_color, self.fresnel, wo)
