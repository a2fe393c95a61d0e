"""Laws of every codec: monotone, idempotent, within its proven bound, which is no looser than it must be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.errors import InputError
from axffit.textures import ROUNDINGS
from axffit.textures.codec import check_rounding
from axffit.textures.floats import SINGLE
from tests.textures.codecs import CODECS, REAL_CODECS, finite_codes

every_codec = pytest.mark.parametrize("name", CODECS)
real_codec = pytest.mark.parametrize("name", REAL_CODECS)
every_rounding = pytest.mark.parametrize("rounding", ROUNDINGS)


def boundary_numbers(codec):
    """Numbers at, just below and just above every point where an encoder may change its mind."""
    numbers = codec.decode(finite_codes(codec))
    low, high = numbers[:-1], numbers[1:]
    if codec is SINGLE:
        low = numbers[:-1]
        high = np.nextafter(low.astype(np.float32), np.float32(np.inf)).astype(np.float64)
    points = [low + f * (high - low) for f in (0.0, 0.4, 0.5, 0.6, 1.0)]
    around = [np.nextafter(p, direction) for p in points for direction in (-np.inf, np.inf)]
    near = [p + s * 1e-6 * (high - low) for p in points for s in (-1, 1)]
    every = np.concatenate([*points, *around, *near])
    return every[~codec.outside(every)]


@every_rounding
@every_codec
def test_decoding_then_encoding_gives_the_code_back(name, rounding):
    codec = CODECS[name]()
    codes = finite_codes(codec)
    numbers = codec.decode(codes)
    np.testing.assert_array_equal(codec.decode(codec.encode(numbers, rounding)), numbers)
    same = codec.encode(numbers, rounding) == codes
    # -0 and +0 are one number; every other code comes back itself.
    assert np.all(same | (numbers == 0)), f"codes {codes[~same]} change"


@every_rounding
@real_codec
def test_error_stays_within_its_bound_at_every_boundary(name, rounding):
    codec = REAL_CODECS[name]()
    x = boundary_numbers(codec)
    error = np.abs(codec.decode(codec.encode(x, rounding)) - x)
    bound = codec.error_bound(x, rounding)
    worst = np.argmax(error - bound)
    assert error[worst] <= bound[worst], f"{x[worst]!r} errs by {error[worst]} > {bound[worst]}"


@every_rounding
@real_codec
def test_the_bound_is_no_looser_than_it_must_be(name, rounding):
    codec = REAL_CODECS[name]()
    x = boundary_numbers(codec)
    error = np.abs(codec.decode(codec.encode(x, rounding)) - x)
    bound = codec.error_bound(x, rounding)
    # One device errs downward only; behind a curve its upward errors, which the bound must cover, would be larger.
    looseness = 1.25 if (name, rounding) == ("SRGB8", "device") else 1.05
    assert np.max(error / bound) > 1 / 1.05
    assert bound.max() <= looseness * error.max()


@every_rounding
@real_codec
def test_encoding_is_monotone(name, rounding):
    codec = REAL_CODECS[name]()
    x = np.sort(boundary_numbers(codec))
    decoded = codec.decode(codec.encode(x, rounding))
    assert np.all(np.diff(decoded) >= 0)


@every_rounding
@real_codec
@given(fraction=st.floats(-1.0, 1.0), exponent=st.integers(-160, 0))
def test_bound_holds_for_every_number_in_range(name, rounding, fraction, exponent):
    codec = REAL_CODECS[name]()
    x = np.array([fraction * 2.0**exponent * codec.highest])
    x = np.maximum(x, codec.lowest)
    error = np.abs(codec.decode(codec.encode(x, rounding)) - x)
    assert np.all(error <= codec.error_bound(x, rounding))


@every_codec
def test_outside_is_what_encoding_cannot_hold(name):
    codec = CODECS[name]()
    beyond = np.nextafter(codec.highest, np.inf) * (1 + 1e-9)
    below = codec.lowest - 1e-9 if codec.lowest == 0 else codec.lowest * (1 + 1e-9)
    got = codec.outside(np.array([codec.lowest, codec.highest, beyond, below, np.nan, np.inf]))
    np.testing.assert_array_equal(got, [False, False, True, True, True, True])


def test_an_unknown_rounding_is_refused_by_name():
    with pytest.raises(InputError, match="unknown rounding 'up'; allowed: nearest_even, toward_zero, floor, device"):
        check_rounding("up")


def test_the_codes_of_a_wide_format_are_not_listed():
    with pytest.raises(ValueError, match="too many codes"):
        SINGLE.all_codes()
