"""PNG files: one level of one slice in UNORM, sRGB or plain integers of 8 or 16 bits.

Codes are stored as they are: no gamma chunk or color profile is written or heeded. Only ``_SRGB`` formats get an sRGB
chunk, as their codes are behind that curve. PNG has no two-channel color: RG is stored as RGB with blue 0.
"""

import re
import struct
import zlib
from pathlib import Path
from typing import NamedTuple

import imagecodecs
import numpy as np

from ...errors import InputError
from ..formats import FORMATS, format_named
from .image import TextureImage, check_size, code_type_of, content_of

SUFFIX = ".png"

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# Samples of a texel by color type: gray, RGB, gray and alpha, RGBA; palettes are left out.
_SAMPLES = {0: 1, 2: 3, 4: 2, 6: 4}
_HEADER_END = 33
_LEVEL = 1  # of deflate: measured maps are noise, and higher levels cost five times as much for a few percent


def holds(format: str) -> bool:
    """Whether PNG can store the codes of a format."""
    return format in FORMATS and re.fullmatch(r"(R|RG|RGB|RGBA)(8|16)_(UNORM|UNORM_SRGB|UINT)", format) is not None


def write(path: Path, image: TextureImage) -> None:
    """Write an image of one level and no slices.

    Raises:
        InputError: the format is no UNORM or UINT of 8 or 16 bits, or the image has levels or slices.
    """
    if not holds(image.format):
        raise InputError(f"{path}: PNG cannot hold {image.format}; it holds UNORM and UINT of 8 or 16 bits")
    if len(image.levels) > 1 or image.is_array:
        raise InputError(f"{path}: a PNG file holds one level of one slice; write one file each")
    codes = image.slice(0, 0)
    height, width, channels = codes.shape
    if channels == 2:
        codes = np.concatenate([codes, np.zeros((height, width, 1), codes.dtype)], axis=-1)
    elif channels == 1:
        codes = codes.reshape(height, width)
    content = bytes(imagecodecs.png_encode(np.ascontiguousarray(codes), level=_LEVEL))
    if image.format.endswith("_SRGB"):
        # Rendering intent 0; the chunk must come before the pixels.
        content = content[:_HEADER_END] + _chunk(b"sRGB", b"\0") + content[_HEADER_END:]
    path.write_bytes(content)


def read(path: Path, format: str | None = None) -> TextureImage:
    """Read an image.

    Args:
        path: the file.
        format: the number format of its codes; None takes UNORM of the file's channels and bits, ``_SRGB`` where an
            8-bit file says so.

    Raises:
        InputError: it is no PNG file, cut off, damaged, has a palette, or does not fit the format.
    """
    content = content_of(path)
    header = _header(path, content)
    chosen = format or f"{'RGBA'[: header.channels]}{header.bits}_UNORM" + ("_SRGB" if header.is_srgb else "")
    form = format_named(chosen)
    stored = 3 if form.channels == 2 else form.channels
    bits = {codec.bits for codec in form.codecs}
    if not holds(chosen) or header.channels != stored or bits != {header.bits}:
        raise InputError(
            f"{path}: {header.channels} channels of {header.bits} bits; {chosen} "
            + (f"is stored as {stored} channels of {min(bits)} bits" if holds(chosen) else "cannot be stored as PNG")
        )
    try:
        pixels = imagecodecs.png_decode(content)
    except (imagecodecs.PngError, ValueError) as error:
        raise InputError(f"{path}: cannot be decoded ({error}); the file is damaged") from error
    codes = np.asarray(pixels).reshape(header.height, header.width, header.channels)
    if codes.dtype != code_type_of(form):
        raise InputError(f"{path}: decodes to {codes.dtype}; {chosen} needs {header.bits} bits; save it without tRNS")
    if form.channels == 2:
        if codes[..., 2].any():
            raise InputError(f"{path}: {chosen} is stored with blue 0; this file has other values there")
        codes = np.ascontiguousarray(codes[..., :2])
    return TextureImage(chosen, (codes,))


class _Header(NamedTuple):
    width: int
    height: int
    bits: int
    channels: int
    is_srgb: bool


def _header(path: Path, content: bytes) -> _Header:
    """The header of a file whose chunks are all there."""
    if content[:8] != _SIGNATURE:
        raise InputError(f"{path}: no PNG file; its first bytes are {content[:8]!r}")
    kinds, at = [], len(_SIGNATURE)
    while not kinds or kinds[-1] != b"IEND":
        if at + 12 > len(content):
            raise InputError(f"{path}: a PNG file that is cut off; give the whole file")
        length, kind = struct.unpack_from(">I4s", content, at)
        kinds.append(kind)
        at += 12 + length
    if at > len(content) or kinds[0] != b"IHDR":
        raise InputError(f"{path}: a PNG file that is cut off or damaged; give the whole file")
    width, height, bits, color = struct.unpack_from(">2I2B", content, 16)
    if color not in _SAMPLES or bits not in (8, 16) or b"tRNS" in kinds:
        raise InputError(
            f"{path}: a PNG file of color type {color}, {bits} bits{', tRNS' if b'tRNS' in kinds else ''}; "
            "save it as gray, RGB or RGBA of 8 or 16 bits"
        )
    channels = _SAMPLES[color]
    check_size(path, width, height, 1, channels * bits // 8, stored=len(content))
    return _Header(width, height, bits, channels, b"sRGB" in kinds and bits == 8)


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
