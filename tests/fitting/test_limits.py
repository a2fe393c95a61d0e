import math

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from axffit.brdf import Lambert
from axffit.fitting import half_difference_limit, metrics_of, reciprocal_limit
from axffit.fitting.limits import _best_cube_root, _best_linear, _best_log
from axffit.measured import Measurements, mbsdf

from .paints import paint, sampled


def mbsdf_like(seed=0):
    wi, wo, weights = mbsdf.grid_directions(6, 5)
    values = np.random.default_rng(seed).gamma(1.0, 0.5, (len(wi), 3))
    return Measurements(wi, wo, values, np.ones(len(wi), bool), weights)


TRANSFORMS = {"linear": (_best_linear, lambda x: x), "log": (_best_log, np.log1p), "cube": (_best_cube_root, np.cbrt)}


@pytest.mark.parametrize("name", TRANSFORMS)
def test_the_best_value_of_a_group_is_the_minimum(name):
    best, transform = TRANSFORMS[name]
    rng = np.random.default_rng(4)
    fc, cosine, weights = rng.gamma(0.5, 2.0, 5), rng.uniform(0.2, 1, 5), rng.uniform(0.1, 1, 5)

    def cost(log_v):
        return np.sum(weights * (transform(fc) - transform(np.exp(log_v) * cosine)) ** 2)

    found = minimize_scalar(cost, bounds=(-10, 6), method="bounded", options={"xatol": 1e-10})
    assert best(fc, cosine, weights, np.zeros(5, int)) == pytest.approx(found.fun, rel=1e-9)


def test_no_reciprocal_model_beats_the_limit_and_the_symmetrized_data_come_close():
    measurements = mbsdf_like()
    limit = reciprocal_limit(measurements, polar_limit=math.pi / 2)
    assert limit is not None
    table = measurements.values.reshape(6, 6, 5, 3)
    symmetric = (0.5 * (table + table.transpose(1, 0, 2, 3))).reshape(-1, 3)
    metrics = metrics_of(measurements, symmetric, polar_limit=math.pi / 2)
    assert limit.log < metrics.log < 1.5 * limit.log
    assert limit.cube_root < metrics.cube_root < 1.5 * limit.cube_root
    assert limit.relative_cosine_rms < metrics.relative_cosine_rms < 1.5 * limit.relative_cosine_rms


def test_reciprocal_data_have_limit_zero():
    limit = reciprocal_limit(sampled(paint()))
    assert limit is not None
    assert max(limit.log, limit.cube_root, limit.relative_cosine_rms) < 1e-7


def test_functions_of_the_two_angles_cannot_follow_geometric_attenuation():
    lobes, flat = half_difference_limit(sampled(paint())), half_difference_limit(sampled(Lambert(jnp.ones(3))))
    assert lobes is not None
    assert lobes.log > 1e-3
    assert flat is not None
    assert flat.log < 1e-12


def test_grids_without_partners_have_no_limit():
    rng = np.random.default_rng(1)
    v = rng.normal(size=(2, 50, 3))
    v[..., 2] = np.abs(v[..., 2])
    wi, wo = v / np.linalg.norm(v, axis=-1, keepdims=True)
    scattered = Measurements(wi, wo, np.ones((50, 3)), np.ones(50, bool), np.ones(50))
    assert reciprocal_limit(scattered) is None
    assert half_difference_limit(scattered) is None
    assert half_difference_limit(mbsdf_like()) is None


def test_the_noisy_paint_has_the_known_reciprocal_limit(reference_data):
    red = mbsdf.read(reference_data("mbsdf_carpaint_nvidia", "carpaint_red.mbsdf"))
    limit = reciprocal_limit(red, polar_limit=math.radians(64.9))
    assert limit is not None
    assert limit.log == pytest.approx(0.0442, abs=1e-4)
    assert limit.cube_root == pytest.approx(0.0446, abs=1e-4)
