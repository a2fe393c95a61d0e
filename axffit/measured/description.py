"""What samples are worth before anything is fitted: coverage, negatives, reciprocity, energy."""

import json
from importlib import resources
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from scipy.spatial import KDTree

from axffit import __version__
from axffit.frames import directions_to_half_difference
from axffit.measured.measurements import Measurements, Wavelengths

SCHEMA_VERSION = 1
HALF_CELLS, DIFFERENCE_CELLS = 18, 9
PAIR_DISTANCE = 1e-3
"""Largest difference of a component between a sample's directions and another's swapped ones."""

LEAST_SAMPLES = 10
"""Directions of the viewer below which the energy of an incidence is not estimated."""

HEMISPHERE_POINTS = 20_000
"""Directions by which parts of the hemisphere are counted."""

INCIDENCE_STEP = 10.0
"""Degrees of a class of incidences where samples have more than `MOST_INCIDENCES` of them."""

MOST_INCIDENCES = 24


def schema() -> dict[str, Any]:
    """The JSON schema of :func:`describe`."""
    text = resources.files("axffit.measured").joinpath("schemas/measured.schema.json").read_text(encoding="utf-8")
    return json.loads(text)


def describe(measurements: Measurements) -> dict[str, Any]:
    """Everything `axffit measured` says, JSON-ready, by :func:`schema`.

    - coverage: samples per cell of half and difference angle, and the share of the cells that hold one (every cell has
      directions above the horizon, those of phi_d = 90 degrees).
    - negatives: how many values of valid samples, their share and the least one.
    - reciprocity: over pairs of samples whose directions are swapped (turned about the normal where isotropic),
      RMS of f(i, o) - f(o, i) over the RMS of f; None without pairs.
    - furnace: per incidence pi times the mean of f over the viewer's cosine-weighted directions, per channel: the
      albedo where they cover the hemisphere, an estimate from what there is elsewhere. Where the file states no
      solid angles (equal weights), a direction counts for the part of the hemisphere that is nearest to it.
    """
    valid = measurements.valid
    spectral = isinstance(measurements.channels, Wavelengths)
    values = measurements.values[valid]
    return {
        "schema": "axffit.measured",
        "schema_version": SCHEMA_VERSION,
        "axffit_version": __version__,
        "name": measurements.name,
        "samples": len(measurements),
        "valid": int(np.count_nonzero(valid)),
        "channels": _channels(measurements),
        "isotropic": _isotropic(measurements),
        "angles": {name: _range(v[valid]) for name, v in (("light", measurements.wi), ("viewer", measurements.wo))},
        "values": {
            "least": _rounded(values.min(axis=0)) if len(values) else None,
            "largest": _rounded(values.max(axis=0)) if len(values) else None,
            "mean": _rounded(values.mean(axis=0)) if len(values) else None,
            "negative": measurements.negative_count,
            "negative_share": _number(measurements.negative_count / values.size) if values.size else None,
            "noise_known": measurements.sigma is not None,
        },
        "coverage": _coverage(measurements),
        "reciprocity": _reciprocity(measurements),
        "furnace": _furnace(measurements),
        "provenance": dict(measurements.provenance) | ({"spectra": "not converted"} if spectral else {}),
    }


def _number(value: float) -> float:
    return float(f"{float(value):.6g}")


def _rounded(values: np.ndarray) -> list[float]:
    return [_number(value) for value in values]


def _channels(measurements: Measurements) -> dict[str, Any]:
    channels = measurements.channels
    if isinstance(channels, Wavelengths):
        return {"kind": "wavelengths", "nanometers": [_number(x) for x in channels.nanometers]}
    return {"kind": "rgb", "primaries": channels.primaries, "white": channels.white}


def _polar(v: np.ndarray) -> np.ndarray:
    return np.degrees(np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2]))


def _range(v: np.ndarray) -> dict[str, Any]:
    """Polar angles in degrees, and how many distinct ones to a hundredth."""
    if not len(v):
        return {"least_degrees": None, "largest_degrees": None, "distinct": 0}
    polar = _polar(v)
    return {
        "least_degrees": round(float(polar.min()), 4),
        "largest_degrees": round(float(polar.max()), 4),
        "distinct": len(np.unique(np.round(polar, 2))),
    }


def _isotropic(measurements: Measurements) -> bool:
    """Whether the samples lie at one azimuth of the light or of the half vector, and so cannot show an anisotropy."""
    half = measurements.wi + measurements.wo
    return bool(_one_azimuth(measurements.wi) or _one_azimuth(half))


def _one_azimuth(v: np.ndarray) -> bool:
    tilted = v[np.hypot(v[:, 0], v[:, 1]) > 1e-6]
    if not len(tilted):
        return True
    # Of lines, not rays: signed polar angles put the light on either side.
    across = tilted[0, 0] * tilted[:, 1] - tilted[0, 1] * tilted[:, 0]
    return bool((np.abs(across) < 1e-6).all())


def _half_difference(measurements: Measurements, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    with jax.enable_x64(new_val=True):
        wi, wo = (jnp.asarray(v[chosen]) for v in (measurements.wi, measurements.wo))
        theta_h, theta_d, _, _ = directions_to_half_difference(wi, wo)
        return np.asarray(theta_h), np.asarray(theta_d)


def _coverage(measurements: Measurements) -> dict[str, Any]:
    theta_h, theta_d = _half_difference(measurements, measurements.valid)
    half_edges = 0.5 * np.pi * np.linspace(0.0, 1.0, HALF_CELLS + 1) ** 2
    difference_edges = np.linspace(0.0, 0.5 * np.pi, DIFFERENCE_CELLS + 1)
    counts, _, _ = np.histogram2d(theta_d, theta_h, [difference_edges, half_edges])
    return {
        "half_edges_degrees": [round(float(x), 4) for x in np.degrees(half_edges)],
        "difference_edges_degrees": [round(float(x), 4) for x in np.degrees(difference_edges)],
        "counts": counts.astype(int).tolist(),
        "filled_share": _number(np.count_nonzero(counts) / counts.size),
    }


def _reciprocity(measurements: Measurements) -> dict[str, Any]:
    valid = np.flatnonzero(measurements.valid)
    nothing = {"pairs": 0, "violation": None, "largest": None}
    if len(valid) < 2:
        return nothing
    wi, wo = measurements.wi[valid], measurements.wo[valid]
    if _isotropic(measurements):
        points, swapped = _isotropic_points(wi, wo), _isotropic_points(wo, wi)
    else:
        points, swapped = np.concatenate([wi, wo], axis=1), np.concatenate([wo, wi], axis=1)
    found_near = KDTree(points).query(swapped, distance_upper_bound=PAIR_DISTANCE, p=np.inf)
    distance, partner = (np.asarray(part) for part in found_near)
    # Directions that are their own swap say nothing; each pair counts once.
    found = np.flatnonzero(np.isfinite(distance))
    found = found[(partner[found] > found) & (np.abs(swapped[found] - points[found]).max(axis=1) > PAIR_DISTANCE)]
    if not len(found):
        return nothing
    first, second = measurements.values[valid[found]], measurements.values[valid[partner[found]]]
    size = np.sqrt(0.5 * np.mean(first**2 + second**2))
    if size == 0:
        return nothing | {"pairs": len(found), "violation": 0.0, "largest": 0.0}
    return {
        "pairs": len(found),
        "violation": _number(np.sqrt(np.mean((first - second) ** 2)) / size),
        "largest": _number(np.abs(first - second).max()),
    }


def _isotropic_points(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """What of two directions a turn about the normal, or a mirror image, leaves: both cosines, along and across."""
    along = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1]
    across = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return np.stack([a[:, 2], b[:, 2], along, across], axis=1)


def _furnace(measurements: Measurements) -> list[dict[str, Any]]:
    polar = np.round(_polar(measurements.wi), 2)
    distinct = np.unique(polar)
    if len(distinct) > MOST_INCIDENCES:
        edges = np.arange(0.0, 90.0 + INCIDENCE_STEP, INCIDENCE_STEP)
        groups = [(low, low + INCIDENCE_STEP, (polar >= low) & (polar < low + INCIDENCE_STEP)) for low in edges[:-1]]
    else:
        groups = [(x, x, polar == x) for x in distinct]
    rows = []
    equal = np.ptp(measurements.weights) <= 1e-9 * measurements.weights.max(initial=0.0)
    for low, high, group in groups:
        chosen = group & measurements.valid
        if np.count_nonzero(chosen) < LEAST_SAMPLES:
            continue
        wi, wo = measurements.wi[chosen], measurements.wo[chosen]
        weights = _nearest_shares(wi, wo) if equal else measurements.weights[chosen] * wo[:, 2]
        if not weights.sum() > 0:
            continue
        albedo = np.pi * np.average(measurements.values[chosen], axis=0, weights=weights)
        rows.append(
            {
                "incidence_degrees": [round(float(low), 4), round(float(high), 4)],
                "samples": int(np.count_nonzero(chosen)),
                "albedo": _rounded(albedo),
            }
        )
    return rows


def _nearest_shares(wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """How much of the cosine-weighted hemisphere is nearest to each direction, azimuths counted from the light's."""
    radius = np.hypot(wi[:, 0], wi[:, 1])
    cosine, sine = (np.where(radius > 1e-6, x / np.maximum(radius, 1e-6), y) for x, y in ((wi[:, 0], 1), (wi[:, 1], 0)))
    turned = np.stack([cosine * wo[:, 0] + sine * wo[:, 1], cosine * wo[:, 1] - sine * wo[:, 0], wo[:, 2]], axis=1)
    one_side = not ((turned[:, 1] > 1e-6).any() and (turned[:, 1] < -1e-6).any())
    # Malley's method on Fibonacci's spiral.
    k = np.arange(HEMISPHERE_POINTS)
    r, phi = np.sqrt((k + 0.5) / HEMISPHERE_POINTS), k * np.pi * (3.0 - np.sqrt(5.0))
    points = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1.0 - r * r)], axis=1)
    if one_side:
        turned[:, 1], points[:, 1] = np.abs(turned[:, 1]), np.abs(points[:, 1])
    _, nearest = KDTree(turned).query(points)
    return np.bincount(nearest, minlength=len(wo)) / HEMISPHERE_POINTS
