"""Numbers behind the plots of a fit or comparison: lobes in the plane of incidence, and where a model fails."""

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit.brdf import AbstractBRDF
from axffit.fitting import POLAR_LIMIT
from axffit.fitting.metrics import within
from axffit.frames import directions_to_half_difference
from axffit.measured import REC709_LUMINANCE, Measurements

INCIDENCE_DEGREES = (15.0, 30.0, 45.0, 60.0, 75.0)
LARGEST_VIEW_DEGREES = 85.0
HALF_CELLS, DIFFERENCE_CELLS = 18, 9
LEAST_SHARE = 1e-3
"""Part of the peak below which a value counts as this part: ratios of two near-black values say nothing."""


@eqx.filter_jit
def _evaluate(brdf, wi, wo):
    return brdf.evaluate(wi, wo)


def _values(brdf: AbstractBRDF, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    with jax.enable_x64(new_val=True):
        value = _evaluate(brdf, jnp.asarray(wi, jnp.float64), jnp.asarray(wo, jnp.float64))
        return np.asarray(value, np.float64)


def luminance(rgb: np.ndarray) -> np.ndarray:
    """Rec. 709 luminance of linear RGB (..., 3)."""
    return np.asarray(rgb) @ REC709_LUMINANCE


def view_angles(incidence: float) -> np.ndarray:
    """View angles (degrees): every 2.5°, every 0.5° around the mirror direction and the retroreflection."""
    around = np.concatenate([np.arange(-7.5, 7.51, 0.5) + incidence, np.arange(-2.0, 2.01, 0.5) - incidence])
    even = np.arange(-LARGEST_VIEW_DEGREES, LARGEST_VIEW_DEGREES + 0.1, 2.5)
    angles = np.unique(np.concatenate([even, around]))
    return angles[np.abs(angles) <= LARGEST_VIEW_DEGREES]


def incidence_plane(measured: AbstractBRDF, model: AbstractBRDF) -> list[dict[str, Any]]:
    """Luminance of f in the plane of incidence, measured and modeled, one entry an angle of incidence.

    Angles are degrees from the normal, signed: the light stands on the negative side, its mirror direction is at
    +``incidence_degrees``. Values are luminance of f in 1/sr.
    """
    curves = []
    for incidence in INCIDENCE_DEGREES:
        view = view_angles(incidence)
        light = np.radians(-incidence)
        wi = np.broadcast_to([np.sin(light), 0.0, np.cos(light)], (len(view), 3))
        theta = np.radians(view)
        wo = np.stack([np.sin(theta), np.zeros_like(theta), np.cos(theta)], axis=-1)
        curve = {"incidence_degrees": incidence, "view_degrees": view.tolist()}
        for name, brdf in (("measured", measured), ("modeled", model)):
            curve[name] = [float(f"{x:.5g}") for x in luminance(_values(brdf, wi, wo))]
        curves.append(curve)
    return curves


def failure_map(measurements: Measurements, model: AbstractBRDF, *, polar_limit: float = POLAR_LIMIT) -> dict[str, Any]:
    """Where the model is too bright or too dark: log2(model / data) over cells of half and difference angle.

    Each cell has the weighted mean over its samples; cells are even in sqrt(theta_h), as the lobes need, and in
    theta_d. Luminances of f cos, data and model, below 10⁻³ of the data's peak count as that. A cell without samples
    is None; samples with a polar angle above ``polar_limit`` (radians) are left out, as fits leave them out.
    """
    cosine = measurements.wi[:, 2]
    used = within(measurements, polar_limit)
    data = luminance(_three_channels(measurements.values[used])) * cosine[used]
    modeled = luminance(_values(model, measurements.wi[used], measurements.wo[used])) * cosine[used]
    least = LEAST_SHARE * max(float(data.max()), 1e-30)
    ratio = np.log2(np.maximum(modeled, least) / np.maximum(data, least))
    theta_h, theta_d = _half_difference(measurements.wi[used], measurements.wo[used])
    weights = np.maximum(measurements.weights[used], 1e-300)
    half_edges = 0.5 * np.pi * np.linspace(0.0, 1.0, HALF_CELLS + 1) ** 2
    difference_edges = np.linspace(0.0, 0.5 * np.pi, DIFFERENCE_CELLS + 1)
    bins = [difference_edges, half_edges]
    total, _, _ = np.histogram2d(theta_d, theta_h, bins, weights=weights)
    summed, _, _ = np.histogram2d(theta_d, theta_h, bins, weights=weights * ratio)
    cells = [
        [None if w == 0 else float(f"{s / w:.4g}") for s, w in zip(sums, ws, strict=True)]
        for sums, ws in zip(summed, total, strict=True)
    ]
    return {
        "half_edges_degrees": [round(float(x), 4) for x in np.degrees(half_edges)],
        "difference_edges_degrees": [round(float(x), 4) for x in np.degrees(difference_edges)],
        "log2_ratio": cells,
    }


def _three_channels(values: np.ndarray) -> np.ndarray:
    return values if values.shape[1] == 3 else np.repeat(values.mean(axis=1, keepdims=True), 3, axis=1)


def _half_difference(wi: np.ndarray, wo: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    with jax.enable_x64(new_val=True):
        theta_h, theta_d, _, _ = directions_to_half_difference(jnp.asarray(wi), jnp.asarray(wo))
        return np.asarray(theta_h), np.asarray(theta_d)
