"""Every operation of axffit that is singular somewhere, each with its declared value and gradient there.

Formulas elsewhere are written so that they need as few of these as possible; what is left stands here, and
``tests/test_numerics.py`` asserts the *value* of each gradient at its singular point.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Inexact

LOWEST_ROUGHNESS = 1e-4
"""Smallest roughness of a lobe; a decoded texel of 0 is floored here and counted by whoever decodes it."""


def compute_dtype(*arrays: Inexact[Array, "..."]) -> jnp.dtype:
    """Floating type of a computation over ``arrays``: float64 if any of them is, otherwise float32.

    Half and bfloat16 are storage types: they are promoted.
    """
    return jnp.dtype(jnp.float64 if any(array.dtype == jnp.float64 for array in arrays) else jnp.float32)


def cosine_limit(dtype: jnp.dtype) -> float:
    """Smallest cosine that may stand in a denominator: 1e-8 in float64, 1e-4 in float32."""
    return 1e-8 if dtype == jnp.float64 else 1e-4


def floor_cosine(cosine: Float[Array, "..."]) -> Float[Array, "..."]:
    """``max(cosine, cosine_limit)`` for cosines in denominators; gradient 1 above the limit, 0 at and below it.

    Several models grow without bound towards the horizon; this is where they stop.
    """
    limit = cosine_limit(cosine.dtype)
    return jnp.where(cosine > limit, cosine, jnp.asarray(limit, cosine.dtype))


@jax.custom_jvp
def safe_sqrt(x: Float[Array, "..."]) -> Float[Array, "..."]:
    """``sqrt(max(x, 0))``; gradient 1 / (2 sqrt x) for x > 0 and 0 for x <= 0.

    Right where the square root enters multiplied by something that vanishes at 0 at least as fast, which every
    caller's docstring argues, or where x < 0 is rounding of 0.
    """
    return jnp.sqrt(jnp.maximum(x, jnp.zeros_like(x)))


@safe_sqrt.defjvp
def _safe_sqrt_jvp(primals, tangents):
    (x,), (x_dot,) = primals, tangents
    root = safe_sqrt(x)
    positive = root > 0
    slope = jnp.where(positive, 0.5 / jnp.where(positive, root, 1.0), 0.0)
    return root, slope * x_dot


def safe_norm(v: Float[Array, "... n"]) -> Float[Array, "..."]:
    """Euclidean length along the last axis; gradient v / |v|, and 0 at v = 0."""
    return safe_sqrt(jnp.sum(v * v, axis=-1))


def normalize(v: Float[Array, "... 3"]) -> Float[Array, "... 3"]:
    """``v / |v|``; the zero vector becomes (0, 0, 1), with gradient 0."""
    square = jnp.sum(v * v, axis=-1, keepdims=True)
    positive = square > 0
    up = jnp.zeros_like(v).at[..., 2].set(1.0)
    return jnp.where(positive, v * jax.lax.rsqrt(jnp.where(positive, square, 1.0)), up)


@jax.custom_jvp
def safe_atan2(y: Float[Array, "..."], x: Float[Array, "..."]) -> Float[Array, "..."]:
    """``atan2(y, x)``; at the origin, where the angle is undefined, value 0 and gradient 0."""
    origin = (x == 0) & (y == 0)
    return jnp.where(origin, 0.0, jnp.arctan2(y, jnp.where(origin, 1.0, x)))


@safe_atan2.defjvp
def _safe_atan2_jvp(primals, tangents):
    (y, x), (y_dot, x_dot) = primals, tangents
    # Scaled by the larger side: y² + x² under- or overflows long before the angle loses meaning.
    scale = jnp.maximum(jnp.abs(x), jnp.abs(y))
    regular = scale > 0
    scale = jnp.where(regular, scale, 1.0)
    sx, sy = x / scale, y / scale
    square = jnp.where(regular, sx * sx + sy * sy, 1.0)
    slope = (sx * (y_dot / scale) - sy * (x_dot / scale)) / square
    return safe_atan2(y, x), jnp.where(regular, slope, 0.0)


def power5(x: Float[Array, "..."]) -> Float[Array, "..."]:
    """``x^5`` as three products: a ``pow`` costs as much as ten of them."""
    square = x * x
    return square * square * x


def times_exp(factor: Float[Array, "..."], exponent: Float[Array, "..."]) -> Float[Array, "..."]:
    """``factor · exp(exponent)`` for exponent <= 0, factor >= 0 of equal shapes.

    The power is multiplied in by halves: by itself it may be too small for a float where the product is not.
    """
    root = jnp.exp(0.5 * exponent)
    return (root * factor) * root


def log_cosine_over_sine_square(tan2: Float[Array, "..."]) -> Float[Array, "..."]:
    """``log(cos) / sin²`` of an angle by its squared tangent: -½ log1p(tan²) (1 + tan²) / tan².

    Smooth, with value -1/2 and slope -1/4 in tan² at 0, where the quotient is continued by its series.
    """
    small = tan2 < 1e-3
    series = -0.5 * (1.0 + tan2 * (0.5 - tan2 * (1 / 6 - tan2 * (1 / 12 - tan2 * (1 / 20 - tan2 / 30)))))
    safe = jnp.where(small, 1.0, tan2)
    return jnp.where(small, series, -0.5 * jnp.log1p(safe) * (1.0 + safe) / safe)


def positive_power(
    base: Float[Array, "..."], one_minus_base: Float[Array, "..."], exponent: Float[Array, "..."]
) -> Float[Array, "..."]:
    """``max(0, base)^exponent`` for base <= 1, exponent >= 0; 0, with gradient 0, wherever base <= 0.

    ``one_minus_base`` carries the digits of a base near 1, which large exponents need.
    """
    positive = base > 0
    near = base > 0.5
    log_near = jnp.log1p(-jnp.where(near, one_minus_base, 0.0))
    log_far = jnp.log(jnp.where(positive & ~near, base, 1.0))
    return jnp.where(positive, jnp.exp(exponent * jnp.where(near, log_near, log_far)), 0.0)
