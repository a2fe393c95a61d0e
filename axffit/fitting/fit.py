"""One entry point for every fit."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import jax
import numpy as np

from axffit.errors import InputError
from axffit.fitting.carpaint import fit_car_paint
from axffit.fitting.estimates import estimates
from axffit.fitting.limits import Limit, half_difference_limit, reciprocal_limit
from axffit.fitting.metrics import POLAR_LIMIT, evaluate_samples, metrics_of, within
from axffit.fitting.models import AbstractFitModel, CarPaintModel
from axffit.fitting.multilobe import LobesModel
from axffit.fitting.multilobe_estimates import multilobe_estimates
from axffit.fitting.names import parse_model
from axffit.fitting.passive import check_passive, solve_passive
from axffit.fitting.residuals import AbstractResidual, LogCosine, NoiseWeighted, Robust
from axffit.fitting.result import FitResult, Outcome
from axffit.fitting.separable import make_problem
from axffit.fitting.starts import minimize
from axffit.fitting.studies import Study, make_study
from axffit.fitting.uncertainty import NOISE_KIND, SANDWICH_KIND
from axffit.measured import Measurements, RGBChannels

Progress = Callable[[str, float], None]
Negatives = Literal["clip", "leave out"]
_MAX_ROUNDS, _SETTLED = 30, 0.01


def fit(
    model: str | AbstractFitModel,
    measurements: Measurements,
    *,
    residual: AbstractResidual | None = None,
    color_table: int = 64,
    smoothing: float = 1e-4,
    polar_limit: float = POLAR_LIMIT,
    negatives: Negatives = "clip",
    passive: bool = False,
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
        negatives: ``"clip"``: they count as 0; ``"leave out"``: samples with one in any channel are left out. The
            noise-weighted residual does not clip.
        passive: no albedo above 1 (``axffit.fitting.passive``); for models that are no car paint, bare or below a coat
            that does not refract.
        max_steps: of each solver.
        study: profiles and bootstrap that are wanted besides the standard errors.
        progress: called with what is being done and how much of it is (0 to 1).

    Returns:
        The fitted model with its parameters, standard errors, metrics and outcome. Data that allow no fit end in a
        named outcome without numbers, not in an exception.

    Raises:
        InputError: the model is unknown, the samples are not RGB, the residual needs a noise that they do not state, or
            the study names a parameter that the model has not, or passivity is asked of a model that cannot have it.
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
    if passive:
        check_passive(fit_model)
    chosen = within(measurements, polar_limit)
    if negatives == "leave out":
        chosen &= np.all(measurements.values >= 0, axis=1)
    samples = _samples_json(measurements, chosen, polar_limit)
    degenerate = _degenerate(fit_model, measurements, chosen)
    if degenerate is not None:
        return FitResult(None, fit_model.name, degenerate, residual=residual.name, samples=samples)
    used = measurements.select(chosen)
    with jax.enable_x64(new_val=True):
        asked = study or Study()

        def once(weighted: Measurements) -> dict[str, Any]:
            if not isinstance(fit_model, CarPaintModel):
                return _fit_colored(
                    fit_model, weighted, residual, passive=passive, max_steps=max_steps, asked=asked, progress=progress
                )
            return fit_car_paint(
                fit_model,
                weighted,
                residual,
                size=color_table,
                smoothing=smoothing,
                max_steps=max_steps,
                asked=asked,
                progress=progress,
            )

        found = _robustly(once, used, residual) if isinstance(residual, Robust) else once(used)
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


def _robustly(once: Callable[[Measurements], dict[str, Any]], used: Measurements, residual: Robust) -> dict[str, Any]:
    """Iteratively reweighted fits, until no sample's weight changes by more than 1 % of itself."""
    factors = np.ones(len(used))
    found: dict[str, Any] = {}
    for _ in range(_MAX_ROUNDS):
        found = once(replace(used, weights=used.weights * factors))
        new = residual.factors(used, evaluate_samples(found["model"], used))
        if np.all(np.abs(new - factors) <= _SETTLED * factors):
            return found
        factors = new
    return found | {"outcome": Outcome.STEP_LIMIT}


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
    *,
    passive: bool,
    max_steps: int,
    asked: Study,
    progress: Progress | None,
) -> dict[str, Any]:
    """Fit of a model with a color a term: scan, polish of the best starts, F0 tried on its bounds."""
    problem = make_problem(model, residual, used, residual.prepare(used))
    free = minimize(problem, max_steps=max_steps, progress=progress)
    best = solve_passive(problem, free, max_steps=max_steps) if passive else free
    outcome = Outcome.CONVERGED if bool(best.converged) else Outcome.STEP_LIMIT
    if not math.isfinite(float(best.cost)):
        outcome = Outcome.NOT_FINITE
    shapes, weights = best.shapes, best.weights
    if isinstance(model, LobesModel):
        if asked != Study():
            raise InputError(f"{model.name}: profiles and bootstrap are there for one lobe and for car paint")
        shapes, weights = model.ordered(shapes, weights)
        fields = multilobe_estimates(problem, model, shapes, weights).fields()
    else:
        found = estimates(problem, shapes, weights)
        fields = found.fields() | make_study(asked, problem, shapes, weights, found, progress)
    notes = () if best is free else ("an albedo of 1 holds the fit back; the standard errors are those without it",)
    return {"model": model.assemble(shapes, weights), "outcome": outcome, "notes": notes, **fields}
