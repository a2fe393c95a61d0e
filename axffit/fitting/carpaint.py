"""The fit of a whole car paint, in stages.

1. Lobes on luminance (Rec. 709), the table's luminance being 1 everywhere. Standard errors of b come from here.
2. The color table for these lobes, per channel; texels that no sample touches are marked and stay 0.
3. Lobes and table together, the table eliminated (``axffit.fitting.joint``), started from three sets of lobes with one
   color: those of stage 1, those that the cosine metric finds, and narrow ones; the lowest cost counts.
   Errors of the lobes are conditional on the table.

f fixes chi and b up to a factor: the data-weighted mean luminance of chi is 1.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from axffit.brdf import AbstractBRDF, ColorTable
from axffit.fitting.bijections import forward_tree, start_tree
from axffit.fitting.estimates import Estimates, estimates
from axffit.fitting.joint import JointProblem, JointResult
from axffit.fitting.lobes import Lobes, canonical
from axffit.fitting.metrics import Metrics, evaluate_samples, metrics_of
from axffit.fitting.models import CarPaintModel, Shapes
from axffit.fitting.parameters import ParameterEstimate
from axffit.fitting.residuals import AbstractResidual, CosineWeighted
from axffit.fitting.result import Outcome, Stage
from axffit.fitting.separable import SeparableProblem, Solution, best_weights, cost_at, make_problem
from axffit.fitting.starts import minimize, subsample
from axffit.fitting.studies import Study, make_study
from axffit.fitting.table import TableDesign
from axffit.frames import directions_to_half_difference, refract
from axffit.measured import REC709_LUMINANCE, Measurements

Progress = Callable[[str, float], None]
_PEAK_SAMPLES = 2048
_NARROWEST, _WIDENING = 0.007, 3.0
"""Spreads of the narrow start: with a table the lobes are for what is finer than its texels (0.025 at 64 of them)."""


def luminance(measurements: Measurements) -> Measurements:
    """The samples' luminance as one channel, noise of the channels taken as independent."""
    sigma = measurements.sigma
    return replace(
        measurements,
        values=(measurements.values @ REC709_LUMINANCE)[:, None],
        sigma=None if sigma is None else np.sqrt(sigma**2 @ REC709_LUMINANCE**2)[:, None],
    )


def angles_below_coat(model: CarPaintModel, measurements: Measurements) -> tuple[np.ndarray, np.ndarray]:
    """theta_h and theta_d (N,) of the samples where the color table sees them."""
    wi, wo = jnp.asarray(measurements.wi), jnp.asarray(measurements.wo)
    if model.coat is not None and model.coat.refracting:
        up, ior = jnp.array([0.0, 0.0, 1.0]), jnp.full(len(wi), model.coat.ior)
        normal = jnp.broadcast_to(up, wi.shape)
        wi, wo = refract(wi, normal, ior), refract(wo, normal, ior)
    theta_h, theta_d, _, _ = directions_to_half_difference(wi, wo)
    return np.asarray(theta_h), np.asarray(theta_d)


def fit_lobes(
    model: CarPaintModel,
    measurements: Measurements,
    residual: AbstractResidual,
    *,
    max_steps: int,
    progress: Progress | None = None,
) -> tuple[SeparableProblem, Solution]:
    """Stage 1: b on luminance, with chi's luminance 1 everywhere; lobes in canonical order."""
    gray = luminance(measurements)
    problem = make_problem(model, residual, gray, residual.prepare(gray))
    best = minimize(problem, max_steps=max_steps, progress=progress)
    lobes = canonical(Lobes(best.shapes, best.weights))
    return problem, best._replace(shapes=lobes.shapes, weights=lobes.weights)


def fit_car_paint(
    model: CarPaintModel,
    measurements: Measurements,
    residual: AbstractResidual,
    *,
    size: int,
    smoothing: float,
    max_steps: int,
    asked: Study,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """All stages; ``size`` 0 stops after the first, with one color for the whole table.

    Returns:
        Fields of :class:`axffit.fitting.FitResult`.
    """
    gray_problem, first = fit_lobes(model, measurements, residual, max_steps=max_steps, progress=progress)
    lobes = Lobes(first.shapes, first.weights)
    problem = make_problem(model, residual, measurements, residual.prepare(measurements))
    color, scaled = _one_color(problem, lobes)
    plain = _paint(model, scaled, color.reshape(1, 1, 3))
    first_estimates = estimates(gray_problem, lobes.shapes, lobes.weights)
    studied = make_study(asked, gray_problem, lobes.shapes, lobes.weights, first_estimates, progress)
    stage = Stage(
        "lobes on luminance, one color",
        _metrics(plain, measurements),
        first_estimates.parameters,
        float(first.cost),
        int(first.steps),
        bool(first.converged),
    )
    if size == 0 or not np.isfinite(first.cost):
        outcome = _outcome(converged=bool(first.converged), cost=float(first.cost))
        return {"model": plain, "outcome": outcome, "stages": (stage,), **first_estimates.fields(), **studied}
    joint = _joint_problem(model, problem, measurements, size, smoothing)
    start = _joint_start(model, scaled, color, size)
    joint.set_penalty(*start)
    table_only = joint.minimize(*start, free_lobes=False, max_steps=max_steps, progress=progress)
    starts = [start]
    for other in (_peak_lobes(model, gray_problem, measurements, max_steps), _narrow_lobes(model, gray_problem)):
        other_color, other_scaled = _one_color(problem, other)
        starts.append(_joint_start(model, other_scaled, other_color, size))
    together = min(
        (joint.minimize(*one, free_lobes=True, max_steps=max_steps, progress=progress) for one in starts),
        key=lambda result: result.state.cost,
    )
    if together.state.cost > table_only.state.cost:
        # A narrow valley can hold the joint loop; from the finished table it cannot end worse than it.
        state = table_only.state
        together = joint.minimize(
            state.raw, state.weights, state.table, free_lobes=True, max_steps=max_steps, progress=progress
        )
    stages = [stage]
    named = (("color table", table_only), ("lobes and color table", together))
    brdf, found = plain, first_estimates
    for name, result in named:
        brdf, found = _finish(joint, model, result)
        stages.append(_stage(name, brdf, found.parameters, result, measurements))
    return {
        "model": brdf,
        "outcome": _outcome(converged=together.converged, cost=together.state.cost),
        "stages": tuple(stages),
        **found.fields(),
        **studied,
        "measured_texels": joint.design.measured.reshape(size, size),
        "notes": _notes(joint.design),
    }


def _joint_start(
    model: CarPaintModel, lobes: Lobes, color: np.ndarray, size: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Raw spreads, weights and table of one color to start from."""
    raw = np.asarray(start_tree(model.bounds(), lobes.shapes).roughness)
    return raw, np.asarray(lobes.weights)[:, 0], np.repeat(color[None, :], size * size, axis=0)


def _peak_lobes(
    model: CarPaintModel, gray_problem: SeparableProblem, measurements: Measurements, max_steps: int
) -> Lobes:
    """Lobes of the cosine metric, which sees the peak: a second start, since the joint problem has many minima."""
    gray, residual = luminance(measurements), CosineWeighted()
    problem = subsample(make_problem(model, residual, gray, residual.prepare(gray)), _PEAK_SAMPLES)
    shapes = minimize(problem, max_steps=max_steps).shapes
    return Lobes(shapes, cost_at(gray_problem, shapes)[1])


def _narrow_lobes(model: CarPaintModel, gray_problem: SeparableProblem) -> Lobes:
    """Lobes of fixed narrow spreads: without a table neither metric would choose them, and with one they often win."""
    shapes = Shapes(jnp.asarray(_NARROWEST * _WIDENING ** np.arange(model.lobe_count)))
    return Lobes(shapes, cost_at(gray_problem, shapes)[1])


def _one_color(problem: SeparableProblem, lobes: Lobes) -> tuple[np.ndarray, Lobes]:
    """The best single color (3,), luminance 1, for a brightness, and the brightness scaled to it."""
    b = problem.design(lobes.shapes) @ lobes.weights
    color = np.asarray(best_weights(problem, b))[0]
    scale = float(color @ REC709_LUMINANCE)
    if not scale > 0:
        return np.ones(3), lobes
    return color / scale, Lobes(lobes.shapes, lobes.weights * scale)


def _joint_problem(
    model: CarPaintModel, problem: SeparableProblem, measurements: Measurements, size: int, smoothing: float
) -> JointProblem:
    padding = np.zeros(len(problem.wi) - len(measurements))
    theta_h, theta_d = angles_below_coat(model, measurements)
    design = TableDesign.of(np.concatenate([theta_h, padding]), np.concatenate([theta_d, padding]), size)
    real = np.concatenate([np.ones(len(measurements)), padding])
    weights = np.concatenate([measurements.weights, padding])
    return JointProblem(problem, design.keeping(real), weights, smoothing=smoothing)


def _finish(joint: JointProblem, model: CarPaintModel, result: JointResult) -> tuple[AbstractBRDF, Estimates]:
    """The paint of a joint state, and its parameters with errors that are conditional on the table."""
    state = result.state
    shapes = forward_tree(model.bounds(), Shapes(jnp.asarray(state.raw)))
    lobes = canonical(Lobes(shapes, jnp.asarray(state.weights[:, None])))
    size = joint.design.size
    brdf = _paint(model, lobes, state.table.reshape(size, size, 3))
    return brdf, conditional_estimates(joint, lobes, state.table)


def conditional_estimates(joint: JointProblem, lobes: Lobes, table: np.ndarray) -> Estimates:
    """Parameters of b with standard errors for this table; each channel is b times a known factor."""
    chi = joint.design.matrix @ table
    return estimates(joint.problem, lobes.shapes, lobes.weights, color=chi)


def _paint(model: CarPaintModel, lobes: Lobes, table: np.ndarray) -> AbstractBRDF:
    return model.covered(model.paint(lobes.shapes, lobes.weights, ColorTable(jnp.asarray(table))))


def _metrics(brdf: AbstractBRDF, measurements: Measurements) -> Metrics:
    return metrics_of(measurements, evaluate_samples(brdf, measurements), polar_limit=np.pi / 2)


def _stage(
    name: str,
    brdf: AbstractBRDF,
    parameters: tuple[ParameterEstimate, ...],
    result: JointResult,
    measurements: Measurements,
) -> Stage:
    metrics = _metrics(brdf, measurements)
    return Stage(name, metrics, parameters, result.state.cost, result.steps, result.converged)


def _outcome(*, converged: bool, cost: float) -> Outcome:
    if not np.isfinite(cost):
        return Outcome.NOT_FINITE
    return Outcome.CONVERGED if converged else Outcome.STEP_LIMIT


def _notes(design: TableDesign) -> tuple[str, ...]:
    touched, total = int(design.measured.sum()), design.size**2
    return (
        f"{touched} of {total} texels of the color table are measured; the others are 0, not extrapolated",
        "standard errors of the lobes are conditional on the color table; those of the first stage are not",
    )
