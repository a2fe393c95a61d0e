"""Levenberg-Marquardt on many texels at once, lanes innermost.

    (H + lambda diag H) step = gradient

per lane, H of :mod:`axffit.fitting.texels.problem`, a Cholesky factor by closed form. A lane has converged when its
undamped step changes nothing: |step| <= 1e-9, or a predicted fall of the cost below
1e-12 of it (1e-5 standard errors).
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from axffit.fitting.texels import small
from axffit.fitting.texels.problem import (
    HIGHEST_LOG_ROUGHNESS,
    LOWEST_LOG_ROUGHNESS,
    Point,
    Samples,
    TexelModel,
    evaluate,
    unpacked,
)

_STEP = 1e-9
_FALL = 1e-12
_ROUNDING = 1e-13
_LONGEST = 0.7
_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-12, 1e10
_RELAX, _TIGHTEN = 0.1, 8.0


class State(NamedTuple):
    """Where the lanes are."""

    point: Point
    damping: Float[Array, " lanes"]
    converged: Bool[Array, " lanes"]
    steps: Int[Array, ""]


def begin(model: TexelModel, samples: Samples, theta: Float[Array, "p lanes"]) -> State:
    """The state before the first step."""
    point, _ = evaluate(model, samples, theta)
    damping = jnp.full_like(point.cost, _FIRST_DAMPING)
    return State(point, damping, jnp.zeros(point.cost.shape, bool), jnp.asarray(0))


@partial(jax.jit, static_argnums=0)
def advance(model: TexelModel, samples: Samples, state: State, steps: Int[Array, ""]) -> State:
    """Up to ``steps`` more steps of all lanes, fewer where all converge."""

    def going(state: State) -> Array:
        return (state.steps < steps) & ~jnp.all(state.converged)

    return jax.lax.while_loop(going, partial(_step, model, samples), state._replace(steps=jnp.asarray(0)))


def _step(model: TexelModel, samples: Samples, state: State) -> State:
    point, damping = state.point, state.damping
    free, hessian, gradient = _free_problem(model, point)
    newton = jnp.stack(small.solve(small.cholesky(hessian), gradient))
    fall = 0.5 * jnp.sum(newton * jnp.stack(gradient), axis=0)
    converged = state.converged | (jnp.max(jnp.abs(newton), axis=0) <= _STEP) | (fall <= _FALL * point.cost)

    damped = [row[:-1] + [row[-1] * (1.0 + damping)] for row in hessian]
    step = jnp.stack(small.solve(small.cholesky(damped), gradient))
    step = step * (_LONGEST / jnp.maximum(jnp.max(jnp.abs(step), axis=0, keepdims=True), _LONGEST))
    trial = _within(point.theta + jnp.where(free, step, 0.0))
    tried, _ = evaluate(model, samples, trial)
    # A last step moves the cost by less than its rounding.
    better = (tried.cost <= point.cost * (1.0 + _ROUNDING)) & ~converged
    kept = jax.tree.map(lambda new, old: jnp.where(better, new, old), tried, point)
    damping = jnp.clip(damping * jnp.where(better, _RELAX, _TIGHTEN), _LEAST_DAMPING, _MOST_DAMPING)
    return State(kept, damping, converged, state.steps + 1)


def _within(theta: Float[Array, "p lanes"]) -> Float[Array, "p lanes"]:
    return theta.at[0].set(jnp.clip(theta[0], LOWEST_LOG_ROUGHNESS, HIGHEST_LOG_ROUGHNESS))


def _free_problem(model: TexelModel, point: Point) -> tuple[Bool[Array, "p lanes"], list[list[Array]], list[Array]]:
    """H and the gradient without a roughness that its bound holds, and which components are free."""
    theta, gradient = point.theta, point.gradient
    held = ((theta[0] <= LOWEST_LOG_ROUGHNESS) & (gradient[0] < 0)) | (
        (theta[0] >= HIGHEST_LOG_ROUGHNESS) & (gradient[0] > 0)
    )
    free = jnp.ones(theta.shape, bool).at[0].set(~held)
    hessian = small.restricted(unpacked(point.hessian, model.shapes), list(free))
    return free, hessian, [jnp.where(use, value, 0.0) for use, value in zip(free, gradient, strict=True)]
