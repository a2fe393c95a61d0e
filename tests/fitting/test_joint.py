import jax.numpy as jnp
import lineax as lx
import numpy as np
import optimistix as optx
import pytest

from axffit.fitting import CarPaintModel, LogCosine
from axffit.fitting.bijections import forward_tree, start_tree
from axffit.fitting.carpaint import angles_below_coat
from axffit.fitting.joint import JointProblem
from axffit.fitting.models import Shapes
from axffit.fitting.separable import make_problem
from axffit.fitting.table import TableDesign
from axffit.measured import REC709_LUMINANCE, reference_grid

from .paints import paint, sampled

SIZE = 4


@pytest.fixture(scope="module")
def joint():
    measurements = sampled(paint(), noise=0.1, grid=reference_grid(10, 8, 6))
    model, residual = CarPaintModel(lobes=1), LogCosine()
    problem = make_problem(model, residual, measurements, residual.prepare(measurements))
    padding = np.zeros(len(problem.wi) - len(measurements))
    theta_h, theta_d = (np.concatenate([a, padding]) for a in angles_below_coat(model, measurements))
    real = np.concatenate([np.ones(len(measurements)), padding])
    design = TableDesign.of(theta_h, theta_d, SIZE).keeping(real)
    return JointProblem(problem, design, np.concatenate([measurements.weights, padding]), smoothing=1e-2)


@pytest.fixture(scope="module")
def start(joint):
    raw = np.asarray(start_tree(joint.problem.model.bounds(), Shapes(jnp.array([0.2]))).roughness)
    return raw, np.array([0.3, 0.1, 0.1]), np.ones((SIZE * SIZE, 3))


@pytest.fixture(scope="module")
def ended(joint, start):
    joint.set_penalty(*start)
    return joint.minimize(*start, free_lobes=True, max_steps=200, tolerance=1e-10)


@pytest.mark.slow
def test_a_dense_general_solver_ends_at_the_same_cost(joint, start, ended):
    # All unknowns in one vector, every residual and the smoothing written out: what the Schur complement shortcuts.
    a = jnp.asarray(joint.design.matrix.toarray())
    measured = joint.design.measured.reshape(SIZE, SIZE)
    pairs = [(i, i + 1) for i in range(SIZE * SIZE) if (i + 1) % SIZE] + [
        (i, i + SIZE) for i in range(SIZE * (SIZE - 1))
    ]
    first, second = np.array([pair for pair in pairs if measured.ravel()[list(pair)].all()]).T
    penalty = jnp.sqrt(jnp.asarray(joint._penalty_scale))
    problem = joint.problem

    def residuals(y, _):
        raw, log_weights, table = y
        b = problem.design(forward_tree(problem.model.bounds(), Shapes(raw))) @ jnp.exp(log_weights)
        # The gauge, so that smoothing sees the same table.
        table = table / (jnp.asarray(joint._gauge) @ (table @ jnp.asarray(REC709_LUMINANCE)))
        x = (a @ table) * b[:, None]
        transform = problem.residual.transform
        data = problem.root_weight * (transform(x) - transform(problem.target))
        return data, (table[first] - table[second]) * penalty[None, :]

    state = ended.state
    assert np.all(state.weights > 1e-6), "the dense solver takes logarithms of the weights"
    y0 = (jnp.asarray(state.raw + 0.2), jnp.log(jnp.asarray(state.weights)) + 0.1, jnp.asarray(state.table) * 1.1)
    solver = optx.LevenbergMarquardt(1e-10, 1e-10, linear_solver=lx.QR())
    dense = optx.least_squares(residuals, solver, y0, options={"jac": "fwd"}, max_steps=500, throw=False)
    cost = 0.5 * sum(float(jnp.sum(r**2)) for r in residuals(dense.value, None))
    assert ended.converged
    assert state.cost == pytest.approx(cost, rel=1e-5)


def test_the_gauge_is_kept(joint, ended):
    assert joint._gauge @ (ended.state.table @ REC709_LUMINANCE) == pytest.approx(1.0)


def test_the_cost_only_falls_and_the_lobes_help(joint, start, ended):
    table_only = joint.minimize(*start, free_lobes=False, max_steps=200, tolerance=1e-10)
    assert ended.state.cost < table_only.state.cost < joint.cost(*start)
    np.testing.assert_array_equal(table_only.state.raw, start[0])


def test_nothing_is_negative_and_unmeasured_texels_stay_zero(joint, ended):
    assert np.all(ended.state.weights >= 0)
    assert np.all(ended.state.table >= 0)
    from_zero = joint.minimize(
        ended.state.raw,
        ended.state.weights,
        np.where(joint.design.measured[:, None], ended.state.table, 0.0),
        free_lobes=True,
    )
    assert np.all(from_zero.state.table[~joint.design.measured] == 0)
