"""The contract of a number format's channel, and the rounding modes.

A codec turns real numbers into unsigned integer codes and back, and states how far a number may move on the way:

    |decode(encode(x)) - x| <= error_bound(x)        for every finite x in [lowest, highest].

Codes are the bits a GPU holds. Decoding is done in float64, so what a bound proves is the format's own loss.
"""

from abc import ABC, abstractmethod
from typing import ClassVar, Literal, get_args

import numpy as np

from ..errors import InputError

Rounding = Literal["nearest_even", "toward_zero", "floor", "device"]
"""How an encoder rounds.

- ``nearest_even``: to the nearest code, ties to the even one (IEEE, NumPy, F16C, CUDA).
- ``toward_zero``: to the neighbor nearer zero (Direct3D's float to half).
- ``floor``: to the neighbor below (importers that cast without adding 0.5).
- ``device``: the largest error the graphics APIs allow. Integer formats may err by 0.6 ULP (Direct3D 11.3
  functional specification 3.2.3.6): the encoder that reaches it rounds up from a fraction of 0.6 on. Float formats may
  take either neighbor (Direct3D: toward zero; Vulkan: open): the encoder that reaches it rounds toward zero.
"""

ROUNDINGS: tuple[Rounding, ...] = get_args(Rounding)

ULPS: dict[str, float] = {"nearest_even": 0.5, "device": 0.6, "toward_zero": 1.0, "floor": 1.0}
"""Largest error of an integer format's encoder in steps of the code."""


def check_rounding(rounding: str) -> None:
    """Refuse a rounding mode that does not exist.

    Raises:
        InputError: naming the modes there are.
    """
    if rounding not in ROUNDINGS:
        raise InputError(f"unknown rounding {rounding!r}; allowed: {', '.join(ROUNDINGS)}")


def round_scaled(scaled: np.ndarray, rounding: str) -> np.ndarray:
    """Numbers in code steps to whole numbers, by the rounding mode."""
    check_rounding(rounding)
    if rounding == "nearest_even":
        return np.rint(scaled)
    if rounding == "device":
        return np.floor(scaled + 0.4)
    return np.trunc(scaled) if rounding == "toward_zero" else np.floor(scaled)


class ScalarCodec(ABC):
    """One channel of a number format.

    Attributes:
        code_type: unsigned integer type that holds a code.
        bits: bits of a code.
        lowest: smallest number the format holds.
        highest: largest finite number the format holds.
        is_float: whether codes lie closer the nearer they are to 0, so that a scale factor gains nothing.
    """

    is_float: ClassVar[bool] = False
    code_type: type[np.unsignedinteger]
    bits: int
    lowest: float
    highest: float

    @abstractmethod
    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes of real numbers, any shape; what happens outside the range is the format's own rule."""

    @abstractmethod
    def decode(self, codes: np.ndarray) -> np.ndarray:
        """The float64 numbers that codes stand for."""

    @abstractmethod
    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Proven bound on |decode(encode(x)) - x| for each finite x in range (same unit as x)."""

    def outside(self, values: np.ndarray) -> np.ndarray:
        """Where encoding must change a number because the format's range does not hold it (NaN included)."""
        # A half could not be compared with the ends of binary32.
        values = np.asarray(values, dtype=np.float64)
        return ~((values >= self.lowest) & (values <= self.highest))

    def all_codes(self) -> np.ndarray:
        """Every code, ascending; only for codes of 16 bits or fewer.

        Raises:
            ValueError: the format has too many codes to list.
        """
        if self.bits > 16:
            raise ValueError(f"a format of {self.bits} bits has too many codes to list")
        return np.arange(2**self.bits, dtype=self.code_type)
