"""Parameters of the models: each kind over its whole legal range, the ends often."""

import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import numpy as np
from hypothesis import strategies as st

from axffit.numerics import LOWEST_ROUGHNESS

Made = TypeVar("Made")
Draw = Callable[[st.SearchStrategy], Any]
"""How a composite strategy draws from others."""


@contextmanager
def _random_state_kept() -> Iterator[None]:
    """Python's random state is put back in the end.

    Hypothesis forbids strategies to draw from ``random``; run-time type checkers do so to choose what to look at.
    """
    state = random.getstate()
    try:
        yield
    finally:
        random.setstate(state)


def built(make: Callable[..., Made], *arguments: object) -> Made:
    """``make(*arguments)``, whatever type checks that runs."""
    with _random_state_kept():
        return make(*arguments)


def composite(function: Callable[..., Made]) -> Callable[..., st.SearchStrategy[Made]]:
    """``hypothesis.strategies.composite``, whatever type checks the function runs."""

    @st.composite
    def drawn(draw: Draw, *arguments: Any, **named: Any) -> Made:
        with _random_state_kept():
            return function(draw, *arguments, **named)

    drawn.__doc__, drawn.__name__ = function.__doc__, function.__name__
    return drawn


def _check_range(what: str, lowest: float, highest: float, *, above: float) -> None:
    if not above < lowest < highest < np.inf:
        raise ValueError(f"{what} from {lowest} to {highest}: give a finite range above {above}")


def _spread(lowest: float, highest: float) -> st.SearchStrategy[float]:
    """Positive numbers, equally often in every octave, and both ends."""
    logarithms = st.floats(np.log(lowest), np.log(highest))
    inside = logarithms.map(lambda x: float(np.clip(np.exp(x), lowest, highest)))
    return st.sampled_from([lowest, highest]) | inside


def _per_axis(one: st.SearchStrategy[float], *, anisotropic: bool | None) -> st.SearchStrategy[np.ndarray]:
    isotropic, two = one.map(np.asarray), st.tuples(one, one).map(np.asarray)
    return isotropic | two if anisotropic is None else two if anisotropic else isotropic


def colors(*, highest: float = 1000.0) -> st.SearchStrategy[np.ndarray]:
    """Linear RGB (3,), >= 0: black, white, pure, in [0, 1], and above 1 up to ``highest``."""
    if not 1 <= highest < np.inf:
        raise ValueError(f"highest={highest}: a finite number from 1 on")
    corners = st.sampled_from([(0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0), (highest, 1.0, 0.0)])
    channel, bright = st.floats(0.0, 1.0), st.floats(0.0, highest)
    return st.one_of(corners, st.tuples(*[channel] * 3), st.tuples(*[bright] * 3)).map(np.asarray)


def roughnesses(
    *, lowest: float = LOWEST_ROUGHNESS, highest: float = 10.0, anisotropic: bool | None = False
) -> st.SearchStrategy[np.ndarray]:
    """Roughness: shape () or, ``anisotropic``, (2,); None draws both kinds."""
    _check_range("roughnesses", lowest, highest, above=0.0)
    return _per_axis(_spread(lowest, highest), anisotropic=anisotropic)


def exponents(*, highest: float = 1e5, anisotropic: bool | None = False) -> st.SearchStrategy[np.ndarray]:
    """Exponents of the Phong family from 0 to ``highest``: shape () or, ``anisotropic``, (2,); None draws both."""
    _check_range("exponents", 0.01, highest, above=0.0)
    return _per_axis(st.just(0.0) | _spread(0.01, highest), anisotropic=anisotropic)


def f0s() -> st.SearchStrategy[np.ndarray]:
    """Reflectance at normal incidence in [0, 1], shape () or (3,)."""
    one = st.sampled_from([0.0, 1.0, 0.04]) | st.floats(0.0, 1.0)
    return one.map(np.asarray) | st.tuples(one, one, one).map(np.asarray)


def iors(*, lowest: float = 1.0, highest: float = 3.0) -> st.SearchStrategy[np.ndarray]:
    """Indices of refraction, (), 1 among them where it lies in the range."""
    _check_range("iors", lowest, highest, above=0.0)
    corners = [lowest, *([1.0] if lowest < 1 < highest else []), highest]
    return (st.sampled_from(corners) | st.floats(lowest, highest)).map(np.asarray)


def normals(*, tilt: float = 1.0) -> st.SearchStrategy[np.ndarray]:
    """Shading normals (3,) tilted by at most ``tilt`` radians, not of unit length: as a filtered map has them."""
    if not 0 <= tilt < np.pi / 2:
        raise ValueError(f"tilt={tilt}: radians from 0 up to, not including, pi/2")

    def normal(theta: float, azimuth: float, length: float) -> np.ndarray:
        return length * np.array([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)])

    angle = st.just(0.0) | st.floats(0.0, tilt)
    return st.builds(normal, angle, rotations(), st.just(1.0) | st.floats(0.5, 1.5))


def rotations() -> st.SearchStrategy[float]:
    """Angles in [-pi, pi] (radians)."""
    return st.sampled_from([0.0, np.pi / 2, -np.pi]) | st.floats(-np.pi, np.pi)
