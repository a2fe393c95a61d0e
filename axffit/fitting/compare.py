"""How well a given BRDF explains samples, without fitting: the metrics overall and by region, and where it fails.

Regions are cells of theta_h (how far from the mirror direction: 0 is the highlight) times the larger polar angle of the
two directions (how grazing). In each the model's bias and the share of the squared errors show where and in which way
it fails.
"""

import json
import math
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np

import axffit
from axffit.errors import InputError
from axffit.fitting.limits import Limit, half_difference_limit, reciprocal_limit
from axffit.fitting.metrics import POLAR_LIMIT, Metrics, evaluate_samples, metrics_of, within
from axffit.hemisphere import Reflector
from axffit.measured import Measurements, RGBChannels

SCHEMA_VERSION = 1
_ROUNDING = 1e-12
THETA_H_EDGES = (0.0, 2.0, 5.0, 15.0, 30.0, 60.0, 90.0)
POLAR_EDGES = (0.0, 30.0, 60.0, 90.0)
_NAMES = (
    "peak of the highlight",
    "highlight",
    "near the highlight",
    "off the highlight",
    "far off",
    "retro and grazing",
)


@dataclass(frozen=True)
class Region:
    """Metrics of the samples with theta_h and the larger polar angle within ranges (degrees).

    ``bias``: mean of the model's f cos over the data's, minus 1; None where the data are 0. ``share`` of the weight
    (solid angle); ``log_share``, ``cosine_share``: of the squared log and cosine errors of all samples.
    """

    name: str
    theta_h: tuple[float, float]
    polar: tuple[float, float]
    metrics: Metrics
    bias: float | None
    share: float
    log_share: float
    cosine_share: float

    def to_json(self) -> dict[str, Any]:
        """The fields by name."""
        return {
            "name": self.name,
            "theta_h_degrees": list(self.theta_h),
            "polar_degrees": list(self.polar),
            "metrics": self.metrics.to_json(),
            "bias": self.bias,
            "share": self.share,
            "log_share": self.log_share,
            "cosine_share": self.cosine_share,
        }


@dataclass(frozen=True)
class Comparison:
    """The answer of :func:`compare`."""

    name: str
    metrics: Metrics
    limits: tuple[Limit, ...]
    regions: tuple[Region, ...]
    channel_bias: tuple[float | None, ...]
    sentence: str
    polar_limit: float

    def to_json(self) -> dict[str, Any]:
        """Everything; validates against :func:`schema`."""
        return {
            "schema": "axffit.comparison",
            "schema_version": SCHEMA_VERSION,
            "axffit_version": axffit.__version__,
            "samples": self.name,
            "polar_limit_degrees": math.degrees(self.polar_limit),
            "metrics": self.metrics.to_json(),
            "limits": [limit.to_json() | {"ratio": limit.ratios(self.metrics)} for limit in self.limits],
            "regions": [region.to_json() for region in self.regions],
            "channel_bias": list(self.channel_bias),
            "sentence": self.sentence,
        }


def compare(brdf: Reflector, measurements: Measurements, *, polar_limit: float = POLAR_LIMIT) -> Comparison:
    """Judge ``brdf`` by samples.

    Args:
        brdf: one BRDF; its value per direction pair is (3,), linear RGB.
        measurements: the samples; linear RGB.
        polar_limit: samples with a larger polar angle (radians) of either direction are left out.

    Raises:
        InputError: the samples are not RGB, or none is valid within the limit.
    """
    if not isinstance(measurements.channels, RGBChannels):
        raise InputError(f"{measurements.name or 'samples'}: spectral samples: convert them to linear RGB first")
    chosen = within(measurements, polar_limit)
    if not chosen.any():
        raise InputError(
            f"{measurements.name or 'samples'}: no valid sample with both polar angles below "
            f"{math.degrees(polar_limit):g} degrees; check for NaN and for directions below the horizon"
        )
    used = measurements.select(chosen)
    values = np.maximum(evaluate_samples(brdf, used), 0.0)
    metrics = metrics_of(used, values, polar_limit=math.pi / 2)
    regions = _regions(used, values)
    limits = (limit(used, polar_limit=math.pi / 2) for limit in (reciprocal_limit, half_difference_limit))
    found = tuple(limit for limit in limits if limit is not None)
    cosine = (used.weights * used.wi[:, 2])[:, None]
    totals = zip(np.sum(cosine * values, axis=0), np.sum(cosine * np.maximum(used.values, 0.0), axis=0), strict=True)
    channel_bias = tuple(float(model / data - 1.0) if data > 0 else None for model, data in totals)
    return Comparison(
        measurements.name, metrics, found, regions, channel_bias, _sentence(metrics, found, regions), polar_limit
    )


def _regions(used: Measurements, values: np.ndarray) -> tuple[Region, ...]:
    half = used.wi + used.wo
    theta_h = np.degrees(np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2]))
    polar = np.degrees(np.arccos(np.minimum(used.wi[:, 2], used.wo[:, 2])))
    cosine = used.wi[:, 2][:, None]
    fc, gc = np.maximum(used.values, 0.0) * cosine, values * cosine
    log_square = used.weights * np.sum((np.log1p(fc) - np.log1p(gc)) ** 2, axis=1)
    cosine_square = used.weights * np.sum((fc - gc) ** 2, axis=1)
    found = []
    for row, (h_low, h_high) in enumerate(zip(THETA_H_EDGES[:-1], THETA_H_EDGES[1:], strict=True)):
        for p_low, p_high in zip(POLAR_EDGES[:-1], POLAR_EDGES[1:], strict=True):
            inside = (theta_h >= h_low) & (theta_h < h_high) & (polar >= p_low) & (polar < p_high)
            if not np.any(used.weights[inside] > 0):
                continue
            data, model = (np.sum(used.weights[inside][:, None] * x[inside]) for x in (fc, gc))
            found.append(
                Region(
                    name=_NAMES[row],
                    theta_h=(h_low, h_high),
                    polar=(p_low, p_high),
                    metrics=metrics_of(used.select(inside), values[inside], polar_limit=math.pi / 2),
                    bias=float(model / data - 1.0) if data > 0 else None,
                    share=float(np.sum(used.weights[inside])),
                    log_share=_share(log_square, inside),
                    cosine_share=_share(cosine_square, inside),
                )
            )
    return tuple(found)


def _share(square: np.ndarray, inside: np.ndarray) -> float:
    total = float(square.sum())
    return float(square[inside].sum()) / total if total > 0 else 0.0


def _sentence(metrics: Metrics, limits: tuple[Limit, ...], regions: tuple[Region, ...]) -> str:
    """Where the model fails and in which way, in plain words."""
    worst = max(regions, key=lambda region: region.log_share)
    if metrics.log < _ROUNDING:
        return "The model reproduces every sample to rounding."
    text = (
        f"{worst.log_share:.0%} of the squared log error comes from {worst.share:.1%} of the solid angle: {worst.name} "
        f"(theta_h {worst.theta_h[0]:g} to {worst.theta_h[1]:g} degrees, the more grazing direction at "
        f"{worst.polar[0]:g} to {worst.polar[1]:g})"
    )
    if worst.bias is not None:
        way = "too bright" if worst.bias > 0 else "too dark"
        text += f", where the model is on average {abs(worst.bias):.0%} {way}."
    else:
        text += ", where the samples are black and the model is not."
    usable = [limit for limit in limits if limit.log > 0]
    if usable:
        limit = max(usable, key=lambda limit: limit.log)
        text += f" Its log error is {metrics.log / limit.log:.3g} times the least that {limit.kind} can reach here."
    return text


def schema() -> dict[str, Any]:
    """The JSON schema of :meth:`Comparison.to_json`."""
    path = resources.files("axffit.fitting").joinpath("schemas/comparison.schema.json")
    return json.loads(path.read_text(encoding="utf-8"))
