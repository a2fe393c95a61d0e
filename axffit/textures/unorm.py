"""Integer channels: UNORM, SNORM, UNORM behind the sRGB curve, and plain unsigned integers."""

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .codec import ULPS, ScalarCodec, check_rounding, round_scaled

_CODE_TYPES: dict[int, type[np.unsignedinteger]] = {2: np.uint8, 8: np.uint8, 10: np.uint16, 16: np.uint16}

# Scaling to code steps and dividing back are one float64 rounding each, at most 2^-54 of the range apiece.
_ARITHMETIC = 2.0**-52


@dataclass(frozen=True)
class Unorm(ScalarCodec):
    """UNORM of n bits: code = round(clamp(x, 0, 1) · (2^n - 1)), x = code / (2^n - 1).

    NaN becomes 0 (Direct3D 11.3 functional specification 3.2.3.6). Encoded in float64: in float32 a 16-bit code would
    err by 0.502 steps instead of 0.5.

    Bound: the step count errs by u = 0.5 (nearest), 0.6 (device) or 1 (toward zero, floor), so x errs by
    u / (2^n - 1), plus two float64 roundings.
    """

    bits: int
    lowest: float = 0.0
    highest: float = 1.0

    @property
    def steps(self) -> int:
        """Number of steps from 0 to 1: 2^n - 1."""
        return 2**self.bits - 1

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint8 or uint16, whichever holds a code."""
        return _CODE_TYPES[self.bits]

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes of numbers, clamped to [0, 1]; NaN gives 0."""
        values = np.asarray(values, dtype=np.float64)
        clamped = np.clip(np.where(np.isnan(values), 0.0, values), 0.0, 1.0)
        return round_scaled(clamped * self.steps, rounding).astype(self.code_type)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """code / (2^n - 1)."""
        return np.asarray(codes, dtype=np.float64) / self.steps

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """u / (2^n - 1), the same for every number."""
        check_rounding(rounding)
        return np.full(np.shape(values), ULPS[rounding] / self.steps + _ARITHMETIC)


@dataclass(frozen=True)
class Snorm(ScalarCodec):
    """SNORM of n bits: code = round(clamp(x, -1, 1) M) in two's complement, M = 2^(n-1) - 1; x = max(code / M, -1).

    NaN becomes 0, and both -2^(n-1) and -2^(n-1) + 1 are -1 (Direct3D 11.3 functional specification 3.2.3.3); the
    first of them is never written. Codes are held as unsigned integers.

    Bound: as for `Unorm`: x errs by u / M, u = 0.5 (nearest), 0.6 (device) or 1, plus two float64 roundings.
    """

    bits: int
    lowest: float = -1.0
    highest: float = 1.0

    @property
    def steps(self) -> int:
        """Number of steps from 0 to 1: 2^(n-1) - 1."""
        return 2 ** (self.bits - 1) - 1

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint8 or uint16."""
        return _CODE_TYPES[self.bits]

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes of numbers, clamped to [-1, 1]; NaN gives 0."""
        values = np.asarray(values, dtype=np.float64)
        clamped = np.clip(np.where(np.isnan(values), 0.0, values), -1.0, 1.0)
        return round_scaled(clamped * self.steps, rounding).astype(np.int32).astype(self.code_type)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """max(code / M, -1), the code read in two's complement."""
        codes = np.asarray(codes, dtype=np.int32)
        signed = np.where(codes > self.steps, codes - 2**self.bits, codes)
        return np.maximum(signed / self.steps, -1.0)

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """u / M, the same for every number."""
        check_rounding(rounding)
        return np.full(np.shape(values), ULPS[rounding] / self.steps + _ARITHMETIC)


def srgb_to_linear(encoded: np.ndarray) -> np.ndarray:
    """The sRGB curve: c / 12.92 up to 0.04045, ((c + 0.055) / 1.055)^2.4 above."""
    encoded = np.asarray(encoded, dtype=np.float64)
    power = ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, encoded / 12.92, power)


def linear_to_srgb(linear: np.ndarray) -> np.ndarray:
    """Inverse of the sRGB curve: 12.92 x up to 0.0031308, 1.055 x^(1/2.4) - 0.055 above."""
    linear = np.asarray(linear, dtype=np.float64)
    power = 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, power)


@dataclass(frozen=True)
class SrgbUnorm(ScalarCodec):
    """UNORM of n bits behind the sRGB curve: linear numbers in and out.

    Bound: with s = linear_to_srgb(x) the decoded s' lies in [s - e, s + e], e the UNORM bound (in [s - e, s] when
    rounding toward zero or to the floor), and the curve rises everywhere, so x errs by at most the larger of
    curve(s + e) - x and x - curve(s - e). Under ``device`` this allows for devices that err upward. The two pieces of
    the standard miss each other by 2.4e-9 at their joint; that and the float64 powers are covered by 1e-8 added to e.
    """

    bits: int = 8
    lowest: float = 0.0
    highest: float = 1.0

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint8 or uint16."""
        return _CODE_TYPES[self.bits]

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes of linear numbers, clamped to [0, 1]; NaN gives 0."""
        values = np.asarray(values, dtype=np.float64)
        clamped = np.clip(np.where(np.isnan(values), 0.0, values), 0.0, 1.0)
        scaled = linear_to_srgb(clamped) * (2**self.bits - 1)
        # The joint of the curve and its powers move an exact code by up to 1e-7 steps: floor must not drop it.
        whole = np.rint(scaled)
        scaled = np.where(np.abs(scaled - whole) < 2e-7, whole, scaled)
        return round_scaled(scaled, rounding).astype(self.code_type)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """srgb_to_linear(code / (2^n - 1))."""
        return srgb_to_linear(np.asarray(codes, dtype=np.float64) / (2**self.bits - 1))

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """The bound of the class docstring, for each number."""
        check_rounding(rounding)
        values = np.asarray(values, dtype=np.float64)
        encoded = linear_to_srgb(values)
        error = ULPS[rounding] / (2**self.bits - 1) + 1e-8
        above = srgb_to_linear(np.minimum(encoded + error, 1.0)) - values
        below = values - srgb_to_linear(np.maximum(encoded - error, 0.0))
        upward = rounding in ("nearest_even", "device")
        return (np.maximum(above, below) if upward else below + 1e-8) + _ARITHMETIC


@dataclass(frozen=True)
class Uint(ScalarCodec):
    """Unsigned integers of n bits: exact, and nothing else is accepted.

    A slice index that does not fit must never wrap around (some importers cast, and 300 becomes 44).
    """

    bits: int = 8
    lowest: float = 0.0

    @property
    def highest(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """2^n - 1."""
        return float(2**self.bits - 1)

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint8 or uint16."""
        return _CODE_TYPES[self.bits]

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """The same whole numbers as codes.

        Raises:
            InputError: a value is no whole number in range.
        """
        check_rounding(rounding)
        values = np.asarray(values, dtype=np.float64)
        bad = self.outside(values) | (np.trunc(values) != values)
        if np.any(bad):
            raise InputError(
                f"value {values[bad].flat[0]:g} does not fit an unsigned integer of {self.bits} bits; "
                f"give whole numbers from 0 to {2**self.bits - 1}"
            )
        return values.astype(self.code_type)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """The same whole numbers."""
        return np.asarray(codes, dtype=np.float64)

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """0: exact."""
        check_rounding(rounding)
        return np.zeros(np.shape(values))
