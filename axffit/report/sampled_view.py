"""A fit's or comparison's JSON as the words and numbers that its section shows."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from axffit.report.numbers import MISSING, aligned, count, number, percent, significant, with_uncertainty

METRICS = (
    ("relative_cosine_rms", "Relative cosine RMS", "of f cos θᵢ, over all samples"),
    ("log", "Log", "RMS of log(1 + f cos θᵢ)"),
    ("cube_root", "Cube root", "RMS of ∛(f cos θᵢ)"),
    ("peak", "Peak", "relative cosine RMS of the brightest 1\u00a0%"),
)
RATIOS = {"relative_cosine_rms", "peak"}
"""Metrics that are shown as percentages."""

STATUSES = {
    "identified": ("good", "identified", "the samples determine it"),
    "conditional": ("plain", "conditional", "holds for the given color table, or for another parameter at its bound"),
    "at bound": ("warn", "at bound", "ends at the edge of its range, so an interval would mean nothing"),
    "not identified": ("warn", "not identified", "the samples do not determine it, so it has no interval"),
}

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SYMBOLS = {
    "diffuse": "diffuse a",
    "coefficient": "coefficient s{}",
    "f0": "F0{}",
    "spread": "spread α{}",
    "roughness": "roughness α",
    "coefficient x f0": "s{} · F0{}",
    "specular": "specular s",
    "specular x f0": "s · F0",
}


def fit_view(content: Mapping[str, Any]) -> dict[str, Any]:
    """Rows and sentences of a section of kind "fit"."""
    result = content["result"]
    stages = [stage for stage in result["stages"] if stage["parameters"]]
    return {
        **_shared(content),
        "kicker": f"Fit of {result['model']}",
        "badge": {"tone": "good" if result["ok"] else "bad", "text": "converged" if result["ok"] else "not converged"},
        "sentence": _sentence(result),
        "limits": [_limit(limit) for limit in result["limits"]],
        "regions": [],
        "channels": "",
        "parameters": [_parameter(p) for p in result["parameters"]],
        "stage": None if len(stages) < 2 else _stage(stages[0]),
        "error_kind": result["error_kind"],
        "table": result["color_table"],
        "notes": result["notes"],
        "advice": result["advice"],
        "modeled": "Fitted",
    }


def compare_view(content: Mapping[str, Any]) -> dict[str, Any]:
    """Rows and sentences of a section of kind "compare"."""
    return {
        **_shared(content),
        "kicker": "Compared with samples, nothing fitted",
        "badge": None,
        "sentence": content["result"]["sentence"],
        "limits": [_limit(limit) for limit in content["result"]["limits"]],
        "regions": [_region(region) for region in content["result"]["regions"]],
        "channels": _channels(content["result"]["channel_bias"]),
        "parameters": [],
        "stage": None,
        "error_kind": "",
        "table": None,
        "notes": [],
        "advice": "",
        "modeled": "Material",
    }


def _shared(content: Mapping[str, Any]) -> dict[str, Any]:
    samples, metrics = content["samples"], content["result"]["metrics"]
    return {
        "metrics": [] if metrics is None else [_metric(name, metrics[name], *words) for name, *words in METRICS],
        "count": "" if metrics is None else _counts(metrics, samples),
        "lobes": content["incidence_plane"] is not None,
        "spheres": content["spheres"],
        "failure": content["failure_map"] is not None,
        "worst": _worst(content["failure_map"]),
        "coated": content["coated"],
        "provenance": list(samples["provenance"].items()),
    }


def _metric(name: str, value: float | None, label: str, what: str) -> dict[str, str]:
    return {"label": label, "what": what, "value": percent(value) if name in RATIOS else significant(value)}


def _counts(metrics: Mapping[str, Any], samples: Mapping[str, Any]) -> str:
    text = f"{count(metrics['sample_count'])} of {count(samples['count'])} samples, "
    text += f"both polar angles at most {number(samples['polar_limit_degrees'])}°"
    negatives = metrics["clipped_negatives"]
    return text + (f"; {count(negatives)} negative values counted as 0" if negatives else "")


def _sentence(result: Mapping[str, Any]) -> str:
    if result["metrics"] is None:
        return f"No fit: {result['advice']}."
    determined = [p for p in result["parameters"] if p["status"] in ("identified", "conditional")]
    ending = "Converged" if result["ok"] else "Not converged"
    total = len(result["parameters"])
    return (
        f"{ending}; minimized: {result['residual']}. {len(determined)} of {total} parameters have a standard error, "
        f"{total - len(determined)} cannot have one: the table says why."
        if len(determined) < total
        else f"{ending}; minimized: {result['residual']}. All {total} parameters have a standard error."
    )


def _parameter(parameter: Mapping[str, Any]) -> dict[str, Any]:
    tone, status, why = STATUSES[parameter["status"]]
    error, low, high = parameter["standard_error"], parameter["low"], parameter["high"]
    value = parameter["value"]
    interval = MISSING
    if error is not None:
        ends = (max(value - 1.96 * error, low), value + 1.96 * error)
        ends = (ends[0], ends[1] if high is None else min(ends[1], high))
        interval = aligned([float(x) for x in ends], error).replace(";", " …")
    return {
        "name": symbol(parameter["name"]),
        "value": with_uncertainty(value, error),
        "interval": interval,
        "range": f"{number(low)} … {'∞' if high is None else number(high)}",
        "tone": tone,
        "status": status,
        "why": why,
    }


def symbol(name: str) -> str:
    """A parameter's name as people write it: "coefficient x f0 2" -> "s₂ · F0₂", "diffuse R" -> "diffuse a, red"."""
    match = re.fullmatch(r"(.*?)(?: (\d+|[RGB]))?", name)
    assert match is not None
    base, suffix = match[1], match[2] or ""
    if base not in _SYMBOLS:
        return name
    if suffix in ("R", "G", "B"):
        return _SYMBOLS[base].replace("{}", "") + ", " + {"R": "red", "G": "green", "B": "blue"}[suffix]
    return _SYMBOLS[base].replace("{}", suffix.translate(_SUBSCRIPTS))


def _stage(stage: Mapping[str, Any]) -> dict[str, Any]:
    return {"name": stage["name"], "parameters": [_parameter(p) for p in stage["parameters"]]}


def _limit(limit: Mapping[str, Any]) -> dict[str, Any]:
    """The best that a class of models can do in each metric, and the model as a multiple of it."""
    cells = []
    for name, label, _ in METRICS[:3]:
        value = percent(limit[name]) if name in RATIOS else significant(limit[name])
        cells.append((label, value, _ratio((limit.get("ratio") or {}).get(name))))
    return {"kind": limit["kind"], "cells": cells}


def _region(region: Mapping[str, Any]) -> dict[str, Any]:
    """One row of the table of where a model fails."""
    half, polar = region["theta_h_degrees"], region["polar_degrees"]
    return {
        "name": region["name"],
        "half": f"{number(half[0])}° to {number(half[1])}°",
        "polar": f"{number(polar[0])}° to {number(polar[1])}°",
        "bias": _bias(region["bias"]),
        "share": percent(region["share"], 2),
        "log_share": percent(region["log_share"], 2),
        "cosine_share": percent(region["cosine_share"], 2),
    }


def _bias(bias: float | None) -> str:
    return MISSING if bias is None else ("+" if bias > 0 else "") + percent(bias, 2)


def _channels(bias: Sequence[float | None]) -> str:
    """The mean error of each channel of RGB, in words."""
    names = ("red", "green", "blue") if len(bias) == 3 else tuple(str(k) for k in range(len(bias)))
    return "Model over samples, all light together: " + ", ".join(
        f"{name} {_bias(x)}" for name, x in zip(names, bias, strict=True)
    )


def _ratio(value: float | None) -> str:
    return MISSING if value is None else f"{significant(value)}\u00a0×"


def _worst(cells: Mapping[str, Any] | None) -> str:
    """Where the model is furthest off, in words."""
    if cells is None:
        return ""
    rows: Sequence[Sequence[float | None]] = cells["log2_ratio"]
    found = [(abs(x), x, i, j) for i, row in enumerate(rows) for j, x in enumerate(row) if x is not None]
    if not found:
        return ""
    _, ratio, row, column = max(found)
    half, difference = cells["half_edges_degrees"], cells["difference_edges_degrees"]
    factor = 2.0 ** abs(ratio)
    amount = f"{significant(factor, 2)} times" if factor >= 1.5 else percent(abs(2.0**ratio - 1.0), 2)
    return (
        f"Worst at half angles {number(half[column], 2)}° to {number(half[column + 1], 2)}°, difference angles "
        f"{number(difference[row], 2)}° to {number(difference[row + 1], 2)}°: "
        f"{amount} too {'bright' if ratio > 0 else 'dark'} on average."
    )
