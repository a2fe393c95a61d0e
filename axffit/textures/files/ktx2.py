"""KTX 2.0 files: uncompressed 2D textures and arrays with mip levels, without supercompression.

Layout (Khronos, "KTX File Format Specification", version 2.0): identifier, header and index (80 bytes), level index,
data format descriptor, key/value data, then the levels, the smallest first, each at a multiple of lcm(texel size, 4).
"""

import math
import struct
from collections.abc import Mapping
from pathlib import Path

from ...errors import InputError
from ..formats import NumberFormat, format_named
from .image import MAXIMUM_LEVELS, TextureImage, check_size, content_of
from .ktx2_descriptor import descriptor
from .texels import from_bytes, is_packed, to_bytes

SUFFIX = ".ktx2"

VULKAN_FORMATS: Mapping[str, int] = {
    "R8_UNORM": 9,
    "R8_SNORM": 10,
    "R8_UINT": 13,
    "R8_UNORM_SRGB": 15,
    "RG8_UNORM": 16,
    "RG8_SNORM": 17,
    "RG8_UINT": 20,
    "RG8_UNORM_SRGB": 22,
    "RGB8_UNORM": 23,
    "RGB8_SNORM": 24,
    "RGB8_UINT": 27,
    "RGB8_UNORM_SRGB": 29,
    "RGBA8_UNORM": 37,
    "RGBA8_SNORM": 38,
    "RGBA8_UINT": 41,
    "RGBA8_UNORM_SRGB": 43,
    "RGB10A2_UNORM": 64,
    "R16_UNORM": 70,
    "R16_SNORM": 71,
    "R16_UINT": 74,
    "R16F": 76,
    "RG16_UNORM": 77,
    "RG16_SNORM": 78,
    "RG16_UINT": 81,
    "RG16F": 83,
    "RGB16_UNORM": 84,
    "RGB16_SNORM": 85,
    "RGB16_UINT": 88,
    "RGB16F": 90,
    "RGBA16_UNORM": 91,
    "RGBA16_SNORM": 92,
    "RGBA16_UINT": 95,
    "RGBA16F": 97,
    "R32F": 100,
    "RG32F": 103,
    "RGB32F": 106,
    "RGBA32F": 109,
    "R11G11B10F": 122,
    "RGB9E5": 123,
}
"""VkFormat of each number format (vulkan_core.h)."""

_NAMES = {code: name for name, code in VULKAN_FORMATS.items()}

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER = struct.Struct("<12s9I4I2Q")
_LEVEL = struct.Struct("<3Q")


def write(path: Path, image: TextureImage) -> None:
    """Write an image; codes are stored as they are.

    Raises:
        InputError: Vulkan has no code for the format, or a level is not half the one before.
    """
    if image.format not in VULKAN_FORMATS:
        raise InputError(f"{path}: KTX2 has no code for {image.format}; it has {', '.join(VULKAN_FORMATS)}")
    if not image.halves:
        raise InputError(f"{path}: KTX2 needs mip levels of half the size each; write EXR or PNG files instead")
    form = image.number_format
    height, width = image.levels[0].shape[-3:-1]
    format_block, pairs = descriptor(form), _pairs()
    format_at = _HEADER.size + len(image.levels) * _LEVEL.size
    pairs_at = format_at + len(format_block)
    end = pairs_at + len(pairs)
    alignment = math.lcm(form.bytes_per_texel, 4)
    places = []
    for level in reversed(image.levels):
        start = -(-end // alignment) * alignment
        end = start + level[..., 0].size * form.bytes_per_texel
        places.append((start, end - start))
    header = _HEADER.pack(
        _IDENTIFIER, VULKAN_FORMATS[image.format], _type_size(form), width, height, 0,
        image.slices if image.is_array else 0, 1, len(image.levels), 0,
        format_at, len(format_block), pairs_at, len(pairs), 0, 0,
    )  # fmt: skip
    with path.open("wb") as file:
        file.write(header)
        for start, length in reversed(places):
            file.write(_LEVEL.pack(start, length, length))
        file.write(format_block + pairs)
        for level, (start, _) in zip(reversed(image.levels), places, strict=True):
            file.write(bytes(start - file.tell()))
            file.write(to_bytes(level, form))


def read(path: Path, format: str | None = None) -> TextureImage:
    """Read an image.

    Args:
        path: the file.
        format: refuse another format than this; None takes what the file says.

    Raises:
        InputError: it is no KTX2 file, damaged, or of a kind that is not read.
    """
    content = content_of(path)
    if content[:12] != _IDENTIFIER:
        raise InputError(f"{path}: no KTX2 file; its first bytes are {content[:12]!r}")
    if len(content) < _HEADER.size:
        raise InputError(f"{path}: {len(content)} bytes are too few for the header of a KTX2 file; it is cut off")
    code, _, width, height, depth, layers, faces, count, packing = _HEADER.unpack_from(content)[1:10]
    if code not in _NAMES:
        raise InputError(f"{path}: Vulkan format {code}; those read are {', '.join(VULKAN_FORMATS)}")
    if depth or faces != 1 or packing:
        raise InputError(
            f"{path}: {depth} texels deep, {faces} faces, supercompression {packing}; only 2D textures and their "
            "arrays are read, without supercompression (0 texels deep, 1 face, 0)"
        )
    found = _NAMES[code]
    if format not in (None, found):
        raise InputError(f"{path}: holds {found}, not {format}; give the file that belongs here")
    form = format_named(found)
    count = max(count, 1)
    if count > MAXIMUM_LEVELS:
        raise InputError(f"{path}: declares {count} levels; at most {MAXIMUM_LEVELS} are read")
    check_size(path, width, height, max(layers, 1), form.bytes_per_texel, stored=len(content))
    if len(content) < _HEADER.size + count * _LEVEL.size:
        raise InputError(f"{path}: cut off within the index of its {count} levels")
    levels = []
    for number in range(count):
        shape = (max(1, height >> number), max(1, width >> number))
        shape = (layers, *shape) if layers else shape
        start, length, _ = _LEVEL.unpack_from(content, _HEADER.size + number * _LEVEL.size)
        expected = math.prod(shape) * form.bytes_per_texel
        if length != expected or start + length > len(content):
            raise InputError(
                f"{path}: level {number} takes {length} bytes at {start} of a file of {len(content)}; "
                f"{found} of shape {list(shape)} takes {expected}; the file is damaged"
            )
        levels.append(from_bytes(memoryview(content)[start : start + length], shape, form))
    return TextureImage(found, tuple(levels))


def _type_size(form: NumberFormat) -> int:
    return 4 if is_packed(form) else form.codecs[0].bits // 8


def _pairs() -> bytes:
    """Key/value data, sorted by key: row 0 is the first row, and who wrote the file."""
    entries = b""
    for key, value in (("KTXorientation", "rd"), ("KTXwriter", "axffit")):
        pair = key.encode() + b"\0" + value.encode() + b"\0"
        entries += struct.pack("<I", len(pair)) + pair + bytes(-len(pair) % 4)
    return entries
