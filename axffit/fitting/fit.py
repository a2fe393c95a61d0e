"""One entry point for every fit."""

import math
from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from axffit.errors import InputError
from axffit.fitting.carpaint import fit_car_paint
from axffit.fitting.estimates import estimates
from axffit.fitting.limits import Limit, half_difference_limit, reciprocal_limit
from axffit.fitting.metrics import POLAR_LIMIT, evaluate_samples, metrics_of, within
from axffit.fitting.models import AbstractFitModel, CarPaintModel, parse_model
from axffit.fitting.residuals import AbstractResidual, LogCosine, NoiseWeighted
from axffit.fitting.result import FitResult, Outcome
from axffit.fitting.separable import make_problem
from axffit.fitting.starts import minimize
from axffit.fitting.studies import Study, make_study
from axffit.fitting.uncertainty import NOISE_KIND, SANDWICH_KIND
from axffit.measured import Measurements, RGBChannels

Progress = Callable[[str, float], None]


def fit(
    model: str | AbstractFitModel,
    measurements: Measurements,
    *,
    residual: AbstractResidual | None = None,
    color_table: int = 64,
    smoothing: float = 1e-3,
    polar_limit: float = POLAR_LIMIT,
    max_steps: int = 100,
    study: Study | None = None,
    progress: Progress | None = None,
) -> FitResult:
    """Find the parameters of a model that explain samples; no start, no seed, the same answer every time.

    Args:
        model: a name such as ``"ggx"``, ``"carpaint"`` (three lobes) or ``"carpaint+coat"``, or a model of
            ``axffit.fitting.models``. ``carpaint`` is the base alone, ``carpaint+coat`` the base below a refracting
            coat of index 1.5.
        measurements: the samples; linear RGB.
        residual: what is minimized. By default noise-weighted where the samples state their noise, else the log metric.
        color_table: texels along each axis of a car paint's color table; 0 for one color everywhere, lobes only.
        smoothing: weight of the squared differences between neighboring texels, relative to the data's.
        polar_limit: samples with a larger polar angle (radians) of either direction are left out.
        max_steps: of each solver.
        study: profiles and bootstrap that are wanted besides the standard errors.
        progress: called with what is being done and how much of it is (0 to 1).

    Returns:
        The fitted model with its parameters, standard errors, metrics and outcome. Data that allow no fit end in a
        named outcome without numbers, not in an exception.

    Raises:
        InputError: the model is unknown, the samples are not RGB, the residual needs a noise that they do not state, or
            the study names a parameter that the model has not.
    """
    fit_model = parse_model(model) if isinstance(model, str) else model
    if not isinstance(measurements.channels, RGBChannels):
        raise InputError(f"{measurements.name or 'samples'}: spectral samples: convert them to linear RGB first")
    if color_table < 0 or color_table == 1 or smoothing < 0 or max_steps < 1:
        raise InputError(
            f"color_table={color_table}, smoothing={smoothing}, max_steps={max_steps}: give 0 or at least 2, >= 0, >= 1"
        )
    if residual is None:
        residual = LogCosine() if measurements.sigma is None else NoiseWeighted()
    chosen = within(measurements, polar_limit)
    samples = _samples_json(measurements, chosen, polar_limit)
    degenerate = _degenerate(fit_model, measurements, chosen)
    if degenerate is not None:
        return FitResult(None, fit_model.name, degenerate, residual=residual.name, samples=samples)
    used = measurements.select(chosen)
    with jax.enable_x64(new_val=True):
        if isinstance(fit_model, CarPaintModel):
            found = fit_car_paint(
                fit_model,
                used,
                residual,
                size=color_table,
                smoothing=smoothing,
                max_steps=max_steps,
                asked=study or Study(),
                progress=progress,
            )
        else:
            found = _fit_colored(fit_model, used, residual, max_steps, study or Study(), progress)
        brdf = found["model"]
        metrics = metrics_of(used, evaluate_samples(brdf, used), polar_limit=math.pi / 2)
    if progress is not None:
        progress("fit", 1.0)
    return FitResult(
        model_name=fit_model.name,
        metrics=metrics,
        limits=_limits(used),
        residual=residual.name,
        error_kind=NOISE_KIND if residual.knows_noise else SANDWICH_KIND,
        samples=samples,
        **found,
    )


def _samples_json(measurements: Measurements, chosen: np.ndarray, polar_limit: float) -> dict[str, Any]:
    return {
        "name": measurements.name,
        "count": len(measurements),
        "used": int(chosen.sum()),
        "clipped_negatives": int(np.count_nonzero(measurements.values[chosen] < 0)),
        "polar_limit_degrees": math.degrees(polar_limit),
        "provenance": dict(measurements.provenance),
    }


def _limits(used: Measurements) -> tuple[Limit, ...]:
    found = (limit(used, polar_limit=math.pi / 2) for limit in (reciprocal_limit, half_difference_limit))
    return tuple(limit for limit in found if limit is not None)


def _degenerate(model: AbstractFitModel, measurements: Measurements, chosen: np.ndarray) -> Outcome | None:
    """Why these samples allow no fit, or None."""
    if not chosen.any():
        return Outcome.NO_SAMPLES
    if not np.any(measurements.values[chosen] > 0):
        return Outcome.ALL_BLACK
    directions = np.round(np.concatenate([measurements.wi, measurements.wo], axis=1)[chosen], 9)
    different = len(np.unique(directions, axis=0)) if len(directions) < 1000 else len(directions)
    needed = 1 + 3 * model.lobe_count
    if different == 1 and needed > 1:
        return Outcome.ONE_DIRECTION
    return Outcome.TOO_FEW_DIRECTIONS if different <= needed and needed > 1 else None


def _fit_colored(
    model: AbstractFitModel,
    used: Measurements,
    residual: AbstractResidual,
    max_steps: int,
    asked: Study,
    progress: Progress | None,
) -> dict[str, Any]:
    """Fit of a model with a color a term: scan, polish of the best starts, F0 tried on its bounds."""
    problem = make_problem(model, residual, used, residual.prepare(used))
    best = minimize(problem, max_steps=max_steps, progress=progress)
    outcome = Outcome.CONVERGED if bool(best.converged) else Outcome.STEP_LIMIT
    if not math.isfinite(float(best.cost)):
        outcome = Outcome.NOT_FINITE
    found = estimates(problem, best.shapes, best.weights)
    return {
        "model": model.assemble(best.shapes, best.weights),
        "outcome": outcome,
        **found.fields(),
        **make_study(asked, problem, best.shapes, best.weights, found, progress),
    }
