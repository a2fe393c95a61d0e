"""DirectDraw surfaces with the DX10 header: uncompressed 2D textures and arrays with mip levels.

Layout (Microsoft, "Programming Guide for DDS"): magic, DDS_HEADER (124 bytes), DDS_HEADER_DXT10 (20 bytes), then for
each slice all its mip levels, the finest first, rows without padding. Level k has max(1, size >> k) texels a side.
"""

import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...errors import InputError
from ..formats import format_named
from .image import MAXIMUM_LEVELS, TextureImage, check_size, content_of
from .texels import from_bytes, to_bytes

SUFFIX = ".dds"

DXGI_FORMATS: Mapping[str, int] = {
    "RGBA32F": 2,
    "RGB32F": 6,
    "RGBA16F": 10,
    "RGBA16_UNORM": 11,
    "RGBA16_UINT": 12,
    "RGBA16_SNORM": 13,
    "RG32F": 16,
    "RGB10A2_UNORM": 24,
    "R11G11B10F": 26,
    "RGBA8_UNORM": 28,
    "RGBA8_UNORM_SRGB": 29,
    "RGBA8_UINT": 30,
    "RGBA8_SNORM": 31,
    "RG16F": 34,
    "RG16_UNORM": 35,
    "RG16_UINT": 36,
    "RG16_SNORM": 37,
    "R32F": 41,
    "RG8_UNORM": 49,
    "RG8_UINT": 50,
    "RG8_SNORM": 51,
    "R16F": 54,
    "R16_UNORM": 56,
    "R16_UINT": 57,
    "R16_SNORM": 58,
    "R8_UNORM": 61,
    "R8_UINT": 62,
    "R8_SNORM": 63,
    "RGB9E5": 67,
}
"""DXGI_FORMAT of each number format (dxgiformat.h); three-channel formats of 8 and 16 bits have none."""

_NAMES = {code: name for name, code in DXGI_FORMATS.items()}

_HEADER = struct.Struct("<4s7I44s2I4s5I4I4x")
_EXTENSION = struct.Struct("<5I")
# DDSD_CAPS | DDSD_HEIGHT | DDSD_WIDTH | DDSD_PITCH | DDSD_PIXELFORMAT, and DDSD_MIPMAPCOUNT
_FLAGS, _FLAG_LEVELS = 0x100F, 0x20000
# DDSCAPS_TEXTURE, and DDSCAPS_COMPLEX | DDSCAPS_MIPMAP
_CAPS, _CAPS_LEVELS = 0x1000, 0x400008
_FOURCC = 0x4
_TEXTURE_2D = 3
_CUBE = 0x4
# DDS_ALPHA_MODE_CUSTOM: the fourth channel is data, not coverage.
_ALPHA_IS_DATA = 4


def write(path: Path, image: TextureImage) -> None:
    """Write an image; codes are stored as they are.

    Raises:
        InputError: DXGI has no code for the format, or a level is not half the one before.
    """
    if image.format not in DXGI_FORMATS:
        raise InputError(f"{path}: DDS has no code for {image.format}; it has {', '.join(DXGI_FORMATS)}")
    if not image.halves:
        raise InputError(f"{path}: DDS needs mip levels of half the size each; write EXR or PNG files instead")
    form = image.number_format
    height, width = image.levels[0].shape[-3:-1]
    count = len(image.levels)
    flags, caps = (_FLAGS | _FLAG_LEVELS, _CAPS | _CAPS_LEVELS) if count > 1 else (_FLAGS, _CAPS)
    header = _HEADER.pack(
        b"DDS ", 124, flags, height, width, width * form.bytes_per_texel, 0, count, bytes(44),
        32, _FOURCC, b"DX10", 0, 0, 0, 0, 0, caps, 0, 0, 0,
    )  # fmt: skip
    extension = _EXTENSION.pack(DXGI_FORMATS[image.format], _TEXTURE_2D, 0, image.slices, _ALPHA_IS_DATA)
    with path.open("wb") as file:
        file.write(header + extension)
        for index in range(image.slices):
            for level in range(count):
                file.write(to_bytes(image.slice(level, index), form))


def read(path: Path, format: str | None = None) -> TextureImage:
    """Read an image; an array of one slice comes back as a plain image, which a DDS file cannot tell apart.

    Args:
        path: the file.
        format: refuse another format than this; None takes what the file says.

    Raises:
        InputError: it is no DDS file with a DX10 header, damaged, or of a kind that is not read.
    """
    content = content_of(path)
    start = _HEADER.size + _EXTENSION.size
    if content[:4] != b"DDS ":
        raise InputError(f"{path}: no DDS file; its first bytes are {content[:4]!r}, not b'DDS '")
    if len(content) < start:
        raise InputError(f"{path}: {len(content)} bytes are too few for the headers of a DDS file; it is cut off")
    fields = _HEADER.unpack_from(content)
    size, height, width, count = fields[1], fields[3], fields[4], fields[7]
    if size != 124 or fields[11] != b"DX10":
        raise InputError(f"{path}: a DDS file without the DX10 header; write it with one (code {fields[11]!r})")
    code, dimension, flags, slices, _ = _EXTENSION.unpack_from(content, _HEADER.size)
    if dimension != _TEXTURE_2D or flags & _CUBE:
        raise InputError(f"{path}: a DDS file of dimension {dimension}, flags {flags}; only 2D textures are read")
    if code not in _NAMES:
        raise InputError(f"{path}: DXGI format {code}; those read are {', '.join(DXGI_FORMATS)}")
    found = _NAMES[code]
    if format not in (None, found):
        raise InputError(f"{path}: holds {found}, not {format}; give the file that belongs here")
    form = format_named(found)
    count = max(count, 1)
    if count > MAXIMUM_LEVELS or slices < 1:
        raise InputError(f"{path}: declares {count} levels of {slices} slices; at most {MAXIMUM_LEVELS} of at least 1")
    check_size(path, width, height, slices, form.bytes_per_texel, stored=len(content))
    shapes = [(max(1, height >> k), max(1, width >> k)) for k in range(count)]
    sizes = [rows * columns * form.bytes_per_texel for rows, columns in shapes]
    if len(content) != start + slices * sum(sizes):
        raise InputError(
            f"{path}: {len(content)} bytes where {width} x {height} texels of {found}, {count} levels and {slices} "
            f"slices take {start + slices * sum(sizes)}; the file is damaged"
        )
    levels = [np.empty((slices, *shape, form.channels), dtype=form.codecs[0].code_type) for shape in shapes]
    texels = memoryview(content)
    for index in range(slices):
        for level, shape, length in zip(levels, shapes, sizes, strict=True):
            level[index] = from_bytes(texels[start : start + length], shape, form)
            start += length
    return TextureImage(found, tuple(level if slices > 1 else level[0] for level in levels))
