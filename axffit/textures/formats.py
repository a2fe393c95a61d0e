"""Texture formats by name: R8_UNORM ... RGBA32F. One codec a channel, one table of all."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .codec import ScalarCodec
from .floats import HALF, SINGLE
from .packed_floats import SharedExponent, UnsignedFloat
from .unorm import Snorm, SrgbUnorm, Uint, Unorm


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
        return self.codecs[0].is_float

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


@dataclass(frozen=True)
class SharedExponentFormat(NumberFormat):
    """RGB9E5: three mantissas and the exponent of the largest in 32 bits; each channel's code holds that exponent too.

    Codes and bounds of a texel depend on all its channels.
    """

    name: str = "RGB9E5"
    codecs: tuple[ScalarCodec, ...] = (SharedExponent(),) * 3

    @property
    def bytes_per_texel(self) -> int:
        """4: the exponent is stored once."""
        return 4

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes [..., 3] of real numbers [..., 3]; the exponent is the same for the channels of a texel.

        Raises:
            InputError: the number of channels differs.
        """
        values = self._checked(values)
        return SharedExponent().encode(values, rounding, _largest(values))

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Proven bound on |decode(encode(x)) - x| for every finite number in range, [..., 3]."""
        values = self._checked(values)
        return SharedExponent().error_bound(values, rounding, _largest(values))


def _largest(values: np.ndarray) -> np.ndarray:
    """The largest channel of each texel, [..., 1]; NaN counts as 0."""
    return np.where(np.isnan(values), 0.0, values).max(axis=-1, keepdims=True)


_CHANNELS = ("R", "RG", "RGB", "RGBA")

_SCALARS: Mapping[str, ScalarCodec] = {
    "8_UNORM": Unorm(8),
    "16_UNORM": Unorm(16),
    "8_SNORM": Snorm(8),
    "16_SNORM": Snorm(16),
    "8_UINT": Uint(8),
    "16F": HALF,
    "32F": SINGLE,
}


def _srgb(channels: str) -> NumberFormat:
    # Alpha is linear in every sRGB format.
    codecs = tuple(Unorm(8) if channel == "A" else SrgbUnorm(8) for channel in channels)
    return NumberFormat(f"{channels}8_UNORM_SRGB", codecs)


_PACKED = (
    NumberFormat("RGB10A2_UNORM", (Unorm(10), Unorm(10), Unorm(10), Unorm(2))),
    NumberFormat("R11G11B10F", (UnsignedFloat(11), UnsignedFloat(11), UnsignedFloat(10))),
    SharedExponentFormat(),
)

FORMATS: Mapping[str, NumberFormat] = {
    entry.name: entry
    for entry in (
        *(
            entry
            for channels in _CHANNELS
            for entry in (
                *(NumberFormat(channels + suffix, (codec,) * len(channels)) for suffix, codec in _SCALARS.items()),
                _srgb(channels),
            )
        ),
        *_PACKED,
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
