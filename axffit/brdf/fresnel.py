"""Fresnel factors: how reflectance grows from F0 towards grazing angles.

A lobe holds one as a field and asks for F(c), c = <h, o> the cosine of the difference angle. The exact dielectric
form is written in m = 1 / n:

    g_m = sqrt((1 - m²) + m² c²)
    F = (1 - m²)² / 2 [ 1 / (m c + g_m)⁴ + ((c² (1 + m²) - m²) / (c + m g_m)²)² ]

the mean of the squared Fresnel amplitudes after (1 - m²) is taken out of both. Nothing cancels for n -> 1, nothing
overflows for n -> infinity, and with F0 as the parameter (1 - m²)² = 16 F0 / (1 + sqrt F0)⁴ leaves no square root
with an infinite slope at F0 = 0.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit.brdf.base import as_parameter
from axffit.numerics import power5, safe_sqrt

Reflectance = Float[Array, "..."]
"""Shape () or (3,): one value for all channels, or one a channel."""


class AbstractFresnel(eqx.Module):
    """Fresnel factor F of a lobe."""

    @abc.abstractmethod
    def factor(self, cos_d: Float[Array, ""], one_minus_cos_d: Float[Array, ""]) -> Reflectance:
        """F at cosine ``cos_d``; ``one_minus_cos_d`` is 1 - cos_d without cancellation. Shape () or (3,)."""


class NoFresnel(AbstractFresnel):
    """F = 1 (AxF 1.0 has no Fresnel; the same as F0 = 1)."""

    def factor(self, cos_d: Float[Array, ""], one_minus_cos_d: Float[Array, ""]) -> Reflectance:
        """The factor 1."""
        return jnp.ones_like(cos_d)


class Schlick1994(AbstractFresnel):
    """F = F0 + (1 - F0) (1 - c)⁵ (Schlick, CGF 13(3), 1994).

    ``f0``: reflectance at normal incidence in [0, 1], shape () or (3,).
    """

    f0: Reflectance = eqx.field(converter=as_parameter)

    def factor(self, cos_d: Float[Array, ""], one_minus_cos_d: Float[Array, ""]) -> Reflectance:
        """The factor."""
        return schlick(self.f0, cos_d, one_minus_cos_d)


class Fresnel1818(AbstractFresnel):
    """Exact unpolarized reflectance of a dielectric (Fresnel; in Cook & Torrance 1982's form), by its F0.

    n = (1 + sqrt F0) / (1 - sqrt F0); equals ½ ((g-c)/(g+c))² (1 + ((c(g+c)-1)/(c(g-c)+1))²), g² = n² + c² - 1.

    ``f0``: reflectance at normal incidence in [0, 1], shape () or (3,).
    """

    f0: Reflectance = eqx.field(converter=as_parameter)

    def factor(self, cos_d: Float[Array, ""], one_minus_cos_d: Float[Array, ""]) -> Reflectance:
        """Exact F; at F0 = 0 the gradient in F0 is the bracket, since F = F0 · (smooth in sqrt F0)."""
        root = safe_sqrt(self.f0)
        m = (1.0 - root) / (1.0 + root)
        square = (1.0 + root) * (1.0 + root)
        return 16.0 * self.f0 / (square * square) * _dielectric_bracket(cos_d, m, 4.0 * root / square)


def _dielectric_bracket(c: Float[Array, "..."], m: Reflectance, one_minus_m2: Reflectance) -> Reflectance:
    """Half of the bracket of the module's formula; 1 - m² is given, since it cancels where n is near 1."""
    m2, c2 = m * m, c * c
    g = safe_sqrt(one_minus_m2 + m2 * c2)
    s = m * c + g
    p = c + m * g
    s2 = s * s
    ratio = (c2 * (1.0 + m2) - m2) / (p * p)
    return 0.5 * (1.0 / (s2 * s2) + ratio * ratio)


def dielectric_reflectance(cosine: Float[Array, "..."], ior: Float[Array, "..."]) -> Float[Array, "..."]:
    """Exact unpolarized Fresnel reflectance of a smooth dielectric of index ``ior`` > 0 against air.

    ``cosine`` > 0 is measured outside. Exactly 0 for ``ior`` = 1; 1 where ``ior`` < 1 reflects totally.
    """
    m, total = _inverse_index(cosine, ior)
    one_minus_m2 = (1.0 - m) * (1.0 + m)
    value = one_minus_m2 * one_minus_m2 * _dielectric_bracket(cosine, m, one_minus_m2)
    return jnp.where(total, jnp.ones_like(value), value)


def dielectric_transmittance(cosine: Float[Array, "..."], ior: Float[Array, "..."]) -> Float[Array, "..."]:
    """1 - F of :func:`dielectric_reflectance`, in a form that keeps its digits where F is near 1.

    2 m c g (1 / (m c + g)² + 1 / (c + m g)²) with m = 1 / n and g the cosine inside; 0 at total reflection.
    """
    m, total = _inverse_index(cosine, ior)
    g = safe_sqrt((1.0 - m) * (1.0 + m) + m * m * cosine * cosine)
    s, p = m * cosine + g, cosine + m * g
    value = 2.0 * m * cosine * g * (1.0 / (s * s) + 1.0 / (p * p))
    return jnp.where(total, jnp.zeros_like(value), value)


def _inverse_index(cosine: Float[Array, "..."], ior: Float[Array, "..."]) -> tuple[Array, Array]:
    """m = 1 / n, and where an index below 1 reflects totally; m is 1 there."""
    m = 1.0 / ior
    total = (1.0 - m) * (1.0 + m) + m * m * cosine * cosine <= 0
    return jnp.where(total, jnp.ones_like(m), m), total


def schlick(f0: Array, cosine: Array, one_minus_cosine: Array) -> Array:
    """F0 + (1 - F0) x⁵ with x = 1 - c, as x⁵ + F0 (1 - x⁵): so the slope in F0 keeps its digits near x = 1, too."""
    return power5(one_minus_cosine) + f0 * _one_minus_power5(cosine, one_minus_cosine)


def _one_minus_power5(cosine: Array, one_minus_cosine: Array) -> Array:
    """1 - x⁵ = c (1 + x + x² + x³ + x⁴), x = 1 - c."""
    x = one_minus_cosine
    return cosine * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x))))


def schlick_reflectance(cosine: Float[Array, "..."], ior: Float[Array, "..."]) -> Float[Array, "..."]:
    """Schlick's approximation with F0 = ((n-1)/(n+1))²."""
    root = (ior - 1.0) / (ior + 1.0)
    return schlick(root * root, cosine, 1.0 - cosine)


def schlick_transmittance(cosine: Float[Array, "..."], ior: Float[Array, "..."]) -> Float[Array, "..."]:
    """1 - F of :func:`schlick_reflectance`: (1 - F0) (1 - (1 - c)⁵), 1 - F0 = 4 n / (n + 1)²."""
    return 4.0 * ior / ((ior + 1.0) * (ior + 1.0)) * _one_minus_power5(cosine, 1.0 - cosine)
