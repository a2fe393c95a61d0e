import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.fitting import RESIDUALS, CarPaintModel, LogCosine, SingleLobeModel
from axffit.fitting.bijections import start_tree
from axffit.fitting.models import Shapes
from axffit.fitting.separable import best_weights, cost_at, make_problem, projected_residuals, solve
from axffit.fitting.starts import minimize, scan, subsample

from .paints import GRID, paint, sampled

SHAPES = Shapes(jnp.array([0.3]), jnp.array(0.4))


def problem_of(residual, model=None, noise=0.2):
    model = SingleLobeModel(lobe="ggx") if model is None else model
    measurements = sampled(paint(), noise=noise)
    return make_problem(model, residual, measurements, residual.prepare(measurements))


@pytest.mark.parametrize("name", RESIDUALS)
def test_no_other_weights_cost_less(name):
    problem = problem_of(RESIDUALS[name]())
    design = problem.design(SHAPES)
    weights = best_weights(problem, design)
    least = jnp.sum(problem.residuals(design, weights) ** 2)
    assert np.all(weights >= 0)
    rng = np.random.default_rng(0)
    for size in (1e-1, 1e-2, 1e-3):
        for _ in range(8):
            other = weights + size * jnp.maximum(jnp.mean(weights), 1e-3) * rng.normal(size=weights.shape)
            assert jnp.sum(problem.residuals(design, jnp.maximum(other, 0.0)) ** 2) >= least * (1 - 1e-12)


@pytest.mark.parametrize("name", RESIDUALS)
def test_the_projected_jacobian_follows_the_moving_weights(name):
    problem = problem_of(RESIDUALS[name]())
    raw = start_tree(problem.model.bounds(), SHAPES)
    direction = Shapes(jnp.array([0.6]), jnp.array(-0.8))

    def along(t):
        moved = jax.tree.map(lambda x, d: x + t * d, raw, direction)
        return projected_residuals(moved, problem)[0]

    _, slope = jax.jvp(along, (jnp.zeros(()),), (jnp.ones(()),))
    step = 1e-4
    numeric = (along(jnp.asarray(step)) - along(jnp.asarray(-step))) / (2 * step)
    scale = float(jnp.max(jnp.abs(numeric)))
    np.testing.assert_allclose(slope / scale, numeric / scale, atol=2e-5)


def test_padding_changes_nothing():
    problem = problem_of(LogCosine())
    assert len(problem.wi) > len(GRID.wi)
    assert np.all(np.asarray(problem.root_weight)[len(GRID.wi) :] == 0)
    residuals = problem.residuals(problem.design(SHAPES), best_weights(problem, problem.design(SHAPES)))
    assert np.all(np.asarray(residuals)[len(GRID.wi) :] == 0)


def test_a_subsample_is_spread_over_the_samples():
    problem = problem_of(LogCosine())
    small = subsample(problem, 500)
    assert len(small.wi) == 500
    rows = {tuple(row) for row in np.asarray(problem.wi).round(12).tolist()}
    assert {tuple(row) for row in np.asarray(small.wi).round(12).tolist()} <= rows
    mean, few = (float(np.mean(np.arccos(np.asarray(p.wi)[: len(GRID.wi), 2]))) for p in (problem, small))
    assert few == pytest.approx(mean, rel=0.03)


def test_the_scan_puts_the_true_lobes_first():
    measurements = sampled(paint())
    residual = LogCosine()
    problem = make_problem(CarPaintModel(lobes=3), residual, measurements, residual.prepare(measurements))
    best = np.asarray(scan(problem, count=1)[0].roughness)
    np.testing.assert_allclose(np.log(best), np.log([0.06, 0.17, 0.5]), atol=0.45)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["log", "cube-root"])
def test_the_scanned_start_ends_at_the_best_of_ten_random_ones(name):
    problem = problem_of(RESIDUALS[name](), CarPaintModel(lobes=2))
    found = minimize(problem, max_steps=100)
    rng = np.random.default_rng(7)
    random = [solve(problem, Shapes(jnp.asarray(np.exp(rng.uniform(-4, 1, 2))))) for _ in range(10)]
    assert float(found.cost) <= min(float(s.cost) for s in random) * 1.001
    assert bool(found.converged)
    np.testing.assert_allclose(float(cost_at(problem, found.shapes)[0]), float(found.cost), rtol=1e-9)
