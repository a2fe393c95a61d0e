"""Starts for the solver by a scan, and the way from there to the minimum: no random numbers, no user's guess.

All basis functions of 14 roughnesses are evaluated once. On the problem linearized about the data every choice of K of
them is a small non-negative least-squares problem on blocks of one Gram matrix, so all are tried (364 for K = 3).
"""

from collections.abc import Callable
from itertools import combinations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from axffit import brdf as brdfs
from axffit.fitting.models import SCAN_ROUGHNESSES, AbstractLobeModel, Shapes
from axffit.fitting.nonnegative import solve_nonnegative
from axffit.fitting.separable import EDGE, SeparableProblem, Solution, cost_at, solve

POLISHED = 6
FINISHED = 3
_ROUGH, _MIDDLE, _FINE = 0.02, 1e-4, 1e-5
_APART = 2
_NEAR = 0.1
_INSIDE = 1e-7
SUBSAMPLE, _SMALLEST = 8192, 2048
_GOLDEN = 0.6180339887498949


@eqx.filter_jit
def _scan(problem: SeparableProblem, model: AbstractLobeModel, roughnesses, choices):
    """Linearized cost (choices,) and weights (choices, channels, m) of every choice of roughnesses."""
    residual = problem.residual
    diffuse = model.column(brdfs.Lambert(jnp.ones(3)), problem.wi, problem.wo)[:, None]
    lobes = jax.lax.map(lambda a: model.scan_basis(a, problem.wi, problem.wo), roughnesses)
    columns = jnp.concatenate([diffuse, jnp.moveaxis(lobes, 0, 1).reshape(len(diffuse), -1)], axis=1)
    design = columns * problem.factor[:, None]
    pairs = 1 + 2 * choices[:, :, None] + jnp.arange(2)[None, None, :]
    indices = jnp.concatenate([jnp.zeros((len(choices), 1), pairs.dtype), pairs.reshape(len(choices), -1)], axis=1)

    def channel(data):
        target, root_weight = data
        square = root_weight * root_weight
        typical = jnp.sum(square * jnp.abs(target)) / jnp.sum(square)
        slope = root_weight * residual.slope(jnp.maximum(target, 1e-2 * typical + 1e-300))
        weighted = design * (slope * slope)[:, None]
        gram, right = design.T @ weighted, weighted.T @ target

        def one(index):
            block, b = gram[index[:, None], index[None, :]], right[index]
            c = solve_nonnegative(block, b)
            return 0.5 * c @ block @ c - b @ c, c

        return jax.lax.map(one, indices, batch_size=128)

    cost, weights = jax.lax.map(channel, (problem.target.T, problem.root_weight.T))
    return jnp.sum(cost, axis=0), jnp.moveaxis(weights, 0, 1)


def scanned_starts(problem: SeparableProblem, model: AbstractLobeModel, count: int) -> Shapes:
    """The ``count`` best starts by the linearized cost, best first, on a leading axis; may be traced by JAX.

    Each is at least two steps of the scan in some lobe away from those before it: the best few choices are neighbors
    and mostly end in the same minimum.
    A fitted F0 starts at p / (p + q) of all channels' and lobes' sums, kept off its bounds.
    """
    choices = np.array(list(combinations(range(len(SCAN_ROUGHNESSES)), model.lobe_count)))
    count = min(count, len(choices))
    cost, weights = _scan(problem, model, jnp.asarray(SCAN_ROUGHNESSES), jnp.asarray(choices))
    best = _spread_out(cost, jnp.asarray(choices), count)
    f0 = None
    if model.bounds().f0 is not None:
        p, q = (jnp.sum(weights[best][:, :, first::2], axis=(1, 2)) for first in (1, 2))
        lit = p + q > 0
        f0 = jnp.where(lit, jnp.clip(p / jnp.where(lit, p + q, 1.0), 0.02, 0.9), 0.5)
    return Shapes(jnp.asarray(SCAN_ROUGHNESSES)[jnp.asarray(choices)[best]], f0)


def _spread_out(cost: Float[Array, " n"], choices: Int[Array, "n k"], count: int) -> Int[Array, " count"]:
    """Indices of the ``count`` least costs whose choices are apart."""
    left = jnp.where(jnp.isfinite(cost), cost, jnp.inf)
    found = []
    for _ in range(count):
        best = jnp.argmin(left)
        found.append(best)
        distance = jnp.max(jnp.abs(choices - choices[best][None, :]), axis=1)
        left = jnp.where(distance < _APART, jnp.inf, left)
    return jnp.stack(found)


def scan(problem: SeparableProblem, *, count: int = 3) -> list[Shapes]:
    """:func:`scanned_starts` as a list; a model without lobes has one start without shapes."""
    model = problem.model
    if not isinstance(model, AbstractLobeModel):
        return [Shapes()]
    starts = scanned_starts(problem, model, count)
    return [jax.tree.map(lambda leaf, k=k: leaf[k], starts) for k in range(len(starts.roughness))]


def subsample(problem: SeparableProblem, count: int) -> SeparableProblem:
    """The problem on ``count`` of its samples, spread evenly through their order by golden-ratio steps.

    The problem itself where it has fewer than twice as many.
    """
    if len(problem.wi) <= 2 * count:
        return problem
    real = np.flatnonzero(np.asarray(problem.root_weight).max(axis=1) > 0)
    order = np.argsort(np.mod(np.arange(len(real)) * _GOLDEN, 1.0), kind="stable")
    chosen = jnp.asarray(np.sort(real[order[:count]]))

    def samples(p: SeparableProblem):
        return (p.wi, p.wo, p.target, p.factor, p.root_weight)

    return eqx.tree_at(samples, problem, tuple(array[chosen] for array in samples(problem)))


def minimize(
    problem: SeparableProblem, *, max_steps: int, progress: Callable[[str, float], None] | None = None
) -> Solution:
    """The best solution from the scan's starts.

    All starts are polished roughly, with many samples on 2048 of them; the best three different ends are finished on
    8192, compared on all, and the best one is finished on all.
    """
    if progress is not None:
        progress("scan for starts", 0.0)
    starts = scan(problem, count=POLISHED)
    small = subsample(problem, SUBSAMPLE)
    smallest = subsample(problem, _SMALLEST)
    total = len(starts) + FINISHED + 1
    rough, found = [], []
    for number, start in enumerate(starts):
        if progress is not None:
            progress("lobes", number / total)
        rough.append(solve(smallest, start, max_steps=max_steps, tolerance=_ROUGH))
    for number, start in enumerate(_different(rough)):
        if progress is not None:
            progress("lobes", (len(starts) + number) / total)
        found.append(_finish(small, start, max_steps, _FINE if small is problem else _MIDDLE))
    if small is problem:
        return min(found, key=lambda solution: _finite(solution.cost))
    if progress is not None:
        progress("lobes", 1.0 - 1.0 / total)
    best = min(found, key=lambda solution: _finite(cost_at(problem, solution.shapes)[0]))
    return _finish(problem, best, max_steps, _FINE)


def _finish(problem: SeparableProblem, start: Solution, max_steps: int, tolerance: float) -> Solution:
    """The minimum near ``start``; where that has F0 next to a bound, first the minimum on the bound."""
    shapes = start.shapes
    if shapes.f0 is not None and abs(float(shapes.f0) - round(float(shapes.f0))) < EDGE:
        f0 = jnp.asarray(round(float(shapes.f0)), jnp.float64)
        held = Shapes(jnp.full(shapes.roughness.shape, jnp.nan), f0)
        on_bound = solve(problem, shapes, held=held, max_steps=max_steps, tolerance=tolerance)
        inside = Shapes(on_bound.shapes.roughness, jnp.abs(f0 - _INSIDE))
        if float(cost_at(problem, inside)[0]) >= float(on_bound.cost):
            return on_bound
    return solve(problem, shapes, max_steps=max_steps, tolerance=tolerance)


def _different(rough: list[Solution]) -> list[Solution]:
    """The best three solutions, best first, without those that have about the shapes of a better one."""

    def place(solution: Solution) -> np.ndarray:
        shapes = solution.shapes
        f0 = np.zeros(0) if shapes.f0 is None else np.ravel(shapes.f0)
        spread = np.zeros(0) if shapes.roughness is None else np.sort(np.log(shapes.roughness))
        return np.concatenate([spread, f0])

    kept: list[Solution] = []
    for solution in sorted(rough, key=lambda solution: _finite(solution.cost)):
        if all(np.max(np.abs(place(solution) - place(one)), initial=0.0) > _NEAR for one in kept):
            kept.append(solution)
    return kept[:FINISHED]


def _finite(cost: jax.Array) -> float:
    value = float(cost)
    return value if np.isfinite(value) else np.inf
