"""Which model, and how many lobes: information criteria and cross-validation over candidates on the same samples.

With n residuals of weighted mean square RSS / n, K free parameters (a parameter that ended at a bound counts):

    AIC = n ln(RSS / n) + 2 K        BIC = n ln(RSS / n) + K ln n         (noise known: RSS in place of n ln(RSS / n))

(Akaike, IEEE TAC 19(6), 1974; Schwarz, Ann. Stat. 6(2), 1978). Both take the residuals as independent. Those of a
smooth BRDF that no model explains fully are not: then both ask for ever more lobes, and cross-validation is the honest
one. There each fifth of the different pairs of directions is predicted from the other four; chosen is the model with
the fewest parameters whose error is within one standard error of the least (Breiman et al. 1984).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from axffit.brdf.carpaint import MAX_LOBES
from axffit.errors import InputError
from axffit.fitting.metrics import POLAR_LIMIT, within
from axffit.fitting.models import LOBES, AbstractFitModel, LambertModel, SingleLobeModel
from axffit.fitting.multilobe import LobesModel
from axffit.fitting.residuals import AbstractResidual, LogCosine, NoiseWeighted
from axffit.fitting.separable import SeparableProblem, Solution, make_problem
from axffit.fitting.starts import minimize
from axffit.measured import Measurements, RGBChannels

FOLDS = 5
SAMPLES = 2048
"""Candidates are compared on this many samples, spread evenly through their order."""
_GOLDEN = 0.6180339887498949
_SCAN_LEAST = 40
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Candidate:
    """How a model does: error (the residual's metric), criteria, and cross-validation with its standard error."""

    model: AbstractFitModel
    parameters: int
    error: float
    aic: float
    bic: float
    validation: float
    validation_error: float

    def to_json(self) -> dict[str, Any]:
        """The numbers by name."""
        names = ("parameters", "error", "aic", "bic", "validation", "validation_error")
        return {"model": self.model.name, "lobes": self.model.lobe_count} | {
            name: getattr(self, name) for name in names
        }


@dataclass(frozen=True)
class Selection:
    """Candidates in the order given, and which of them each criterion chooses."""

    candidates: tuple[Candidate, ...]
    residual: str
    samples: int

    def _least(self, name: str) -> Candidate:
        return min(self.candidates, key=lambda candidate: getattr(candidate, name))

    @property
    def by_aic(self) -> Candidate:
        """Least AIC."""
        return self._least("aic")

    @property
    def by_bic(self) -> Candidate:
        """Least BIC."""
        return self._least("bic")

    @property
    def chosen(self) -> Candidate:
        """By cross-validation: fewest parameters within one standard error of the least error."""
        best = self._least("validation")
        good = [one for one in self.candidates if one.validation <= best.validation + best.validation_error]
        return min(good, key=lambda one: (one.parameters, one.validation))

    def notes(self) -> tuple[str, ...]:
        """What was chosen and why, in words."""
        best, chosen = self._least("validation"), self.chosen
        return (
            f"{chosen.model.name} chosen among {len(self.candidates)} models by {FOLDS}-fold cross-validation on "
            f"{self.samples} samples: {self.residual} error {chosen.validation:.4g} of directions held back, "
            f"with {chosen.parameters} parameters; the least is {best.validation:.4g} of {best.model.name}",
            f"AIC chooses {self.by_aic.model.name}, BIC {self.by_bic.model.name}; both take residuals as independent",
        )

    def to_json(self) -> dict[str, Any]:
        """Everything, and the choices by model name."""
        return {
            "residual": self.residual,
            "samples": self.samples,
            "folds": FOLDS,
            "candidates": [candidate.to_json() for candidate in self.candidates],
            "aic": self.by_aic.model.name,
            "bic": self.by_bic.model.name,
            "cross_validation": self.chosen.model.name,
        }


def default_candidates() -> tuple[AbstractFitModel, ...]:
    """Lambert, then Ward, Cook-Torrance and GGX, each with 1 to 4 lobes that share one F0."""
    kinds = [lobe for lobe in LOBES if ":" not in lobe]
    several = [LobesModel(lobe=lobe, lobes=n, f0="shared") for lobe in kinds for n in range(2, MAX_LOBES + 1)]
    return (LambertModel(), *(SingleLobeModel(lobe=lobe) for lobe in kinds), *several)


def select(
    measurements: Measurements,
    candidates: Sequence[AbstractFitModel] | None = None,
    *,
    residual: AbstractResidual | None = None,
    polar_limit: float = POLAR_LIMIT,
    progress: Progress | None = None,
) -> Selection:
    """Compare models on samples.

    Args:
        measurements: the samples; linear RGB.
        candidates: the models; :func:`default_candidates` without them. Models whose weights are colors, no car paint.
        residual: as of :func:`axffit.fitting.fit`.
        polar_limit: samples with a larger polar angle (radians) of either direction are left out.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: there are too few samples to hold some back, all are black, or they are not RGB.
    """
    if not isinstance(measurements.channels, RGBChannels):
        raise InputError(f"{measurements.name or 'samples'}: spectral samples: convert them to linear RGB first")
    chosen = np.flatnonzero(within(measurements, polar_limit))
    if len(chosen) > SAMPLES:
        chosen = np.sort(chosen[np.argsort(np.mod(np.arange(len(chosen)) * _GOLDEN, 1.0), kind="stable")[:SAMPLES]])
    used = measurements.select(chosen)
    fold = _folds(used)
    if len(np.unique(fold)) < FOLDS or len(used) < _SCAN_LEAST or not np.any(used.values > 0):
        raise InputError(
            f"{measurements.name or 'samples'}: {len(used)} usable samples do not tell models apart: {_SCAN_LEAST} of "
            f"{FOLDS} different directions, not all black, are the least"
        )
    if residual is None:
        residual = LogCosine() if measurements.sigma is None else NoiseWeighted()
    models = default_candidates() if candidates is None else tuple(candidates)
    found = []
    with jax.enable_x64(new_val=True):
        for number, model in enumerate(models):
            if progress is not None:
                progress(f"{model.name}, {number + 1} of {len(models)}", number / len(models))
            found.append(_candidate(model, residual, used, fold))
    return Selection(tuple(found), residual.name, len(used))


def _folds(used: Measurements) -> np.ndarray:
    """A fold 0 to 4 for each sample (N,); samples of the same directions, either way round, share one."""
    low, high = np.minimum(used.wi, used.wo), np.maximum(used.wi, used.wo)
    keys = np.round(np.concatenate([low, high], axis=1), 6)
    _, group = np.unique(keys, axis=0, return_inverse=True)
    # Neighbors in the sorted order go to different folds, but not in step with any grid.
    return np.floor(np.mod(group.reshape(-1) * _GOLDEN, 1.0) * FOLDS).astype(int)


def _candidate(model: AbstractFitModel, residual: AbstractResidual, used: Measurements, fold: np.ndarray) -> Candidate:
    data = residual.prepare(used)
    problem = make_problem(model, residual, used, data)
    best = minimize(problem, max_steps=100)
    count = sum(np.size(leaf) for leaf in jax.tree.leaves(best.shapes)) + best.weights.size
    n = int(np.count_nonzero(data.root_weight))
    rss = 2.0 * float(best.cost)
    if residual.knows_noise:
        deviance = rss
    else:
        deviance = n * math.log(max(rss / n, 1e-300))
    errors = [_held_out(problem, fold == one) for one in range(FOLDS)]
    return Candidate(
        model,
        count,
        _error(problem, problem, best),
        deviance + 2.0 * count,
        deviance + count * math.log(n),
        float(np.mean(errors)),
        float(np.std(errors, ddof=1) / math.sqrt(FOLDS)),
    )


def _held_out(problem: SeparableProblem, held: np.ndarray) -> float:
    """Root mean square of the residual of the samples ``held`` back from the fit."""
    kept = np.ones(len(problem.wi), bool)
    kept[: len(held)] = ~held
    found = minimize(_weighted(problem, kept), max_steps=100)
    return _error(_weighted(problem, ~kept), problem, found)


def _weighted(problem: SeparableProblem, kept: np.ndarray) -> SeparableProblem:
    """The problem with weight 0 for samples that are not ``kept``: its size, and so its program, stay the same."""
    root_weight = jnp.where(jnp.asarray(kept)[:, None], problem.root_weight, 0.0)
    return SeparableProblem(
        problem.model, problem.residual, problem.wi, problem.wo, problem.target, problem.factor, root_weight
    )


def _error(part: SeparableProblem, whole: SeparableProblem, found: Solution) -> float:
    """Root mean square of the residual over a ``part`` of the samples: the metric, or in units of the noise."""
    square = float(jnp.sum(part.residuals(part.design(found.shapes), found.weights) ** 2))
    if part.residual.knows_noise:
        return math.sqrt(square / int(jnp.count_nonzero(part.root_weight)))
    share = jnp.sum(part.root_weight**2) / jnp.sum(whole.root_weight**2)
    return math.sqrt(square / float(share))
