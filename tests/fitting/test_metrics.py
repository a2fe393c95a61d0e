import dataclasses
import json
import math

import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.fitting import evaluate_samples, metrics_of
from axffit.measured import Measurements

from .paints import paint, sampled


def two_samples():
    """One sample of f cos = 1 at 60 degrees, one of 0.5 at 0 degrees, the first with three times the weight."""
    tilted = [math.sin(math.pi / 3), 0.0, math.cos(math.pi / 3)]
    wi = np.array([tilted, [0.0, 0.0, 1.0]])
    values = np.array([[2.0] * 3, [0.5] * 3])
    return Measurements(wi, wi[::-1], values, np.ones(2, bool), np.array([3.0, 1.0]))


def test_figures_worked_out_by_hand():
    measurements = two_samples()
    metrics = metrics_of(measurements, np.array([[4.0] * 3, [0.5] * 3]))
    assert metrics.relative_cosine_rms == pytest.approx(math.sqrt(0.75 * 1.0 / (0.75 * 1.0 + 0.25 * 0.25)))
    assert metrics.log == pytest.approx(math.sqrt(0.75) * math.log(3 / 2))
    assert metrics.cube_root == pytest.approx(math.sqrt(0.75) * (2 ** (1 / 3) - 1))
    assert metrics.peak == pytest.approx(1.0)
    assert metrics.sample_count == 2


def test_negatives_are_clipped_and_counted_and_a_model_below_zero_is_clipped_too():
    measurements = dataclasses.replace(two_samples(), values=np.array([[2.0, -1.0, 2.0], [0.5] * 3]))
    metrics = metrics_of(measurements, np.array([[2.0, -7.0, 2.0], [0.5] * 3]))
    assert metrics.clipped_negatives == 1
    assert metrics.log == 0


def test_grazing_and_invalid_samples_do_not_count():
    grazing = [math.sin(math.radians(81)), 0.0, math.cos(math.radians(81))]
    base = two_samples()
    wi = np.concatenate([base.wi, [grazing, base.wi[0]]])
    wo = np.concatenate([base.wo, [base.wi[0], base.wi[0]]])
    values = np.concatenate([base.values, [[9.0] * 3, [np.nan] * 3]])
    measurements = Measurements(wi, wo, values, np.ones(4, bool), np.array([3.0, 1.0, 5.0, 5.0]))
    model = np.concatenate([[[4.0] * 3, [0.5] * 3], np.zeros((2, 3))])
    assert metrics_of(measurements, model) == metrics_of(base, model[:2])


def test_black_data_have_no_relative_error_and_json_says_so():
    measurements = dataclasses.replace(two_samples(), values=np.zeros((2, 3)))
    assert metrics_of(measurements, np.zeros((2, 3))).relative_cosine_rms == 0
    fields = metrics_of(measurements, np.ones((2, 3))).to_json()
    assert fields["relative_cosine_rms"] is None
    json.dumps(fields, allow_nan=False)


def test_peak_looks_at_the_brightest_percent_only():
    measurements = sampled(paint())
    values = measurements.values.copy()
    fc = (values * measurements.wi[:, [2]]).mean(axis=1)
    dim = fc < np.quantile(fc, 0.98)
    values[dim] *= 3.0
    metrics = metrics_of(measurements, values, polar_limit=math.pi / 2)
    assert metrics.peak == 0
    assert metrics.log > 0.01


def test_nothing_to_compare_is_an_error():
    with pytest.raises(ValueError, match="no valid sample"):
        metrics_of(two_samples(), np.ones((2, 3)), polar_limit=0.1)
    with pytest.raises(ValueError, match="shape"):
        metrics_of(two_samples(), np.ones((3, 3)))


def test_a_brdf_is_evaluated_in_the_samples_directions():
    values = evaluate_samples(Lambert(jnp.array([0.1, 0.2, 0.3])), two_samples())
    np.testing.assert_allclose(values, np.tile(np.array([0.1, 0.2, 0.3]) / np.pi, (2, 1)))
