"""Codes to the bytes of a texel and back, as GPUs and the uncompressed containers lay them out.

Channels of 8, 16 or 32 bits follow each other, little endian. Channels of other or unequal sizes share one 32-bit
word, the first channel in the lowest bits (DXGI_FORMAT_R10G10B10A2_UNORM, VK_FORMAT_A2B10G10R10_UNORM_PACK32).
"""

from collections.abc import Iterator

import numpy as np

from ..formats import NumberFormat
from .image import code_type_of


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
    for channel, (start, _) in enumerate(shifts(form)):
        words |= codes[..., channel].astype("<u4") << np.uint32(start)
    return words.tobytes()


def from_bytes(content: memoryview, shape: tuple[int, ...], form: NumberFormat) -> np.ndarray:
    """Codes [..., C] of as many bytes as ``shape`` [...] of texels takes; a new array."""
    code_type = code_type_of(form)
    if not is_packed(form):
        stored = np.frombuffer(content, dtype=np.dtype(code_type).newbyteorder("<"))
        return stored.reshape(*shape, form.channels).astype(code_type)
    words = np.frombuffer(content, dtype="<u4").reshape(shape)
    codes = np.empty((*shape, form.channels), dtype=code_type)
    for channel, (start, bits) in enumerate(shifts(form)):
        codes[..., channel] = (words >> np.uint32(start)) & np.uint32(2**bits - 1)
    return codes
