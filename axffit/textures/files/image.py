"""What an image file holds, as codes, and how much a file may make its reader allocate."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import InputError
from ..formats import NumberFormat, format_named

MAXIMUM_BYTES = 2**32
"""Largest image read, uncompressed: a 16384² map of four floats."""

MAXIMUM_SIDE = 2**16
"""Most texels along a side; the graphics APIs stop at 2^14 or 2^15."""

MAXIMUM_LEVELS = 32
"""Most mip levels of a file that is read."""

_EXPANSION = 1100
"""Deflate expands at most 1032 times."""

_SMALL = 2**26
"""Bytes below which a file may expand by any factor."""


@dataclass(frozen=True, eq=False)
class TextureImage:
    """A texture as a file stores it: codes of one number format, all mip levels, all slices.

    Attributes:
        format: name of the number format.
        levels: codes, the finest level first: [H, W, C], or [D, H, W, C] of an array of D slices; row 0 first in the
            file.

    Raises:
        InputError: the levels are not codes of that format, or do not belong together.
    """

    format: str
    levels: tuple[np.ndarray, ...]

    def __post_init__(self) -> None:
        form = self.number_format
        code_type = code_type_of(form)
        if not self.levels:
            raise InputError(f"an image of {self.format} has no level; give at least one")
        first = self.levels[0]
        for number, codes in enumerate(self.levels):
            right = codes.ndim in (3, 4) and codes.ndim == first.ndim and codes.shape[:-3] == first.shape[:-3]
            if not right or codes.shape[-1] != form.channels or codes.size == 0 or codes.dtype != code_type:
                raise InputError(
                    f"level {number} has shape {codes.shape} of {codes.dtype}; {self.format} needs [height, width, "
                    f"{form.channels}] of {np.dtype(code_type)}, with the same slices before it in every level"
                )

    @property
    def number_format(self) -> NumberFormat:
        """The number format itself."""
        return format_named(self.format)

    @property
    def is_array(self) -> bool:
        """Whether it is an array of slices."""
        return self.levels[0].ndim == 4

    @property
    def slices(self) -> int:
        """Slices of the array; 1 of a plain image."""
        return self.levels[0].shape[0] if self.is_array else 1

    @property
    def halves(self) -> bool:
        """Whether each level has half the texels of the one before along each side, as DDS and KTX2 require."""
        return shapes_halve([level.shape for level in self.levels])

    def slice(self, level: int, index: int) -> np.ndarray:
        """Codes [H, W, C] of one slice of one level."""
        return self.levels[level][index] if self.is_array else self.levels[level]


def shapes_halve(shapes: Sequence[tuple[int, ...]]) -> bool:
    """Whether level k of shapes [..., H, W, C] has max(1, H >> k) x max(1, W >> k) texels."""
    height, width = shapes[0][-3:-1]
    return all(shape[-3:-1] == (max(1, height >> k), max(1, width >> k)) for k, shape in enumerate(shapes))


def code_type_of(form: NumberFormat) -> type[np.unsignedinteger]:
    """Unsigned integer type of an array of a format's codes."""
    return np.result_type(*(codec.code_type for codec in form.codecs)).type


def content_of(path: Path) -> bytes:
    """All bytes of a file.

    Raises:
        InputError: it is no regular file or larger than `MAXIMUM_BYTES`.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file; give the path of an image file")
    size = path.stat().st_size
    if size > MAXIMUM_BYTES:
        raise InputError(f"{path}: {size} bytes; image files of at most {MAXIMUM_BYTES} bytes are read")
    return path.read_bytes()


def check_size(path: Path, width: int, height: int, layers: int, texel_bytes: int, *, stored: int) -> None:
    """Refuse a declared size that is absurd, before anything is allocated.

    Args:
        path: the file, for the message.
        width: texels along u.
        height: texels along v.
        layers: slices times levels, roughly.
        texel_bytes: bytes of one texel in memory.
        stored: bytes of the file; a compressed image may declare 1100 times as much (any amount below 64 MiB).

    Raises:
        InputError: a side is 0 or above `MAXIMUM_SIDE`, or the image declares too many bytes.
    """
    if not (1 <= width <= MAXIMUM_SIDE and 1 <= height <= MAXIMUM_SIDE):
        raise InputError(f"{path}: declares {width} x {height} texels; allowed: 1 to {MAXIMUM_SIDE} along each side")
    check_bytes(path, width * height * layers * texel_bytes, stored=stored)


def check_bytes(path: Path, declared: int, *, stored: int, most: int = MAXIMUM_BYTES) -> None:
    """Refuse more bytes of texels than files of ``stored`` bytes can hold, or than ``most``.

    Raises:
        InputError: as said.
    """
    if declared > most or declared > max(_SMALL, _EXPANSION * stored):
        raise InputError(
            f"{path}: declares {declared} bytes of texels where {stored} bytes are stored; it is damaged, "
            f"or larger than {most} bytes, which is the most that is read"
        )
