import numpy as np

from axffit.measured import reference_grid


def test_the_reference_grid_has_the_documented_number_of_directions_within_80_degrees():
    grid = reference_grid()
    limit = np.cos(np.radians(80.0))
    assert np.count_nonzero((grid.wi[:, 2] >= limit) & (grid.wo[:, 2] >= limit)) == 60_632


def test_directions_are_those_of_the_angles():
    grid = reference_grid(12, 9, 8)
    half = grid.wi + grid.wo
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    np.testing.assert_allclose(np.arccos(np.clip(half[:, 2], -1, 1)), grid.theta_h, atol=1e-7)
    np.testing.assert_allclose(np.sum(half * grid.wi, axis=1), np.cos(grid.theta_d), atol=1e-12)
    np.testing.assert_allclose(half[:, 1], 0.0, atol=1e-12)


def test_weights_integrate_the_cosines_over_both_hemispheres():
    # The mean of i_z o_z over pairs of directions is 1/4: isotropic, so phi_h may stay 0.
    grid = reference_grid(240, 90, 72)
    mean = np.sum(grid.weights * grid.wi[:, 2] * grid.wo[:, 2])
    np.testing.assert_allclose(mean, 0.25, rtol=2e-3)
    np.testing.assert_allclose(grid.weights.sum(), 1.0)
