"""R11G11B10F and RGB9E5 against the half and against the texts of the two extensions."""

import numpy as np
import pytest

from axffit.textures import ROUNDINGS, format_named
from axffit.textures.floats import HALF
from axffit.textures.packed_floats import UnsignedFloat


@pytest.mark.parametrize("bits", [11, 10])
def test_unsigned_floats_are_halves_without_sign_and_low_mantissa_bits(bits):
    codec = UnsignedFloat(bits)
    as_half = HALF.decode(codec.all_codes() << np.uint16(15 - bits))
    np.testing.assert_array_equal(codec.decode(codec.all_codes()), as_half)


def test_largest_and_smallest_numbers():
    assert (UnsignedFloat(11).highest, UnsignedFloat(10).highest) == (65024.0, 64512.0)
    np.testing.assert_array_equal(
        UnsignedFloat(11).decode(np.array([0, 1, 0x7BF, 0x7C0])), [0, 2.0**-20, 65024, np.inf]
    )
    np.testing.assert_array_equal(UnsignedFloat(10).decode(np.array([1, 0x3DF])), [2.0**-19, 64512])


def by_the_extension(texel):
    """Mantissas and exponent by the steps of EXT_texture_shared_exponent, in whole numbers of 2^-24."""
    clamped = [min(max(x, 0.0), 65408.0) for x in texel]
    exponent = max(-16, int(np.floor(np.log2(max(clamped)))) if max(clamped) > 0 else -16) + 16
    if np.floor(max(clamped) / 2.0 ** (exponent - 24) + 0.5) == 512:
        exponent += 1
    return [int(np.floor(x / 2.0 ** (exponent - 24) + 0.5)) for x in clamped], exponent


def test_shared_exponents_follow_the_extension():
    rng = np.random.default_rng(7)
    texels = 2.0 ** rng.uniform(-30, 17, (2000, 3)) * rng.choice([-1, 1, 1, 1], (2000, 3))
    texels[:500] = texels[:500, :1] * rng.uniform(0.9, 1.1, (500, 3))
    codes = format_named("RGB9E5").encode(texels).astype(int)
    for code, texel in zip(codes, texels, strict=True):
        mantissas, exponent = by_the_extension(texel)
        assert (code & 511).tolist() == mantissas
        assert set(code >> 9) == {exponent}


@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_the_bound_of_a_texel_holds_and_is_reached(rounding):
    form = format_named("RGB9E5")
    rng = np.random.default_rng(8)
    largest = 2.0 ** rng.uniform(-18, 15.9, (40_000, 1))
    largest[::2] = np.ldexp(rng.uniform(511, 512, (20_000, 1)), rng.integers(-24, 7, (20_000, 1)))
    x = np.minimum(largest * np.concatenate([np.ones_like(largest), rng.random((40_000, 2))], axis=-1), 65408.0)
    decoded = form.decode(form.encode(x, rounding))
    bound = form.error_bound(x, rounding)
    assert np.all(np.abs(decoded - x) <= bound)
    assert np.max(np.abs(decoded - x) / bound, axis=0).min() > 1 / 1.05
    np.testing.assert_array_equal(form.decode(form.encode(decoded, rounding)), decoded)


def test_a_bright_channel_takes_the_steps_of_the_dark_ones():
    form = format_named("RGB9E5")
    np.testing.assert_array_equal(form.decode(form.encode(np.array([100.0, 0.3, np.nan]))), [100.0, 0.25, 0.0])
    np.testing.assert_array_equal(form.error_bound(np.array([100.0, 0.3, 0.0])), [0.125, 0.125, 0.125])
