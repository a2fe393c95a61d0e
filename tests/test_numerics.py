"""The guarded operations: values and, at the singular points, the values of the gradients."""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit import numerics

DTYPES = [jnp.float32, jnp.float64]


@pytest.mark.parametrize("dtype", DTYPES)
def test_floor_cosine_stops_at_the_limit_with_gradient_zero(dtype):
    limit = numerics.cosine_limit(jnp.dtype(dtype))
    cosines = jnp.asarray([0.0, limit / 2, limit, 2 * limit, 0.7], dtype)
    np.testing.assert_array_equal(numerics.floor_cosine(cosines), jnp.maximum(cosines, jnp.asarray(limit, dtype)))
    slopes = jax.vmap(jax.grad(numerics.floor_cosine))(cosines)
    np.testing.assert_array_equal(slopes, [0, 0, 0, 1, 1])


@pytest.mark.parametrize("dtype", DTYPES)
def test_safe_sqrt_has_the_declared_gradients(dtype):
    x = jnp.asarray([-1e-7, 0.0, 4.0], dtype)
    np.testing.assert_array_equal(numerics.safe_sqrt(x), [0, 0, 2])
    np.testing.assert_array_equal(jax.vmap(jax.grad(numerics.safe_sqrt))(x), [0, 0, 0.25])
    np.testing.assert_array_equal(jax.vmap(jax.grad(jax.grad(numerics.safe_sqrt)))(x), [0, 0, -1 / 32])


def test_safe_norm_is_flat_at_zero_and_radial_elsewhere():
    grad = jax.grad(numerics.safe_norm)
    np.testing.assert_array_equal(grad(jnp.zeros(3)), np.zeros(3))
    np.testing.assert_allclose(grad(jnp.asarray([3.0, 0.0, 4.0])), [0.6, 0, 0.8], rtol=1e-15)


def test_normalize_of_zero_is_the_normal_with_gradient_zero():
    np.testing.assert_array_equal(numerics.normalize(jnp.zeros(3)), [0, 0, 1])
    np.testing.assert_array_equal(jax.jacobian(numerics.normalize)(jnp.zeros(3)), np.zeros((3, 3)))


@given(st.floats(-8, 8), st.floats(-8, 8), st.floats(-150, 150))
def test_safe_atan2_is_atan2_with_its_gradient_at_every_scale(y, x, exponent):
    scale = 10.0**exponent
    y, x = y * scale, x * scale
    if (abs(x) < 1e-290 and abs(y) < 1e-290) or (x == 0 and y == 0):
        return
    assert numerics.safe_atan2(jnp.asarray(y), jnp.asarray(x)) == pytest.approx(np.arctan2(y, x), rel=1e-15)
    dy, dx = jax.grad(numerics.safe_atan2, argnums=(0, 1))(jnp.asarray(y), jnp.asarray(x))
    radius = np.hypot(x, y)
    np.testing.assert_allclose([dy * radius, dx * radius], [x / radius, -y / radius], rtol=1e-12, atol=1e-12)


def test_safe_atan2_at_the_origin_is_zero_with_gradient_zero():
    zero = jnp.asarray(0.0)
    assert numerics.safe_atan2(zero, zero) == 0
    assert jax.grad(numerics.safe_atan2, argnums=(0, 1))(zero, zero) == (0, 0)


def test_power5_is_the_fifth_power():
    x = jnp.linspace(-2.0, 2.0, 9)
    np.testing.assert_allclose(numerics.power5(x), np.asarray(x) ** 5, rtol=1e-15)


def test_compute_dtype_promotes_storage_types():
    half, brain, single, double = (jnp.ones(1, t) for t in (jnp.float16, jnp.bfloat16, jnp.float32, jnp.float64))
    assert numerics.compute_dtype(half, brain) == jnp.float32
    assert numerics.compute_dtype(half, single) == jnp.float32
    assert numerics.compute_dtype(half, double) == jnp.float64


def test_log_cosine_over_sine_square_is_smooth_at_the_normal():
    f = numerics.log_cosine_over_sine_square
    assert f(jnp.asarray(0.0)) == -0.5
    assert jax.grad(f)(jnp.asarray(0.0)) == -0.25
    for t in (1e-12, 9.99e-4, 1.001e-3, 0.3, 1e6):
        with mp.workdps(40):
            cosine2 = 1 / (1 + mp.mpf(t))
            expected = mp.log(cosine2) / 2 / (1 - cosine2)
        assert float(f(jnp.asarray(t))) == pytest.approx(float(expected), rel=1e-14)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 20.0, 1e5])
def test_positive_power_keeps_the_digits_near_one_and_stops_at_zero(exponent):
    n = jnp.asarray(exponent)
    for one_minus in (0.0, 1e-12, 1e-6, 0.3, 0.7):
        with mp.workdps(40):
            expected = (1 - mp.mpf(one_minus)) ** mp.mpf(exponent)
        got = numerics.positive_power(jnp.asarray(1 - one_minus), jnp.asarray(one_minus), n)
        assert float(got) == pytest.approx(float(expected), rel=1e-10, abs=1e-300)
    for base in (0.0, -0.4):
        value, slopes = jax.value_and_grad(numerics.positive_power, argnums=(0, 2))(
            jnp.asarray(base), jnp.asarray(1 - base), n
        )
        assert value == 0
        assert slopes == (0, 0)
