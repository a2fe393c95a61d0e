"""Uncertainty on request, beyond standard errors: profiles and a bootstrap of the fit that was just made.

A car paint is studied as its lobes on luminance, the first stage: only there no color table takes part.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from axffit.errors import InputError
from axffit.fitting.bootstrap import bootstrap
from axffit.fitting.estimates import Estimates, estimates
from axffit.fitting.lobes import canonical_solution
from axffit.fitting.models import Shapes
from axffit.fitting.parameters import ParameterEstimate
from axffit.fitting.profiles import names_of, profile
from axffit.fitting.separable import SeparableProblem, Weights

Progress = Callable[[str, float], None]


class Study(NamedTuple):
    """What is asked for: names of parameters to profile (``"all"``: each), and the fits of a bootstrap (0: none)."""

    profiles: tuple[str, ...] = ()
    bootstrap: int = 0
    seed: int = 0


def make_study(
    asked: Study,
    problem: SeparableProblem,
    shapes: Shapes,
    weights: Weights,
    found: Estimates,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Fields ``profiles`` and ``bootstrap`` of :class:`axffit.fitting.FitResult`.

    Raises:
        InputError: an unknown parameter, or fewer fits than percentiles need.
    """
    known = names_of(problem.model, shapes, weights)
    wanted = list(known) if asked.profiles == ("all",) else list(asked.profiles)
    unknown = [name for name in wanted if name not in known]
    if unknown:
        raise InputError(f"no profile of {', '.join(map(repr, unknown))}: this model has {', '.join(known)}; or all")
    profiles = []
    for number, name in enumerate(wanted):
        if progress is not None:
            progress(f"profile of {name}", number / len(wanted))
        profiles.append(profile(problem, shapes, weights, found, name))
    result: dict[str, Any] = {"profiles": tuple(profiles)}
    if asked.bootstrap:
        if progress is not None:
            progress("bootstrap", 0.0)
        result["bootstrap"] = bootstrap(problem, shapes, weights, _named, count=asked.bootstrap, seed=asked.seed)
    return result


def _named(problem: SeparableProblem, shapes: Shapes, weights: Weights) -> tuple[ParameterEstimate, ...]:
    return estimates(problem, *canonical_solution(problem.model, shapes, weights)).parameters
