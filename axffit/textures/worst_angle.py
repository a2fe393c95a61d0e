"""The largest angle a unit-vector encoding errs by, searched for: what a proven bound is held against.

Within the vectors of one code the angle to the decoded vector is largest at the corners: where two stored components
lie on rounding boundaries. For components of 8 bits or fewer all corners are tried, on all their sides; for wider
ones corners next to drawn vectors, and then those around the worst ones found.
"""

import functools
from collections.abc import Iterator

import numpy as np

from .unit_vectors import Components, RebuiltZ, UnitVectorEncoding
from .worst_case import straddles

_DRAWN = 50_000
_BEST = 400
_CLIMBS = 30


def angles_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles [...] in radians between vectors [..., 3], precise at every angle."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1))


def random_vectors(count: int, seed: int) -> np.ndarray:
    """Unit vectors [count, 3] spread evenly over the hemisphere z >= 0."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors * np.where(vectors[:, 2:] < 0, [1.0, 1.0, -1.0], 1.0)


def angle_errors(encoding: UnitVectorEncoding, vectors: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
    """Angles in radians between vectors [..., 3] and what they come back as."""
    return angles_between(vectors, encoding.decode(encoding.encode(vectors, rounding)))


@functools.cache
def largest_angle(encoding: UnitVectorEncoding, rounding: str = "nearest_even", seed: int = 0) -> float:
    """The largest angle found, radians."""
    codec, offset = encoding.stored.codec, encoding.stored.offset
    ends = np.unique(np.concatenate([*straddles(codec, rounding), [codec.lowest, codec.highest]]))
    ends = 2.0 * ends - 1.0 if offset else ends
    ends = ends[np.abs(ends) <= 1.0]
    if codec.bits <= 8:
        first, second = (side.reshape(-1) for side in np.meshgrid(ends, ends))
        return max(float(angle_errors(encoding, v, rounding).max()) for v in _corners(encoding, first, second))
    rng = np.random.default_rng(seed)
    around, largest = _drawn(encoding, seed), 0.0
    for climb in range(_CLIMBS):
        tried = np.concatenate(list(_snapped(encoding, around, ends, rng)))
        order = np.argsort(_squared_sines(encoding, tried, rounding), kind="stable")
        largest = max(largest, float(angle_errors(encoding, tried[order[-1:]], rounding).max()))
        best = np.repeat(tried[order[-_BEST:]], 20, axis=0)
        around = best + rng.normal(size=best.shape) * 0.1 * 0.5**climb
        around[:, 2] = np.abs(around[:, 2])
        around /= np.linalg.norm(around, axis=-1, keepdims=True)
    return largest


def _squared_sines(encoding: UnitVectorEncoding, vectors: np.ndarray, rounding: str) -> np.ndarray:
    """What ranks angles by operations that IEEE 754 binds: many are equal, and every machine has its own arctan2."""
    return np.sum(np.cross(vectors, encoding.decode(encoding.encode(vectors, rounding))) ** 2, axis=-1)


def _drawn(encoding: UnitVectorEncoding, seed: int) -> np.ndarray:
    vectors = random_vectors(_DRAWN, seed)
    if isinstance(encoding, RebuiltZ):
        # A rebuilt z is worst next to the horizon.
        vectors[::2, 2] *= 0.01
        vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors


def _snapped(
    encoding: UnitVectorEncoding, vectors: np.ndarray, ends: np.ndarray, rng: np.random.Generator
) -> Iterator[np.ndarray]:
    """Corners next to vectors: two components moved to one of the nearest ends of their cells."""
    for axes in ((0, 1), (0, 2)) if encoding.channels == 3 else ((0, 1),):
        components = encoding.components(vectors)[..., axes]
        near = np.searchsorted(ends, components) + rng.integers(-2, 2, components.shape)
        first, second = ends[np.clip(near, 0, len(ends) - 1)].T
        yield from _corners(encoding, first, second)


def _corners(encoding: UnitVectorEncoding, first: np.ndarray, second: np.ndarray) -> Iterator[np.ndarray]:
    """Unit vectors of the hemisphere with two stored components as given, [n] each."""
    if not isinstance(encoding, Components | RebuiltZ):
        yield encoding.direction(np.stack([first, second], axis=-1))
        return
    inside = first**2 + second**2 <= 1.0
    first, second = first[inside], second[inside]
    third = np.sqrt(np.maximum(1.0 - first**2 - second**2, 0.0))
    yield np.stack([first, second, third], axis=-1)
    if isinstance(encoding, RebuiltZ):
        rim = np.sqrt(1.0 - first**2)
        yield np.stack([first, np.where(second < 0, -rim, rim), np.zeros_like(first)], axis=-1)
        return
    upper = second >= 0
    for sign in (1.0, -1.0):
        yield np.stack([first, sign * third, second], axis=-1)[upper]
