"""What a fit returns: the model, how sure its parameters are, how well it does, and how it ended."""

import enum
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np

import axffit
from axffit.brdf import AbstractBRDF
from axffit.fitting.bootstrap import Bootstrap
from axffit.fitting.limits import Limit
from axffit.fitting.metrics import Metrics
from axffit.fitting.parameters import ParameterEstimate
from axffit.fitting.profiles import Profile

SCHEMA_VERSION = 1


class Outcome(enum.Enum):
    """How a fit ended; the value is what to do about it."""

    CONVERGED = "converged: no further step lowers the error noticeably"
    STEP_LIMIT = (
        "stopped at the step limit while the error still fell: the model is usable; allow more steps to be sure of it"
    )
    NOT_FINITE = "the solver met numbers that are not finite: look for samples many orders of magnitude off the others"
    NO_SAMPLES = (
        "no valid sample within the polar limit: check for NaN and for directions below the horizon, or raise the limit"
    )
    ALL_BLACK = "all samples are 0 or negative: a black material has no parameters to find; check channels and scale"
    ONE_DIRECTION = "all samples share one pair of directions: measure at more angles; one value determines no lobe"
    TOO_FEW_DIRECTIONS = "fewer different directions than parameters: measure at more angles or choose a smaller model"

    @property
    def ok(self) -> bool:
        """Whether the fit converged."""
        return self is Outcome.CONVERGED


@dataclass(frozen=True)
class Stage:
    """One stage of a fit in several: its model's metrics and parameters when it ended."""

    name: str
    metrics: Metrics
    parameters: tuple[ParameterEstimate, ...]
    cost: float
    steps: int
    converged: bool

    def to_json(self) -> dict[str, Any]:
        """The fields by name."""
        return {
            "name": self.name,
            "metrics": self.metrics.to_json(),
            "parameters": [parameter.to_json() for parameter in self.parameters],
            "cost": self.cost,
            "steps": self.steps,
            "converged": self.converged,
        }


@dataclass(frozen=True, eq=False)
class FitResult:
    """The answer of :func:`axffit.fitting.fit`.

    Attributes:
        model: the fitted BRDF, or None where the data allow none (``outcome`` says why).
        model_name: as on the command line.
        outcome: how the fit ended.
        parameters: of ``model``, lobes in the order of their spreads, lobes without weight last.
        correlations: (P, P) of the estimates of ``parameters``, NaN where one of a pair has no standard error; or None.
        profiles: of the parameters that were asked for; of a car paint for the lobes of its first stage.
        bootstrap: on request, of the same; or None.
        metrics: of ``model`` on the samples, or None.
        limits: the best that whole classes of models can do on these samples.
        stages: of a fit in several; the first one's parameters hold for lobes without a free color table.
        residual: name of what was minimized.
        error_kind: how the standard errors were found.
        measured_texels: (H, W) bool, which texels of the color table the samples touch (others are 0), or None.
        samples: name, count, polar limit and provenance of the samples.
        notes: what a reader should know besides.
    """

    model: AbstractBRDF | None
    model_name: str
    outcome: Outcome
    parameters: tuple[ParameterEstimate, ...] = ()
    correlations: np.ndarray | None = None
    profiles: tuple[Profile, ...] = ()
    bootstrap: Bootstrap | None = None
    metrics: Metrics | None = None
    limits: tuple[Limit, ...] = ()
    stages: tuple[Stage, ...] = ()
    residual: str = ""
    error_kind: str = ""
    measured_texels: np.ndarray | None = None
    samples: Mapping[str, Any] | None = None
    notes: tuple[str, ...] = ()

    def parameter(self, name: str) -> ParameterEstimate:
        """The parameter of that name.

        Raises:
            KeyError: there is none; the message lists the names.
        """
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(f"no parameter {name!r}; there are {', '.join(p.name for p in self.parameters)}")

    def to_json(self) -> dict[str, Any]:
        """Everything but the model itself; validates against :func:`schema`."""
        return {
            "schema": "axffit.fit",
            "schema_version": SCHEMA_VERSION,
            "axffit_version": axffit.__version__,
            "model": self.model_name,
            "outcome": self.outcome.name,
            "advice": self.outcome.value,
            "ok": self.outcome.ok,
            "residual": self.residual,
            "error_kind": self.error_kind,
            "samples": dict(self.samples or {}),
            "metrics": None if self.metrics is None else self.metrics.to_json(),
            "limits": [_limit_json(limit, self.metrics) for limit in self.limits],
            "parameters": [parameter.to_json() for parameter in self.parameters],
            "correlations": None if self.correlations is None else _correlations_json(self.correlations),
            "profiles": [profile.to_json() for profile in self.profiles],
            "bootstrap": None if self.bootstrap is None else self.bootstrap.to_json(),
            "stages": [stage.to_json() for stage in self.stages],
            "color_table": None if self.measured_texels is None else _table_json(self.measured_texels),
            "notes": list(self.notes),
        }


def _limit_json(limit: Limit, metrics: Metrics | None) -> dict[str, Any]:
    """The limit, and the metrics as multiples of it."""
    return limit.to_json() | {"ratio": None if metrics is None else limit.ratios(metrics)}


def _correlations_json(correlations: np.ndarray) -> list[list[float | None]]:
    return [[None if math.isnan(value) else value for value in row] for row in correlations.tolist()]


def _table_json(measured: np.ndarray) -> dict[str, int]:
    return {"height": measured.shape[0], "width": measured.shape[1], "measured_texels": int(measured.sum())}


def schema() -> dict[str, Any]:
    """The JSON schema of :meth:`FitResult.to_json`."""
    return json.loads(resources.files("axffit.fitting").joinpath("schemas/fit.schema.json").read_text(encoding="utf-8"))
