import numpy as np
import pytest

from axffit.fitting.uncertainty import covariance


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
