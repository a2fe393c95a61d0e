"""IEEE 754 channels: half (binary16) and single (binary32) precision, with directed rounding."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .codec import ScalarCodec, check_rounding


def binade(values: np.ndarray, lowest: int) -> np.ndarray:
    """Largest e with 2^e <= |x|, at least ``lowest``; ``lowest`` for 0."""
    values = np.abs(np.asarray(values, dtype=np.float64))
    # frexp's mantissa lies in [1/2, 1), one binade above.
    _, exponent = np.frexp(values)
    return np.where(values == 0.0, lowest, np.maximum(exponent - 1, lowest))


@dataclass(frozen=True)
class IeeeFloat(ScalarCodec):
    """A binary interchange format; a code is its bit pattern.

    NaN stays NaN and infinity infinity. A finite number beyond the range goes to infinity under ``nearest_even`` (IEEE)
    and to the largest finite number under ``toward_zero`` (Direct3D: 65504); ``outside`` finds it beforehand.

    Bound: with p significant bits (11 or 24) and 2^e <= |x| < 2^(e+1), neighbors lie u = 2^(max(e, e_min) - p + 1)
    apart, subnormals included. ``nearest_even`` errs by u / 2 at most, every other mode by u.

    Attributes:
        bits: 16 or 32.
        significant_bits: p, the hidden bit included.
        lowest_exponent: e_min of the normal numbers.
    """

    is_float: ClassVar[bool] = True
    bits: int
    significant_bits: int
    lowest_exponent: int
    highest: float

    @property
    def lowest(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The negative of the largest finite number."""
        return -self.highest

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint16 or uint32."""
        return np.uint16 if self.bits == 16 else np.uint32

    @property
    def float_type(self) -> type[np.floating]:
        """float16 or float32."""
        return np.float16 if self.bits == 16 else np.float32

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Bit patterns of numbers of float16, float32 or float64."""
        check_rounding(rounding)
        values = np.asarray(values)
        if values.dtype.kind != "f":
            values = values.astype(np.float64)
        if values.dtype.itemsize < np.dtype(self.float_type).itemsize:
            values = values.astype(self.float_type)
        with np.errstate(all="ignore"):
            nearest = values.astype(self.float_type)
        # A one-element view of a 0-d array is not allowed, hence the reshape.
        codes = nearest.reshape(-1).view(self.code_type).reshape(values.shape).copy()
        if rounding == "nearest_even":
            return codes
        rounded = nearest.astype(values.dtype)
        with np.errstate(invalid="ignore"):
            above, below = rounded > values, rounded < values
        one = codes.dtype.type(1)
        if rounding == "floor":
            # Codes count magnitude: one less is lower for positive numbers, one more for negative ones.
            codes[above & ~np.signbit(nearest)] -= one
            codes[above & np.signbit(nearest)] += one
        else:
            codes[(above & (values > 0)) | (below & (values < 0))] -= one
        return codes

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """The numbers bit patterns stand for; exact in float64."""
        codes = np.ascontiguousarray(codes, dtype=self.code_type)
        with np.errstate(invalid="ignore"):  # a signaling NaN, which a foreign file may hold, becomes a quiet one
            return codes.reshape(-1).view(self.float_type).reshape(codes.shape).astype(np.float64)

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """u / 2 or u of the class docstring, for each number."""
        check_rounding(rounding)
        spacing = np.ldexp(1.0, binade(values, self.lowest_exponent) - self.significant_bits + 1)
        return spacing / 2 if rounding == "nearest_even" else spacing


HALF = IeeeFloat(bits=16, significant_bits=11, lowest_exponent=-14, highest=65504.0)
"""binary16: relative bound 2^-11 (nearest) or 2^-10, absolute 2^-25 or 2^-24 among the subnormals."""

SINGLE = IeeeFloat(bits=32, significant_bits=24, lowest_exponent=-126, highest=float(np.finfo(np.float32).max))
"""binary32."""
