"""How much light a model reflects in all: integrals of f cos theta_i by the model's own sampling.

The uniforms are no random numbers but Sobol's sequence, so that a result is the same on every machine and its error
falls nearly as 1 / samples. Every sample is divided by the density it was drawn with, so a narrow lobe costs no more
than a broad one.
"""

from functools import singledispatch

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Channels, Direction, Directions
from axffit.brdf.base import AbstractBRDF, Framed, Sum
from axffit.brdf.clearcoat import ClearCoat
from axffit.frames import tangent_frame, to_local
from axffit.hemisphere import sample_cosine

SAMPLES = 2**14
"""Default number of samples; powers of two fill the sequence's cells evenly."""


def albedo(
    brdf: AbstractBRDF, wo: Directions, *, samples: int = SAMPLES, mirror: bool = False
) -> Float[Array, "... 3"]:
    """Directional-hemispherical reflectance: the integral of f(wi, wo) cos theta_i over all wi.

    Measured with the default number of samples: Ward, Cook-Torrance and GGX of roughness 1e-4 to 0.5, from 0 to 80
    degrees, come within 2e-4 of their converged value, relative; coated and many-lobed models within 3e-3, roughness 10
    within 4e-3. The derivatives are those of the integrand, the draws being held.

    Args:
        brdf: the model.
        wo: unit directions to the viewer, (..., 3).
        samples: draws a direction (static under ``jit``).
        mirror: whether to add what a coat reflects as a mirror, which ``evaluate`` leaves out: the outermost coat of
            every term of a sum.

    Returns:
        Linear RGB, (..., 3); 0 below the horizon.
    """
    uniforms = sobol_points(samples, 3, wo.dtype)

    def of_one(wo: Direction) -> RGB:
        total = jnp.mean(_estimates(brdf, jnp.broadcast_to(wo, (samples, 3)), uniforms), axis=0)
        if not mirror:
            return total
        return total + jnp.where(wo[2] > 0, mirror_reflectance(brdf, wo), 0.0)

    # One viewer after the other: thousands of draws fill the machine, and the memory of all at once would not be small.
    return jax.lax.map(of_one, wo.reshape(-1, 3)).reshape(wo.shape)


def mean_albedo(brdf: AbstractBRDF, *, samples: int = SAMPLES, mirror: bool = False) -> Float[Array, "3"]:
    """Mean of :func:`albedo` over wo, weighted by cos theta_o: the share of diffuse light that is reflected.

    Every sample draws its own wo. Measured with the default number of samples: typically within 5e-4 of the converged
    value, relative; 7e-3 at worst, for lobes whose energy lies at grazing angles.

    Args:
        brdf: the model.
        samples: draws (static under ``jit``).
        mirror: as in :func:`albedo`.

    Returns:
        Linear RGB, (3,).
    """
    uniforms = sobol_points(samples, 5, jnp.zeros(0).dtype)
    wo = sample_cosine(uniforms[:, 3:])
    total = jnp.mean(_estimates(brdf, wo, uniforms[:, :3]), axis=0)
    if not mirror:
        return total
    return total + jnp.mean(jax.vmap(lambda wo: mirror_reflectance(brdf, wo))(wo), axis=0)


_POLYNOMIALS = ((0, 0, ()), (1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)), (3, 2, (1, 1, 1)))
"""Degree, inner coefficients and first odd numbers of each dimension (Joe & Kuo, ACM TOMS 29(1), 2003)."""

_BITS = 24
"""Digits of a point: as many as float32 holds."""


def _direction_numbers(degree: int, coefficients: int, first: tuple[int, ...]) -> list[int]:
    """What each binary digit of an index adds (by exclusive or) to the point, in units of 2^-24."""
    numbers = [1] * _BITS if degree == 0 else list(first)
    for k in range(len(numbers), _BITS):
        number = numbers[k - degree] ^ (numbers[k - degree] << degree)
        for step in range(1, degree):
            if (coefficients >> (degree - 1 - step)) & 1:
                number ^= numbers[k - step] << step
        numbers.append(number)
    return [number << (_BITS - 1 - k) for k, number in enumerate(numbers)]


def sobol_points(count: int, dimensions: int, dtype: jnp.dtype) -> Float[Array, "{count} {dimensions}"]:
    """The first points of Sobol's sequence (1967) in up to five dimensions, each in the middle of its cell."""
    index = jnp.arange(count, dtype=jnp.uint32)
    power = max(count - 1, 1).bit_length()
    columns = []
    for polynomial in _POLYNOMIALS[:dimensions]:
        point = jnp.zeros_like(index)
        for digit, number in enumerate(_direction_numbers(*polynomial)[:power]):
            point = point ^ (((index >> digit) & 1) * number)
        columns.append(point.astype(dtype) * 0.5**_BITS + 0.5 ** (power + 1))
    return jnp.stack(columns, axis=-1)


def _estimates(brdf: AbstractBRDF, wo: Float[Array, "n 3"], uniforms: Float[Array, "n 3"]) -> Channels:
    """f cos theta_i / density of each draw; 0 for draws that carry no light."""
    # Held: the integral's derivative is that of the integrand, and draws that cross the horizon would not show theirs.
    wi = jax.lax.stop_gradient(brdf.sample(wo, uniforms))
    density = jax.lax.stop_gradient(brdf.pdf(wi, wo))
    lit = density > 0
    share = jnp.where(lit, wi[:, 2] / jnp.where(lit, density, 1.0), 0.0)
    return brdf.evaluate(wi, wo) * share[:, None]


@singledispatch
def mirror_reflectance(brdf: AbstractBRDF, wo: Direction) -> RGB:
    """Share of light that ``brdf`` reflects as a mirror towards ``wo``, (3,): 0 unless there is a coat."""
    return jnp.zeros_like(wo)


@mirror_reflectance.register
def _(brdf: Sum, wo: Direction) -> RGB:
    return sum((mirror_reflectance(term, wo) for term in brdf.terms), jnp.zeros_like(wo))


@mirror_reflectance.register
def _(brdf: Framed, wo: Direction) -> RGB:
    return mirror_reflectance(brdf.base, to_local(tangent_frame(brdf.normal, brdf.rotation), wo))


@mirror_reflectance.register
def _(brdf: ClearCoat, wo: Direction) -> RGB:
    if brdf.mirror_roughness is not None:
        return jnp.zeros_like(wo)
    wi, weight = brdf.mirror(wo)
    # Above the coat's normal, and not mirrored to below the surface.
    return jnp.where((wi[2] > 0) & (wo[2] > 0) & (jnp.sum(wi * brdf.normal) > 0), weight, jnp.zeros_like(wo))
