"""A batch of fits gives what each fit alone gives."""

import jax
import numpy as np
import pytest

from axffit.fitting import CarPaintModel, LogCosine, NoiseWeighted, SingleLobeModel
from axffit.fitting.batch import solve_batch
from axffit.fitting.carpaint import luminance
from axffit.fitting.models import Shapes
from axffit.fitting.separable import make_problem, solve
from axffit.fitting.starts import minimize
from axffit.measured import reference_grid

from .paints import paint, sampled

SMALL = reference_grid(8, 6, 5)


def problems(model, residual, seeds):
    """One problem a seed: the same directions, other noise."""
    data = [sampled(paint(), noise=0.02, seed=seed, grid=SMALL) for seed in seeds]
    return [make_problem(model, residual, one, residual.prepare(one)) for one in data]


def batch_of(alone, **options):
    targets = np.stack([np.asarray(problem.target) for problem in alone])
    weights = np.stack([np.asarray(problem.root_weight) for problem in alone])
    return solve_batch(alone[0], targets, weights, **options)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "residual"),
    [
        pytest.param(SingleLobeModel(lobe="ggx"), NoiseWeighted(), id="ggx noise"),
        pytest.param(SingleLobeModel(lobe="ward", fresnel="none"), LogCosine(), id="ward log"),
    ],
)
def test_each_lane_ends_where_its_own_fit_ends(model, residual):
    alone = problems(model, residual, range(3))
    # Two lanes at once and three sets: the last chunk is filled up, and what fills it does not come back.
    together = batch_of(alone, lanes=2)
    for index, problem in enumerate(alone):
        single = minimize(problem, max_steps=100)
        assert together.cost[index] == pytest.approx(float(single.cost), rel=1e-8)
        np.testing.assert_allclose(together.shapes.roughness[index], single.shapes.roughness, rtol=1e-4)
        np.testing.assert_allclose(together.weights[index], single.weights, rtol=1e-3, atol=1e-9)
    assert together.converged.all()
    assert len(together.cost) == 3


@pytest.mark.slow
def test_given_starts_are_used():
    alone = problems(SingleLobeModel(lobe="ggx"), LogCosine(), range(2))
    start = Shapes(np.array([[0.3], [0.1]]), np.array([0.5, 0.4]))
    together = batch_of(alone, start=start)
    single = solve(alone[1], jax.tree.map(lambda leaf: jax.numpy.asarray(leaf[1]), start))
    assert together.cost[1] == pytest.approx(float(single.cost), rel=1e-8)
    assert int(together.steps[1]) == int(single.steps)


@pytest.mark.slow
def test_three_lobes():
    model, residual = CarPaintModel(lobes=3), LogCosine()
    grays = [luminance(sampled(paint(), noise=0.02, seed=seed, grid=SMALL)) for seed in range(2)]
    alone = [make_problem(model, residual, gray, residual.prepare(gray)) for gray in grays]
    together = batch_of(alone)
    for index, problem in enumerate(alone):
        assert together.cost[index] == pytest.approx(float(minimize(problem, max_steps=100).cost), rel=1e-6)
