"""A clear coat as intervals: what it lets through, and how what lies below it changes with its normal and its index.

With the coat's normal m, a direction i* below it and c* = <i*, m>: outside the cosine is c, c² = 1 - n² (1 - c*²), and
i = n i* - (n c* - c) m. Moving m by a small w across it moves i* by kappa w + kappa' <i, w> m with kappa = c* - c / n,
kappa' = dkappa/dc = c / (n² c*) - 1 / n, and changes c by <i, w> = n <i*, w>; moving n moves i* by (m / c* - i*) / n.
"""

from typing import NamedTuple

import numpy as np

from . import intervals as iv
from .fresnel import Passing, passing, quotient
from .geometry import HORIZON
from .intervals import Interval
from .pairs import ONE, ZERO, Pairs, Vector, cosine_between, dot, plus, times
from .terms import Parameters


class CoatFrame(NamedTuple):
    """The coat's normal and two axes across it, in the base's frame."""

    normal: Vector
    first: Vector
    second: Vector


def coat_frame(gap: Interval, azimuth: Interval) -> CoatFrame:
    """The frame of a normal at an angle ``gap`` and an azimuth: the base's, tilted without a twist.

    So a wide range of azimuths moves its axes by no more than the gap. With versin g = 2 sin²(g/2) the first axis is
    (1 - cos² a versin g, -cos a sin a versin g, -cos a sin g).
    """
    cos_g, sin_g, cos_a, sin_a = iv.cos(gap), iv.sin(gap), iv.cos(azimuth), iv.sin(azimuth)
    versine = 2.0 * iv.square(iv.sin(0.5 * gap))
    x, y, mixed = sin_g * cos_a, sin_g * sin_a, -(cos_a * sin_a * versine)
    return CoatFrame(
        (x, y, cos_g),
        (1.0 - iv.square(cos_a) * versine, mixed, -x),
        (mixed, 1.0 - iv.square(sin_a) * versine, -y),
    )


FLAT = CoatFrame((ZERO, ZERO, ONE), (ONE, ZERO, ZERO), (ZERO, ONE, ZERO))


class Side(NamedTuple):
    """One direction at the coat."""

    below: Interval
    """Cosine below the coat, c*."""
    cosine: Interval
    """Cosine outside, c."""


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
        return w[2] if self.aligned else iv.clip(cosine_between(w, frame.normal), -1.0, 1.0)

    def side(self, below: Interval, n: Interval) -> Side:
        """From the cosine below; not cut down to the domain, and -1 outside where nothing leaves."""
        if self.kind != "refracting":
            return Side(below, below)
        square = 1.0 - iv.square(n) * iv.clip(1.0 - iv.square(iv.clip(below, 0.0, 1.0)), 0.0, 1.0)
        cosine = iv.sqrt(square)
        leaves = (square.hi > 0) & (below.hi > 0)
        return Side(below, Interval(np.where(square.lo > 0, cosine.lo, -1.0), np.where(leaves, cosine.hi, -1.0)))

    def cut(self, side: Side) -> Side:
        """The part with a cosine outside of at least sin 1°."""
        cosine = iv.clip(side.cosine, HORIZON, 1.0)
        return Side(side.below if self.kind is None else iv.clip(side.below, self.lowest, 1.0), cosine)

    def motion(self, sides: tuple[Side, Side], n: Interval, g: Pairs, frame: CoatFrame) -> "Motion":
        """What happens as the normal or the index moves, of light and viewer at the coat."""
        moving = []
        for side, w in zip(sides, (g.wi, g.wo), strict=True):
            most = iv.sqrt(iv.clip(1.0 - iv.square(side.below), 0.0, 1.0)).hi
            across = [iv.clip(dot(w, axis), -most, most) for axis in (frame.first, frame.second)]
            kappa, bent = ZERO, ZERO
            if self.kind == "refracting":
                # kappa = (G - c) / n falls with c; n kappa' = c / G - 1, for <i, w> = n <i*, w>.
                inside = iv.square(n) - 1.0
                kappa = iv.falling(lambda c, rest=inside: iv.sqrt(rest + iv.square(c)) - c, side.cosine) / n
                bent = quotient(n, side.cosine) - 1.0
            moving.append(Moving(w, side.below, (across[0], across[1]), passing(n, side.cosine), kappa, bent))
        return Motion(self.kind == "refracting", (moving[0], moving[1]), n, g, frame)


class Moving(NamedTuple):
    """One direction below a coat that moves."""

    w: Vector
    below: Interval
    """Cosine below the coat, c*."""
    across: tuple[Interval, Interval]
    """<i*, axis> of the coat's two axes across its normal."""
    through: Passing
    kappa: Interval
    bent: Interval
    """n kappa'."""


class Motion(NamedTuple):
    """How a pair below a coat moves with the coat's normal and its index."""

    refracting: bool
    sides: tuple[Moving, Moving]
    index: Interval
    pairs: Pairs
    frame: CoatFrame

    def changes(self, slopes: tuple[Vector, Vector]) -> tuple[Interval, Interval, Interval]:
        """Derivatives of log f by the two components of the normal's motion, and by the index.

        Args:
            slopes: gradients of the base's log f by the light and by the viewer.
        """
        along, by_index, n = [ZERO, ZERO], ZERO, self.index
        axes = (self.frame.first, self.frame.second)
        for side, gradient in zip(self.sides, slopes, strict=True):
            by_index = by_index + side.through.by_index
            if not self.refracting:
                along = [a + side.through.by_cosine * c for a, c in zip(along, side.across, strict=True)]
                continue
            towards = dot(gradient, self.frame.normal)
            rate = side.bent * towards + n * side.through.by_cosine
            along = [
                a + side.kappa * dot(gradient, axis) + rate * c
                for a, c, axis in zip(along, side.across, axes, strict=True)
            ]
            by_index = by_index + (towards / side.below - dot(gradient, side.w)) / n
        return along[0], along[1], by_index

    def angles(self) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """How fast theta_h and theta_d change at most: each by the normal and by the index.

        h turns by at most |di* + do*| / (2 cos theta_d), theta_d by (|di*| + |do*|) / 2 or |<di*, o*> + <i*, do*>| /
        (2 sin 2 theta_d), whichever is less.
        """
        light, viewer = self.sides
        cos_d = self.pairs.cos_d
        halves, over = (0.5 / cos_d).hi, (1.0 / self.index).hi
        together = [light.bent * a + viewer.bent * b for a, b in zip(light.across, viewer.across, strict=True)]
        h_by_normal = iv.up(halves * _length(light.kappa + viewer.kappa, *together))
        lengths = [_length(side.kappa, *(side.bent * c for c in side.across)) for side in self.sides]
        doubled = 2.0 * cos_d * iv.sqrt(iv.clip(1.0 - iv.square(cos_d), 0.0, 1.0))
        apart = [
            light.kappa * b + light.bent * a * viewer.below + viewer.kappa * a + viewer.bent * b * light.below
            for a, b in zip(light.across, viewer.across, strict=True)
        ]
        d_by_normal = np.fmin(iv.up(0.5 * iv.up(lengths[0] + lengths[1])), iv.up(_length(*apart) * (0.5 / doubled).hi))
        index = [plus(times(1.0 / side.below, self.frame.normal), times(-ONE, side.w)) for side in self.sides]
        h_by_index = iv.up(iv.up(halves * over) * _length(*plus(*index)))
        d_by_index = iv.up(iv.up(0.5 * over) * iv.up(_length(*index[0]) + _length(*index[1])))
        return (h_by_normal, h_by_index), (d_by_normal, d_by_index)


def _length(*components: Interval) -> np.ndarray:
    """The largest length of vectors."""
    total = iv.square(components[0])
    for component in components[1:]:
        total = total + iv.square(component)
    return iv.sqrt(total).hi
