"""Fresnel factors: textbook angles, limits between forms, and gradients at the ends of F0."""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.brdf import ClearCoat, Fresnel1818, Lambert, NoFresnel, Schlick1994
from axffit.brdf.fresnel import dielectric_reflectance, schlick_reflectance


def cook_torrance_1981(c, f0):
    """Exact form of Cook & Torrance, 50 digits."""
    with mp.workdps(50):
        c, f0 = mp.mpf(c), mp.mpf(f0)
        n = (1 + mp.sqrt(f0)) / (1 - mp.sqrt(f0))
        g = mp.sqrt(n * n + c * c - 1)
        return ((g - c) / (g + c)) ** 2 * (1 + ((c * (g + c) - 1) / (c * (g - c) + 1)) ** 2) / 2


def one(value):
    return jnp.asarray(value, float)


@given(st.floats(1e-3, 1.0), st.floats(1e-9, 1 - 1e-9))
def test_exact_form_and_its_gradient_are_cook_and_torrances(c, f0):
    def factor(f0):
        return Fresnel1818(f0).factor(one(c), one(1 - c))

    value, slope = jax.value_and_grad(factor)(one(f0))
    assert float(value) == pytest.approx(float(cook_torrance_1981(c, f0)), rel=1e-12)
    with mp.workdps(50):
        expected = mp.diff(lambda x: cook_torrance_1981(c, x), mp.mpf(f0), h=mp.mpf(10) ** -20 * mp.mpf(f0))
    assert float(slope) == pytest.approx(float(expected), rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("c", [1.0, 0.7, 0.1])
def test_gradient_at_the_ends_of_f0_is_the_limit(c):
    slope = jax.grad(lambda f0: Fresnel1818(f0).factor(one(c), one(1 - c)))
    # At F0 = 0, F = F0 (1 + (2c² - 1)²) / (2 c⁴) to first order (n = 1 + 2 sqrt F0, from the amplitudes).
    assert float(slope(one(0.0))) == pytest.approx((1 + (2 * c * c - 1) ** 2) / (2 * c**4), rel=1e-14)
    near = float(slope(one(1 - 1e-9)))
    assert float(slope(one(1.0))) == pytest.approx(near, rel=1e-6)


@pytest.mark.parametrize("fresnel", [Fresnel1818, Schlick1994])
def test_f0_is_the_value_at_normal_incidence_and_grazing_is_total(fresnel):
    f0 = jnp.asarray([0.0, 0.04, 1.0])
    np.testing.assert_allclose(fresnel(f0).factor(one(1.0), one(0.0)), f0, rtol=1e-15)
    grazing = fresnel(f0[1:]).factor(one(1e-8), one(1.0 - 1e-8))
    np.testing.assert_allclose(grazing, 1.0, atol=1e-6)
    assert NoFresnel().factor(one(0.3), one(0.7)) == 1


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_total_reflectance_does_not_overflow(dtype):
    for c in (1.0, 0.5, 1e-4):
        value = Fresnel1818(jnp.asarray(1.0, dtype)).factor(jnp.asarray(c, dtype), jnp.asarray(1 - c, dtype))
        assert float(value) == pytest.approx(1.0, rel=1e-6)


def test_dielectric_at_brewsters_angle_and_for_light_from_inside():
    ior = 1.5
    cosine = np.cos(np.arctan(ior))
    # At Brewster's angle only the s-polarized half is reflected: ((n² - 1)/(n² + 1))² / 2.
    expected = ((ior**2 - 1) / (ior**2 + 1)) ** 2 / 2
    assert float(dielectric_reflectance(one(cosine), one(ior))) == pytest.approx(expected, rel=1e-13)
    assert float(dielectric_reflectance(one(1.0), one(1 / ior))) == pytest.approx(0.04, rel=1e-14)
    assert dielectric_reflectance(one(0.2), one(1 / ior)) == 1  # beyond the critical angle
    assert jax.grad(dielectric_reflectance, argnums=1)(one(0.2), one(1 / ior)) == 0


def test_coat_of_index_one_reflects_nothing_and_flatly():
    cosines = jnp.linspace(0.01, 1, 50)
    coat = ClearCoat(Lambert(jnp.ones(3)), 1.0)
    np.testing.assert_array_equal(coat.reflectance(cosines), 0)
    slope = jax.grad(lambda n: dielectric_reflectance(one(0.4), n))(one(1.0))
    assert slope == 0


def test_schlick_reflectance_from_the_index():
    assert float(schlick_reflectance(one(1.0), one(1.5))) == pytest.approx(0.04, rel=1e-14)
    assert float(schlick_reflectance(one(0.5), one(1.5))) == pytest.approx(0.04 + 0.96 / 32, rel=1e-14)
