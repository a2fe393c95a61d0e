"""Floats that share a 32-bit word: the unsigned ones of R11G11B10F, and RGB9E5 with one exponent for three channels."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .codec import ScalarCodec, check_rounding, round_scaled
from .floats import binade

_LOWEST_EXPONENT = -14


def _round(steps: np.ndarray, rounding: str) -> np.ndarray:
    # A device may take either neighbor of a float; rounding toward zero is the farthest that goes.
    return round_scaled(steps, "toward_zero" if rounding == "device" else rounding)


@dataclass(frozen=True)
class UnsignedFloat(ScalarCodec):
    """A float of 11 or 10 bits: 5 of exponent (bias 15), the rest mantissa, no sign (EXT_packed_float).

    Negative numbers and -infinity become 0, a finite number beyond the range the largest finite one; +infinity and NaN
    stay. ``device`` may take either neighbor; as with the half, the encoder that reaches it rounds toward zero.

    Bound: with m mantissa bits and 2^e <= x < 2^(e+1), neighbors lie u = 2^(max(e, -14) - m) apart, subnormals
    included, and both neighbors of x are encodable (the upper one may be 2^(e+1)). ``nearest_even`` errs by u / 2 at
    most, every other mode by less than u. Scaling by a power of two is exact, so float64 adds nothing.
    """

    is_float: ClassVar[bool] = True
    bits: int
    lowest: float = 0.0

    @property
    def mantissa_bits(self) -> int:
        """Bits below the exponent: 6 or 5."""
        return self.bits - 5

    @property
    def highest(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """65024 (11 bits) or 64512 (10 bits)."""
        return 2.0**16 - 2.0 ** (15 - self.mantissa_bits)

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint16."""
        return np.uint16

    def encode(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes of numbers; what has no code is treated as the class docstring says."""
        values = np.asarray(values, dtype=np.float64)
        infinity = 31 << self.mantissa_bits
        held = np.clip(np.where(np.isnan(values), 0.0, values), 0.0, self.highest)
        exponent = binade(held, _LOWEST_EXPONENT)
        # A mantissa that rounds up to 2^(m+1) carries into the exponent by itself; subnormals have exponent field 0.
        steps = _round(np.ldexp(held, self.mantissa_bits - exponent), rounding)
        codes = steps.astype(np.int64) + ((exponent - _LOWEST_EXPONENT) << self.mantissa_bits)
        codes = np.where(values == np.inf, infinity, codes)
        return np.where(np.isnan(values), 2**self.bits - 1, codes).astype(np.uint16)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """The numbers codes stand for; exact in float64."""
        codes = np.asarray(codes, dtype=np.int64)
        field, mantissa = codes >> self.mantissa_bits, codes & (2**self.mantissa_bits - 1)
        hidden = np.where(field > 0, 2**self.mantissa_bits, 0)
        exponent = np.maximum(field, 1) - 1 + _LOWEST_EXPONENT - self.mantissa_bits
        finite = np.ldexp((mantissa + hidden).astype(np.float64), exponent)
        return np.where(field < 31, finite, np.where(mantissa == 0, np.inf, np.nan))

    def error_bound(self, values: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """u / 2 or u of the class docstring, for each number."""
        check_rounding(rounding)
        spacing = np.ldexp(1.0, binade(values, _LOWEST_EXPONENT) - self.mantissa_bits)
        return spacing / 2 if rounding == "nearest_even" else spacing


MANTISSA_BITS = 9
"""Bits of a mantissa of RGB9E5."""

_BIAS = 15
_WHOLE = 2**MANTISSA_BITS


@dataclass(frozen=True)
class SharedExponent(ScalarCodec):
    """A channel of RGB9E5 (EXT_texture_shared_exponent): x = mantissa 2^(exponent - 24), 9 and 5 bits.

    A code is exponent 2^9 + mantissa. All channels of a texel have the exponent of its largest channel; without
    ``largest`` a number counts as its own, as in a gray texel. NaN, negative numbers and -infinity become 0, numbers
    beyond the range and +infinity its end, 65408.

    Bound: with M the largest channel and 2^(e-1) <= M < 2^e, e at least -15, the step is u = 2^(e - 9), or twice that
    if M rounds up to 2^9 steps. ``nearest_even`` errs by u / 2 at most, every other mode by less than u. In a texel
    with the doubled step, a channel of 511.5 old steps or more becomes 2^9 of them and errs by half an *old* step.
    Scaling by a power of two is exact, so float64 adds nothing.
    """

    is_float: ClassVar[bool] = True
    bits: int = MANTISSA_BITS + 5
    lowest: float = 0.0
    highest: float = float((_WHOLE - 1) * 2 ** (31 - _BIAS - MANTISSA_BITS))

    @property
    def code_type(self) -> type[np.unsignedinteger]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """uint16."""
        return np.uint16

    def encode(
        self, values: np.ndarray, rounding: str = "nearest_even", largest: np.ndarray | None = None
    ) -> np.ndarray:
        """Codes of numbers; ``largest`` (None: the number itself) is the largest channel of each one's texel."""
        held = self._held(values)
        exponent, _ = self._exponents(held if largest is None else self._held(largest), rounding)
        steps = _round(np.ldexp(held, MANTISSA_BITS - exponent), rounding)
        return (steps.astype(np.int64) + ((exponent + _BIAS) << MANTISSA_BITS)).astype(np.uint16)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """mantissa 2^(exponent - 24); exact in float64."""
        codes = np.asarray(codes, dtype=np.int64)
        mantissa = (codes & (_WHOLE - 1)).astype(np.float64)
        return np.ldexp(mantissa, (codes >> MANTISSA_BITS) - _BIAS - MANTISSA_BITS)

    def error_bound(
        self, values: np.ndarray, rounding: str = "nearest_even", largest: np.ndarray | None = None
    ) -> np.ndarray:
        """The bound of the class docstring, for each number."""
        held = self._held(values)
        exponent, before = self._exponents(held if largest is None else self._held(largest), rounding)
        rounds_to_whole = np.ldexp(held, MANTISSA_BITS - before) >= _WHOLE - 0.5
        step = np.ldexp(1.0, np.where(rounds_to_whole, before, exponent) - MANTISSA_BITS)
        return step / 2 if rounding == "nearest_even" else step

    def _held(self, values: np.ndarray) -> np.ndarray:
        values = np.asarray(values, dtype=np.float64)
        return np.clip(np.where(np.isnan(values), 0.0, values), 0.0, self.highest)

    def _exponents(self, largest: np.ndarray, rounding: str) -> tuple[np.ndarray, np.ndarray]:
        """e of the class docstring after and before the largest channel rounds up to 2^9 steps."""
        before = binade(largest, -_BIAS - 1) + 1
        steps = _round(np.ldexp(largest, MANTISSA_BITS - before), rounding)
        return before + (steps >= _WHOLE), before
