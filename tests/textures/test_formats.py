"""The table of formats: names, sizes, channels, and the same rules through every one of them."""

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.textures import FORMATS, ROUNDINGS, format_named

every_format = pytest.mark.parametrize("name", FORMATS)

SPECIFIED = {
    "R8_UNORM": 1, "RG8_UNORM": 2, "RGBA8_UNORM": 4, "RGBA8_UNORM_SRGB": 4, "R8_UINT": 1, "R16_UNORM": 2,
    "RG16_UNORM": 4, "RGBA16_UNORM": 8, "R16F": 2, "RG16F": 4, "RGBA16F": 8, "R32F": 4, "RGBA32F": 16,
    "RGBA8_SNORM": 4, "RGBA16_SNORM": 8, "RGB10A2_UNORM": 4, "R11G11B10F": 4, "RGB9E5": 4,
}  # fmt: skip
"""Formats the specification names, with their bytes a texel."""


@pytest.mark.parametrize("name", SPECIFIED)
def test_specified_formats_are_there(name):
    assert format_named(name).bytes_per_texel == SPECIFIED[name]
    assert format_named(name).name == name


@every_format
@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_round_trip_within_the_bound(name, rounding):
    form = FORMATS[name]
    rng = np.random.default_rng(3)
    x = rng.random((40, 30, form.channels))
    if form.is_integer:
        x = np.round(255 * x)
    codes = form.encode(x, rounding)
    assert codes.shape == x.shape
    assert np.all(np.abs(form.decode(codes) - x) <= form.error_bound(x, rounding))
    assert not form.outside(x).any()
    np.testing.assert_array_equal(form.encode(form.decode(codes), rounding), codes)


def test_alpha_of_an_srgb_format_is_linear():
    form = format_named("RGBA8_UNORM_SRGB")
    np.testing.assert_array_equal(form.encode(np.full((1, 4), 0.5)), [[188, 188, 188, 128]])


@every_format
def test_a_wrong_number_of_channels_is_refused(name):
    form = FORMATS[name]
    with pytest.raises(InputError, match=f"{name} holds {form.channels} channels"):
        form.encode(np.zeros((4, 4, form.channels + 1)))


def test_an_unknown_format_is_refused_by_name():
    with pytest.raises(InputError, match="unknown texture format 'BC7'; allowed: R8_UNORM"):
        format_named("BC7")
