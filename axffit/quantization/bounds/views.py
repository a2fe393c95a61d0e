"""The peak of each view of a whole material, proved from below.

Views are cut into cells of (log of the cosine outside, azimuth about the coat's normal); isotropic materials whose coat
has the base's normal need no azimuth. For each cell the search gives the slopes of a half vector. Interval arithmetic
proves that the light which the views of the cell see through it exists, and how high f i_z stands there. The mirror
direction exists by the definition of the domain. Nothing rests on the search but the height of the bound.
"""

import numpy as np

from . import intervals as iv
from .coat import Coat, Side
from .color_table import TableBounds
from .extremes import Extremes
from .fresnel import passing
from .geometry import HORIZON
from .intervals import Interval
from .pairs import Vector, pairs_of_views, plus, times
from .terms import Model, Parameters

STRETCH = (1.0, 0.8, 1.4, 2.0)
"""Slopes found may not lead to a light for every view of the cell: these multiples of them are tried, too."""

NEIGHBORS = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (4, 0))
"""And those of cells near by, in steps of cosine and azimuth."""

SHARES = (0.1, 0.2, 0.3, 0.4, 0.6)
"""Where a view's mirror direction hardly leaves the coat, lights this far from there to the coat's normal are tried."""

FINER = 2
"""Next to views whose mirror direction does not leave the coat peaks change fast."""


def edges(cells: int) -> np.ndarray:
    """Ends of cells in the cosine outside."""
    return np.concatenate([[HORIZON], HORIZON ** (1 - np.arange(1, cells) / cells), [1.0]])


class Grid:
    """Cells of views.

    Args:
        cosines: cells in the cosine.
        azimuths: cells in azimuth; 1 for views whose azimuth does not matter.
    """

    def __init__(self, cosines: int, azimuths: int):
        """The cells' ends."""
        self.edges, self.azimuths = edges(cosines), azimuths

    def middles(self) -> tuple[np.ndarray, np.ndarray]:
        """Cosines and azimuths of the middles of all cells, (cosines · azimuths,)."""
        cosine = np.sqrt(self.edges[:-1] * self.edges[1:])
        azimuth = -np.pi + (np.arange(self.azimuths) + 0.5) * 2 * np.pi / self.azimuths
        one, other = np.meshgrid(cosine, azimuth if self.azimuths > 1 else np.zeros(1), indexing="ij")
        return one.reshape(-1), other.reshape(-1)

    def boxes(self) -> tuple[Interval, Interval]:
        """Cosines and azimuths of all cells; without azimuths all views stand at azimuth 0."""
        low, high = (np.repeat(e, self.azimuths) for e in (self.edges[:-1], self.edges[1:]))
        step = 2 * np.pi / self.azimuths
        start = np.tile(-np.pi + np.arange(self.azimuths) * step, len(self.edges) - 1)
        azimuth = Interval(start - 1e-12, start + step + 1e-12) if self.azimuths > 1 else Interval(0.0, 0.0)
        return Interval(low, high), azimuth

    def cells(self, cosine: Interval, x: Interval, y: Interval) -> tuple[np.ndarray, ...]:
        """First and last cell along both axes that views touch; azimuths may run over the ends.

        Args:
            cosine: of the views outside.
            x: component along the coat's first axis.
            y: component along its second axis.
        """
        count = len(self.edges) - 1
        first = np.clip(np.searchsorted(self.edges, cosine.lo, side="left") - 1, 0, count - 1)
        last = np.clip(np.searchsorted(self.edges, cosine.hi, side="right") - 1, 0, count - 1)
        if self.azimuths == 1:
            return first, last, np.zeros_like(first), np.zeros_like(first)
        x, y = (Interval(*np.broadcast_arrays(c.lo, c.hi)) for c in (x, y))
        center = (0.5 * (x.lo + x.hi), 0.5 * (y.lo + y.hi))
        turns = [
            np.arctan2(center[0] * b - center[1] * a, center[0] * a + center[1] * b)
            for a in (x.lo, x.hi)
            for b in (y.lo, y.hi)
        ]
        anywhere = (x.lo <= 0) & (x.hi >= 0) & (y.lo <= 0) & (y.hi >= 0)
        middle = np.arctan2(center[1], center[0])
        low, high = (middle + turn for turn in (np.min(turns, axis=0) - 1e-9, np.max(turns, axis=0) + 1e-9))
        step = 2 * np.pi / self.azimuths
        start, stop = (np.int64(np.floor((a + np.pi) / step)) for a in (low, high))
        # The table holds three turns, the middle one counted from 0.
        start = np.clip(start, -self.azimuths, 2 * self.azimuths - 1)
        stop = np.clip(stop, start, 2 * self.azimuths - 1)
        all_ = anywhere | (stop - start >= self.azimuths)
        return (
            first,
            last,
            np.where(all_, 0, start) + self.azimuths,
            np.where(all_, self.azimuths - 1, stop) + self.azimuths,
        )


class Peaks:
    """Lower bounds of log f i_z at the peak, without what the coat lets out to the viewer.

    Args:
        model: the terms.
        coat: the coat.
        given: the class's ranges.
        grid: the cells; where azimuths matter each is cut into `FINER`² of its own.
        slopes: of a high light's half vector for each cell's middle, in the base's frame, two arrays.
        table: the color table of a car paint, whose brightest channel counts.
    """

    def __init__(
        self,
        model: Model,
        coat: Coat,
        given: Parameters,
        grid: Grid,
        slopes: tuple[np.ndarray, np.ndarray],
        table: TableBounds | None,
    ):
        """Proof over all cells."""
        steps = np.array(NEIGHBORS)
        if grid.azimuths > 1:
            shape = (len(grid.edges) - 1, grid.azimuths)
            slopes = tuple(np.kron(s.reshape(shape), np.ones((FINER, FINER))).reshape(-1) for s in slopes)  # pyright: ignore[reportAssignmentType]
            grid, steps = Grid(FINER * shape[0], FINER * shape[1]), FINER * steps
        self.grid = grid
        cosine, azimuth = grid.boxes()
        views = _views_below(coat, given, cosine, azimuth)
        best = np.full(cosine.lo.shape, -np.inf)
        shape = (len(grid.edges) - 1, grid.azimuths)
        near = [tuple(np.roll(s.reshape(shape), step, axis=(0, 1)).reshape(-1) for s in slopes) for step in steps]
        tries = [tuple(part * s for s in slopes) for part in STRETCH[1:]] + near
        if not coat.aligned:
            normal = coat.frame(given).normal
            tries += [_between(views, normal, share) for share in SHARES]
        tries.append(tuple(np.zeros_like(s) for s in slopes))
        for attempt in tries:
            mirror = not np.any(attempt[0]) and not np.any(attempt[1])
            best = np.maximum(best, _height(model, coat, given, views, attempt, table, mirror=mirror))
        # Views whose mirror direction does not leave the coat are not of the domain, and hold nothing down.
        mirror = (-views[0], -views[1], views[2])
        leaves = coat.side(coat.cosine_below(mirror, coat.frame(given)), given["ior"]).cosine.hi >= HORIZON
        lowest = np.where(leaves, best, np.inf).reshape(shape)
        self._table = Extremes(np.tile(lowest, (1, 3)) if grid.azimuths > 1 else lowest, np.minimum)

    def __call__(self, cosine: Interval, x: Interval, y: Interval) -> np.ndarray:
        """Lower bound of the log of the lowest peak of views, see `Grid.cells`."""
        first, last, start, stop = self.grid.cells(cosine, x, y)
        return self._table(start, stop, first, last)


def _between(views: Vector, normal: Vector, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Slopes of half vectors through which views see lights between their mirror direction and the coat's normal."""
    x, y, z = (0.5 * (c.lo + c.hi) for c in views)
    light = [(1 - share) * w + share * 0.5 * (m.lo + m.hi) for w, m in zip((-x, -y, z), normal, strict=True)]
    length = np.sqrt(sum(c * c for c in light))
    height = light[2] / length + z
    return (light[0] / length + x) / height, (light[1] / length + y) / height


def _views_below(coat: Coat, given: Parameters, cosine: Interval, azimuth: Interval) -> Vector:
    """Views below the coat in the base's frame."""
    sine = iv.sqrt(iv.clip(1.0 - iv.square(cosine), 0.0, 1.0))
    below = cosine
    if coat.kind == "refracting":
        sine = sine / given["ior"]
        below = iv.sqrt(iv.clip(1.0 - iv.square(sine), 0.0, 1.0))
    x, y = sine * iv.cos(azimuth), sine * iv.sin(azimuth)
    if coat.aligned:
        return (x, y, iv.clip(below, HORIZON, 1.0))
    frame = coat.frame(given)
    views = plus(plus(times(x, frame.first), times(y, frame.second)), times(below, frame.normal))
    return (views[0], views[1], iv.clip(views[2], HORIZON, 1.0))


def _height(
    model: Model,
    coat: Coat,
    given: Parameters,
    views: Vector,
    slopes: tuple[np.ndarray, ...],
    table: TableBounds | None,
    *,
    mirror: bool,
) -> np.ndarray:
    """Lower bound of log f i_z through half vectors; -inf where the light may not exist."""
    pairs, exists = pairs_of_views((slopes[0], slopes[1]), views, *model.roughness(given))
    side = coat.side(coat.cosine_below(pairs.wi, coat.frame(given)), given["ior"])
    if not mirror:
        exists &= side.cosine.lo >= HORIZON
    side = coat.cut(side)
    log = log_sum(model.values(pairs, given)) + light_factor(coat, given, side)
    log = log if table is None else log + table.brightest(pairs.t2, pairs.cos_d)
    return np.where(exists, log.lo, -np.inf)


def light_factor(coat: Coat, given: Parameters, side: Side) -> Interval:
    """Log of i_z times what the coat lets in."""
    log = iv.log(side.cosine)
    return log if coat.kind is None else log + passing(given["ior"], side.cosine).log


def log_sum(logs: list[Interval]) -> Interval:
    """Log of the sum of exponentials."""
    if len(logs) == 1:
        return logs[0]
    lows, highs = (np.stack(np.broadcast_arrays(*(getattr(x, end) for x in logs))) for end in ("lo", "hi"))

    def total(ends: np.ndarray) -> Interval:
        largest = np.maximum(ends.max(axis=0), -1e308)
        whole = sum((iv.exp(Interval(e, e) - Interval(largest, largest)) for e in ends), Interval(0.0, 0.0))
        return iv.log(whole) + Interval(largest, largest)

    return Interval(total(lows).lo, total(highs).hi)
