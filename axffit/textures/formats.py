"""Texture formats by name: R8_UNORM ... RGBA32F. One codec a channel, one table of all."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .codec import ScalarCodec
from .floats import HALF, SINGLE, IeeeFloat
from .unorm import SrgbUnorm, Uint, Unorm


@dataclass(frozen=True)
class NumberFormat:
    """A texel format: one codec a channel. Arrays are [..., C] with C = the format's channels.

    Attributes:
        name: as in the graphics APIs, e.g. ``RGBA16_UNORM``.
        codecs: the codec of each channel.
    """

    name: str
    codecs: tuple[ScalarCodec, ...]

    @property
    def channels(self) -> int:
        """Number of channels."""
        return len(self.codecs)

    @property
    def is_float(self) -> bool:
        """Whether it holds floating-point numbers, so that scale factors are useless."""
        return isinstance(self.codecs[0], IeeeFloat)

    @property
    def is_integer(self) -> bool:
        """Whether it holds plain integers, so that an index needs no division by 255."""
        return isinstance(self.codecs[0], Uint)

    @property
    def bytes_per_texel(self) -> int:
        """Size of a texel in bytes."""
        return sum(codec.bits for codec in self.codecs) // 8

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes [..., C] of real numbers [..., C].

        Raises:
            InputError: the number of channels differs, or an integer format is given what it cannot hold.
        """
        values = self._checked(values)
        return self._per_channel("encode", values, rounding)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """Float64 numbers [..., C] of codes [..., C]."""
        return self._per_channel("decode", self._checked(codes))

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Proven bound on |decode(encode(x)) - x| for every finite number in range, [..., C]."""
        return self._per_channel("error_bound", self._checked(values), rounding)

    def outside(self, values: np.ndarray) -> np.ndarray:
        """Where the format's range does not hold a number, [..., C] of booleans."""
        return self._per_channel("outside", self._checked(values))

    def _checked(self, array: np.ndarray) -> np.ndarray:
        array = np.asarray(array)
        if array.ndim == 0 or array.shape[-1] != self.channels:
            raise InputError(f"{self.name} holds {self.channels} channels on the last axis, not shape {array.shape}")
        return array

    def _per_channel(self, operation: str, array: np.ndarray, *arguments: str) -> np.ndarray:
        if all(codec == self.codecs[0] for codec in self.codecs):
            return getattr(self.codecs[0], operation)(array, *arguments)
        parts = [getattr(codec, operation)(array[..., c], *arguments) for c, codec in enumerate(self.codecs)]
        return np.stack(parts, axis=-1)


_CHANNELS = ("R", "RG", "RGB", "RGBA")

_SCALARS: Mapping[str, ScalarCodec] = {
    "8_UNORM": Unorm(8),
    "16_UNORM": Unorm(16),
    "8_UINT": Uint(8),
    "16F": HALF,
    "32F": SINGLE,
}


def _srgb(channels: str) -> NumberFormat:
    # Alpha is linear in every sRGB format.
    codecs = tuple(Unorm(8) if channel == "A" else SrgbUnorm(8) for channel in channels)
    return NumberFormat(f"{channels}8_UNORM_SRGB", codecs)


FORMATS: Mapping[str, NumberFormat] = {
    entry.name: entry
    for channels in _CHANNELS
    for entry in (
        *(NumberFormat(channels + suffix, (codec,) * len(channels)) for suffix, codec in _SCALARS.items()),
        _srgb(channels),
    )
}
"""Every format by its name."""


def format_named(name: str) -> NumberFormat:
    """The format of that name.

    Raises:
        InputError: there is none; the message lists those there are.
    """
    try:
        return FORMATS[name]
    except KeyError:
        raise InputError(f"unknown texture format {name!r}; allowed: {', '.join(FORMATS)}") from None
