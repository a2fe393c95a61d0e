"""The tables every law below runs over: a codec added here inherits all of them."""

from collections.abc import Callable

import numpy as np

from axffit.textures.codec import ScalarCodec
from axffit.textures.floats import HALF, SINGLE
from axffit.textures.unorm import SrgbUnorm, Uint, Unorm

REAL_CODECS: dict[str, Callable[[], ScalarCodec]] = {
    "UNORM8": lambda: Unorm(8),
    "UNORM16": lambda: Unorm(16),
    "SRGB8": lambda: SrgbUnorm(8),
    "half": lambda: HALF,
    "float32": lambda: SINGLE,
}
"""Codecs that take real numbers."""

CODECS: dict[str, Callable[[], ScalarCodec]] = {**REAL_CODECS, "UINT8": lambda: Uint(8), "UINT16": lambda: Uint(16)}
"""Every codec."""

SMALL_CODECS = {name: make for name, make in CODECS.items() if make().bits <= 16}
"""Codecs whose codes can be listed."""


def finite_codes(codec: ScalarCodec) -> np.ndarray:
    """Every code of a finite number in ascending order of the number (float32: a seeded sample of every binade)."""
    if codec is SINGLE:
        rng = np.random.default_rng(0)
        exponents = np.repeat(np.arange(255, dtype=np.uint32), 40)
        mantissas = rng.integers(0, 2**23, exponents.size, dtype=np.uint32)
        mantissas[::40], mantissas[1::40] = 0, 2**23 - 1
        positive = (exponents << np.uint32(23)) | mantissas
        codes = np.concatenate([positive, positive | np.uint32(2**31)])
    else:
        codes = codec.all_codes()
    values = codec.decode(codes)
    codes, values = codes[np.isfinite(values)], values[np.isfinite(values)]
    return codes[np.argsort(values, kind="stable")]
