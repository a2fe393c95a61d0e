"""What the batched solver leaves unfinished, by optimistix: one problem a texel, weights eliminated as before."""

from functools import partial

import jax
import jax.numpy as jnp
import lineax as lx
import optimistix as optx
from jaxtyping import Array, Bool, Float

from axffit.fitting.texels.problem import (
    HIGHEST_LOG_ROUGHNESS,
    LOWEST_LOG_ROUGHNESS,
    Samples,
    TexelModel,
    cost_at,
    residuals_at,
)

_TOLERANCE = 1e-8
_ROUNDING = 1e-9
_INSIDE = 1e-9
"""How far from an end of its range (a share of it) a roughness begins: the ends lie at infinity for the solver."""
_RANGE = HIGHEST_LOG_ROUGHNESS - LOWEST_LOG_ROUGHNESS


def to_free(theta: Float[Array, "p lanes"]) -> Float[Array, "p lanes"]:
    """theta with its roughness, which has a range, as a logit: optimistix knows no bounds."""
    share = jnp.clip((theta[0] - LOWEST_LOG_ROUGHNESS) / _RANGE, _INSIDE, 1.0 - _INSIDE)
    return theta.at[0].set(jnp.log(share) - jnp.log1p(-share))


def from_free(free: Float[Array, "p lanes"]) -> Float[Array, "p lanes"]:
    """Inverse of :func:`to_free`."""
    return free.at[0].set(LOWEST_LOG_ROUGHNESS + _RANGE * jax.nn.sigmoid(free[0]))


@partial(jax.jit, static_argnums=(0, 3))
def finish(
    model: TexelModel, samples: Samples, theta: Float[Array, "p lanes"], max_steps: int = 500
) -> tuple[Float[Array, "p lanes"], Bool[Array, " lanes"]]:
    """theta of least cost of each lane as optimistix finds it from ``theta``, and whether it converged.

    A worse one than ``theta`` is not taken.
    """
    size = jnp.sqrt(jnp.sum(residuals_at(model, samples, theta) ** 2, axis=(0, 1)))
    size = jnp.where(size > 0, size, 1.0)

    def lane(values: Array, precisions: Array, theta: Array, size: Array) -> tuple[Array, Array]:
        own = Samples(samples.light, values[..., None], precisions[..., None])
        # Residuals of size 1 at first: optimistix damps by the identity.
        solution = optx.least_squares(
            lambda free, _: residuals_at(model, own, from_free(free[:, None])).ravel() / size,
            optx.LevenbergMarquardt(_TOLERANCE, _TOLERANCE, linear_solver=lx.Normal(lx.Cholesky())),
            to_free(theta[:, None])[:, 0],
            options={"jac": "fwd"},
            max_steps=max_steps,
            throw=False,
        )
        return from_free(solution.value[:, None])[:, 0], solution.result == optx.RESULTS.successful

    found, converged = jax.vmap(lane, in_axes=-1, out_axes=-1)(samples.values, samples.precisions, theta, size)
    before, after = cost_at(model, samples, theta), cost_at(model, samples, found)
    better = after <= before * (1.0 + _ROUNDING)
    return jnp.where(better, found, theta), converged & better
