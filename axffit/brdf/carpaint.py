"""AxF's car paint, CarPaint2, below its coat (Rump et al., CGF 27(2), 2008; Rump, Sarlette & Klein, VMV 2009)."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.color_table import ColorTable, white_color_table
from axffit.brdf.cook_torrance import beckmann, v_groove_over_cosines
from axffit.brdf.flakes import Flakes
from axffit.brdf.fresnel import schlick
from axffit.brdf.geometry import HalfGeometry, half_angles, half_geometry
from axffit.brdf.sampling import (
    Uniforms,
    choose,
    cosine_density,
    cosine_draw,
    gaussian_slopes,
    mirrored,
    shares,
    slope_density_to_direction,
    slope_gaussian,
    slope_normal,
)
from axffit.numerics import safe_atan2

MAX_LOBES = 4


class CarPaint(AbstractBRDF):
    """The base of a car paint: brightness times color plus flakes, all directions below the coat.

        f = chi(theta_h, theta_d) b + Xi(uv, theta_h, theta_d)
        b = a / pi + sum_k s_k / pi · D_k(h) F_k(<h,o>) G / (i_z o_z)

    D_k, G of Cook-Torrance with spread alpha_k, F_k = F0_k + (1 - F0_k)(1 - <h,o>)⁵. A whole paint is
    ``ClearCoat(base=CarPaint(...), ior=...)``.

    Attributes:
        diffuse: a, AxF ``CT_diffuse``, ().
        coefficients: s_k, AxF ``CT_coeffs``, (K,), 1 <= K <= 4.
        f0: F0_k, AxF ``CT_F0s``, (K,), in [0, 1].
        spreads: alpha_k, AxF ``CT_spreads``, (K,), > 0; up to 8 in real paints.
        color_table: chi, AxF ``BRDFcolors``; white by default.
        flakes: Xi, AxF ``BTFflakes``, at one place of the surface, or None.
    """

    diffuse: Scalar = eqx.field(converter=as_parameter)
    coefficients: Float[Array, " lobes"] = eqx.field(converter=as_parameter)
    f0: Float[Array, " lobes"] = eqx.field(converter=as_parameter)
    spreads: Float[Array, " lobes"] = eqx.field(converter=as_parameter)
    color_table: ColorTable = eqx.field(default_factory=white_color_table)
    flakes: Flakes | None = None

    def __check_init__(self):
        counts = (self.coefficients.shape[-1], self.f0.shape[-1], self.spreads.shape[-1])
        if len(set(counts)) != 1 or not 1 <= counts[0] <= MAX_LOBES:
            raise ValueError(
                f"coefficients, f0 and spreads have {counts[0]}, {counts[1]} and {counts[2]} lobes: "
                f"give all three the same length, 1 to {MAX_LOBES}"
            )

    def with_flakes(self, flakes: Flakes | None) -> "CarPaint":
        """The same paint with other flakes, or with none."""
        return CarPaint(self.diffuse, self.coefficients, self.f0, self.spreads, self.color_table, flakes)

    def brightness(self, half: HalfGeometry) -> Scalar:
        """b, in 1/sr, without the color."""
        fresnel = schlick(self.f0, half.cos_d, half.one_minus_cos_d)
        shape = beckmann(half, self.spreads, self.spreads, v_groove_over_cosines(half))
        return (self.diffuse + jnp.sum(self.coefficients * fresnel * shape)) / jnp.pi

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """Brightness times color, plus flakes."""
        half = half_geometry(wi, wo)
        theta_h = safe_atan2(*half_angles(half))
        theta_d = safe_atan2(half.sin_d, half.cos_d)
        value = self.color_table.lookup(theta_h, theta_d) * self.brightness(half)
        return value if self.flakes is None else value + self.flakes.lookup(theta_h, theta_d)

    def _lobe_weights(self, wo: Direction) -> Float[Array, " lobes"]:
        """Rough albedo of each lobe: 4 s F at the mirror direction, less what a broad lobe loses."""
        fresnel = schlick(self.f0, wo[2], 1.0 - wo[2])
        return 4.0 * self.coefficients * fresnel / (1.0 + self.spreads * self.spreads)

    def _shares(self, wo: Direction) -> Float[Array, " terms"]:
        """Shares of the lobes and, last, of the cosine: diffuse part, flakes, and what is broader than a cosine.

        The slopes of a broad lobe lie almost all at the horizon, where masking leaves nothing of it.
        """
        lobes = self._lobe_weights(wo)
        broad = self.spreads * self.spreads / (1.0 + self.spreads * self.spreads)
        cosine = self.diffuse + jnp.sum((0.1 + broad) * lobes)
        return shares(jnp.concatenate([(1.0 - broad) * lobes, cosine[None]]))

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """A draw of one lobe, mirrored about a facet of Gaussian slopes, or of the cosine."""
        index, u = choose(u, self._shares(wo))
        lobe = jnp.minimum(index, self.spreads.shape[0] - 1)
        slopes = gaussian_slopes(u, self.spreads[lobe], self.spreads[lobe])
        return jnp.where(index == self.spreads.shape[0], cosine_draw(u), mirrored(wo, slope_normal(*slopes)))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Mixture of the lobes' densities and the cosine's."""
        half, share = half_geometry(wi, wo), self._shares(wo)
        lobes = slope_density_to_direction(slope_gaussian(half, self.spreads, self.spreads), half)
        return jnp.sum(share[:-1] * lobes) + share[-1] * cosine_density(wi)

    def weight(self, wo: Direction) -> Scalar:
        """Diffuse part and lobes at the mirror direction."""
        return self.diffuse + jnp.sum(self._lobe_weights(wo))
