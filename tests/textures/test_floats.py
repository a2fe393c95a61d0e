"""Half and single precision: every code and every midpoint between neighbors, in each rounding mode."""

import struct

import numpy as np
import pytest

from axffit.textures.floats import HALF, SINGLE

POSITIVE = np.arange(0x7C00, dtype=np.uint16)
"""Bit patterns of the finite halves from +0 up."""


def test_decoding_agrees_with_the_struct_module():
    codes = HALF.all_codes()
    expected = np.array(struct.unpack(f"<{codes.size}e", codes.astype("<u2").tobytes()))
    np.testing.assert_array_equal(HALF.decode(codes), expected)


@pytest.mark.parametrize("source", [np.float32, np.float64])
@pytest.mark.parametrize("sign", [1, -1])
def test_both_sides_of_every_midpoint(source, sign):
    low, high = POSITIVE[:-1], POSITIVE[1:]
    middle = (HALF.decode(low) + HALF.decode(high)) / 2
    middle = (sign * middle).astype(source)
    bit = np.uint16(0x8000 if sign < 0 else 0)
    even = np.where(low % 2 == 0, low, high)
    outward = np.nextafter(middle, source(sign * np.inf))
    inward = np.nextafter(middle, source(0))
    np.testing.assert_array_equal(HALF.encode(middle), even | bit)
    np.testing.assert_array_equal(HALF.encode(outward), high | bit)
    np.testing.assert_array_equal(HALF.encode(inward), low | bit)
    for x in (middle, outward, inward):
        for rounding in ("toward_zero", "device"):
            np.testing.assert_array_equal(HALF.encode(x, rounding), low | bit)
        np.testing.assert_array_equal(HALF.encode(x, "floor"), (low if sign > 0 else high) | bit)


def test_bounds_are_the_documented_ones():
    x = np.array([1.0, 1.999, 2.0**-14, 2.0**-15, 0.0, 65504.0])
    np.testing.assert_array_equal(HALF.error_bound(x), [2**-11, 2**-11, 2**-25, 2**-25, 2**-25, 16.0])
    np.testing.assert_array_equal(HALF.error_bound(x, "toward_zero"), 2 * HALF.error_bound(x))
    normal = np.logspace(-4, 4, 1001)
    assert np.all(HALF.error_bound(normal) <= 2.0**-11 * normal)
    assert np.all(HALF.error_bound(normal, "toward_zero") <= 2.0**-10 * normal)


def test_overflow_infinity_and_nan():
    x = np.array([65519.99, 65520.0, 1e9, -1e9, np.inf, -np.inf, np.nan])
    inf = np.inf
    np.testing.assert_array_equal(HALF.decode(HALF.encode(x)), [65504, inf, inf, -inf, inf, -inf, np.nan])
    np.testing.assert_array_equal(
        HALF.decode(HALF.encode(x, "toward_zero")), [65504, 65504, 65504, -65504, inf, -inf, np.nan]
    )
    np.testing.assert_array_equal(HALF.decode(HALF.encode(x, "floor")), [65504, 65504, 65504, -inf, inf, -inf, np.nan])


def test_subnormals_survive():
    tiny = np.array([2.0**-24, 3 * 2.0**-24, 0.4 * 2.0**-24, -0.4 * 2.0**-24])
    np.testing.assert_array_equal(HALF.decode(HALF.encode(tiny)), [2.0**-24, 3 * 2.0**-24, 0, 0])
    np.testing.assert_array_equal(HALF.decode(HALF.encode(tiny, "floor")), [2.0**-24, 3 * 2.0**-24, 0, -(2.0**-24)])


def test_single_keeps_every_half_and_every_single():
    halves = HALF.decode(POSITIVE).astype(np.float16)
    np.testing.assert_array_equal(SINGLE.decode(SINGLE.encode(halves)), halves.astype(np.float64))
    singles = np.random.default_rng(2).normal(size=1000).astype(np.float32)
    for rounding in ("nearest_even", "floor"):
        np.testing.assert_array_equal(SINGLE.decode(SINGLE.encode(singles, rounding)), singles.astype(np.float64))


def test_whole_numbers_are_taken_too():
    np.testing.assert_array_equal(HALF.decode(HALF.encode(np.array([1, 2, 2049]))), [1.0, 2.0, 2048.0])


def test_a_signaling_nan_decodes_without_a_warning():
    assert np.isnan(SINGLE.decode(np.array([0x7F800001], np.uint32))).all()


def test_halves_are_compared_with_the_ends_of_single_precision():
    assert not SINGLE.outside(np.array([1.0, -65504.0], np.float16)).any()
    assert SINGLE.outside(np.array([np.nan, np.inf], np.float16)).all()
