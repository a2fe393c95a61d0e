"""Interval arithmetic on float64 arrays with outward rounding.

An `Interval` is an array of lower and one of upper ends; every operation returns ends that enclose the exact result
for all exact operands between the given ends. The four operations and the square root are correctly rounded by IEEE
754, so that one `nextafter` outward suffices. For the library functions (`exp`, `log`, …) that no standard binds,
`LIBRARY_ULPS` is allowed, then one `nextafter`; numpy's vectorized versions promise 4. A float beside an interval is
that very number. Infinite ends are legal; 0 · inf counts as 0, as the operands themselves are finite numbers.
"""

from collections.abc import Callable
from typing import Union

import numpy as np

LIBRARY_ULPS = 8
"""Largest error of a library function that is allowed for, in units in the last place."""

Operand = Union["Interval", float]
"""An interval, or a float that stands for exactly itself."""

_LIBRARY = LIBRARY_ULPS * 2.0**-52
_LIBRARY_SUBNORMAL = LIBRARY_ULPS * 2.0**-1074


class Interval:
    """Intervals [lo, hi], elementwise.

    Attributes:
        lo: lower ends, float64 of any shape; a scalar becomes shape (1,).
        hi: upper ends, same shape, hi >= lo.
    """

    __slots__ = ("hi", "lo")

    def __init__(self, lo: np.ndarray | float, hi: np.ndarray | float):
        """Ends as they are, without rounding."""
        self.lo = np.atleast_1d(np.asarray(lo, np.float64))
        self.hi = np.atleast_1d(np.asarray(hi, np.float64))

    def __repr__(self) -> str:
        return f"Interval({self.lo!r}, {self.hi!r})"

    def __getitem__(self, index: np.ndarray) -> "Interval":
        """Some of the elements."""
        return Interval(self.lo[index], self.hi[index])

    def __neg__(self) -> "Interval":
        return Interval(-self.hi, -self.lo)

    def __add__(self, other: Operand) -> "Interval":
        lo, hi = (other.lo, other.hi) if isinstance(other, Interval) else (other, other)
        return Interval(np.nextafter(self.lo + lo, -np.inf), np.nextafter(self.hi + hi, np.inf))

    __radd__ = __add__

    def __sub__(self, other: Operand) -> "Interval":
        lo, hi = (other.lo, other.hi) if isinstance(other, Interval) else (other, other)
        return Interval(np.nextafter(self.lo - hi, -np.inf), np.nextafter(self.hi - lo, np.inf))

    def __rsub__(self, other: float) -> "Interval":
        return Interval(np.nextafter(other - self.hi, -np.inf), np.nextafter(other - self.lo, np.inf))

    def __mul__(self, other: Operand) -> "Interval":
        lo, hi = (other.lo, other.hi) if isinstance(other, Interval) else (other, other)
        products = np.stack(np.broadcast_arrays(self.lo * lo, self.lo * hi, self.hi * lo, self.hi * hi))
        products = np.where(np.isnan(products), 0.0, products)
        return Interval(np.nextafter(products.min(axis=0), -np.inf), np.nextafter(products.max(axis=0), np.inf))

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> "Interval":
        return self * reciprocal(other if isinstance(other, Interval) else Interval(other, other))

    def __rtruediv__(self, other: float) -> "Interval":
        return reciprocal(self) * other


def down(x: np.ndarray) -> np.ndarray:
    """The next float below."""
    return np.nextafter(x, -np.inf)


def up(x: np.ndarray) -> np.ndarray:
    """The next float above."""
    return np.nextafter(x, np.inf)


def reciprocal(x: Interval) -> Interval:
    """1 / x; everything where x holds 0 inside, one-sided where 0 is an end."""
    inside = (x.lo < 0) & (x.hi > 0)
    lo = np.where(inside | (x.hi == 0), -np.inf, np.nextafter(1.0 / np.where(x.hi == 0, 1.0, x.hi), -np.inf))
    hi = np.where(inside | (x.lo == 0), np.inf, np.nextafter(1.0 / np.where(x.lo == 0, 1.0, x.lo), np.inf))
    return Interval(lo, hi)


def square(x: Interval) -> Interval:
    """x², never negative."""
    a, b = x.lo * x.lo, x.hi * x.hi
    low = np.where((x.lo <= 0) & (x.hi >= 0), 0.0, np.minimum(a, b))
    return Interval(np.maximum(np.nextafter(low, -np.inf), 0.0), np.nextafter(np.maximum(a, b), np.inf))


def sqrt(x: Interval) -> Interval:
    """Square root of the part of x that is not negative."""
    lo, hi = np.sqrt(np.maximum(x.lo, 0.0)), np.sqrt(np.maximum(x.hi, 0.0))
    return Interval(np.maximum(np.nextafter(lo, -np.inf), 0.0), np.nextafter(hi, np.inf))


def _rising(function: Callable[[np.ndarray], np.ndarray], x: Interval, least: float) -> Interval:
    """A rising library function, its values at least `least`."""
    lo, hi = function(x.lo), function(x.hi)
    lo = np.nextafter(lo - (np.abs(lo) * _LIBRARY + _LIBRARY_SUBNORMAL), -np.inf)
    hi = np.nextafter(hi + (np.abs(hi) * _LIBRARY + _LIBRARY_SUBNORMAL), np.inf)
    # inf - inf: an end that overflowed inwards stops at the largest float, which still encloses.
    largest = np.finfo(np.float64).max
    lo, hi = np.where(np.isnan(lo), largest, lo), np.where(np.isnan(hi), -largest, hi)
    return Interval(np.maximum(lo, least), hi)


def exp(x: Interval) -> Interval:
    """e^x."""
    return _rising(np.exp, x, 0.0)


def expm1(x: Interval) -> Interval:
    """e^x - 1."""
    return _rising(np.expm1, x, -1.0)


def log(x: Interval) -> Interval:
    """Natural logarithm of the part of x that is not negative; -inf at 0."""
    return _rising(np.log, clip(x, 0.0, np.inf), -np.inf)


def log1p(x: Interval) -> Interval:
    """log(1 + x) of the part of x above -1; -inf at -1."""
    return _rising(np.log1p, clip(x, -1.0, np.inf), -np.inf)


def sinh(x: Interval) -> Interval:
    """Hyperbolic sine."""
    return _rising(np.sinh, x, -np.inf)


def clip(x: Interval, least: float | np.ndarray, most: float | np.ndarray) -> Interval:
    """The part of x between two numbers; where there is none, the nearer of the two."""
    return Interval(np.clip(x.lo, least, most), np.clip(x.hi, least, most))


def hull(*parts: Interval) -> Interval:
    """The smallest interval that holds all of them."""
    lo, hi = parts[0].lo, parts[0].hi
    for part in parts[1:]:
        lo, hi = np.minimum(lo, part.lo), np.maximum(hi, part.hi)
    return Interval(lo, hi)


def magnitude(x: Interval) -> np.ndarray:
    """The largest |x|."""
    return np.maximum(np.abs(x.lo), np.abs(x.hi))


def rising(function: Callable[[Interval], Interval], x: Interval) -> Interval:
    """A function that is known to rise with x, at its ends only: free of what repeated use of x would add."""
    return Interval(function(Interval(x.lo, x.lo)).lo, function(Interval(x.hi, x.hi)).hi)


def falling(function: Callable[[Interval], Interval], x: Interval) -> Interval:
    """A function that is known to fall with x, at its ends only."""
    return Interval(function(Interval(x.hi, x.hi)).lo, function(Interval(x.lo, x.lo)).hi)
