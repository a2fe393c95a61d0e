import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from axffit.fitting.nonnegative import faces, solve_nonnegative

solve = jax.jit(solve_nonnegative)


@given(st.integers(0, 10_000), st.sampled_from([1, 3, 5, 7]))
def test_agrees_with_an_active_set_solver(seed, n):
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(20, n)) * 10.0 ** rng.uniform(-4, 4, n)
    right = rng.normal(size=20)
    expected, _ = nnls(matrix, right)
    found = np.asarray(solve(jnp.asarray(matrix.T @ matrix), jnp.asarray(matrix.T @ right)))
    scale = np.linalg.norm(matrix, axis=0)
    np.testing.assert_allclose(found * scale, expected * scale, atol=1e-7)
    assert np.array_equal(found == 0, expected == 0)


def test_collinear_and_empty_columns_do_no_harm():
    rng = np.random.default_rng(5)
    matrix = rng.uniform(size=(30, 4))
    matrix[:, 2] = matrix[:, 1]
    matrix[:, 3] = 0.0
    right = matrix @ np.array([1.0, 2.0, 0.0, 0.0])
    found = np.asarray(solve(jnp.asarray(matrix.T @ matrix), jnp.asarray(matrix.T @ right)))
    np.testing.assert_allclose(matrix @ found, right, rtol=1e-6)
    assert found[3] == 0


def test_the_minimizer_of_an_all_negative_problem_is_exactly_zero():
    assert np.all(np.asarray(solve(jnp.eye(3), -jnp.ones(3))) == 0)


def test_faces_are_all_subsets():
    assert len({tuple(row) for row in faces(4).tolist()}) == 16
    with pytest.raises(ValueError, match="1 to 10"):
        faces(11)
