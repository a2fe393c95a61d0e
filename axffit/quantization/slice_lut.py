"""The slice table in an 8-bit UNORM texel: which entries a shader gets back, by how it decodes and rounds.

An entry k is stored as k / 255. Reading it back as `255 · texel` is exact on paper; on a GPU the texel may be held as a
half, and Direct3D allows a decode to err by 0.6 ULP of its float, other APIs by one. Truncating then loses k.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..textures.unorm import Unorm

ENTRIES = np.arange(256)


def _decoded() -> np.ndarray:
    """k / 255 rounded to float32, k from the code that k / 255 (computed in float32) encodes to."""
    stored = ENTRIES.astype(np.float32) / np.float32(255)
    return Unorm(8).encode(stored).astype(np.float32) / np.float32(255)


def _lowest_within(ulps: float) -> np.ndarray:
    """The smallest float32 within so many ULP below the exact k / 255."""
    nearest = _decoded()
    lower = np.maximum(np.nextafter(nearest, np.float32(-1)), np.float32(0))
    gap = nearest.astype(np.float64) - lower.astype(np.float64)
    reachable = ENTRIES / 255 - lower.astype(np.float64) <= ulps * gap
    return np.where(reachable & (ENTRIES > 0), lower, nearest)


def _one_ulp_low() -> np.ndarray:
    return np.maximum(np.nextafter(_decoded(), np.float32(-1)), np.float32(0))


def _half() -> np.ndarray:
    return _decoded().astype(np.float16)


DECODES: Mapping[str, Callable[[], np.ndarray]] = {
    "float32": _decoded,
    "float32, 0.6 ULP low": lambda: _lowest_within(0.6),
    "float32, one ULP low": _one_ulp_low,
    "half texel, float32 product": lambda: _half().astype(np.float32),
    "half texel, half product": _half,
}
"""How a shader may hold the texel."""

READINGS: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {"truncated": np.trunc, "rounded": np.rint}
"""How it turns 255 · texel into an index."""


@dataclass(frozen=True)
class LutReading:
    """One way to read the table.

    Attributes:
        decode: how the texel is held.
        rounding: "truncated" or "rounded".
        failures: every k in 0..255 that does not come back.
    """

    decode: str
    rounding: str
    failures: tuple[int, ...]


def lut_readings() -> tuple[LutReading, ...]:
    """Every decode with both readings, exhaustively over k = 0..255; R8_UINT, which divides nothing, has no failure."""
    readings = []
    for decode, texels in DECODES.items():
        held = texels()
        product = held * held.dtype.type(255)
        for rounding, index in READINGS.items():
            failures = tuple(int(k) for k in ENTRIES[index(product).astype(int) != ENTRIES])
            readings.append(LutReading(decode, rounding, failures))
    readings.extend(LutReading("R8_UINT", rounding, ()) for rounding in READINGS)
    return tuple(readings)


def lut_json(entries: np.ndarray) -> dict[str, Any]:
    """The readings as JSON, with the failures among the entries this table uses."""
    used = {int(k) for k in entries}
    rows = [
        {
            "decode": reading.decode,
            "rounding": reading.rounding,
            "failures": list(reading.failures),
            "failures_used": [k for k in reading.failures if k in used],
        }
        for reading in lut_readings()
    ]
    return {"entries": [int(k) for k in entries], "readings": rows}
