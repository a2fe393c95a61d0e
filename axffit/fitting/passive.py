"""Fits that reflect no more light than arrives.

The directional albedo A(wo) = integral of f cos theta_i d omega_i is linear in the weights of a model, so each viewer
adds one row to the problem: target 1, and the residual max(A - 1, 0) times a large weight, which the inner search for
weights sees as it sees a sample. What the penalty leaves over 1 is scaled away at the end. Below a refracting coat the
base's albedo is not the material's, and the coat's mirror takes its part: there the constraint would mean nothing.

Viewers stand at 0 to 80 degrees. The integral runs over half vectors h,

    A = integral f cos theta_i · 4 <h,o> d omega_h,    theta_h = (pi/2) t³

so that nodes are dense at the highlight: it is good to 1 % for roughnesses from 0.02 on.
"""

from typing import ClassVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit.brdf import AbstractBRDF
from axffit.errors import InputError
from axffit.fitting.models import AbstractFitModel, CarPaintModel, Coat, Directions, Shapes
from axffit.fitting.residuals import AbstractResidual, ResidualData, Values
from axffit.fitting.separable import SeparableProblem, Solution, Weights, solve
from axffit.measured import Measurements

VIEWERS = np.radians([0.0, 20.0, 40.0, 55.0, 65.0, 75.0, 80.0])
_POLAR, _AZIMUTH = 48, 24
_STRENGTH = 1e4
_ALLOWED = 1.0


class AlbedoRows(eqx.Module):
    """Nodes of the albedo of each viewer: directions (V, Q, 3) and weights with the cosine (V, Q)."""

    wi: Float[Array, "v q 3"]
    wo: Float[Array, "v q 3"]
    weights: Float[Array, "v q"]

    def of(self, model: AbstractFitModel, shapes: Shapes) -> Float[Array, "v m"]:
        """Albedo of each basis function."""
        viewers, nodes, _ = self.wi.shape
        values = model.basis(shapes, self.wi.reshape(-1, 3), self.wo.reshape(-1, 3))
        return jnp.sum(values.reshape(viewers, nodes, -1) * self.weights[:, :, None], axis=1)


def albedo_rows() -> AlbedoRows:
    """Nodes for :data:`VIEWERS`."""
    t = (np.arange(_POLAR) + 0.5) / _POLAR
    theta = np.repeat(0.5 * np.pi * t**3, _AZIMUTH)
    spacing = np.repeat(1.5 * np.pi * t**2 / _POLAR, _AZIMUTH)
    phi = np.tile(2.0 * np.pi * (np.arange(_AZIMUTH) + 0.5) / _AZIMUTH, _POLAR)
    h = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)
    solid_angle = np.sin(theta) * spacing * (2.0 * np.pi / _AZIMUTH)
    wo = np.stack([np.sin(VIEWERS), np.zeros_like(VIEWERS), np.cos(VIEWERS)], axis=1)
    h_o = wo @ h.T
    wi = 2.0 * h_o[:, :, None] * h[None] - wo[:, None, :]
    seen = (h_o > 0) & (wi[:, :, 2] > 1e-6)
    # Nodes below the horizon weigh nothing; they are moved to where every basis function is finite.
    wi = np.where(seen[:, :, None], wi, np.array([0.0, 0.0, 1.0]))
    weights = np.where(seen, 4.0 * h_o * solid_angle[None] * wi[:, :, 2], 0.0)
    return AlbedoRows(jnp.asarray(wi), jnp.asarray(np.broadcast_to(wo[:, None, :], wi.shape)), jnp.asarray(weights))


class _PassiveModel(AbstractFitModel):
    """``base`` with the albedos as the last rows of its basis."""

    base: AbstractFitModel
    rows: AlbedoRows
    coat: Coat | None = None

    @property
    def name(self) -> str:
        """The base's."""
        return self.base.name

    @property
    def lobe_count(self) -> int:
        """The base's."""
        return self.base.lobe_count

    def bounds(self) -> Shapes:
        """The base's."""
        return self.base.bounds()

    def basis(self, shapes: Shapes, wi: Directions, wo: Directions) -> Float[Array, "n m"]:
        """The base's for all but the last directions, for which the albedos stand."""
        count = len(self.rows.wi)
        samples = self.base.basis(shapes, wi[:-count], wo[:-count])
        return jnp.concatenate([samples, self.rows.of(self.base, shapes)])

    def assemble(self, shapes: Shapes, weights: Float[Array, "m channels"]) -> AbstractBRDF:
        """The base's."""
        return self.base.assemble(shapes, weights)


class _PassiveResidual(AbstractResidual):
    """``base`` for all but the last ``count`` rows, max(x - 1, 0) for those."""

    base: AbstractResidual
    count: int = eqx.field(static=True)
    name: ClassVar[str] = "passive"
    linear: ClassVar[bool] = False
    knows_noise: ClassVar[bool] = False

    def _split(self, samples: Values, rows: Values) -> Values:
        return jnp.concatenate([samples[: -self.count], rows[-self.count :]])

    def transform(self, x: Values) -> Values:
        """T of the samples, the excess of the rows."""
        return self._split(self.base.transform(x), jnp.maximum(x - _ALLOWED, 0.0))

    def slope(self, x: Values) -> Values:
        """T' of the samples; 1 for rows with an excess."""
        return self._split(self.base.slope(x), jnp.where(x > _ALLOWED, 1.0, 0.0))

    def curvature(self, x: Values) -> Values:
        """T'' of the samples; 0 for the rows."""
        return self._split(self.base.curvature(x), jnp.zeros_like(x))

    def prepare(self, measurements: Measurements) -> ResidualData:
        """The base's."""
        return self.base.prepare(measurements)


def check_passive(model: AbstractFitModel) -> None:
    """Refuse a model below a refracting coat, and a car paint, whose table belongs to its albedo.

    Raises:
        InputError: its coat refracts, or it is a car paint.
    """
    if isinstance(model, CarPaintModel):
        raise InputError("carpaint: passivity is asked of models without a color table; choose another model")
    if model.coat is not None and model.coat.refracting:
        raise InputError(f"{model.name}: passivity is asked of what lies bare or below a coat that does not refract")


def albedos(model: AbstractFitModel, shapes: Shapes, weights: Weights) -> np.ndarray:
    """Directional albedo (V, channels) at :data:`VIEWERS`."""
    return np.asarray(albedo_rows().of(model, shapes) @ weights)


def solve_passive(problem: SeparableProblem, free: Solution, *, max_steps: int) -> Solution:
    """The minimum near ``free`` with no albedo above 1; ``free`` itself where it has none."""
    rows = albedo_rows()
    if float(jnp.max(rows.of(problem.model, free.shapes) @ free.weights)) <= _ALLOWED:
        return free
    count, channels = len(rows.wi), problem.target.shape[1]
    up = jnp.broadcast_to(jnp.array([0.0, 0.0, 1.0]), (count, 3))
    # As strong as all samples of a black model together, many times over.
    whole = float(jnp.sum((problem.root_weight * problem.residual.transform(problem.target)) ** 2))
    bounded = SeparableProblem(
        _PassiveModel(base=problem.model, rows=rows),
        _PassiveResidual(base=problem.residual, count=count),
        jnp.concatenate([problem.wi, up]),
        jnp.concatenate([problem.wo, up]),
        jnp.concatenate([problem.target, jnp.ones((count, channels))]),
        jnp.concatenate([problem.factor, jnp.ones(count)]),
        jnp.concatenate([problem.root_weight, jnp.full((count, channels), np.sqrt(_STRENGTH * whole))]),
    )
    found = solve(bounded, free.shapes, max_steps=max_steps)
    excess = jnp.maximum(jnp.max(rows.of(problem.model, found.shapes) @ found.weights, axis=0), _ALLOWED)
    weights = found.weights / excess[None, :]
    cost = 0.5 * jnp.sum(problem.residuals(problem.design(found.shapes), weights) ** 2)
    return Solution(found.shapes, weights, cost, found.converged, found.steps)
