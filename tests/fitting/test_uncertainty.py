import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.fitting import NoiseWeighted, SingleLobeModel, fit
from axffit.fitting.batch import solve_batch
from axffit.fitting.estimates import estimates
from axffit.fitting.models import Shapes
from axffit.fitting.separable import make_problem
from axffit.fitting.uncertainty import covariance
from axffit.measured import reference_grid

from .paints import sampled


@pytest.fixture
def regression():
    rng = np.random.default_rng(20)
    jacobian = rng.normal(size=(40, 1, 3)) * np.array([1.0, 1e3, 1e-3])
    return rng.normal(size=(40, 1)), jacobian


def test_known_noise_gives_the_inverse_of_the_normal_matrix(regression):
    r, jacobian = regression
    found = covariance(r, jacobian, np.ones(3, bool), knows_noise=True)
    j = jacobian[:, 0]
    np.testing.assert_allclose(found.matrix, np.linalg.inv(j.T @ j), rtol=1e-8)
    assert found.determined.all()


def test_unknown_noise_gives_hc3(regression):
    r, jacobian = regression
    j = jacobian[:, 0]
    bread = np.linalg.inv(j.T @ j)
    leverage = np.diag(j @ bread @ j.T)
    meat = j.T @ np.diag((r[:, 0] / (1 - leverage)) ** 2) @ j
    found = covariance(r, jacobian, np.ones(3, bool), knows_noise=False)
    np.testing.assert_allclose(found.matrix, bread @ meat @ bread, rtol=1e-6)


def test_repeated_channels_are_not_counted_as_independent(regression):
    r, jacobian = regression
    one = covariance(r, jacobian, np.ones(3, bool), knows_noise=False)
    thrice = covariance(np.repeat(r, 3, 1), np.repeat(jacobian, 3, 1), np.ones(3, bool), knows_noise=False)
    # The same errors up to the leverage correction, not errors smaller by the root of 3.
    np.testing.assert_allclose(np.sqrt(np.diag(thrice.matrix) / np.diag(one.matrix)), 1.0, atol=0.12)


def test_a_direction_without_information_is_undetermined(regression):
    r, jacobian = regression
    jacobian = np.concatenate([jacobian, jacobian[:, :, :1], np.zeros((40, 1, 1))], axis=2)
    found = covariance(r, jacobian, np.ones(5, bool), knows_noise=True)
    assert found.determined.tolist() == [False, True, True, False, False]


def test_parameters_that_are_not_free_take_no_part(regression):
    r, jacobian = regression
    free = np.array([True, False, True])
    found = covariance(r, jacobian, free, knows_noise=True)
    j = jacobian[:, 0][:, free]
    np.testing.assert_allclose(found.matrix[np.ix_(free, free)], np.linalg.inv(j.T @ j), rtol=1e-8)
    assert np.all(found.matrix[1] == 0)
    gradient = np.array([1.0, 5.0, 0.0])
    assert found.error(gradient) == pytest.approx(np.sqrt(found.matrix[0, 0]))


@pytest.mark.slow
def test_correlations_are_those_of_repeated_fits():
    model, residual, sets = SingleLobeModel(lobe="ggx"), NoiseWeighted(), 300
    shapes, weights = Shapes(jnp.array([0.2]), jnp.array(0.3)), jnp.array([[0.1, 0.2, 0.3], [0.5, 0.4, 0.3]])
    data = sampled(model.assemble(shapes, weights), noise=0.02, grid=reference_grid(6, 5, 6))
    problem = make_problem(model, residual, data, residual.prepare(data))
    values, sigma = problem.design(shapes) @ weights, np.asarray(problem.root_weight)
    noise = np.random.default_rng(3).normal(size=(sets, *values.shape)) / np.where(sigma > 0, sigma, np.inf)
    start = jax.tree.map(lambda leaf: np.broadcast_to(leaf, (sets, *leaf.shape)), shapes)
    fits = solve_batch(problem, np.asarray(values) + noise, sigma[None], start=start)
    found = estimates(problem, shapes, weights)
    alone = [estimates(problem, *jax.tree.map(lambda leaf, k=k: jnp.asarray(leaf[k]), fits)[:2]) for k in range(sets)]
    seen = np.asarray(np.corrcoef([[one.value for one in each.parameters] for each in alone], rowvar=False))
    np.testing.assert_allclose(np.diagonal(found.correlations), 1.0)
    # Fisher: atanh of a correlation of n pairs has the standard error 1 / sqrt(n - 3); at 4.9 of it the false alarm
    # of the 55 pairs together is 5e-5.
    above = np.triu_indices(len(seen), 1)
    apart = np.arctanh(seen[above]) - np.arctanh(found.correlations[above])
    assert np.max(np.abs(apart)) < 4.9 / np.sqrt(sets - 3)
    assert np.min(found.correlations) < -0.5


def test_a_parameter_without_interval_has_no_correlation():
    found = fit(SingleLobeModel(lobe="ggx"), sampled(Lambert(jnp.full(3, 0.4))))
    assert found.correlations is not None
    for row, parameter in enumerate(found.parameters):
        assert np.isfinite(found.correlations[row, row]) == (parameter.standard_error is not None)
    assert {parameter.status for parameter in found.parameters} == {"identified", "not identified", "at bound"}
