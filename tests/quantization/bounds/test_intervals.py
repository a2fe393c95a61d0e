"""Every interval operation encloses the exact result, computed by mpmath, and is hardly wider than it."""

import mpmath
import numpy as np
import pytest

from axffit.quantization.bounds import intervals as iv
from axffit.quantization.bounds.intervals import Interval

COUNT = 2000
BINARY = {
    "add": (lambda a, b: a + b, lambda a, b: a + b),
    "subtract": (lambda a, b: a - b, lambda a, b: a - b),
    "multiply": (lambda a, b: a * b, lambda a, b: a * b),
    "divide": (lambda a, b: a / b, lambda a, b: a / b),
}
UNARY = {
    "square": (iv.square, lambda x: x * x, (-1e3, 1e3)),
    "sqrt": (iv.sqrt, mpmath.sqrt, (0.0, 1e6)),
    "exp": (iv.exp, mpmath.exp, (-700.0, 700.0)),
    "expm1": (iv.expm1, mpmath.expm1, (-30.0, 30.0)),
    "log": (iv.log, mpmath.log, (1e-300, 1e3)),
    "log1p": (iv.log1p, mpmath.log1p, (-0.99, 1e3)),
    "sinh": (iv.sinh, mpmath.sinh, (-30.0, 30.0)),
    "reciprocal": (iv.reciprocal, lambda x: 1 / x, (0.01, 1e3)),
}


@pytest.fixture(autouse=True)
def _quiet():
    with np.errstate(all="ignore"), mpmath.workdps(40):
        yield


def numbers(rng, low, high, count=COUNT):
    """Half of them spread evenly, half over the orders of magnitude."""
    even = rng.uniform(low, high, count // 2)
    small = np.sign(rng.uniform(low, high, count - count // 2)) * 10.0 ** rng.uniform(-12, 0, count - count // 2)
    return np.concatenate([even, np.clip(small, low, high)])


def pair_holding(rng, x):
    """Intervals around x, a third of them points."""
    width = np.abs(x) * 10.0 ** rng.uniform(-15, -1, x.shape) * (rng.random(x.shape) > 1 / 3)
    return Interval(x - width * rng.random(x.shape), x + width * rng.random(x.shape))


@pytest.mark.parametrize("name", BINARY)
def test_four_operations_enclose(name):
    ours, exact = BINARY[name]
    rng = np.random.default_rng(1)
    a, b = numbers(rng, -1e3, 1e3), numbers(rng, -1e3, 1e3)
    wide_a, wide_b = pair_holding(rng, a), pair_holding(rng, b)
    for result in (ours(wide_a, wide_b), ours(Interval(a, a), Interval(b, b))):
        for lo, hi, x, y in zip(result.lo, result.hi, a, b, strict=True):
            assert lo <= exact(mpmath.mpf(x), mpmath.mpf(y)) <= hi
    relative = (result.hi - result.lo) / np.maximum(np.abs(result.lo), 1e-300)
    assert np.all(relative <= 9 * 2.0**-52)


@pytest.mark.parametrize("name", UNARY)
def test_functions_enclose(name):
    ours, exact, domain = UNARY[name]
    rng = np.random.default_rng(2)
    x = numbers(rng, *domain)
    wide = iv.clip(pair_holding(rng, x), *domain)
    for result in (ours(wide), ours(Interval(x, x))):
        for lo, hi, value in zip(result.lo, result.hi, x, strict=True):
            assert lo <= exact(mpmath.mpf(value)) <= hi
    relative = (result.hi - result.lo) / np.maximum(np.abs(result.lo), 1e-300)
    assert np.all(relative <= (2 * iv.LIBRARY_ULPS + 4) * 2.0**-52)


@pytest.mark.parametrize("name", ["exp", "expm1", "log", "log1p", "sinh"])
def test_library_functions_err_by_less_than_is_allowed_for(name):
    """The assumption behind the outward rounding, measured: at most half of `LIBRARY_ULPS`."""
    _, exact, domain = UNARY[name]
    x = numbers(np.random.default_rng(3), *domain, count=6000)
    ours = getattr(np, name)(x)
    errors = [
        abs(mpmath.mpf(float(y)) - exact(mpmath.mpf(float(v)))) / np.spacing(abs(y))
        for v, y in zip(x, ours, strict=True)
    ]
    assert max(errors) <= iv.LIBRARY_ULPS / 2


def test_a_float_is_exactly_itself_and_operators_commute():
    x = Interval(np.array([1.0]), np.array([2.0]))
    for result, ends in [
        (1 + x, (2, 3)),
        (x - 1, (0, 1)),
        (1 - x, (-1, 0)),
        (2 * x, (2, 4)),
        (1 / x, (0.5, 1)),
        (-x, (-2, -1)),
    ]:
        assert result.lo[0] <= ends[0] <= ends[1] <= result.hi[0]
        assert result.hi[0] - result.lo[0] <= ends[1] - ends[0] + 1e-14


def test_signs_zero_and_infinity():
    x = Interval(np.array([-1.0, 0.0, -2.0, 1.0]), np.array([2.0, 0.5, 0.0, np.inf]))
    inverse = iv.reciprocal(x)
    assert np.isneginf(inverse.lo[0])
    assert np.isposinf(inverse.hi[0])
    assert inverse.lo[1] <= 2
    assert np.isposinf(inverse.hi[1])
    assert np.isneginf(inverse.lo[2])
    assert inverse.hi[2] >= -0.5
    assert inverse.lo[3] <= 0 <= inverse.hi[3] <= 1.1
    assert inverse.hi[3] >= 1
    assert iv.square(x).lo[0] == 0
    product = Interval(0.0, 0.0) * Interval(-np.inf, np.inf)
    assert abs(product.lo) < 1e-300
    assert abs(product.hi) < 1e-300
    assert iv.exp(Interval(-np.inf, np.inf)).lo == 0
    assert np.isposinf(iv.exp(Interval(0.0, 1e4)).hi)
    assert np.isneginf(iv.log(Interval(0.0, 1.0)).lo)
    assert np.isfinite(iv.exp(Interval(800.0, 900.0)).lo)
    assert np.isfinite(iv.log(Interval(0.0, 0.0)).hi)


def test_monotone_helpers_use_ends_only():
    x = Interval(np.array([1.0]), np.array([3.0]))

    def quotient(z):
        return z / (z + 1.0)

    tight, loose = iv.rising(quotient, x), quotient(x)
    assert tight.lo[0] <= 0.5
    assert tight.hi[0] >= 0.75
    assert tight.lo[0] > loose.lo[0]
    assert tight.hi[0] < loose.hi[0]
    fall = iv.falling(lambda z: 1.0 / z, x)
    assert fall.lo[0] <= 1 / 3
    assert fall.hi[0] >= 1
    assert iv.magnitude(Interval(-3.0, 2.0)) == 3
    joined = iv.hull(Interval(0.0, 1.0), Interval(-1.0, 0.5))
    assert (joined.lo, joined.hi) == (-1, 1)
