"""How sure a fit is of its parameters.

Covariance of the free parameters from the Jacobian J of the residuals r at the solution:

- noise-weighted residuals: (J^T J)^-1, for their noise is 1 by construction;
- every other metric: the sandwich (J^T J)^-1 M (J^T J)^-1 with leverage-corrected scores (HC3, MacKinnon & White,
  J. Econometrics 29(3), 1985): M = sum over samples of u u^T, u = sum over the sample's channels of
  J_row r / (1 - h), h the leverage of the row. The plain covariance is wrong there: the weights of the metric are no
  noise weights. The channels of one sample are not taken as independent.

Non-linear functions of the parameters get errors by linearization (delta method).
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit.fitting.models import Shapes
from axffit.fitting.separable import SeparableProblem, Weights

NOISE_KIND = "Gauss-Newton covariance at the stated noise"
SANDWICH_KIND = "leverage-corrected sandwich (HC3)"

_NULL = 1e-13
_NULL_SHARE = 1e-3


class Covariance(NamedTuple):
    """Covariance (P, P) of a vector of parameters; rows and columns of parameters that are not free are 0.

    ``plain``: (J^T J)^-1, which is ``matrix`` where the noise is known. ``free`` (P,): took part. ``determined`` (P,):
    lies in no direction that the data leave undetermined.
    """

    matrix: np.ndarray
    plain: np.ndarray
    free: np.ndarray
    determined: np.ndarray

    def error(self, gradient: np.ndarray) -> float:
        """Standard error of a function with this gradient (P,)."""
        return float(np.sqrt(max(gradient @ self.matrix @ gradient, 0.0)))


@eqx.filter_jit
def _jacobians(
    problem: SeparableProblem, shapes: Shapes, weights: Weights, color: Float[Array, "n_or_1 channels_or_1"]
) -> tuple[Array, Array, Array]:
    """Residuals (n, c), their derivative in the physical shapes (n, c, k) and in a channel's weights (n, c, m)."""

    def model(shapes):
        return (problem.design(shapes) @ weights) * color

    transform = problem.residual.transform
    x = model(shapes)
    slope = problem.root_weight * problem.residual.slope(x)
    parts = jax.tree.leaves(jax.jacfwd(model)(shapes)) if jax.tree.leaves(shapes) else []
    in_shapes = [slope[:, :, None] * part.reshape(*x.shape, -1) for part in parts]
    nothing = jnp.zeros((*slope.shape, 0), slope.dtype)
    in_weights = (slope * color)[:, :, None] * problem.design(shapes)[:, None, :]
    residuals = problem.root_weight * (transform(x) - transform(problem.target))
    return residuals, jnp.concatenate([nothing, *in_shapes], axis=2), in_weights


def parameter_covariance(
    problem: SeparableProblem,
    shapes: Shapes,
    weights: Weights,
    free: np.ndarray,
    *,
    color: np.ndarray | None = None,
) -> Covariance:
    """Covariance of (shapes, then the weights channel by channel).

    ``free`` says which of them take part. A weight at its bound 0 may: the others' errors then allow for a true value
    off the bound. With ``color`` (n, channels) the model is one brightness of weights (m, 1) times known colors.
    """
    factor = jnp.ones((1, 1)) if color is None else jnp.asarray(color)
    r, in_shapes, in_weights = (np.asarray(a) for a in _jacobians(problem, shapes, weights, factor))
    n, channels, m = in_weights.shape
    k = in_shapes.shape[2]
    columns = weights.shape[1]
    jacobian = np.zeros((n, channels, k + columns * m))
    jacobian[:, :, :k] = in_shapes
    for channel in range(channels):
        start = k + (channel * m if columns > 1 else 0)
        jacobian[:, channel, start : start + m] = in_weights[:, channel]
    used = np.asarray(problem.root_weight).max(axis=1) > 0
    return covariance(r[used], jacobian[used], free, knows_noise=problem.residual.knows_noise)


def covariance(r: np.ndarray, jacobian: np.ndarray, free: np.ndarray, *, knows_noise: bool) -> Covariance:
    """Covariance from residuals (n, c) and Jacobian (n, c, P), over the ``free`` parameters (P,)."""
    n, channels, count = jacobian.shape
    j = jacobian[:, :, free].reshape(n * channels, -1)
    scale = np.sqrt(np.sum(j * j, axis=0))
    scale[scale == 0] = 1.0
    j = j / scale
    values, vectors = np.linalg.eigh(j.T @ j)
    kept = values > _NULL * max(values.max(initial=0.0), 1e-300)
    plain = inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    if not knows_noise:
        leverage = np.minimum(np.einsum("np,np->n", j @ inverse, j), 1.0 - 1e-6)
        scores = (j * (r.reshape(-1) / (1.0 - leverage))[:, None]).reshape(n, channels, -1).sum(axis=1)
        inverse = inverse @ (scores.T @ scores) @ inverse
    matrices = np.zeros((2, count, count))
    matrices[np.ix_([0, 1], free, free)] = np.stack([inverse, plain]) / np.outer(scale, scale)
    determined = free.copy()
    determined[free] = np.sum(vectors[:, ~kept] ** 2, axis=1) < _NULL_SHARE
    return Covariance(matrices[0], matrices[1], free, determined)
