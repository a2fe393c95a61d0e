"""How far a model is from samples: the metrics of the project, defined once.

With fc = max(f, 0) i_z (data; negatives are clipped and counted), gc the model's, weights w of both solid angles
summing to 1, the mean over channels, and directions with either polar angle above 80 degrees left out:

    relative cosine RMS = sqrt(sum w (fc - gc)²) / sqrt(sum w fc²)
    log                 = sqrt(sum w (log1p fc - log1p gc)²)          Löw et al. 2012
    cube root           = sqrt(sum w (fc^(1/3) - gc^(1/3))²)          Fores et al. 2012
    peak                = relative cosine RMS over the 1 % of the samples with the largest mean fc

The log and cube-root metrics hardly see the peak, therefore the fourth.
"""

import math
from dataclasses import asdict, dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit.hemisphere import Reflector
from axffit.measured import Measurements

POLAR_LIMIT = math.radians(80.0)
"""Directions with a larger polar angle are left out: measurements and models are least reliable there."""

PEAK_SHARE = 0.01


@dataclass(frozen=True)
class Metrics:
    """The metrics of one model on one set of samples; see the module for the formulas."""

    relative_cosine_rms: float
    log: float
    cube_root: float
    peak: float
    sample_count: int
    clipped_negatives: int

    def to_json(self) -> dict[str, float | int | None]:
        """The fields by name; an infinite one (relative to black data) is None, for JSON has no infinity."""
        return {name: value if math.isfinite(value) else None for name, value in asdict(self).items()}


def within(measurements: Measurements, polar_limit: float = POLAR_LIMIT) -> np.ndarray:
    """Which samples are valid and have both polar angles at most ``polar_limit`` (radians), (N,) bool."""
    lowest = math.cos(polar_limit) - 1e-12
    return measurements.valid & (measurements.wi[:, 2] >= lowest) & (measurements.wo[:, 2] >= lowest)


def evaluate_samples(brdf: Reflector, measurements: Measurements) -> np.ndarray:
    """The model's values (N, 3) float64 in the samples' directions."""
    with jax.enable_x64(new_val=True):
        wi, wo = jnp.asarray(measurements.wi), jnp.asarray(measurements.wo)
        return np.asarray(_evaluate(brdf, wi, wo), np.float64)


@eqx.filter_jit
def _evaluate(brdf, wi, wo):
    return brdf.evaluate(wi, wo)


def _root_mean_square(difference: np.ndarray, weights: np.ndarray) -> float:
    return float(np.sqrt(np.sum(weights[:, None] * difference**2) / difference.shape[1]))


def _relative(fc: np.ndarray, gc: np.ndarray, weights: np.ndarray) -> float:
    scale = _root_mean_square(fc, weights)
    error = _root_mean_square(fc - gc, weights)
    if scale > 0:
        return error / scale
    return 0.0 if error == 0 else math.inf


def peak_samples(fc: np.ndarray) -> np.ndarray:
    """Which samples are the peak: the 1 % (at least one) with the largest mean over the channels of ``fc`` (N, C)."""
    brightness = fc.mean(axis=1)
    count = max(1, round(PEAK_SHARE * len(brightness)))
    return brightness >= np.partition(brightness, -count)[-count]


def metrics_of(measurements: Measurements, values: np.ndarray, *, polar_limit: float = POLAR_LIMIT) -> Metrics:
    """Metrics of model values (N, C) against samples.

    Raises:
        ValueError: no sample is valid within ``polar_limit``, or the channels do not match.
    """
    chosen = within(measurements, polar_limit)
    if values.shape != measurements.values.shape:
        raise ValueError(f"model values have shape {values.shape}, the samples {measurements.values.shape}")
    if not chosen.any():
        raise ValueError("no valid sample within the polar limit: there is nothing to compare")
    cosine = measurements.wi[chosen, 2][:, None]
    data = measurements.values[chosen]
    fc, gc = np.maximum(data, 0.0) * cosine, np.maximum(values[chosen], 0.0) * cosine
    weights = measurements.weights[chosen] / measurements.weights[chosen].sum()
    peak = peak_samples(fc)
    return Metrics(
        relative_cosine_rms=_relative(fc, gc, weights),
        log=_root_mean_square(np.log1p(fc) - np.log1p(gc), weights),
        cube_root=_root_mean_square(np.cbrt(fc) - np.cbrt(gc), weights),
        peak=_relative(fc[peak], gc[peak], weights[peak]),
        sample_count=int(chosen.sum()),
        clipped_negatives=int(np.count_nonzero(data < 0)),
    )
