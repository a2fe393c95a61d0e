"""The largest error of a codec, found exhaustively: what a proven bound is held against.

Encoding is monotone, so between two neighboring numbers of a format lies exactly one place where the code changes.
`straddles` finds the two neighboring float64 numbers on its sides; in between no float64 exists, and the error grows
toward them from either side, so the largest error there is the largest over all float64 numbers of the cell.
"""

from dataclasses import dataclass

import numpy as np

from .codec import ScalarCodec
from .floats import SINGLE
from .unorm import SrgbUnorm

_DEVICE = 0.6


@dataclass(frozen=True)
class WorstCase:
    """The largest error against the bound.

    Attributes:
        numbers: where each cell's error is largest, ascending.
        errors: the error there.
        bounds: the proven bound there.
    """

    numbers: np.ndarray
    errors: np.ndarray
    bounds: np.ndarray

    @property
    def ratio(self) -> float:
        """The largest bound / error of any cell: 1 is a bound that cannot be lowered anywhere."""
        return float(np.max(self.bounds / self.errors))

    @property
    def holds(self) -> bool:
        """Whether no error exceeds its bound."""
        return bool(np.all(self.errors <= self.bounds))


def finite_numbers(codec: ScalarCodec) -> np.ndarray:
    """Every finite number of a format, ascending; of binary32 40 neighboring pairs a binade, drawn with seed 0."""
    if codec.bits > 16:
        return _neighbors_of_singles()
    values = codec.decode(codec.all_codes())
    return np.unique(values[np.isfinite(values)])


def _neighbors_of_singles() -> np.ndarray:
    rng = np.random.default_rng(0)
    exponents = np.repeat(np.arange(255, dtype=np.uint32), 40)
    mantissas = rng.integers(0, 2**23 - 1, exponents.size, dtype=np.uint32)
    mantissas[::40], mantissas[1::40] = 0, 2**23 - 2
    low = (exponents << np.uint32(23)) | mantissas
    positive = SINGLE.decode(np.unique(np.concatenate([low, low + np.uint32(1)])))
    return np.unique(np.concatenate([-positive, positive]))


def neighbors(codec: ScalarCodec) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of numbers of a format with none in between, the lower and the higher ones."""
    numbers = finite_numbers(codec)
    low, high = numbers[:-1], numbers[1:]
    if codec.bits > 16:
        adjacent = np.nextafter(low.astype(np.float32), np.float32(np.inf)).astype(np.float64) == high
        return low[adjacent], high[adjacent]
    return low, high


def straddles(codec: ScalarCodec, rounding: str = "nearest_even") -> tuple[np.ndarray, np.ndarray]:
    """For each pair of `neighbors` the two neighboring float64 numbers between which the encoder changes its mind.

    Found by bisection in the order of float64's bit patterns; the first of the two is encoded as the lower number, the
    second as the higher one.
    """
    low, high = neighbors(codec)
    below, above = _ordinals(low), _ordinals(high)
    while np.any(above - below > 1):
        middle = below + (above - below) // 2
        decoded = codec.decode(codec.encode(_numbers(middle), rounding))
        upper = decoded > low
        below, above = np.where(upper, below, middle), np.where(upper, middle, above)
    return _numbers(below), _numbers(above)


def worst_case(codec: ScalarCodec, rounding: str = "nearest_even") -> WorstCase:
    """The largest error in each cell between two numbers of a format.

    ``device`` allows more encoders than the one that axffit has. Behind a curve the worst of them is another one: it
    rounds up from a fraction of 0.4 on, and its errors are counted too.
    """
    low, high = neighbors(codec)
    below, above = straddles(codec, rounding)
    numbers, errors = np.concatenate([below, above]), np.concatenate([below - low, high - above])
    if rounding == "device" and isinstance(codec, SrgbUnorm):
        numbers = np.concatenate([numbers, codec.decode(codec.all_codes()[1:] - _DEVICE)])
        errors = np.concatenate([errors, high - numbers[-len(high) :]])
    cells = np.tile(np.arange(len(low)), len(numbers) // len(low))
    # The worst of each cell: sorted by error, the last entry of a cell stays.
    order = np.argsort(errors, kind="stable")
    worst = np.empty(len(low), dtype=np.int64)
    worst[cells[order]] = order
    return WorstCase(numbers[worst], errors[worst], codec.error_bound(numbers[worst], rounding))


def _ordinals(numbers: np.ndarray) -> np.ndarray:
    """Integers in the order of float64 numbers, neighbors one apart."""
    bits = (numbers + 0.0).view(np.int64)  # -0 becomes 0
    return np.where(bits < 0, np.iinfo(np.int64).min - bits, bits)


def _numbers(ordinals: np.ndarray) -> np.ndarray:
    return np.where(ordinals < 0, np.iinfo(np.int64).min - ordinals, ordinals).view(np.float64)
