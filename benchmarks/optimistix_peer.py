"""Texels by optimistix under vmap: the full problem, and the one with the linear parts eliminated."""

from functools import partial

import jax
import jax.numpy as jnp
import lineax as lx
import numpy as np
import optimistix as optx

from axffit.fitting.texels.problem import Samples, evaluate, model_values, residuals_at


def _solve(residuals, start, tolerance):
    # Dogleg is no faster here: the damping of Levenberg-Marquardt seldom rejects a step.
    solver = optx.LevenbergMarquardt(tolerance, tolerance, linear_solver=lx.Normal(lx.Cholesky()))
    solution = optx.least_squares(residuals, solver, start, options={"jac": "fwd"}, max_steps=100, throw=False)
    return solution.value


@partial(jax.jit, static_argnums=(0, 3))
def full(model, samples, start, tolerance):
    """Shape parameters, then diffuse and specular of each channel, all by optimistix; (p + weights, lanes)."""
    channels = samples.values.shape[0]

    def lane(values, precisions, start):
        def residuals(x, _):
            theta, weights = x[: model.shapes, None], x[model.shapes :].reshape(channels, model.weights, 1)
            return (
                jnp.sqrt(precisions) * (model_values(model, samples.light, theta, weights)[..., 0] - values)
            ).ravel()

        return _solve(residuals, start, tolerance)

    return jax.vmap(lane, -1, -1)(samples.values, samples.precisions, start)


@partial(jax.jit, static_argnums=(0, 3))
def projected(model, samples, start, tolerance):
    """Shape parameters only; the linear parts are eliminated as axffit does it."""

    def lane(values, precisions, start):
        own = Samples(samples.light, values[..., None], precisions[..., None])
        return _solve(lambda theta, _: residuals_at(model, own, theta[:, None]).ravel(), start, tolerance)

    return jax.vmap(lane, -1, -1)(samples.values, samples.precisions, start)


def fit(implementation, model, samples, start, *, tolerance=1e-6, lanes=512):
    """Shape parameters of all texels, ``lanes`` at a time, from ``start`` (p, texels)."""
    found = []
    for first in range(0, start.shape[1], lanes):
        part = slice(first, first + lanes)
        own = Samples(samples.light, samples.values[..., part], samples.precisions[..., part])
        begun = start[:, part]
        if implementation is full:
            weights = evaluate(model, own, begun)[0].weights
            begun = jnp.concatenate([begun, weights.reshape(-1, weights.shape[-1])])
        found.append(np.asarray(implementation(model, own, begun, tolerance))[: model.shapes])
    return np.concatenate(found, axis=1)
