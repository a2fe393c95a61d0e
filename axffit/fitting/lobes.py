"""The lobes of a car paint, in an order that does not depend on how they were found."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from axffit.fitting.models import AbstractFitModel, CarPaintModel, Shapes
from axffit.fitting.separable import Weights


class Lobes(NamedTuple):
    """A brightness b: spreads (K,) and weights (1 + 2 K, 1)."""

    shapes: Shapes
    weights: Weights


def canonical(lobes: Lobes) -> Lobes:
    """The same brightness with lobes in the order of their spreads, lobes without weight last."""
    spreads, weights = np.asarray(lobes.shapes.roughness), np.asarray(lobes.weights)
    p, q = weights[1::2], weights[2::2]
    order = np.lexsort((spreads, (p + q)[:, 0] == 0))
    pairs = np.stack([p[order], q[order]], axis=1).reshape(-1, weights.shape[1])
    return Lobes(Shapes(jnp.asarray(spreads[order])), jnp.asarray(np.concatenate([weights[:1], pairs])))


def canonical_solution(model: AbstractFitModel, shapes: Shapes, weights: Weights) -> Lobes:
    """:func:`canonical` for a car paint; other models have one lobe and stay as they are."""
    lobes = Lobes(shapes, weights)
    return canonical(lobes) if isinstance(model, CarPaintModel) else lobes
