"""Many data sets of the same directions, fitted in one vmapped batch: calibration, bootstrap.

Every lane goes the way of :func:`axffit.fitting.starts.minimize`: the scan's starts, each minimized by optimistix, the
best one kept.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit.fitting.models import AbstractLobeModel, Shapes
from axffit.fitting.separable import SeparableProblem, Solution, solve
from axffit.fitting.starts import POLISHED, scanned_starts

LANES = 1000
"""Data sets in flight at once; bounds the memory."""


def lane_of(problem: SeparableProblem, target: Array, root_weight: Array) -> SeparableProblem:
    """``problem`` with another data set."""
    return eqx.tree_at(lambda p: (p.target, p.root_weight), problem, (target, root_weight))


def solve_batch(
    problem: SeparableProblem,
    targets: Float[np.ndarray, "sets n channels"],
    root_weights: Float[np.ndarray, "#sets n channels"],
    *,
    start: Shapes | None = None,
    max_steps: int = 100,
    lanes: int = LANES,
) -> Solution:
    """The best solution of each data set, on a leading axis, as NumPy arrays.

    Args:
        problem: model, residual and directions; its own target and weights are not looked at.
        targets: what :attr:`SeparableProblem.target` would be for each data set.
        root_weights: the same of its ``root_weight``; one for all where the first axis is 1.
        start: where each data set's fit begins, on a leading axis; None takes the scan's starts of each.
        max_steps: of each solver.
        lanes: how many data sets are in flight at once.
    """
    sets = len(targets)
    root_weights = np.broadcast_to(root_weights, targets.shape)
    found = []
    for first in range(0, sets, lanes):
        # Every chunk has the same shape, so that one compilation serves all.
        part = np.resize(np.arange(first, min(first + lanes, sets)), min(lanes, sets))
        starts = jax.tree.map(lambda leaf, part=part: jnp.asarray(leaf)[part], start)
        batch = _solve_lanes(problem, jnp.asarray(targets[part]), jnp.asarray(root_weights[part]), starts, max_steps)
        found.append(jax.tree.map(lambda leaf, first=first: np.asarray(leaf)[: sets - first], batch))
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *found)


@eqx.filter_jit
def _solve_lanes(
    problem: SeparableProblem, targets: Array, root_weights: Array, start: Shapes | None, max_steps: int
) -> Solution:
    model = problem.model

    def lane(target: Array, root_weight: Array, begin: Shapes | None) -> Solution:
        own = lane_of(problem, target, root_weight)
        if begin is not None or not isinstance(model, AbstractLobeModel):
            return solve(own, Shapes() if begin is None else begin, max_steps=max_steps)
        starts = scanned_starts(own, model, POLISHED)
        solutions = jax.lax.map(lambda shapes: solve(own, shapes, max_steps=max_steps), starts)
        best = jnp.argmin(jnp.where(jnp.isfinite(solutions.cost), solutions.cost, jnp.inf))
        return jax.tree.map(lambda leaf: leaf[best], solutions)

    return jax.vmap(lane)(targets, root_weights, start)
