import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import ColorTable
from axffit.fitting.table import TableDesign, band_product


@pytest.fixture
def angles():
    rng = np.random.default_rng(8)
    corners = np.array([0.0, np.pi / 2, 0.0, np.pi / 2])
    theta_h = np.concatenate([rng.uniform(0, np.pi / 2, 300), corners])
    theta_d = np.concatenate([rng.uniform(0, np.pi / 3, 300), corners[::-1]])
    return theta_h, theta_d


@pytest.fixture
def design(angles):
    return TableDesign.of(angles[0], angles[1], 9)


def dense(band):
    n = band.shape[1]
    full = np.zeros((n, n))
    for k in range(band.shape[0]):
        for j in range(n - k):
            full[j + k, j] = full[j, j + k] = band[k, j]
    return full


def test_the_design_looks_up_what_the_color_table_does(angles, design):
    values = np.random.default_rng(9).uniform(size=(9, 9, 3))
    expected = jax.vmap(ColorTable(jnp.asarray(values)).lookup)(*(jnp.asarray(a) for a in angles))
    np.testing.assert_allclose(design.matrix @ values.reshape(81, 3), expected, atol=1e-12)


def test_the_band_is_the_normal_matrix(design):
    weights = np.random.default_rng(10).uniform(size=(304, 2))
    bands = design.normal_band(weights)
    a = design.matrix.toarray()
    for band, w in zip(bands, weights.T, strict=True):
        np.testing.assert_allclose(dense(band), a.T @ (a * w[:, None]), atol=1e-12)
    x = np.random.default_rng(11).normal(size=(81, 3))
    np.testing.assert_allclose(band_product(bands[0], x), dense(bands[0]) @ x, atol=1e-12)


def test_smoothness_is_the_sum_of_squared_differences_between_measured_neighbors(design):
    x = np.random.default_rng(12).normal(size=81)
    measured = design.measured.reshape(9, 9)
    assert not measured.all()
    grid = np.where(measured, x.reshape(9, 9), np.nan)
    expected = np.nansum(np.diff(grid, axis=0) ** 2) + np.nansum(np.diff(grid, axis=1) ** 2)
    np.testing.assert_allclose(x @ band_product(design.smoothness_band, x[:, None])[:, 0], expected)


def test_unmeasured_texels_are_found_and_solved_as_zero(design):
    touched = np.asarray(design.matrix.sum(axis=0)).ravel() > 0
    np.testing.assert_array_equal(design.measured, touched)
    band = design.normal_band(np.ones((304, 1)))[0] + 1e-3 * design.smoothness_band
    right = design.transposed @ np.ones(304)
    solution = design.factor(band).solve(right)
    assert np.all(solution[~design.measured] == 0)
    a = dense(band)[np.ix_(design.measured, design.measured)]
    np.testing.assert_allclose(solution[design.measured], np.linalg.solve(a, right[design.measured]), rtol=1e-8)


def test_dropped_samples_touch_nothing(design):
    keep = np.zeros(304)
    keep[:5] = 1.0
    kept = design.keeping(keep)
    assert 0 < kept.measured.sum() <= 20
    assert kept.matrix.shape == design.matrix.shape
