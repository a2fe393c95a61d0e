"""Rules of the integer formats, checked against Direct3D's text and exact arithmetic."""

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.textures import ROUNDINGS
from axffit.textures.unorm import Snorm, SrgbUnorm, Uint, Unorm, linear_to_srgb, srgb_to_linear

BITS = pytest.mark.parametrize("bits", [8, 16])


@BITS
@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_special_numbers(bits, rounding):
    top = 2**bits - 1
    x = np.array([np.nan, -np.inf, -0.1, -0.0, 0.0, 1.0, 1.1, np.inf])
    np.testing.assert_array_equal(Unorm(bits).encode(x, rounding), [0, 0, 0, 0, 0, top, top, top])


@BITS
def test_neighboring_floats_fall_on_either_side_of_every_rounding_boundary(bits):
    codec = Unorm(bits)
    codes = np.arange(codec.steps)
    boundary = (codes + 0.5) / codec.steps
    below = boundary.astype(np.float32)
    # 24 bits times 16 bits is exact in float64, so this comparison is.
    below = np.where(below.astype(np.float64) * codec.steps >= codes + 0.5, np.nextafter(below, np.float32(-1)), below)
    above = np.nextafter(below, np.float32(2))
    above = np.where(above.astype(np.float64) * codec.steps == codes + 0.5, np.nextafter(above, np.float32(2)), above)
    assert np.all(below.astype(np.float64) * codec.steps < codes + 0.5)
    assert np.all(above.astype(np.float64) * codec.steps > codes + 0.5)
    np.testing.assert_array_equal(codec.encode(below), codes)
    np.testing.assert_array_equal(codec.encode(above), codes + 1)


def test_ties_go_to_the_even_code():
    codec = Unorm(8)
    # 0.5 · 255 = 127.5 and 0.1 · 255 = 25.5 are exact ties in float64.
    np.testing.assert_array_equal(codec.encode(np.array([0.5, 0.1])), [128, 26])
    np.testing.assert_array_equal(codec.encode(np.array([0.3, 0.7])), [76, 178])


def test_a_float32_encoder_errs_by_more_than_half_a_step():
    # Why UNORM16 is encoded in float64: clamp(x)·65535 + 0.5, truncated, in float32.
    rng = np.random.default_rng(1)
    x = ((rng.integers(0, 65535, 400_000) + 0.5) / 65535).astype(np.float32)
    x = np.concatenate([np.nextafter(x, np.float32(0)), x, np.nextafter(x, np.float32(1))])
    exact = x.astype(np.float64) * 65535
    single = np.floor(x * np.float32(65535) + np.float32(0.5)).astype(np.float64)
    assert 0.5015 < np.max(np.abs(single - exact)) < 0.506
    assert np.max(np.abs(Unorm(16).encode(x).astype(np.float64) - exact)) <= 0.5


def test_device_rounding_reaches_six_tenths_of_a_step():
    x = (np.arange(255) + 0.59999) / 255
    error = np.abs(Unorm(8).decode(Unorm(8).encode(x, "device")) - x) * 255
    np.testing.assert_allclose(error, 0.59999, atol=1e-9)


def test_the_srgb_curve_is_the_standard_one():
    codes = np.arange(256) / 255
    np.testing.assert_allclose(linear_to_srgb(srgb_to_linear(codes)), codes, atol=1e-7)
    # IEC 61966-2-1: 18 % gray is code 118 (117.6), 50 % is 188 (187.5).
    np.testing.assert_array_equal(SrgbUnorm(8).encode(np.array([0.18, 0.5, 0.0, 1.0])), [118, 188, 0, 255])
    assert srgb_to_linear(np.array([0.04045]))[0] == 0.04045 / 12.92


@pytest.mark.parametrize("value", [300.0, -1.0, 2.5, np.nan])
def test_an_integer_format_never_wraps(value):
    with pytest.raises(InputError, match="give whole numbers from 0 to 255"):
        Uint(8).encode(np.array([1.0, value]))


@BITS
def test_both_lowest_codes_of_snorm_are_minus_one(bits):
    codec = Snorm(bits)
    half = 2 ** (bits - 1)
    np.testing.assert_array_equal(codec.decode(np.array([half, half + 1, 0, half - 1])), [-1, -1, 0, 1])
    np.testing.assert_array_equal(codec.encode(np.array([-1.0, -2.0, 1.0])), [half + 1, half + 1, half - 1])


def test_snorm_rounds_negative_numbers_as_the_mode_says():
    x = np.array([-1.3, -1.5, -1.7, -2.5, 1.3, 1.5, 1.7, 2.5]) / 127
    expected = {
        "nearest_even": [-1, -2, -2, -2, 1, 2, 2, 2],
        "toward_zero": [-1, -1, -1, -2, 1, 1, 1, 2],
        "floor": [-2, -2, -2, -3, 1, 1, 1, 2],
        "device": [-1, -2, -2, -3, 1, 1, 2, 2],
    }
    for rounding, steps in expected.items():
        np.testing.assert_array_equal(Snorm(8).encode(x, rounding).view(np.int8), steps)
