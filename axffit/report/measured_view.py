"""A description of samples as a section of a page: its numbers, plots and words."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from axffit.frames import directions_to_half_difference
from axffit.measured import Measurements
from axffit.measured.description import describe
from axffit.report import plots
from axffit.report.curves import luminance
from axffit.report.numbers import MISSING, count, number, percent, significant
from axffit.report.sections import SPHERE_SIZE, Section

SHOWN_SAMPLES = 1500
"""Samples in the plot of values over the half angle, evenly picked."""


@dataclass(frozen=True, eq=False)
class DescribedSamples:
    """Samples, for a section that describes them without fitting anything."""

    measurements: Measurements

    def section(self, *, sphere_size: int = SPHERE_SIZE) -> Section:
        """Content and pictures; there is no sphere to size."""
        del sphere_size
        result = describe(self.measurements)
        title = self.measurements.name or "samples"
        points = _points(self.measurements)
        shown = {"plot coverage": plots.coverage_heat_map(result["coverage"], label=f"{title}: samples by angle")}
        if result["furnace"]:
            shown["plot furnace"] = plots.furnace_curve(result["furnace"], label=f"{title}: albedo per incidence")
        if any(x > 0 for x in points["value"]):
            shown["plot values"] = plots.value_scatter(points, label=f"{title}: values over the half angle")
        return Section({"kind": "measured", "title": title, "result": result, "points": points}, shown)


def _points(measurements: Measurements) -> dict[str, list[float]]:
    """Half and difference angle (degrees) and luminance or channel mean of f for some of the valid samples."""
    valid = np.flatnonzero(measurements.valid)
    chosen = valid[np.unique(np.linspace(0, len(valid) - 1, SHOWN_SAMPLES).astype(int))] if len(valid) else valid
    with jax.enable_x64(new_val=True):
        wi, wo = (jnp.asarray(v[chosen]) for v in (measurements.wi, measurements.wo))
        theta_h, theta_d, _, _ = directions_to_half_difference(wi, wo)
        angles = np.degrees(np.asarray(theta_h)), np.degrees(np.asarray(theta_d))
    values = measurements.values[chosen]
    value = luminance(values) if values.shape[1] == 3 else values.mean(axis=1)
    named = zip(("half_degrees", "difference_degrees", "value"), (*angles, value), strict=True)
    return {name: [float(f"{x:.5g}") for x in array] for name, array in named}


def measured_view(content: Mapping[str, Any]) -> dict[str, Any]:
    """Rows and sentences of a section of kind "measured"."""
    result = content["result"]
    values, reciprocity = result["values"], result["reciprocity"]
    return {
        "kicker": "Samples, nothing fitted",
        "badge": None,
        "sentence": sentence(result),
        "rows": facts(result),
        "furnace": [
            (_degrees(row["incidence_degrees"]), count(row["samples"]), ", ".join(map(significant, row["albedo"])))
            for row in result["furnace"]
        ]
        if len(values["mean"] or []) <= 3
        else [],
        "reciprocal": reciprocity["pairs"] > 0,
        "provenance": list(result["provenance"].items()),
    }


def _degrees(pair: list[float]) -> str:
    return f"{number(pair[0])}°" if pair[0] == pair[1] else f"{number(pair[0])}° to {number(pair[1])}°"


def channels_text(channels: Mapping[str, Any]) -> str:
    """What the channels are, in words."""
    if channels["kind"] == "rgb":
        return f"RGB, {channels['primaries']} primaries, white {channels['white']}"
    found = channels["nanometers"]
    if len(found) <= 4:
        return ", ".join(f"{x:g}" for x in found) + " nm"
    return f"{len(found)} wavelengths, {found[0]:g} to {found[-1]:g} nm"


def facts(result: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What a description says, a topic and words each."""
    values, reciprocity = result["values"], result["reciprocity"]
    rows = [
        ("samples", f"{count(result['samples'])}, {count(result['valid'])} of them valid"),
        ("channels", channels_text(result["channels"])),
    ]
    for name, angles in result["angles"].items():
        if angles["distinct"]:
            least, largest = (number(angles[f"{end}_degrees"]) for end in ("least", "largest"))
            rows.append((f"{name}'s polar angle", f"{least}° to {largest}°, {count(angles['distinct'])} distinct"))
    rows.append(("anisotropy", "not measured" if result["isotropic"] else "measured: both directions turn"))
    if values["mean"] is not None:
        rows.append(("f", f"{significant(min(values['least']))} to {significant(max(values['largest']))} 1/sr"))
    rows.append(("negative values", f"{count(values['negative'])} ({percent(values['negative_share'], 2)})"))
    rows.append(
        ("coverage", f"{percent(result['coverage']['filled_share'], 2)} of the cells of half and difference angle")
    )
    if reciprocity["violation"] is None:
        rows.append(("reciprocity", "not judged: no two samples have swapped directions"))
    else:
        amount = (
            f"{percent(reciprocity['violation'], 2)} RMS, {count(reciprocity['pairs'])} pairs of swapped directions"
        )
        rows.append(("reciprocity violated by", f"{amount}; at most {significant(reciprocity['largest'])} 1/sr"))
    rows.append(("white furnace", _furnace(result["furnace"])))
    rows.append(("noise", "stated" if values["noise_known"] else "not stated"))
    return rows


def _furnace(rows: list[dict[str, Any]]) -> str:
    if not rows:
        return "not judged: too few directions of the viewer at any incidence"
    largest = max(rows, key=lambda row: max(row["albedo"]))
    return (
        f"albedo up to {significant(max(largest['albedo']))}, at {_degrees(largest['incidence_degrees'])}"
        f"{'; more light than falls in' if max(largest['albedo']) > 1 else ''}"
    )


def sentence(result: Mapping[str, Any]) -> str:
    """What a reader must know of the samples."""
    if not result["valid"]:
        return "None of the samples is valid: there is nothing to fit."
    filled = percent(result["coverage"]["filled_share"], 2)
    violation = result["reciprocity"]["violation"]
    swapped = MISSING if violation is None else percent(violation, 2)
    text = f"{count(result['valid'])} valid samples in {filled} of the cells of half and difference angle; "
    text += f"{percent(result['values']['negative_share'], 2)} of the values are negative"
    return text + (f", reciprocity is violated by {swapped} RMS." if violation is not None else ".")
