"""Laws of every codec: monotone, idempotent, within its proven bound, which is no looser than it must be."""

import functools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.errors import InputError
from axffit.textures import ROUNDINGS
from axffit.textures.codec import check_rounding
from axffit.textures.floats import SINGLE
from axffit.textures.worst_case import finite_numbers, neighbors, straddles, worst_case
from tests.textures.codecs import CODECS, REAL_CODECS

# Three laws look at the same cells.
worst_case = functools.cache(worst_case)

every_codec = pytest.mark.parametrize("name", CODECS)
real_codec = pytest.mark.parametrize("name", REAL_CODECS)
every_rounding = pytest.mark.parametrize("rounding", ROUNDINGS)


def finite_codes(codec):
    """Every code of a finite number, the number ascending; of binary32 a sample of every binade."""
    codes = codec.encode(finite_numbers(codec)) if codec.bits > 16 else codec.all_codes()
    numbers = codec.decode(codes)
    return codes[np.isfinite(numbers)], numbers[np.isfinite(numbers)]


@every_rounding
@every_codec
def test_decoding_then_encoding_gives_the_number_and_the_code_back(name, rounding):
    # More than what `device` and `floor` promise: in float64 no decode rounds a number below itself.
    codec = CODECS[name]()
    codes, numbers = finite_codes(codec)
    again = codec.encode(numbers, rounding)
    np.testing.assert_array_equal(codec.decode(again), numbers)
    # +0 and -0, both codes of -1 (SNORM) and mantissas that could be doubled (RGB9E5) are one number with two codes.
    _, inverse, count = np.unique(numbers, return_inverse=True, return_counts=True)
    only = count[inverse] == 1
    np.testing.assert_array_equal(again[only], codes[only])


@every_rounding
@real_codec
def test_the_error_stays_within_its_bound_at_both_floats_beside_every_boundary(name, rounding):
    worst = worst_case(REAL_CODECS[name].make(), rounding)
    excess = np.argmax(worst.errors - worst.bounds)
    assert worst.holds, f"{worst.numbers[excess]!r} errs by {worst.errors[excess]} > {worst.bounds[excess]}"


@every_rounding
@real_codec
def test_the_bound_is_no_looser_than_it_must_be_in_any_cell(name, rounding):
    worst = worst_case(REAL_CODECS[name].make(), rounding)
    assert worst.bounds.max() <= 1.05 * worst.errors.max()
    assert worst.ratio <= 1.05


@every_rounding
@real_codec
def test_straddles_are_neighboring_floats_on_either_side(name, rounding):
    codec = REAL_CODECS[name].make()
    low, high = neighbors(codec)
    below, above = straddles(codec, rounding)
    np.testing.assert_array_equal(np.nextafter(below, np.inf), above)
    np.testing.assert_array_equal(codec.decode(codec.encode(below, rounding)), low)
    np.testing.assert_array_equal(codec.decode(codec.encode(above, rounding)), high)


@every_rounding
@real_codec
def test_encoding_is_monotone_across_every_boundary(name, rounding):
    codec = REAL_CODECS[name].make()
    low, high = neighbors(codec)
    below, above = straddles(codec, rounding)
    x = np.sort(np.concatenate([low, high, below, above, (low + below) / 2, (above + high) / 2]))
    assert np.all(np.diff(codec.decode(codec.encode(x, rounding))) >= 0)


def in_range(codec):
    """Finite numbers of a codec's range, float64's subnormals included; magnitudes spread over its binades too."""
    scaled = st.builds(
        lambda f, e: max(f * 2.0**e * codec.highest, codec.lowest), st.floats(-1, 1), st.integers(-160, 0)
    )
    return st.floats(codec.lowest, codec.highest) | scaled


@every_rounding
@real_codec
@given(data=st.data())
def test_the_bound_holds_for_every_number_in_range(name, rounding, data):
    codec = REAL_CODECS[name].make()
    x = np.array([data.draw(in_range(codec))])
    error = np.abs(codec.decode(codec.encode(x, rounding)) - x)
    assert np.all(error <= codec.error_bound(x, rounding))


@every_rounding
@real_codec
@given(data=st.data())
def test_encoding_is_monotone_and_idempotent(name, rounding, data):
    codec = REAL_CODECS[name].make()
    x = np.sort(np.array([data.draw(in_range(codec)), data.draw(in_range(codec))]))
    decoded = codec.decode(codec.encode(x, rounding))
    assert decoded[0] <= decoded[1]
    np.testing.assert_array_equal(codec.decode(codec.encode(decoded, rounding)), decoded)


@every_rounding
@real_codec
def test_nan_infinities_and_numbers_out_of_range(name, rounding):
    case = REAL_CODECS[name]
    codec = case.make()
    got = codec.decode(codec.encode(np.array([np.nan, -np.inf, np.inf]), rounding))
    np.testing.assert_array_equal(got, [case.nan, *case.infinities])
    if case.beyond is not None:
        far = np.array([np.nextafter(codec.lowest, -np.inf), -1e30, np.nextafter(codec.highest, np.inf), 1e30])
        got = codec.decode(codec.encode(far, rounding))
        np.testing.assert_array_equal(got, np.repeat(case.beyond, 2))


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
