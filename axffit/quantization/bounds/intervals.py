"""Interval arithmetic on float64 arrays with outward rounding.

An `Interval` is an array of lower and one of upper ends; every operation returns ends that enclose the exact result
for all exact operands between the given ends. The four operations and the square root are correctly rounded by IEEE
754, so that one rounding outward (`down`, `up`) suffices. For the library functions (`exp`, `log`, …) that no standard
binds, `LIBRARY_ULPS` is allowed, then one rounding outward; numpy's vectorized versions promise 4. A float beside an
interval is that very number. Infinite ends are legal; 0 · inf counts as 0, as the operands themselves are finite
numbers.
"""

from collections.abc import Callable
from typing import Union

import numpy as np

LIBRARY_ULPS = 8
"""Largest error of a library function that is allowed for, in units in the last place."""

Operand = Union["Interval", float]
"""An interval, or a float that stands for exactly itself."""

_LARGEST, _SMALLEST, _ULP = float(np.finfo(np.float64).max), 2.0**-1074, 2.0**-52
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
        # The operations below hand in arrays, and their number makes every call count.
        self.lo = lo if type(lo) is np.ndarray and lo.ndim else np.atleast_1d(np.asarray(lo, np.float64))
        self.hi = hi if type(hi) is np.ndarray and hi.ndim else np.atleast_1d(np.asarray(hi, np.float64))

    def __repr__(self) -> str:
        return f"Interval({self.lo!r}, {self.hi!r})"

    def __getitem__(self, index: np.ndarray) -> "Interval":
        """Some of the elements."""
        return Interval(self.lo[index], self.hi[index])

    def __neg__(self) -> "Interval":
        return Interval(-self.hi, -self.lo)

    def __add__(self, other: Operand) -> "Interval":
        lo, hi = (other.lo, other.hi) if isinstance(other, Interval) else (other, other)
        return Interval(down(self.lo + lo), up(self.hi + hi))

    __radd__ = __add__

    def __sub__(self, other: Operand) -> "Interval":
        lo, hi = (other.lo, other.hi) if isinstance(other, Interval) else (other, other)
        return Interval(down(self.lo - hi), up(self.hi - lo))

    def __rsub__(self, other: float) -> "Interval":
        return Interval(down(other - self.hi), up(other - self.lo))

    def __mul__(self, other: Operand) -> "Interval":
        if isinstance(other, Interval):
            products = (self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi)
        else:
            products = (self.lo * other, self.hi * other)
        lo, hi = _least(products), _most(products)
        if np.isnan(lo).any():
            products = tuple(np.where(np.isnan(x), 0.0, x) for x in products)
            lo, hi = _least(products), _most(products)
        return Interval(down(lo), up(hi))

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> "Interval":
        return self * reciprocal(other if isinstance(other, Interval) else Interval(other, other))

    def __rtruediv__(self, other: float) -> "Interval":
        return reciprocal(self) * other


def down(x: np.ndarray) -> np.ndarray:
    """At or below every number that rounds to x, to nearest.

    x - (|x| 2^-52 + the smallest float): `np.nextafter` would be closer by an ULP and five times slower.
    """
    x = np.minimum(x, _LARGEST)
    step = np.abs(x)
    step *= _ULP
    step += _SMALLEST
    x -= step
    return x


def up(x: np.ndarray) -> np.ndarray:
    """At or above every number that rounds to x, to nearest."""
    x = np.maximum(x, -_LARGEST)
    step = np.abs(x)
    step *= _ULP
    step += _SMALLEST
    x += step
    return x


def _least(parts: tuple[np.ndarray, ...]) -> np.ndarray:
    least = np.minimum(parts[0], parts[1])
    return np.minimum(least, np.minimum(parts[2], parts[3])) if len(parts) == 4 else least


def _most(parts: tuple[np.ndarray, ...]) -> np.ndarray:
    most = np.maximum(parts[0], parts[1])
    return np.maximum(most, np.maximum(parts[2], parts[3])) if len(parts) == 4 else most


def reciprocal(x: Interval) -> Interval:
    """1 / x; everything where x holds 0 inside, one-sided where 0 is an end."""
    inside = (x.lo < 0) & (x.hi > 0)
    lo = np.where(inside | (x.hi == 0), -np.inf, down(1.0 / np.where(x.hi == 0, 1.0, x.hi)))
    hi = np.where(inside | (x.lo == 0), np.inf, up(1.0 / np.where(x.lo == 0, 1.0, x.lo)))
    return Interval(lo, hi)


def square(x: Interval) -> Interval:
    """x², never negative."""
    a, b = x.lo * x.lo, x.hi * x.hi
    low = np.where((x.lo <= 0) & (x.hi >= 0), 0.0, np.minimum(a, b))
    return Interval(np.maximum(down(low), 0.0), up(np.maximum(a, b)))


def sqrt(x: Interval) -> Interval:
    """Square root of the part of x that is not negative."""
    lo, hi = np.sqrt(np.maximum(x.lo, 0.0)), np.sqrt(np.maximum(x.hi, 0.0))
    return Interval(np.maximum(down(lo), 0.0), up(hi))


def _rising(function: Callable[[np.ndarray], np.ndarray], x: Interval, least: float) -> Interval:
    """A rising library function, its values at least `least`."""
    lo, hi = function(x.lo), function(x.hi)
    lo = down(lo - (np.abs(lo) * _LIBRARY + _LIBRARY_SUBNORMAL))
    hi = up(hi + (np.abs(hi) * _LIBRARY + _LIBRARY_SUBNORMAL))
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


def cos(x: Interval) -> Interval:
    """Cosine of angles of moderate size; an absolute error of `LIBRARY_ULPS` of 1 is allowed for."""
    pad = _LIBRARY
    ends = np.cos(x.lo), np.cos(x.hi)
    low, high = np.minimum(*ends) - pad, np.maximum(*ends) + pad
    low = np.where(_holds(x, np.pi), -1.0, np.maximum(low, -1.0))
    return Interval(low, np.where(_holds(x, 0.0), 1.0, np.minimum(high, 1.0)))


def sin(x: Interval) -> Interval:
    """Sine, as `cos`."""
    pad = _LIBRARY
    ends = np.sin(x.lo), np.sin(x.hi)
    low, high = np.minimum(*ends) - pad, np.maximum(*ends) + pad
    low = np.where(_holds(x, -0.5 * np.pi), -1.0, np.maximum(low, -1.0))
    return Interval(low, np.where(_holds(x, 0.5 * np.pi), 1.0, np.minimum(high, 1.0)))


def _holds(x: Interval, angle: float) -> np.ndarray:
    """Whether intervals may hold an angle, up to whole turns; the slack covers the rounding of pi."""
    turns = [(end - angle) / (2 * np.pi) for end in (x.lo, x.hi)]
    return np.floor(turns[1] + 1e-12) >= np.ceil(turns[0] - 1e-12)


def clip(x: Interval, least: float | np.ndarray, most: float | np.ndarray) -> Interval:
    """The part of x between two numbers; where there is none, the nearer of the two."""
    return Interval(np.clip(x.lo, least, most), np.clip(x.hi, least, most))


def hull(*parts: Interval) -> Interval:
    """The smallest interval that holds all of them."""
    lo, hi = parts[0].lo, parts[0].hi
    for part in parts[1:]:
        lo, hi = np.minimum(lo, part.lo), np.maximum(hi, part.hi)
    return Interval(lo, hi)


def lesser(a: Interval, b: Interval) -> Interval:
    """The smaller of two quantities."""
    return Interval(np.minimum(a.lo, b.lo), np.minimum(a.hi, b.hi))


def greater(a: Interval, b: Interval) -> Interval:
    """The larger of two quantities."""
    return Interval(np.maximum(a.lo, b.lo), np.maximum(a.hi, b.hi))


def around(x: Interval, radius: float | np.ndarray) -> Interval:
    """Everything within a distance."""
    return Interval(down(x.lo - radius), up(x.hi + radius))


def meet(a: Interval, b: Interval) -> Interval:
    """What two enclosures of the same quantity have in common; the first where rounding leaves nothing."""
    lo, hi = np.maximum(a.lo, b.lo), np.minimum(a.hi, b.hi)
    return Interval(np.where(lo <= hi, lo, a.lo), np.where(lo <= hi, hi, a.hi))


def magnitude(x: Interval) -> np.ndarray:
    """The largest |x|."""
    return np.maximum(np.abs(x.lo), np.abs(x.hi))


def rising(function: Callable[[Interval], Interval], x: Interval) -> Interval:
    """A function that is known to rise with x, at its ends only: free of what repeated use of x would add."""
    return Interval(function(Interval(x.lo, x.lo)).lo, function(Interval(x.hi, x.hi)).hi)


def falling(function: Callable[[Interval], Interval], x: Interval) -> Interval:
    """A function that is known to fall with x, at its ends only."""
    return Interval(function(Interval(x.hi, x.hi)).lo, function(Interval(x.lo, x.lo)).hi)
