"""What do 6, 12 and 19 multi-angle measurements determine of a paint?

    python -m experiments.07_how_few_angles

The synthetic paints' bases (without their coat, which an instrument's geometries avoid) are measured at the geometries
of portable instruments with 1 % noise, and fitted with one, two and three lobes, one color everywhere. Counted are the
parameters that come out with an interval, and how narrow; and how well the fit predicts the directions that were not
measured.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from rich.progress import track

from axffit import axf
from axffit.axf import AxfMaterial, MaterialKind
from axffit.axf.appearance import car_paint_base
from axffit.fitting import CarPaintModel, NoiseWeighted, evaluate_samples, fit, metrics_of
from axffit.measured import Measurements, reference_grid
from axffit.measured.multiangle import directions
from experiments import common

SIX = ("45as-15", "45as15", "45as25", "45as45", "45as75", "45as110")
TWELVE = (*SIX, "15as-45", "15as-15", "15as15", "15as45", "15as80", "65as20")
NINETEEN = (*TWELVE, "45as15az90", "45as25az90", "45as45az90", "45as25az-90", "15as40az45", "65as10", "65as60")
SETS = {"6 angles": SIX, "12 angles": TWELVE, "19 angles": NINETEEN}
"""In the manner of the MA-T6 and BYK-mac i, the MA-T12 and the MA98; not one maker's exact list."""

LOBES = (1, 2, 3)
NOISE, SEED = 0.01, 7
NARROW = 0.2
"""A parameter counts as known where its standard error is at most this part of its value."""


def paints() -> list[AxfMaterial]:
    """The synthetic car paints."""
    files = sorted((common.ROOT / "data_synthetic").rglob("*.axf"))
    materials = [material for file in files for material in axf.read(file).materials]
    return [material for material in materials if material.kind is MaterialKind.CAR_PAINT]


def samples(paint: AxfMaterial, wi: np.ndarray, wo: np.ndarray, weights: np.ndarray, noise: float) -> Measurements:
    """The paint's base in these directions, with noise of a share of each value."""
    values = np.asarray(car_paint_base(paint).evaluate(jnp.asarray(wi), jnp.asarray(wo)), np.float64)
    sigma = None if noise == 0 else noise * values + 1e-9
    if sigma is not None:
        values = values + sigma * np.random.default_rng(SEED).normal(size=values.shape)
    return Measurements(wi, wo, values, np.ones(len(wi), bool), weights, sigma, name=paint.name)


def measure(paint: AxfMaterial, geometries: tuple[str, ...], lobes: int) -> dict[str, Any]:
    """One fit: how it ended, what it determines, and its errors in the measured and in all directions."""
    wi, wo = directions(geometries)
    data = samples(paint, wi, wo, np.ones(len(wi)), NOISE)
    result = fit(CarPaintModel(lobes=lobes), data, residual=NoiseWeighted(), color_table=0)
    content: dict[str, Any] = {"outcome": result.outcome.name}
    if result.model is None or result.metrics is None:
        return content
    grid = reference_grid(30, 15, 12)
    everywhere = samples(paint, grid.wi, grid.wo, grid.weights, 0.0)
    metrics = metrics_of(everywhere, evaluate_samples(result.model, everywhere))
    own = [one for one in result.parameters if " x " not in one.name]
    return content | {
        "parameters": len(own),
        "with_interval": sum(one.standard_error is not None for one in own),
        "known": sum(one.standard_error is not None and one.standard_error <= NARROW * one.value for one in own),
        "not_identified": [one.name for one in own if one.standard_error is None],
        "log_measured": result.metrics.log,
        "log_everywhere": metrics.log,
        "cosine_rms_everywhere": metrics.relative_cosine_rms,
    }


def subset() -> dict[str, Any]:
    """The first paint at 6 and at 19 angles with one lobe."""
    with jax.enable_x64(new_val=True):
        paint = paints()[0]
        return {name: measure(paint, SETS[name], 1) for name in ("6 angles", "19 angles")}


def text(data: dict[str, Any]) -> str:
    """report.md."""
    rows, answers = [], []
    for name in SETS:
        for lobes in LOBES:
            cases = [paint[name][str(lobes)] for paint in data["paints"].values()]
            fitted = [case for case in cases if "known" in case]
            if not fitted:
                rows.append([name, lobes, f"0 of {len(cases)}", "-", "-", "-", "-"])
                continue
            rows.append(
                [
                    name,
                    lobes,
                    f"{len(fitted)} of {len(cases)}",
                    f"{np.mean([case['known'] for case in fitted]):.1f} of {fitted[0]['parameters']}",
                    f"{np.mean([len(case['not_identified']) for case in fitted]):.1f}",
                    float(np.median([case["log_everywhere"] for case in fitted])),
                    float(np.median([case["cosine_rms_everywhere"] for case in fitted])),
                ]
            )
        errors = {
            lobes: [paint[name][str(lobes)].get("log_everywhere") for paint in data["paints"].values()]
            for lobes in LOBES
        }
        usable = {lobes: float(np.median(values)) for lobes, values in errors.items() if None not in values}
        if usable:
            least = min(usable, key=usable.__getitem__)
            answers.append(
                f"With {name}, of the numbers of lobes that every paint could be fitted with, {least} did best "
                f"elsewhere (median log error {usable[least]:.3g})."
            )
        else:
            answers.append(f"With {name} no number of lobes could be fitted to every paint.")
    outcomes = sorted(
        {case["outcome"] for paint in data["paints"].values() for sets in paint.values() for case in sets.values()
         if "known" not in case}
    )  # fmt: skip
    head = ("measured", "lobes", "fits", f"known to {NARROW:.0%}", "not identified", "log error", "cosine RMS")
    return f"""# What do few angles determine of a paint?

`python -m experiments.07_how_few_angles`: the bases of {len(data["paints"])} synthetic paints (three lobes and a color
table) measured at 6, 12 and 19 geometries with {data["noise"]:.0%} noise, fitted with one to three lobes of one color.
Means over the paints; errors (medians) on all directions, not only the measured ones.

{common.table(head, rows)}

{" ".join(answers)} Fits that are missing ended in a named outcome ({", ".join(outcomes)}). Medians over few fits
compare other paints than those over all. A parameter without an interval is at a bound or not identified; its value is
a number, not a finding.
Errors here include what one color everywhere cannot follow: the paints' color tables vary with both angles.
"""


def main() -> None:
    """Every paint, set of angles and number of lobes."""
    with jax.enable_x64(new_val=True):
        found = {
            paint.id: {
                name: {str(lobes): measure(paint, geometries, lobes) for lobes in LOBES}
                for name, geometries in SETS.items()
            }
            for paint in track(paints())
        }
    data = {"noise": NOISE, "seed": SEED, "sets": SETS, "paints": found}
    common.write(__file__, data, text(data))


if __name__ == "__main__":
    main()
