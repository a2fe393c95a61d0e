"""A bound of many classes of texels: branch and bound that takes the classes apart, too.

Where a box of directions is done with for all classes at once, it is done with for each. What is left is looked at anew
for either half of the classes, whose parameters and errors span less. So directions are split as finely as the worst
classes need, and classes only where directions alone do not help.
"""

import heapq
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import count

import numpy as np

from ..tolerances import Kind
from .branch import Bounds, Ends, Function, Rest, bound, side_scale
from .texel_class import TexelClass

FIRST, STEP, BATCH = 20_000, 1_000, 512
"""Boxes evaluated for all classes at first and, beside those that are left, for each half; boxes split at once."""

Functions = Mapping[Kind, tuple[Function, Function | None]]
"""Upper bounds of the errors over boxes, and what boxes are compared by if not by them."""


@dataclass(frozen=True, eq=False)
class Group:
    """Classes of texels that are bounded together.

    Attributes:
        texels: a class that holds them all.
        halves: two parts of the group, or None where it is not taken apart.
    """

    texels: TexelClass
    halves: Callable[[], "tuple[Group, Group] | None"] = lambda: None


@dataclass(frozen=True, eq=False)
class Problem:
    """A class of texels with its peaks proved.

    Attributes:
        functions: of boxes of directions and parameters.
        domain: the box of everything, (sides, 2, 1).
        weights: of the sides.
        narrowed: the same for a class within this one, with the same sides.
    """

    functions: Functions
    domain: Ends
    weights: np.ndarray | float
    narrowed: Callable[[TexelClass], "Problem"]

    @property
    def scale(self) -> np.ndarray:
        """What widths of sides are compared with."""
        return side_scale(self.domain, self.weights)


def descend(
    problem: Problem,
    group: Group,
    kind: Kind,
    target: float,
    near: float,
    most: int,
    progress: Callable[[float], None] = lambda fraction: None,
) -> Bounds:
    """Upper bound of an error over all directions and all classes of a group.

    Args:
        problem: of the whole group.
        group: the classes.
        kind: which error.
        target: boxes at or below it are not looked at further, as long as all classes are looked at together.
        near: nor are those at or below this, once classes are taken apart.
        most: boxes to evaluate, by about those of two halves.
        progress: called with the part of ``most`` that is done; at the end with 1.
    """

    def searched(part: Problem, ends: Ends, enough: float, budget: int) -> Rest:
        errors, guide = part.functions[kind]
        return bound(errors, ends, enough, scale, guide, budget=budget, batch=BATCH)

    scale, order = problem.scale, count()
    rest = searched(problem, problem.domain, target, FIRST)
    far = rest.values > near
    done, boxes = max(rest.done, float(rest.values[~far].max(initial=0.0))), rest.boxes
    open_ = [(-rest.worst, next(order), group, problem, rest.ends[..., far])]
    while open_ and -open_[0][0] > near and boxes < most:
        progress(boxes / most)
        _, _, group, problem, ends = heapq.heappop(open_)
        halves = group.halves()
        with np.errstate(all="ignore"):
            parts = [(group, problem)] if halves is None else [(half, problem.narrowed(half.texels)) for half in halves]
        for half, part in parts:
            if (left := _within(ends, part.domain)).size:
                rest = searched(part, left, near, STEP)
                done, boxes = max(done, rest.done), boxes + rest.boxes
                heapq.heappush(open_, (-rest.worst, next(order), half, part, rest.ends))
    progress(1.0)
    return Bounds(max(done, -open_[0][0] if open_ else 0.0), boxes)


def _within(ends: Ends, domain: Ends) -> Ends:
    """What boxes have in common with a domain."""
    ends = np.stack([np.maximum(ends[:, 0], domain[:, 0]), np.minimum(ends[:, 1], domain[:, 1])], axis=1)
    return ends[..., (ends[:, 0] <= ends[:, 1]).all(axis=0)]
