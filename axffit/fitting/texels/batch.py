"""Texels in any number: blocks of lanes through the batched solver, the slow ones again, the rest by optimistix.

A texel that does not converge has often begun at a wrong normal: what is left over tries the other starts as well.
"""

import enum
from collections.abc import Iterator
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from axffit.fitting.texels.finish import finish
from axffit.fitting.texels.problem import Samples, TexelModel, evaluate
from axffit.fitting.texels.shading import common_light
from axffit.fitting.texels.solver import advance, begin
from axffit.fitting.texels.starts import best_starts

LANES = 256
"""Texels in flight at once: 64 images of them fill a core's cache."""

ROUNDS = (8, 24)
"""Steps that all lanes of a block may take, then those of the texels left over, packed together."""

_FINISHED_TOGETHER = 16


class Outcome(enum.IntEnum):
    """How a texel's fit ended."""

    CONVERGED = 0
    """By the batched solver."""
    FINISHED = 1
    """By optimistix, after the batched solver had not converged."""
    NOT_CONVERGED = 2
    """Neither converged: the best parameters found are given, without standard errors."""
    TOO_FEW_SAMPLES = 3
    """No more samples than parameters: nothing was fitted."""


class TexelFit(NamedTuple):
    """Solutions of some texels; the fields are those of :mod:`axffit.fitting.texels.problem`'s Point and Coupling."""

    theta: Float[np.ndarray, "p texels"]
    weights: Float[np.ndarray, "channels k texels"]
    cost: Float[np.ndarray, " texels"]
    hessian: Float[np.ndarray, "packed texels"]
    gram: Float[np.ndarray, "channels packed_gram texels"]
    mixed: Float[np.ndarray, "channels k p texels"]
    outcome: Int[np.ndarray, " texels"]


@jax.enable_x64(new_val=True)
def fit_texels(
    model: TexelModel,
    wi: Float[np.ndarray, "n 3"],
    wo: Float[np.ndarray, "n 3"],
    values: Float[np.ndarray, "channels n texels"],
    precisions: Float[np.ndarray, "channels n texels"],
    start: Float[np.ndarray, "p texels"] | None = None,
    lanes: int = LANES,
) -> TexelFit:
    """The best parameters of every texel.

    Args:
        model: what is fitted.
        wi: unit vectors to the light, one an image.
        wo: unit vectors to the viewer.
        values: radiance over irradiance at normal incidence.
        precisions: 1 / sigma² of each value; 0 where it is not to be used.
        start: theta to begin with; None looks for one (:mod:`axffit.fitting.texels.starts`).
        lanes: texels in flight at once. A texel's bits may depend on its place in a block, so a run that is to be
            repeated bit for bit keeps it.
    """
    texels = values.shape[-1]
    usable = np.count_nonzero(precisions > 0, axis=(0, 1)) > model.parameters(len(values))
    # A channel without any sample would leave its weights undetermined.
    usable &= np.all(np.count_nonzero(precisions > 0, axis=1) > model.weights, axis=0)
    outcome = np.where(usable, Outcome.NOT_CONVERGED, Outcome.TOO_FEW_SAMPLES).astype(np.int8)
    light = common_light(wi, wo)
    theta = np.zeros((model.shapes, texels))
    damping = np.zeros(texels)

    def samples_at(part: Int[np.ndarray, " lanes"]) -> Samples:
        return Samples(light, jnp.asarray(values[..., part]), jnp.asarray(precisions[..., part]))

    left = np.flatnonzero(usable)
    for number, steps in enumerate(ROUNDS):
        for part, count in _blocks(left, lanes):
            samples = samples_at(part)
            if number > 0:
                state = begin(model, samples, jnp.asarray(theta[:, part]))._replace(damping=jnp.asarray(damping[part]))
            else:
                first = best_starts(model, samples)[0] if start is None else jnp.asarray(start[:, part])
                state = begin(model, samples, first)
            state = advance(model, samples, state, jnp.asarray(steps))
            own = part[:count]
            theta[:, own] = np.asarray(state.point.theta)[:, :count]
            damping[own] = np.asarray(state.damping)[:count]
            outcome[own[np.asarray(state.converged)[:count]]] = Outcome.CONVERGED
        left = left[outcome[left] == Outcome.NOT_CONVERGED]
    if start is None and model.normal:
        for part, count in _blocks(left, _FINISHED_TOGETHER):
            samples, own = samples_at(part), part[:count]
            states = [begin(model, samples, jnp.asarray(theta[:, part]))]
            others = best_starts(model, samples)[1:]
            states += [
                advance(model, samples, begin(model, samples, other), jnp.asarray(sum(ROUNDS))) for other in others
            ]
            costs = np.stack([np.asarray(state.point.cost) for state in states])
            best = np.argmin(np.where(np.isfinite(costs), costs, np.inf), axis=0)
            for lane, texel in enumerate(own):
                theta[:, texel] = np.asarray(states[best[lane]].point.theta)[:, lane]
                if np.asarray(states[best[lane]].converged)[lane]:
                    outcome[texel] = Outcome.CONVERGED
        left = left[outcome[left] == Outcome.NOT_CONVERGED]
    for part, count in _blocks(left, _FINISHED_TOGETHER):
        finished = finish(model, samples_at(part), jnp.asarray(theta[:, part]))
        found, converged = (np.asarray(array)[..., :count] for array in finished)
        theta[:, part[:count]] = found
        outcome[part[:count][converged]] = Outcome.FINISHED
    parts = []
    for part, count in _blocks(np.arange(texels), lanes):
        point, coupling = evaluate(model, samples_at(part), jnp.asarray(theta[:, part]))
        solved = (point.theta, point.weights, point.cost, point.hessian, coupling.gram, coupling.mixed)
        parts.append([np.asarray(array)[..., :count] for array in solved])
    whole = [np.concatenate(arrays, axis=-1) for arrays in zip(*parts, strict=True)]
    return TexelFit(*whole, outcome=outcome)


def _blocks(texels: Int[np.ndarray, " texels"], lanes: int) -> Iterator[tuple[Int[np.ndarray, " lanes"], int]]:
    """The texels in blocks of equal size, so that one compilation serves all, and how many of a block count."""
    for first in range(0, len(texels), lanes):
        part = texels[first : first + lanes]
        yield np.concatenate([part, np.repeat(part[-1:], lanes - len(part))]), len(part)
