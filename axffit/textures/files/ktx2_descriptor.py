"""The data format descriptor that every KTX2 file carries: one basic block (Khronos Data Format 1.3, section 5)."""

import struct

from ..formats import NumberFormat
from ..unorm import SrgbUnorm, Uint, Unorm
from .texels import shifts

_RGBSDA = 1
_BT709 = 1
_LINEAR, _SRGB = 1, 2
# Channel numbers of the RGBSDA model; alpha is 15.
_CHANNELS = (0, 1, 2, 15)
_IS_LINEAR, _IS_EXPONENT, _IS_SIGNED, _IS_FLOAT = 0x10, 0x20, 0x40, 0x80
_MINUS_ONE, _ONE = 0xBF800000, 0x3F800000


def descriptor(form: NumberFormat) -> bytes:
    """The whole descriptor of a format, its length first: one sample a channel, no padding bits.

    ``lower`` and ``upper`` of a sample are the codes of the range's ends: 0 and 2^n - 1 of UNORM, 0 and 1 of plain
    integers, -1 and 1 of signed numbers (floats as binary32), 0 and 1 of unsigned floats. RGB9E5 has two samples a
    channel, its mantissa and the common exponent.

    Raises:
        ValueError: a channel of a kind that is not known here.
    """
    gamma = any(isinstance(codec, SrgbUnorm) for codec in form.codecs)
    if form.name == "RGB9E5":
        samples = [sample for channel in range(3) for sample in _shared_exponent(channel)]
    else:
        samples = [_sample(form, number, gamma=gamma) for number in range(form.channels)]
    length = 24 + 16 * len(samples)
    block = struct.pack(
        "<2I2H4B4B8B",
        4 + length, 0, 2, length,
        _RGBSDA, _BT709, _SRGB if gamma else _LINEAR, 0,
        0, 0, 0, 0,
        form.bytes_per_texel, 0, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip
    return block + b"".join(samples)


def _sample(form: NumberFormat, number: int, *, gamma: bool) -> bytes:
    start, bits = list(shifts(form))[number]
    codec = form.codecs[number]
    kind = _CHANNELS[number]
    if form.is_float:
        signed = codec.lowest < 0
        kind |= _IS_FLOAT | (_IS_SIGNED if signed else 0)
        lower, upper = _MINUS_ONE if signed else 0, _ONE
    elif isinstance(codec, Uint):
        lower, upper = 0, 1
    elif isinstance(codec, Unorm | SrgbUnorm):
        kind |= _IS_LINEAR if gamma and isinstance(codec, Unorm) else 0
        lower, upper = 0, 2**bits - 1
    elif codec.lowest == -1 and codec.highest == 1:
        kind |= _IS_SIGNED
        upper = 2 ** (bits - 1) - 1
        lower = 2**32 - upper
    else:
        raise ValueError(f"{form.name}: no data format descriptor for a channel in [{codec.lowest}, {codec.highest}]")
    return _packed(start, bits, kind, lower, upper)


def _shared_exponent(channel: int) -> tuple[bytes, bytes]:
    """Mantissa and exponent of a channel: 1 is the mantissa 8448 at the exponent 15."""
    mantissa = _packed(9 * channel, 9, channel, 0, 8448)
    return mantissa, _packed(27, 5, channel | _IS_EXPONENT, 15, 31)


def _packed(start: int, bits: int, kind: int, lower: int, upper: int) -> bytes:
    return struct.pack("<H2B4B2I", start, bits - 1, kind, 0, 0, 0, 0, lower, upper)
