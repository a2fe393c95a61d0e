"""The best that any model of a class can do on given samples: yardsticks for a fit.

A class of models is a rule for which samples must have the same value. Every reciprocal isotropic model gives equal
values where the directions are swapped or mirrored; every function of (theta_h, theta_d) where those two agree. The
best value of a group of samples is found for each metric by itself, so each figure is an exact lower bound.
"""

import math
from dataclasses import asdict, dataclass

import numpy as np

from axffit.fitting.metrics import POLAR_LIMIT, Metrics, within
from axffit.measured import Measurements

_DECIMALS = 6
_SMALLEST_SHARE = 0.5


@dataclass(frozen=True)
class Limit:
    """Lowest value of each metric (``axffit.fitting.metrics``) within a class of models, on one set of samples."""

    kind: str
    relative_cosine_rms: float
    log: float
    cube_root: float
    sample_count: int
    group_count: int

    def ratios(self, metrics: Metrics) -> dict[str, float | None]:
        """The metrics as multiples of the limit; None where the limit is 0 or the metric infinite."""
        found = {}
        for name in ("relative_cosine_rms", "log", "cube_root"):
            value, least = getattr(metrics, name), getattr(self, name)
            found[name] = value / least if least > 0 and math.isfinite(value) else None
        return found

    def to_json(self) -> dict[str, str | float | int]:
        """The fields by name."""
        return asdict(self)


def reciprocal_limit(measurements: Measurements, *, polar_limit: float = POLAR_LIMIT) -> Limit | None:
    """Limit of any reciprocal isotropic model: f(theta_i, theta_o, |dphi|) = f(theta_o, theta_i, |dphi|).

    None where fewer than half of the samples have a partner, which is when the directions form no symmetric grid.
    """
    theta_i, theta_o = np.arccos(measurements.wi[:, 2]), np.arccos(measurements.wo[:, 2])
    azimuth = np.arctan2(
        measurements.wi[:, 0] * measurements.wo[:, 1] - measurements.wi[:, 1] * measurements.wo[:, 0],
        measurements.wi[:, 0] * measurements.wo[:, 0] + measurements.wi[:, 1] * measurements.wo[:, 1],
    )
    keys = [np.minimum(theta_i, theta_o), np.maximum(theta_i, theta_o), np.abs(azimuth)]
    return _limit("reciprocal isotropic models", measurements, np.stack(keys, axis=1), polar_limit, smallest_group=2)


def half_difference_limit(measurements: Measurements, *, polar_limit: float = POLAR_LIMIT) -> Limit | None:
    """Limit of any function of (theta_h, theta_d).

    None where fewer than half of the samples share both angles with two others: reciprocity alone makes pairs.
    """
    half, difference = measurements.wi + measurements.wo, measurements.wi - measurements.wo
    theta_h = np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2])
    theta_d = np.arctan2(np.linalg.norm(difference, axis=1), np.linalg.norm(half, axis=1))
    keys = np.stack([theta_h, theta_d], axis=1)
    return _limit("functions of (theta_h, theta_d)", measurements, keys, polar_limit, smallest_group=3)


def _limit(
    kind: str, measurements: Measurements, keys: np.ndarray, polar_limit: float, *, smallest_group: int
) -> Limit | None:
    chosen = within(measurements, polar_limit)
    if not chosen.any():
        return None
    _, group = np.unique(np.round(keys[chosen], _DECIMALS), axis=0, return_inverse=True)
    group = group.reshape(-1)
    sizes = np.bincount(group)
    if np.mean(sizes[group] >= smallest_group) < _SMALLEST_SHARE:
        return None
    cosine = measurements.wi[chosen, 2]
    fc = np.maximum(measurements.values[chosen], 0.0) * cosine[:, None]
    weights = measurements.weights[chosen] / measurements.weights[chosen].sum()
    square = {"cosine": 0.0, "log": 0.0, "cube root": 0.0}
    for channel in fc.T:
        for name, best in (("cosine", _best_linear), ("log", _best_log), ("cube root", _best_cube_root)):
            square[name] += best(channel, cosine, weights, group)
    channels = fc.shape[1]
    scale = np.sum(weights[:, None] * fc**2)
    return Limit(
        kind=kind,
        relative_cosine_rms=float(np.sqrt(square["cosine"] / scale)) if scale > 0 else 0.0,
        log=float(np.sqrt(square["log"] / channels)),
        cube_root=float(np.sqrt(square["cube root"] / channels)),
        sample_count=len(group),
        group_count=len(sizes),
    )


def _group_ratio(numerator: np.ndarray, denominator: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Sum of ``numerator`` over sum of ``denominator`` of each group, per sample."""
    above, below = np.bincount(group, numerator), np.bincount(group, denominator)
    return np.divide(above, below, out=np.zeros_like(above), where=below > 0)[group]


def _best_linear(fc: np.ndarray, cosine: np.ndarray, weights: np.ndarray, group: np.ndarray) -> float:
    """Lowest sum w (fc - v cosine)² over one v >= 0 a group."""
    v = _group_ratio(weights * fc * cosine, weights * cosine**2, group)
    return float(np.sum(weights * (fc - v * cosine) ** 2))


def _best_cube_root(fc: np.ndarray, cosine: np.ndarray, weights: np.ndarray, group: np.ndarray) -> float:
    """Lowest sum w (fc^(1/3) - (v cosine)^(1/3))²: linear in v^(1/3)."""
    return _best_linear(np.cbrt(fc), np.cbrt(cosine), weights, group)


def _best_log(fc: np.ndarray, cosine: np.ndarray, weights: np.ndarray, group: np.ndarray) -> float:
    """Lowest sum w (log1p fc - log1p(v cosine))², by Gauss-Newton on all groups at once."""
    target = np.log1p(fc)
    # In u = log v the problem is nearly quadratic for bright samples and smooth for dark ones; v stays positive.
    v = np.maximum(_group_ratio(weights * fc, weights * cosine, group), 1e-300)
    for _ in range(60):
        x = v * cosine
        slope = x / (1.0 + x)
        step = _group_ratio(weights * slope * (target - np.log1p(x)), weights * slope**2, group)
        v = v * np.exp(np.clip(step, -2.0, 2.0))
        if np.max(np.abs(step) * (v > 1e-200)) < 1e-10:
            break
    return float(np.sum(weights * (target - np.log1p(v * cosine)) ** 2))
