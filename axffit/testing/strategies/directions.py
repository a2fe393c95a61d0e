"""Directions and pairs of them."""

import numpy as np
from hypothesis import strategies as st

from axffit.testing.directions import GRAZING_COSINES

_MIRROR = np.array([-1.0, -1.0, 1.0])


def cosines(*, lowest: float = 0.0) -> st.SearchStrategy[float]:
    """Cosines with the normal in [``lowest``, 1], never 0: the normal itself, and grazing ones down to 1e-300."""
    if not 0 <= lowest < 1:
        raise ValueError(f"lowest={lowest}: a cosine from 0 up to, not including, 1")
    smallest = max(lowest, min(GRAZING_COSINES))
    corners = [1.0, smallest, *(cosine for cosine in GRAZING_COSINES if cosine > smallest)]
    return st.sampled_from(corners) | st.floats(smallest, 1.0)


def _azimuths() -> st.SearchStrategy[float]:
    return st.sampled_from([0.0, np.pi / 2, np.pi, -np.pi / 2]) | st.floats(-np.pi, np.pi)


def _direction(cosine: float, azimuth: float) -> np.ndarray:
    sine = np.sqrt((1 - cosine) * (1 + cosine))
    return np.array([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine])


def directions(*, lowest: float = 0.0) -> st.SearchStrategy[np.ndarray]:
    """Unit vectors (3,) above the horizon, their cosine with the normal at least ``lowest``."""
    return st.builds(_direction, cosines(lowest=lowest), _azimuths())


def lower_directions() -> st.SearchStrategy[np.ndarray]:
    """Unit vectors (3,) on the horizon or below it."""
    below = directions().map(lambda v: v * [1.0, 1.0, -1.0])
    return below | _azimuths().map(lambda azimuth: _direction(0.0, azimuth))


def direction_pairs(*, lowest: float = 0.0) -> st.SearchStrategy[tuple[np.ndarray, np.ndarray]]:
    """Pairs (wi, wo) above the horizon: coincident, mirrored, almost coincident, in one plane, or unrelated."""
    one = directions(lowest=lowest)
    coincident = one.map(lambda v: (v, v))
    mirrored = one.map(lambda v: (v, v * _MIRROR))
    close = st.builds(
        lambda cosine, azimuth, turn: (_direction(cosine, azimuth), _direction(cosine, azimuth + turn)),
        cosines(lowest=lowest),
        _azimuths(),
        st.sampled_from([1e-15, 1e-9, 1e-5, 1e-2]),
    )
    in_one_plane = st.builds(
        lambda first, second, azimuth, turn: (_direction(first, azimuth), _direction(second, azimuth + turn)),
        cosines(lowest=lowest),
        cosines(lowest=lowest),
        _azimuths(),
        st.sampled_from([0.0, np.pi]),
    )
    return st.one_of(coincident, mirrored, close, in_one_plane, st.tuples(one, one))
