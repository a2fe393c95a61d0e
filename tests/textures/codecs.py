"""The table every law of codecs runs over: a codec added here inherits all of them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from axffit.textures.codec import ScalarCodec
from axffit.textures.floats import HALF, SINGLE
from axffit.textures.packed_floats import SharedExponent, UnsignedFloat
from axffit.textures.unorm import Snorm, SrgbUnorm, Uint, Unorm

NAN, INF = np.nan, np.inf
LARGEST_SINGLE = SINGLE.highest


class Case(NamedTuple):
    """A codec and what NaN, -infinity, +infinity and finite numbers far below and above its range decode as.

    Numbers beyond the range of an IEEE float depend on the rounding and have tests of their own: None here.
    """

    make: Callable[[], ScalarCodec]
    nan: float
    infinities: tuple[float, float]
    beyond: tuple[float, float] | None


REAL_CODECS: dict[str, Case] = {
    "UNORM2": Case(lambda: Unorm(2), 0, (0, 1), (0, 1)),
    "UNORM8": Case(lambda: Unorm(8), 0, (0, 1), (0, 1)),
    "UNORM10": Case(lambda: Unorm(10), 0, (0, 1), (0, 1)),
    "UNORM16": Case(lambda: Unorm(16), 0, (0, 1), (0, 1)),
    "SNORM8": Case(lambda: Snorm(8), 0, (-1, 1), (-1, 1)),
    "SNORM16": Case(lambda: Snorm(16), 0, (-1, 1), (-1, 1)),
    "SRGB8": Case(lambda: SrgbUnorm(8), 0, (0, 1), (0, 1)),
    "half": Case(lambda: HALF, NAN, (-INF, INF), None),
    "unsigned float of 11 bits": Case(lambda: UnsignedFloat(11), NAN, (0, INF), (0, 65024)),
    "unsigned float of 10 bits": Case(lambda: UnsignedFloat(10), NAN, (0, INF), (0, 64512)),
    "shared exponent": Case(SharedExponent, 0, (0, 65408), (0, 65408)),
    "float32": Case(lambda: SINGLE, NAN, (-INF, INF), None),
}
"""Codecs that take real numbers."""

CODECS: dict[str, Callable[[], ScalarCodec]] = {
    **{name: case.make for name, case in REAL_CODECS.items()},
    "UINT8": lambda: Uint(8),
    "UINT16": lambda: Uint(16),
}
"""Every codec."""
