"""The heart of a fit: variable projection (Golub & Pereyra, SIAM J. Numer. Anal. 10(2), 1973).

A model linear in its weights is fitted over its few non-linear shapes only. For every trial of the shapes the best
weights >= 0 are found in an inner loop (exactly and at once for linear residuals, by Newton's method on quadratic
programs otherwise), and the solver sees

    r(shapes) = w^(1/2) (T(D c*) - T(f c)),   D = basis · factor,   c* = argmin over c >= 0

with the derivative of c* taken along (implicit function theorem).
"""

from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import lineax as lx
import numpy as np
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int

from axffit.fitting.bijections import forward_tree, start_tree
from axffit.fitting.models import AbstractFitModel, Shapes
from axffit.fitting.nonnegative import solve_nonnegative, solve_on_face
from axffit.fitting.residuals import AbstractResidual, ResidualData
from axffit.measured import Measurements

_PADDING = 4096
_INNER_STEPS = 50
_INNER_TOLERANCE = 1e-12
_NEGLIGIBLE = 1e-9
_STEP_LENGTHS = (1.0, 0.4, 0.1)
_FIRST_DAMPING = 0.03
EDGE = 1e-3
"""Nearer to a bound than this, F0 is tried on it."""

Weights = Float[Array, "m channels"]


class SeparableProblem(eqx.Module):
    """Samples, model and residual, ready for the solvers. Arrays are padded with samples of weight 0."""

    model: AbstractFitModel
    residual: AbstractResidual
    wi: Float[Array, "n 3"]
    wo: Float[Array, "n 3"]
    target: Float[Array, "n channels"]
    factor: Float[Array, " n"]
    root_weight: Float[Array, "n channels"]

    def design(self, shapes: Shapes) -> Float[Array, "n m"]:
        """D: the basis times the residual's factor."""
        return self.model.basis(shapes, self.wi, self.wo) * self.factor[:, None]

    def residuals(self, design: Float[Array, "n m"], weights: Weights) -> Float[Array, "n channels"]:
        """R for a design and weights."""
        transform = self.residual.transform
        return self.root_weight * (transform(design @ weights) - transform(self.target))


def make_problem(
    model: AbstractFitModel, residual: AbstractResidual, measurements: Measurements, data: ResidualData
) -> SeparableProblem:
    """A problem on samples that are all valid.

    The number of samples is padded to a multiple of 4096, so that materials of nearly equal size share one
    compilation.
    """
    n = len(measurements)
    padding = -n % _PADDING if n > _PADDING else -n % 256

    def padded(array: np.ndarray, fill: float | np.ndarray) -> Array:
        tail = np.broadcast_to(np.asarray(fill, np.float64), (padding, *array.shape[1:]))
        return jnp.asarray(np.concatenate([array, tail]))

    up = np.array([0.0, 0.0, 1.0])
    return SeparableProblem(
        model,
        residual,
        padded(measurements.wi, up),
        padded(measurements.wo, up),
        padded(data.target, 0.0),
        padded(data.factor, 1.0),
        padded(data.root_weight, 0.0),
    )


def _channel_derivatives(residual, design, target, root_weight, c):
    """Cost, gradient, Gauss-Newton and exact Hessian in the weights of one channel."""
    x = design @ c
    r = root_weight * (residual.transform(x) - residual.transform(target))
    slope = root_weight * residual.slope(x)
    gradient = design.T @ (slope * r)
    gauss_newton = design.T @ (design * (slope * slope)[:, None])
    return 0.5 * jnp.sum(r * r), gradient, gauss_newton, x, r


def _exact_hessian(residual, design, root_weight, gauss_newton, x, r):
    bend = root_weight * residual.curvature(x) * r
    return gauss_newton + design.T @ (design * bend[:, None])


def _initial_weights(residual, design, target, root_weight):
    """Weights of the problem linearized about the data: T(x) ~ T(t) + T'(t) (x - t)."""
    typical = jnp.sum(root_weight * root_weight * jnp.abs(target)) / jnp.sum(root_weight * root_weight)
    slope = root_weight * residual.slope(jnp.maximum(target, 1e-2 * typical + 1e-300))
    weighted = design * (slope * slope)[:, None]
    return solve_nonnegative(design.T @ weighted, weighted.T @ target)


def _best_channel_weights(residual, design, target, root_weight):
    """Weights >= 0 of least cost for one channel."""
    start = _initial_weights(residual, design, target, root_weight)
    if residual.linear:
        return start

    def cost(c):
        r = root_weight * (residual.transform(design @ c) - residual.transform(target))
        return 0.5 * jnp.sum(r * r)

    def step(state):
        c, _, count, _ = state
        before, gradient, gauss_newton, x, r = _channel_derivatives(residual, design, target, root_weight, c)
        exact = _exact_hessian(residual, design, root_weight, gauss_newton, x, r)
        convex = jnp.all(jnp.isfinite(jnp.linalg.cholesky(exact + 1e-14 * jnp.diag(jnp.diagonal(gauss_newton)))))
        hessian = jnp.where(convex, exact, gauss_newton)
        change = solve_nonnegative(hessian, hessian @ c - gradient) - c
        lengths = jnp.asarray(_STEP_LENGTHS, c.dtype)
        proposals = c[None, :] + lengths[:, None] * change[None, :]
        costs = jax.vmap(cost)(proposals)
        costs = jnp.where(jnp.isfinite(costs), costs, jnp.inf)
        best = jnp.argmin(costs)
        improved = costs[best] < before
        gain = jnp.where(improved, before - costs[best], 0.0)
        return jnp.where(improved, proposals[best], c), before - gain, count + 1, gain > _INNER_TOLERANCE * before

    def going(state):
        return state[3] & (state[2] < _INNER_STEPS)

    first = (start, jnp.asarray(jnp.inf, start.dtype), jnp.asarray(0), jnp.ones((), bool))
    return jax.lax.while_loop(going, step, first)[0]


def best_weights(problem: SeparableProblem, design: Float[Array, "n m"]) -> Weights:
    """Weights >= 0 of least cost for fixed shapes, channel by channel; not differentiable."""

    def one(channel):
        target, root_weight = channel
        return _best_channel_weights(problem.residual, design, target, root_weight)

    return jax.lax.map(one, (problem.target.T, problem.root_weight.T)).T


def _attach_derivative(problem: SeparableProblem, design: Float[Array, "n m"], weights: Weights) -> Weights:
    """``weights`` with the derivative of the inner minimum along ``design``.

    One Newton step on the face of the positive weights: at the minimum the gradient is 0, so the step's value is 0 and
    its derivative is the implicit function theorem's.
    """
    fixed = jax.lax.stop_gradient(design)

    def one(target, root_weight, c):
        residual = problem.residual
        _, _, gauss_newton, x, r = _channel_derivatives(residual, fixed, target, root_weight, c)
        exact = _exact_hessian(residual, fixed, root_weight, gauss_newton, x, r)
        x = design @ c
        r = root_weight * (residual.transform(x) - residual.transform(target))
        gradient = design.T @ (root_weight * residual.slope(x) * r)
        face = c > 0
        newton = solve_on_face(exact, gradient, face)
        fallback = solve_on_face(gauss_newton, gradient, face)
        step = jnp.where(jnp.all(jnp.isfinite(newton)), newton, fallback)
        # Only the derivative is wanted: the value is rounding, or where the inner loop stopped early a wrong sign.
        return c - (step - jax.lax.stop_gradient(step))

    return jax.vmap(one, in_axes=(1, 1, 1), out_axes=1)(problem.target, problem.root_weight, weights)


def shapes_at(raw: Shapes, problem: SeparableProblem, held: Shapes | None = None) -> Shapes:
    """Physical shapes of raw ones; where ``held`` is not NaN, its value."""
    shapes = forward_tree(problem.model.bounds(), raw)
    if held is None:
        return shapes
    return jax.tree.map(lambda free, value: jnp.where(jnp.isnan(value), free, value), shapes, held)


def projected_residuals(
    raw: Shapes, problem: SeparableProblem, held: Shapes | None = None
) -> tuple[Float[Array, "n channels"], Weights]:
    """Residuals as a function of the raw shapes alone, and the best weights."""
    design = problem.design(shapes_at(raw, problem, held))
    weights = best_weights(problem, jax.lax.stop_gradient(design))
    return problem.residuals(design, _attach_derivative(problem, design, weights)), weights


class Solution(NamedTuple):
    """Where a solver ended."""

    shapes: Shapes
    weights: Weights
    cost: Float[Array, ""]
    converged: Bool[Array, ""]
    steps: Int[Array, ""]


@eqx.filter_jit
def cost_at(problem: SeparableProblem, shapes: Shapes) -> tuple[Float[Array, ""], Weights]:
    """Half of the sum of squares at the best weights for ``shapes``, and those weights."""
    design = problem.design(shapes)
    weights = best_weights(problem, design)
    return 0.5 * jnp.sum(problem.residuals(design, weights) ** 2), weights


def solve(
    problem: SeparableProblem,
    shapes: Shapes,
    *,
    held: Shapes | None = None,
    max_steps: int = 100,
    tolerance: float = 1e-5,
) -> Solution:
    """Minimize from ``shapes`` with optimistix; a model without shapes needs only its weights.

    Where ``held`` is not NaN a shape keeps its value. F0 ends exactly on a bound that it approaches if this lowers the
    cost: a logistic bound is never reached.
    """
    if not jax.tree.leaves(shapes):
        cost, weights = cost_at(problem, shapes)
        return Solution(shapes, weights, cost, jnp.isfinite(cost), jnp.asarray(0))
    raw = start_tree(problem.model.bounds(), shapes)
    if held is None:
        held = Shapes(
            *(None if leaf is None else jnp.full(jnp.shape(leaf), jnp.nan) for leaf in (shapes.roughness, shapes.f0))
        )
    # As an array: another tolerance needs no other program.
    found, converged, steps = _solve(problem, raw, held, max_steps, jnp.asarray(tolerance, jnp.float64))
    cost, weights = cost_at(problem, found)
    if found.f0 is not None:
        edge = Shapes(found.roughness, jnp.round(found.f0))
        edge_cost, edge_weights = cost_at(problem, edge)
        closer = (jnp.abs(found.f0 - edge.f0) < EDGE) & (edge_cost <= cost)

        def either(ours: Array, theirs: Array) -> Array:
            return jnp.where(closer, theirs, ours)

        found, weights, cost = jax.tree.map(either, (found, weights, cost), (edge, edge_weights, edge_cost))
        converged = converged | closer
    weights = _without_rounding(problem, found, weights)
    return Solution(found, weights, cost, converged & jnp.isfinite(cost), steps)


@eqx.filter_jit
def _without_rounding(problem: SeparableProblem, shapes: Shapes, weights: Weights) -> Weights:
    """Weights with those set to 0 that nowhere give more than 1e-9 of the model: they only fit rounding errors."""
    parts = problem.design(shapes)[:, :, None] * weights[None, :, :]
    used = (jnp.max(problem.root_weight, axis=1) > 0)[:, None, None]
    total = jnp.sum(parts, axis=1, keepdims=True)
    seen = jnp.max(jnp.where(used & (total > 0), parts / jnp.where(total > 0, total, 1.0), 0.0), axis=0)
    return jnp.where(seen > _NEGLIGIBLE, weights, 0.0)


@eqx.filter_jit
def _solve(
    problem: SeparableProblem, raw: Shapes, held: Shapes | None, max_steps: int, tolerance: Any
) -> tuple[Shapes, Bool[Array, ""], Int[Array, ""]]:
    # Levenberg-Marquardt damps by the identity, at first times 1: with residuals far below 1 it would not move at all.
    first = _FIRST_DAMPING * jnp.sqrt(jnp.sum(projected_residuals(raw, problem, held)[0] ** 2))
    size = jnp.where(jnp.isfinite(first) & (first > 0), first, 1.0)
    solution = optx.least_squares(
        lambda raw, problem: projected_residuals(raw, problem, held)[0] / size,
        optx.LevenbergMarquardt(tolerance, tolerance, linear_solver=lx.Normal(lx.Cholesky())),
        raw,
        problem,
        options={"jac": "fwd"},
        max_steps=max_steps,
        throw=False,
    )
    shapes = shapes_at(solution.value, problem, held)
    return shapes, solution.result == optx.RESULTS.successful, jnp.asarray(solution.stats["num_steps"])
