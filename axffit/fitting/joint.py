"""Lobes and color table together: damped Gauss-Newton with the table eliminated by its Schur complement.

Unknowns: y = (raw spreads, weights >= 0 of the brightness b) and the table X (texels, channels). f = (A X) b(y).
With J_X block diagonal over the channels, each block banded,

    (H_yy - sum_c H_yX H_XX^-1 H_Xy) dy = -(g_y - sum_c H_yX H_XX^-1 g_X),   dX = -H_XX^-1 (g_X + H_Xy dy)

so a step costs one banded factor a channel. The weights stay >= 0 (bounded least squares on the small system). A dense
Jacobian would have 180 000 x 12 000 entries, which is why this stage does not run on a general solver.

The scale shared by X and b is fixed after every step: the data-weighted mean luminance of the table is 1.
"""

from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import scipy.linalg
import scipy.optimize
from jaxtyping import Array, Float

from axffit.fitting.bijections import forward_tree
from axffit.fitting.models import Shapes
from axffit.fitting.separable import SeparableProblem
from axffit.fitting.table import TableDesign, band_product
from axffit.measured import REC709_LUMINANCE

_TABLE_DAMPING = 0.01
"""The table is nearly linear; damping it as much as the lobes only slows the loop."""
_MAX_DAMPING = 1e8
Progress = Callable[[str, float], None]


class JointState(NamedTuple):
    """Raw spreads (K,), weights (m,) and table (texels, 3), with the cost there."""

    raw: np.ndarray
    weights: np.ndarray
    table: np.ndarray
    cost: float


class JointResult(NamedTuple):
    """Where the loop ended."""

    state: JointState
    converged: bool
    steps: int


@eqx.filter_jit
def _brightness(problem: SeparableProblem, raw: Float[Array, " k"]) -> tuple[Array, Array]:
    """Design (n, m) at raw spreads, and its derivative (n, m, k)."""

    def design(raw):
        return problem.design(forward_tree(problem.model.bounds(), Shapes(raw)))

    return design(raw), jax.jacfwd(design)(raw)


@eqx.filter_jit
def _design(problem: SeparableProblem, raw: Float[Array, " k"]) -> Array:
    return problem.design(forward_tree(problem.model.bounds(), Shapes(raw)))


@eqx.filter_jit
def _terms(problem: SeparableProblem, x: Float[Array, "n c"]) -> tuple[Array, Array]:
    """Residuals and their derivative in x, both (n, c)."""
    residual = problem.residual
    r = problem.root_weight * (residual.transform(x) - residual.transform(problem.target))
    return r, problem.root_weight * residual.slope(x)


class JointProblem:
    """The joint problem on one set of samples; ``problem`` holds the colored samples and the brightness model."""

    def __init__(self, problem: SeparableProblem, design: TableDesign, sample_weights: np.ndarray, *, smoothing: float):
        """``sample_weights`` (n,) are those of the gauge; ``smoothing`` is relative to the curvature of the data."""
        self.problem = problem
        self.design = design
        self.smoothing = smoothing
        self._gauge = (design.transposed @ sample_weights) / sample_weights.sum()
        self._penalty_scale = np.ones(problem.target.shape[1])

    def normalize(self, weights: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same product with the data-weighted mean luminance of the table at 1."""
        scale = float(self._gauge @ (table @ REC709_LUMINANCE))
        return (weights * scale, table / scale) if scale > 0 else (weights, table)

    def _x(self, design: np.ndarray, weights: np.ndarray, table: np.ndarray) -> np.ndarray:
        return (self.design.matrix @ table) * (design @ weights)[:, None]

    def _penalty(self, table: np.ndarray) -> np.ndarray:
        return self._penalty_scale * np.sum(table * band_product(self.design.smoothness_band, table), axis=0)

    def set_penalty(self, raw: np.ndarray, weights: np.ndarray, table: np.ndarray) -> None:
        """Scale the smoothing to the curvature of the data at a point; done once: the cost must stay one function."""
        design = np.asarray(_design(self.problem, jnp.asarray(raw)))
        _, slope = (np.asarray(a) for a in _terms(self.problem, jnp.asarray(self._x(design, weights, table))))
        bands = self.design.normal_band((slope * (design @ weights)[:, None]) ** 2)
        self._penalty_scale = self.smoothing * np.mean(bands[:, 0, self.design.measured], axis=1)

    def cost(self, raw: np.ndarray, weights: np.ndarray, table: np.ndarray) -> float:
        """Half of the sum of squares, smoothing included."""
        design = np.asarray(_design(self.problem, jnp.asarray(raw)))
        r, _ = _terms(self.problem, jnp.asarray(self._x(design, weights, table)))
        return 0.5 * float(np.sum(np.asarray(r) ** 2)) + 0.5 * float(np.sum(self._penalty(table)))

    def minimize(
        self,
        raw: np.ndarray,
        weights: np.ndarray,
        table: np.ndarray,
        *,
        free_lobes: bool,
        max_steps: int = 60,
        tolerance: float = 3e-5,
        progress: Progress | None = None,
    ) -> JointResult:
        """Damped Gauss-Newton from a start; with ``free_lobes`` false the table alone moves.

        Stops when an accepted step lowers the cost by less than ``tolerance`` of it.
        """
        weights, table = self.normalize(weights, np.where(self.design.measured[:, None], table, 0.0))
        state = JointState(raw, weights, table, self.cost(raw, weights, table))
        damping, small = 1e-3, 0
        for step in range(max_steps):
            if progress is not None:
                progress("lobes and color table" if free_lobes else "color table", step / max_steps)
            system = self._linearize(state, free_lobes=free_lobes)
            while True:
                trial = self._try(state, system, damping)
                if trial is not None and free_lobes:
                    trial = self._refined(trial)
                if trial is not None and trial.cost < state.cost:
                    break
                damping *= 8.0
                if damping > _MAX_DAMPING:
                    return JointResult(state, converged=True, steps=step)
            gain = 1.0 - trial.cost / state.cost if state.cost > 0 else 0.0
            damping = max(damping / 5.0, 1e-9)
            state = trial
            # Two in a row: one short step may only mean that the damping was high.
            small = small + 1 if gain < tolerance else 0
            if small >= 2 or (small and damping < 1e-3):
                return JointResult(state, converged=True, steps=step + 1)
        return JointResult(state, converged=False, steps=max_steps)

    def _refined(self, state: JointState) -> JointState:
        """``state`` after one step of the table alone.

        The product of table and brightness is bilinear: a joint step is right only to first order, and without this the
        loop creeps along curved valleys with heavy damping.
        """
        better = self._try(state, self._linearize(state, free_lobes=False), 0.0)
        return better if better is not None and better.cost < state.cost else state

    def _linearize(self, state: JointState, *, free_lobes: bool) -> dict[str, np.ndarray]:
        """Gradient and Gauss-Newton blocks at ``state``."""
        design, derivative = (np.asarray(a) for a in _brightness(self.problem, jnp.asarray(state.raw)))
        b, chi = design @ state.weights, self.design.matrix @ state.table
        r, slope = (np.asarray(a) for a in _terms(self.problem, jnp.asarray(chi * b[:, None])))
        j_x = slope * b[:, None]
        bands = self.design.normal_band(j_x**2)
        bands = bands + self._penalty_scale[:, None, None] * self.design.smoothness_band
        smooth = self._penalty_scale * band_product(self.design.smoothness_band, state.table)
        # The cost counts the smoothing of the normalized table, so a change of its scale alone must not lower it.
        smooth = smooth - np.sum(self._penalty(state.table)) * np.outer(self._gauge, REC709_LUMINANCE)
        g_x = self.design.transposed @ (j_x * r) + smooth
        if free_lobes:
            j_b = np.concatenate([np.einsum("nmk,m->nk", derivative, state.weights), design], axis=1)
        else:
            j_b = np.zeros((len(b), 0))
        j_chi = slope * chi
        cross = [self.design.transposed @ (j_b * (j_chi * j_x)[:, [c]]) for c in range(r.shape[1])]
        return {
            "bands": bands,
            "g_x": g_x,
            "g_y": j_b.T @ np.sum(j_chi * r, axis=1),
            "h_yy": j_b.T @ (j_b * np.sum(j_chi**2, axis=1)[:, None]),
            "h_xy": np.stack(cross, axis=2),
        }

    def _try(self, state: JointState, system: dict[str, np.ndarray], damping: float) -> JointState | None:
        """The state after a damped step, or None where the step cannot be computed."""
        count = len(system["g_y"])
        diagonal = np.diagonal(system["h_yy"])
        schur = system["h_yy"] + np.diag(damping * diagonal + 1e-12 * diagonal.max(initial=0.0) + 1e-300)
        right = -system["g_y"].copy()
        solved = []
        for channel, band in enumerate(system["bands"]):
            damped = band.copy()
            damped[0] *= 1.0 + _TABLE_DAMPING * damping
            try:
                factor = self.design.factor(damped)
            except np.linalg.LinAlgError:
                return None
            h_xy = system["h_xy"][:, :, channel]
            both = factor.solve(np.concatenate([h_xy, system["g_x"][:, channel : channel + 1]], axis=1))
            schur = schur - h_xy.T @ both[:, :count]
            right = right + h_xy.T @ both[:, count]
            solved.append(both)
        change = _bounded_step(schur, right, state) if count else np.zeros(0)
        if change is None:
            return None
        table = np.stack([-both[:, count] - both[:, :count] @ change for both in solved], axis=1) + state.table
        lobes = len(state.raw) if count else 0
        raw = state.raw + change[:lobes] if count else state.raw
        weights = np.maximum(state.weights + change[lobes:], 0.0) if count else state.weights
        weights, table = self.normalize(weights, np.maximum(table, 0.0))
        trial = JointState(raw, weights, table, self.cost(raw, weights, table))
        return trial if np.isfinite(trial.cost) else None


def _bounded_step(schur: np.ndarray, right: np.ndarray, state: JointState) -> np.ndarray | None:
    """The step of least quadratic cost that keeps the weights >= 0 and moves a raw spread by at most 1."""
    size = np.sqrt(np.maximum(np.diagonal(schur), 1e-300))
    try:
        lower = scipy.linalg.cholesky(schur / np.outer(size, size) + 1e-12 * np.eye(len(size)), lower=True)
    except np.linalg.LinAlgError:
        return None
    target = scipy.linalg.solve_triangular(lower, right / size, lower=True)
    bound = np.concatenate([np.full(len(state.raw), -1.0), -state.weights])
    upper = np.concatenate([np.full(len(state.raw), 1.0), np.full(len(state.weights), np.inf)])
    change = scipy.optimize.lsq_linear(lower.T, target, (bound * size - 1e-14, upper * size), method="bvls").x
    return change / size
