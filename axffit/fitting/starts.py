"""Starts for the solver by a scan: no random numbers, no user's guess.

All basis functions of 14 roughnesses are evaluated once. On the problem linearized about the data every choice of K of
them is a small non-negative least-squares problem on blocks of one Gram matrix, so all are tried (364 for K = 3).
"""

from itertools import combinations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit import brdf as brdfs
from axffit.fitting.models import SCAN_ROUGHNESSES, Shapes
from axffit.fitting.nonnegative import solve_nonnegative
from axffit.fitting.separable import SeparableProblem


@eqx.filter_jit
def _scan(problem: SeparableProblem, roughnesses, choices):
    """Linearized cost (choices,) and weights (choices, channels, m) of every choice of roughnesses."""
    model, residual = problem.model, problem.residual
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


def scan(problem: SeparableProblem, *, count: int = 3) -> list[Shapes]:
    """The ``count`` best starts, best first, by the linearized cost.

    For single lobes F0 = p / (p + q) of the channels' sums, kept off its bounds.
    """
    model = problem.model
    if model.lobe_count == 0:
        return [Shapes()]
    choices = np.array(list(combinations(range(len(SCAN_ROUGHNESSES)), model.lobe_count)))
    cost, weights = (np.asarray(x) for x in _scan(problem, jnp.asarray(SCAN_ROUGHNESSES), jnp.asarray(choices)))
    starts = []
    for best in np.argsort(cost, kind="stable")[:count]:
        f0 = None
        if model.bounds().f0 is not None:
            p, q = weights[best].sum(axis=0)[1:3]
            f0 = jnp.asarray(np.clip(p / (p + q), 0.02, 0.9) if p + q > 0 else 0.5)
        starts.append(Shapes(jnp.asarray(SCAN_ROUGHNESSES[choices[best]]), f0))
    return starts
