"""Codes to the bytes of a texel and back, as GPUs and the uncompressed containers lay them out.

Channels of 8, 16 or 32 bits follow each other, little endian. Channels of other or unequal sizes share one 32-bit
word, the first channel in the lowest bits (DXGI_FORMAT_R10G10B10A2_UNORM, VK_FORMAT_A2B10G10R10_UNORM_PACK32). RGB9E5
has three mantissas of 9 bits and one exponent in the highest 5.
"""

from collections.abc import Iterator

import numpy as np

from ..formats import NumberFormat, SharedExponentFormat
from ..packed_floats import MANTISSA_BITS
from .image import code_type_of

_MANTISSA = 2**MANTISSA_BITS - 1


def is_packed(form: NumberFormat) -> bool:
    """Whether the channels share one 32-bit word."""
    bits = {codec.bits for codec in form.codecs}
    return len(bits) > 1 or not bits <= {8, 16, 32}


def shifts(form: NumberFormat) -> Iterator[tuple[int, int]]:
    """Lowest bit and number of bits of each channel in a texel."""
    start = 0
    for codec in form.codecs:
        yield start, codec.bits
        start += codec.bits


def to_bytes(codes: np.ndarray, form: NumberFormat) -> bytes:
    """Bytes of codes [..., C], texel after texel."""
    if not is_packed(form):
        return codes.astype(codes.dtype.newbyteorder("<"), copy=False).tobytes()
    words = np.zeros(codes.shape[:-1], dtype="<u4")
    if isinstance(form, SharedExponentFormat):
        words |= (codes[..., 0] >> np.uint16(MANTISSA_BITS)).astype("<u4") << np.uint32(3 * MANTISSA_BITS)
        codes = codes & np.uint16(_MANTISSA)
    for channel, start in enumerate(_starts(form)):
        words |= codes[..., channel].astype("<u4") << np.uint32(start)
    return words.tobytes()


def from_bytes(content: memoryview, shape: tuple[int, ...], form: NumberFormat) -> np.ndarray:
    """Codes [..., C] of as many bytes as ``shape`` [...] of texels takes; a new array."""
    code_type = code_type_of(form)
    if not is_packed(form):
        stored = np.frombuffer(content, dtype=np.dtype(code_type).newbyteorder("<"))
        return stored.reshape(*shape, form.channels).astype(code_type)
    words = np.frombuffer(content, dtype="<u4").reshape(shape)
    shared = isinstance(form, SharedExponentFormat)
    exponent = (words >> np.uint32(3 * MANTISSA_BITS)) << np.uint32(MANTISSA_BITS) if shared else np.uint32(0)
    codes = np.empty((*shape, form.channels), dtype=code_type)
    for channel, start in enumerate(_starts(form)):
        mask = _MANTISSA if shared else 2 ** form.codecs[channel].bits - 1
        codes[..., channel] = (words >> np.uint32(start)) & np.uint32(mask) | exponent
    return codes


def _starts(form: NumberFormat) -> list[int]:
    """Lowest bit of each channel in a word."""
    if isinstance(form, SharedExponentFormat):
        return [channel * MANTISSA_BITS for channel in range(form.channels)]
    return [start for start, _ in shifts(form)]
