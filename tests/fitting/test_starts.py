"""The way from the scan to the minimum."""

import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import GGX, Lambert, Schlick1994, Sum
from axffit.fitting import RESIDUALS, CarPaintModel, LobesModel, SingleLobeModel
from axffit.fitting.carpaint import luminance
from axffit.fitting.models import Shapes
from axffit.fitting.separable import cost_at, make_problem, solve
from axffit.fitting.starts import minimize, subsample
from axffit.measured import reference_grid

from .paints import GRID, paint, sampled


def problem_of(model, residual, measurements):
    return make_problem(model, residual, measurements, residual.prepare(measurements))


@pytest.mark.slow
@pytest.mark.parametrize("residual", ["log", "cosine"])
def test_the_end_is_a_minimum_of_all_samples_however_small_the_residuals(residual):
    # Dim samples: residuals of 1e-4, where a damping that starts at 1 would stop the solver at its start.
    samples = sampled(paint())
    dim = samples.__class__(samples.wi, samples.wo, 1e-3 * samples.values, samples.valid, samples.weights, name="dim")
    problem = problem_of(SingleLobeModel(lobe="cook-torrance"), RESIDUALS[residual](), dim)
    found = minimize(problem, max_steps=100)
    assert bool(found.converged)
    for change in (-3e-3, 3e-3):
        for shapes in (
            Shapes(found.shapes.roughness * (1.0 + change), found.shapes.f0),
            Shapes(found.shapes.roughness, jnp.clip(found.shapes.f0 + change, 0.0, 1.0)),
        ):
            assert float(cost_at(problem, shapes)[0]) >= float(found.cost) * (1.0 - 1e-9)


@pytest.mark.slow
def test_f0_on_its_bound_is_reached_and_is_a_minimum():
    brdf = Sum((Lambert(jnp.full(3, 0.1)), GGX(jnp.full(3, 0.2), 0.2, Schlick1994(1.0))))
    problem = problem_of(SingleLobeModel(lobe="ggx"), RESIDUALS["log"](), sampled(brdf, noise=0.02, seed=4))
    found = minimize(problem, max_steps=100)
    assert bool(found.converged)
    f0 = float(found.shapes.f0)
    assert f0 > 0.9
    nearby = Shapes(found.shapes.roughness, jnp.asarray(f0 - 1e-3))
    assert float(cost_at(problem, nearby)[0]) >= float(found.cost)


def test_a_held_shape_stays_where_it_is():
    problem = problem_of(SingleLobeModel(lobe="ggx"), RESIDUALS["log"](), sampled(paint()))
    start = Shapes(jnp.array([0.3]), jnp.array(0.5))
    held = Shapes(jnp.array([jnp.nan]), jnp.array(0.25))
    found = solve(problem, start, held=held)
    assert float(found.shapes.f0) == 0.25
    assert float(found.cost) >= float(solve(problem, start).cost)


def test_a_subsample_of_few_samples_is_all_of_them():
    problem = problem_of(SingleLobeModel(lobe="ggx"), RESIDUALS["log"](), sampled(paint()))
    assert subsample(problem, len(GRID.wi)) is problem
    assert len(subsample(problem, 100).wi) == 100


@pytest.mark.slow
@pytest.mark.parametrize("f0", ["each", "shared", 0.2])
def test_two_lobes_of_their_own_data_are_found(f0):
    model = LobesModel(lobe="ggx", lobes=2, f0=f0)
    shapes = Shapes(jnp.array([0.08, 0.4]), jnp.array(0.2) if f0 == "shared" else None)
    count = 5 if f0 == "each" else 3
    weights = jnp.asarray(np.random.default_rng(1).uniform(0.05, 0.3, (count, 3)))
    samples = sampled(model.assemble(shapes, weights), grid=reference_grid(20, 8, 6))
    problem = problem_of(model, RESIDUALS["log"](), samples)
    found = minimize(problem, max_steps=100)
    ordered, values = model.ordered(found.shapes, found.weights)
    np.testing.assert_allclose(ordered.roughness, shapes.roughness, rtol=1e-4)
    np.testing.assert_allclose(values, weights, rtol=1e-2, atol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("metric", ["log", "cube-root"])
@pytest.mark.parametrize("name", ["cc_ibiza_sunset_rgb", "vch_silk_blue_rgb", "irid_flake_paint2_rgb"])
def test_the_scan_ends_where_the_best_of_thirty_random_starts_does(reference_data, name, metric):
    from axffit import measured
    from axffit.fitting.metrics import within

    samples = measured.read(reference_data("nbrdf_measured", "rgl_isotropic_nbrdf_weights.npz"), name)
    gray = luminance(samples.select(within(samples)))
    problem = subsample(problem_of(CarPaintModel(lobes=3), RESIDUALS[metric](), gray), 1024)
    scanned = float(minimize(problem, max_steps=100).cost)
    draws = np.random.default_rng(6).uniform(np.log(0.005), np.log(5.0), (30, 3))
    costs = [float(solve(problem, Shapes(jnp.asarray(np.sort(np.exp(draw))))).cost) for draw in draws]
    # 0.1 % of the error is 0.2 % of the cost.
    assert scanned <= np.nanmin(costs) * 1.001**2
