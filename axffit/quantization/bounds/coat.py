"""A clear coat as intervals: what it lets through, and how what lies below it changes with its normal and its index.

With the coat's normal m, a direction i* below it and c* = <i*, m>: outside the cosine is c, c² = 1 - n² (1 - c*²), and
i = n i* - (n c* - c) m. Moving m by a small w across it moves i* by kappa w + kappa' <i, w> m with kappa = c* - c / n,
kappa' = dkappa/dc = c / (n² c*) - 1 / n, and changes c by <i, w> = n <i*, w>; moving n moves i* by (m / c* - i*) / n.
"""

from typing import NamedTuple

import numpy as np

from . import intervals as iv
from .fresnel import Passing, passing
from .geometry import HORIZON
from .intervals import Interval
from .pairs import ONE, ZERO, Pairs, Vector, dot
from .terms import Parameters


class CoatFrame(NamedTuple):
    """The coat's normal and two axes across it, in the base's frame."""

    normal: Vector
    first: Vector
    second: Vector


def coat_frame(gap: Interval, azimuth: Interval) -> CoatFrame:
    """The frame of a normal at an angle ``gap`` and an azimuth."""
    cos_g, sin_g, cos_a, sin_a = iv.cos(gap), iv.sin(gap), iv.cos(azimuth), iv.sin(azimuth)
    return CoatFrame(
        (sin_g * cos_a, sin_g * sin_a, cos_g), (cos_g * cos_a, cos_g * sin_a, -sin_g), (-sin_a, cos_a, ZERO)
    )


FLAT = CoatFrame((ZERO, ZERO, ONE), (ONE, ZERO, ZERO), (ZERO, ONE, ZERO))


class Side(NamedTuple):
    """One direction at the coat."""

    below: Interval
    """Cosine below the coat, c*."""
    cosine: Interval
    """Cosine outside, c."""
    inside: Interval
    """G = n times the cosine inside the coat."""


class Coat:
    """The coat of a form, or none (which is a coat that lets everything through, its normal the base's).

    Args:
        kind: ``"refracting"``, ``"straight"`` or None.
        aligned: whether its normal is the base's.
        lowest: cosine below it that a direction has at least if it is 1° above its horizon outside.
    """

    def __init__(self, kind: str | None, *, aligned: bool, lowest: float):
        """Of a kind."""
        self.kind, self.aligned, self.lowest = kind, aligned, lowest

    def frame(self, given: Parameters) -> CoatFrame:
        """The coat's frame."""
        return FLAT if self.aligned else coat_frame(given["gap"], given["gap_azimuth"])

    def cosine_below(self, w: Vector, frame: CoatFrame) -> Interval:
        """<w, m>."""
        return w[2] if self.aligned else iv.clip(dot(w, frame.normal), -1.0, 1.0)

    def side(self, below: Interval, n: Interval) -> Side:
        """From the cosine below; not cut down to the domain, and -1 outside where nothing leaves."""
        if self.kind is None:
            return Side(below, below, below)
        if self.kind == "straight":
            square = iv.square(n) - 1.0 + iv.square(below)
            return Side(below, below, iv.sqrt(square))
        square = 1.0 - iv.square(n) * iv.clip(1.0 - iv.square(iv.clip(below, 0.0, 1.0)), 0.0, 1.0)
        cosine = iv.sqrt(square)
        leaves = (square.hi > 0) & (below.hi > 0)
        return Side(
            below, Interval(np.where(square.lo > 0, cosine.lo, -1.0), np.where(leaves, cosine.hi, -1.0)), n * below
        )

    def cut(self, side: Side) -> Side:
        """The part with a cosine outside of at least sin 1°."""
        if self.kind is None:
            return Side(side.below, iv.clip(side.cosine, HORIZON, 1.0), side.inside)
        cosine = iv.clip(side.cosine, HORIZON, 1.0)
        return Side(iv.clip(side.below, self.lowest, 1.0), cosine, iv.clip(side.inside, self.lowest, np.inf))

    def passing(self, side: Side, n: Interval) -> Passing:
        """What passes at one side."""
        return passing(n, side.cosine, side.inside)

    def tilt_and_index(
        self, sides: tuple[Side, Side], n: Interval, g: Pairs, slopes: tuple[Vector, Vector], frame: CoatFrame
    ) -> tuple[Interval, Interval, Interval]:
        """Derivatives of log f by the two components of the normal's motion, and by the index.

        Args:
            sides: light and viewer at the coat.
            n: index of refraction.
            g: the pairs below.
            slopes: gradients of the base's log f by the light and by the viewer.
            frame: the coat's frame.
        """
        along, by_index = [ZERO, ZERO], ZERO
        for side, w, gradient in zip(sides, (g.wi, g.wo), slopes, strict=True):
            through = self.passing(side, n)
            by_index = by_index + through.by_index
            most = iv.sqrt(iv.clip(1.0 - iv.square(side.below), 0.0, 1.0)).hi
            across = [iv.clip(dot(w, axis), -most, most) for axis in (frame.first, frame.second)]
            if self.kind == "straight":
                along = [a + through.by_cosine * c for a, c in zip(along, across, strict=True)]
                continue
            kappa = side.below - side.cosine / n
            bent = side.cosine / (iv.square(n) * side.below) - 1.0 / n
            towards = dot(gradient, frame.normal)
            rate = n * (bent * towards + through.by_cosine)
            along = [
                a + kappa * dot(gradient, axis) + rate * c
                for a, c, axis in zip(along, across, (frame.first, frame.second), strict=True)
            ]
            by_index = by_index + (towards / side.below - dot(gradient, w)) / n
        return along[0], along[1], by_index
