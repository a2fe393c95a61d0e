"""Are the 95 % intervals of a fit 95 % intervals? 4 000 noisy fits of a known truth, a model and a metric.

    python -m experiments.10_calibration

500 samples each, Gaussian noise of 2 % of each value, starts by the scan as in every fit, all lanes in vmapped batches.
A fit that did not converge, or gives a parameter no interval, counts as a miss. Standard errors: Gauss-Newton in the
noise-weighted metric, the leverage-corrected sandwich (HC3) in the log metric.
"""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from rich.progress import track

from axffit.fitting import RESIDUALS, CarPaintModel, SingleLobeModel
from axffit.fitting.batch import lane_of, solve_batch
from axffit.fitting.estimates import estimates
from axffit.fitting.lobes import canonical_solution
from axffit.fitting.models import AbstractFitModel, Shapes
from axffit.fitting.separable import SeparableProblem, Solution, make_problem
from axffit.measured import Measurements, reference_grid
from experiments import common

SETS, SAMPLES, NOISE, SEED = 4000, 500, 0.02, 20261125
LANES, FIRST = 250, 100
METRICS = ("noise", "log")
PARAMETERS_WITHIN, MEAN_WITHIN = (0.92, 0.98), (0.94, 0.96)


class Truth(NamedTuple):
    """A model with its shapes and weights."""

    model: AbstractFitModel
    shapes: Shapes
    weights: jax.Array


def _single(lobe: str) -> Truth:
    shapes = Shapes(jnp.array([0.2]), jnp.array(0.3))
    return Truth(SingleLobeModel(lobe=lobe), shapes, jnp.array([[0.1, 0.2, 0.3], [0.5, 0.4, 0.3]]))


def truths() -> dict[str, Truth]:
    """The cases: one colored lobe over a diffuse term, and the three lobes of a car paint on luminance."""
    s, f0 = np.array([0.012, 0.06, 0.2]), np.array([0.6, 0.3, 0.15])
    weights = np.concatenate([[0.05], np.stack([s * f0, s * (1.0 - f0)], axis=1).ravel()])[:, None]
    paint = Truth(CarPaintModel(lobes=3), Shapes(jnp.array([0.06, 0.17, 0.5])), jnp.asarray(weights))
    return {"ggx": _single("ggx"), "carpaint": paint}


def directions() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """500 pairs of directions spread evenly through a coarse grid, and their weights."""
    grid = reference_grid(10, 5, 14)
    chosen = np.linspace(0, len(grid.wi) - 1, SAMPLES).round().astype(int)
    return grid.wi[chosen], grid.wo[chosen], grid.weights[chosen]


def fitted(truth: Truth, metric: str, sets: int) -> tuple[SeparableProblem, np.ndarray, np.ndarray, Solution]:
    """The problem, the targets and root weights of all sets, and where their fits ended."""
    wi, wo, weights = directions()
    values = np.asarray(truth.model.basis(truth.shapes, jnp.asarray(wi), jnp.asarray(wo)) @ truth.weights)
    draws = np.random.default_rng(SEED).normal(size=(sets, *values.shape))
    residual = RESIDUALS[metric]()

    def data(noisy: np.ndarray) -> Measurements:
        valid = np.ones(len(noisy), bool)
        return Measurements(wi, wo, noisy, valid, weights, NOISE * values, name="synthetic")

    first = data(values)
    problem = make_problem(truth.model, residual, first, residual.prepare(first))
    padding = ((0, len(problem.wi) - len(values)), (0, 0))
    prepared = [residual.prepare(data(values * (1.0 + NOISE * draw))) for draw in draws]
    targets = np.stack([np.pad(one.target, padding) for one in prepared])
    root_weights = np.stack([np.pad(one.root_weight, padding) for one in prepared])
    return problem, targets, root_weights, solve_batch(problem, targets, root_weights, lanes=min(LANES, sets))


def coverage(truth: Truth, metric: str, sets: int = SETS) -> dict[str, Any]:
    """How often each parameter's interval covers its true value."""
    problem, targets, root_weights, found = fitted(truth, metric, sets)
    true = {one.name: one.value for one in estimates(problem, truth.shapes, truth.weights).parameters}
    hits, first, without = (dict.fromkeys(true, 0) for _ in range(3))
    for lane in range(sets):
        solution = jax.tree.map(lambda leaf, lane=lane: jnp.asarray(leaf[lane]), found)
        own = lane_of(problem, jnp.asarray(targets[lane]), jnp.asarray(root_weights[lane]))
        lobes = canonical_solution(truth.model, solution.shapes, solution.weights)
        for one in estimates(own, *lobes).parameters:
            if one.interval is None:
                without[one.name] += 1
            elif solution.converged and one.interval[0] <= true[one.name] <= one.interval[1]:
                hits[one.name] += 1
                first[one.name] += lane < FIRST
    parameters = {
        name: {
            "truth": true[name],
            "coverage": hits[name] / sets,
            "hits_in_first": first[name],
            "without_interval": without[name] / sets,
        }
        for name in true
    }
    return {
        "sets": sets,
        "converged": float(np.mean(found.converged)),
        "parameters": parameters,
        "mean_coverage": float(np.mean([entry["coverage"] for entry in parameters.values()])),
    }


def subset(case: str, metric: str) -> dict[str, Any]:
    """The first 100 fits of a case again: the same draws, so the same hits."""
    with jax.enable_x64(new_val=True):
        return coverage(truths()[case], metric, FIRST)


def outside(cases: dict[str, Any]) -> list[str]:
    """What lies outside of the stated limits."""
    found = []
    for name, case in cases.items():
        found += [
            f"{name}: {parameter} {entry['coverage']:.4f}"
            for parameter, entry in case["parameters"].items()
            if not PARAMETERS_WITHIN[0] <= entry["coverage"] <= PARAMETERS_WITHIN[1]
        ]
        if not MEAN_WITHIN[0] <= case["mean_coverage"] <= MEAN_WITHIN[1]:
            found.append(f"{name}: mean {case['mean_coverage']:.4f}")
    return found


def text(data: dict[str, Any]) -> str:
    """report.md."""
    rows = []
    for name, case in data["cases"].items():
        values = {parameter: entry["coverage"] for parameter, entry in case["parameters"].items()}
        low, high = min(values, key=values.__getitem__), max(values, key=values.__getitem__)
        rows.append(
            [
                name,
                f"{100 * case['converged']:.2f} %",
                f"{100 * case['mean_coverage']:.2f} %",
                f"{100 * values[low]:.2f} % ({low})",
                f"{100 * values[high]:.2f} % ({high})",
            ]
        )
    spread = 100 * 1.96 * math.sqrt(0.95 * 0.05 / data["sets"])
    verdict = (
        "Every parameter is covered 92 to 98 % of the time and every mean lies within 94 to 96 %."
        if not data["outside"]
        else "Outside of 92 to 98 % (a parameter) or 94 to 96 % (a mean): " + "; ".join(data["outside"]) + "."
    )
    head = ("case", "converged", "mean", "least", "most")
    return f"""# Are the 95 % intervals 95 % intervals?

`python -m experiments.10_calibration`: {data["sets"]} noisy fits a case, {data["samples"]} samples each, noise
{100 * data["noise"]:g} % of each value, starts by the scan. A fit that did not converge, or a parameter without an
interval, counts as a miss. With {data["sets"]} fits a true coverage of 95 % is seen within ±{spread:.2f} % 19 times of
20.

{common.table(head, rows)}

![coverage](coverage.png)

{verdict}

The noise-weighted metric uses the Gauss-Newton covariance at the stated noise, the log metric the leverage-corrected
sandwich (HC3). The truths lie away from bounds; near one, intervals are withheld ("at bound"), not stretched. The noise
is independent from sample to sample: systematic errors of an instrument are in no interval.
"""


def picture(cases: dict[str, Any], path: str) -> None:
    """Coverage of every parameter, a row a case."""
    figure, axes = plt.subplots(figsize=(7.2, 0.42 * len(cases) + 1.1), layout="constrained")
    axes.axvspan(*(100 * limit for limit in PARAMETERS_WITHIN), color="#e8eef7", label="92 to 98 %")
    axes.axvline(95, color="#8899aa", lw=1)
    for row, case in enumerate(cases.values()):
        values = [100 * entry["coverage"] for entry in case["parameters"].values()]
        axes.plot(
            values, [row] * len(values), "o", ms=4, alpha=0.6, color="#1f5fa8", label="" if row else "a parameter"
        )
        axes.plot(
            100 * case["mean_coverage"], row, "|", ms=16, mew=2, color="#c2410c", label="" if row else "their mean"
        )
    axes.set_yticks(range(len(cases)), list(cases))
    axes.invert_yaxis()
    axes.set_xlim(90, 100)
    axes.set_xlabel("coverage of the 95 % interval (%)")
    axes.legend(loc="lower right", fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main() -> None:
    """Run every case and write the report."""
    matplotlib.use("Agg")
    with jax.enable_x64(new_val=True):
        jobs = [(f"{name}, {metric}", truth, metric) for name, truth in truths().items() for metric in METRICS]
        cases = {name: coverage(truth, metric) for name, truth, metric in track(jobs)}
    data = {"sets": SETS, "samples": SAMPLES, "noise": NOISE, "seed": SEED, "cases": cases, "outside": outside(cases)}
    picture(cases, str(common.folder(__file__) / "coverage.png"))
    common.write(__file__, data, text(data))


if __name__ == "__main__":
    main()
