"""Bootstrap: the fit again on samples drawn with replacement from its own, many times, in vmapped batches.

Whole samples (a pair of directions with all channels) are drawn, so neither equal nor independent noise within a sample
is assumed (Efron, Ann. Statist. 7(1), 1979). Drawn k times, a sample has k times its weight. Every fit starts from the
solution. The intervals are percentiles.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from axffit.errors import InputError
from axffit.fitting.batch import lane_of, solve_batch
from axffit.fitting.models import Shapes
from axffit.fitting.parameters import ParameterEstimate
from axffit.fitting.separable import SeparableProblem, Weights

_PERCENTILES = (2.5, 97.5)
FEWEST = 40
"""Below, a percentile of 2.5 lies beyond the most extreme of the fits."""

Named = Callable[[SeparableProblem, Shapes, Weights], tuple[ParameterEstimate, ...]]


class Resampled(NamedTuple):
    """One parameter over all fits of a bootstrap.

    ``low`` and ``high``: 2.5 and 97.5 % percentiles; None where the fit itself calls the parameter not identified or at
    a bound.
    """

    name: str
    mean: float
    standard_deviation: float
    low: float | None
    high: float | None


class Bootstrap(NamedTuple):
    """``count`` fits, of which ``converged`` converged; the others are left out of the parameters."""

    count: int
    converged: int
    seed: int
    parameters: tuple[Resampled, ...]

    def to_json(self) -> dict[str, Any]:
        """The fields by name."""
        return self._asdict() | {"parameters": [parameter._asdict() for parameter in self.parameters]}


def bootstrap(
    problem: SeparableProblem, shapes: Shapes, weights: Weights, named: Named, *, count: int, seed: int = 0
) -> Bootstrap:
    """Resamples and fits again.

    Args:
        problem: what was fitted.
        shapes: the solution's shapes, where every fit starts.
        weights: the solution's weights.
        named: turns a problem with its solution into named parameters, lobes in canonical order.
        count: how many fits, at least 40.
        seed: of the draws.

    Raises:
        InputError: fewer than 40 fits.
    """
    if count < FEWEST:
        raise InputError(
            f"a bootstrap of {count} fits: give at least {FEWEST}; its percentiles need them (200 is usual)"
        )
    root_weight = np.asarray(problem.root_weight)
    real = np.flatnonzero(root_weight.max(axis=1) > 0)
    draws = np.random.default_rng(seed).multinomial(len(real), np.full(len(real), 1.0 / len(real)), size=count)
    root_weights = np.zeros((count, *root_weight.shape))
    root_weights[:, real] = np.sqrt(draws)[:, :, None] * root_weight[real]
    targets = np.broadcast_to(np.asarray(problem.target), root_weights.shape)
    start = jax.tree.map(lambda leaf: np.broadcast_to(leaf, (count, *leaf.shape)), shapes)
    found = solve_batch(problem, targets, root_weights, start=start)
    kept = np.flatnonzero(found.converged)
    values = []
    for lane in kept.tolist():
        own, ended = jax.tree.map(lambda leaf, lane=lane: jnp.asarray(leaf[lane]), (found.shapes, found.weights))
        values.append([one.value for one in named(problem, own, ended)])
    rows = np.array(values).T if values else np.full((0, 0), np.nan)
    solution = named(lane_of(problem, problem.target, problem.root_weight), shapes, weights)
    return Bootstrap(count, len(kept), seed, tuple(_resampled(*pair) for pair in zip(solution, rows, strict=False)))


def _resampled(parameter: ParameterEstimate, values: np.ndarray) -> Resampled:
    low, high = np.percentile(values, _PERCENTILES).tolist()
    if parameter.standard_error is None:
        low = high = None
    return Resampled(parameter.name, float(values.mean()), float(values.std(ddof=1)), low, high)
