"""The data format descriptor of KTX2, field by field, for each kind of channel."""

import struct

import pytest

from axffit.textures import NumberFormat, format_named
from axffit.textures.files.ktx2_descriptor import descriptor
from axffit.textures.unorm import Snorm

MINUS_ONE, ONE = 0xBF800000, 0x3F800000
# First bit, bits less one, channel and qualifiers, lower, upper of each sample; qualifiers are 0x10 linear,
# 0x20 exponent, 0x40 signed, 0x80 float.
SAMPLES = {
    "R8_UNORM": [(0, 7, 0, 0, 255)],
    "RG16_UNORM": [(0, 15, 0, 0, 65535), (16, 15, 1, 0, 65535)],
    "R8_UINT": [(0, 7, 0, 0, 1)],
    "RGBA8_UNORM_SRGB": [(8 * c, 7, c, 0, 255) for c in range(3)] + [(24, 7, 15 | 0x10, 0, 255)],
    "RGB16F": [(16 * c, 15, c | 0xC0, MINUS_ONE, ONE) for c in range(3)],
    "RGBA32F": [(32 * c, 31, (0, 1, 2, 15)[c] | 0xC0, MINUS_ONE, ONE) for c in range(4)],
}


def fields_of(block):
    total, vendor, version, length, model, primaries, transfer, flags = struct.unpack_from("<2I2H4B", block)
    assert (total, length, len(block)) == (4 + length, len(block) - 4, total)
    assert (vendor, version, model, primaries, flags) == (0, 2, 1, 1, 0)
    samples = [struct.unpack_from("<H2B4x2I", block, at) for at in range(28, len(block), 16)]
    return transfer, block[20], samples


@pytest.mark.parametrize("format", SAMPLES)
def test_each_channel_has_its_sample(format):
    form = format_named(format)
    transfer, texel, samples = fields_of(descriptor(form))
    assert transfer == (2 if format.endswith("_SRGB") else 1)
    assert texel == form.bytes_per_texel
    assert samples == SAMPLES[format]


def test_channels_of_unequal_bits_and_signed_ones():
    assert fields_of(descriptor(format_named("RGB10A2_UNORM")))[1:] == (
        4,
        [(0, 9, 0, 0, 1023), (10, 9, 1, 0, 1023), (20, 9, 2, 0, 1023), (30, 1, 15, 0, 3)],
    )
    signed = fields_of(descriptor(format_named("RGBA8_SNORM")))[2]
    assert signed == [(8 * c, 7, (0, 1, 2, 15)[c] | 0x40, 2**32 - 127, 127) for c in range(4)]


def test_a_shared_exponent_belongs_to_each_channel():
    _, texel, samples = fields_of(descriptor(format_named("RGB9E5")))
    assert texel == 4
    assert samples == [sample for c in range(3) for sample in ((9 * c, 8, c, 0, 8448), (27, 4, c | 0x20, 15, 31))]


def test_a_channel_of_an_unknown_kind_is_refused():
    with pytest.raises(ValueError, match=r"no data format descriptor for a channel in \[-1.0, 5.0\]"):
        descriptor(NumberFormat("R8_ODD", (Snorm(8, -1.0, 5.0),)))
