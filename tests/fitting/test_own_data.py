"""A fit of a model's own data reproduces them, whatever the parameters."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axffit.fitting import RESIDUALS, CarPaintModel, SingleLobeModel, evaluate_samples, metrics_of
from axffit.fitting.lobes import Lobes, canonical
from axffit.fitting.models import Shapes
from axffit.fitting.separable import make_problem
from axffit.fitting.starts import minimize
from axffit.measured import Measurements, reference_grid

GRID = reference_grid(24, 8, 6)
REPRODUCED = 1e-6
PEAK_SHARE = 0.01


def samples_of(values):
    return Measurements(GRID.wi, GRID.wo, values, np.ones(len(values), bool), GRID.weights, name="own")


colors = st.lists(st.floats(0.01, 1.0), min_size=3, max_size=3).map(np.array)
# A lobe narrower than the grid's finest spacing is not seen; a wider one than 1 is next to diffuse.
roughnesses = st.floats(np.log(0.03), np.log(1.0)).map(np.exp)


@pytest.mark.slow
@pytest.mark.parametrize("residual", ["log", "cosine"])
@pytest.mark.parametrize("lobe", ["ward", "cook-torrance", "ggx"])
@settings(max_examples=8)
@given(diffuse=colors, specular=colors, roughness=roughnesses, f0=st.floats(0.0, 1.0))
def test_one_lobe(lobe, residual, diffuse, specular, roughness, f0):
    model = SingleLobeModel(lobe=lobe)
    brdf = model.assemble(Shapes(jnp.array([roughness]), jnp.array(f0)), jnp.asarray(np.stack([diffuse, specular])))
    samples = samples_of(np.asarray(brdf.evaluate(jnp.asarray(GRID.wi), jnp.asarray(GRID.wo))))
    objective = RESIDUALS[residual]()
    found = minimize(make_problem(model, objective, samples, objective.prepare(samples)), max_steps=200)
    values = evaluate_samples(model.assemble(found.shapes, found.weights), samples)
    assert metrics_of(samples, values).relative_cosine_rms < REPRODUCED
    np.testing.assert_allclose(found.shapes.roughness, [roughness], rtol=1e-3)
    # The product of color and F0 is what the brightness near the mirror direction shows.
    assert float(found.shapes.f0) * np.asarray(found.weights[1]) == pytest.approx(f0 * specular, rel=1e-2, abs=1e-4)


@st.composite
def lobes_apart(draw):
    """Two or three lobes, each spread at least twice the one before and each peak at least 1 % of the highest."""
    count = draw(st.integers(2, 3))
    spreads = [draw(st.floats(0.04, 0.1))]
    for _ in range(count - 1):
        spreads.append(spreads[-1] * draw(st.floats(2.0, 3.0)))
    spreads = np.array(spreads)
    # The peak of a lobe is s F0 / alpha² but for a factor that all share.
    peaks = np.array([draw(st.floats(PEAK_SHARE, 1.0)) for _ in range(count)])
    f0 = np.array([draw(st.floats(0.05, 0.95)) for _ in range(count)])
    p = 0.5 * (peaks / peaks.max()) * spreads**2
    return spreads, p, p / f0 - p, draw(st.floats(0.01, 0.5))


@pytest.mark.slow
@settings(max_examples=12)
@given(lobes=lobes_apart())
def test_lobes_a_factor_of_two_apart(lobes):
    spreads, p, q, diffuse = lobes
    model = CarPaintModel(lobes=len(spreads))
    weights = np.concatenate([[diffuse], np.stack([p, q], axis=1).ravel()])[:, None]
    wi, wo = jnp.asarray(GRID.wi), jnp.asarray(GRID.wo)
    samples = samples_of(np.asarray(model.basis(Shapes(jnp.asarray(spreads)), wi, wo) @ weights))
    objective = RESIDUALS["log"]()
    found = minimize(make_problem(model, objective, samples, objective.prepare(samples)), max_steps=200)
    values = np.asarray(model.basis(found.shapes, wi, wo) @ found.weights)
    assert metrics_of(samples, values).relative_cosine_rms < REPRODUCED
    ordered = canonical(Lobes(found.shapes, found.weights))
    np.testing.assert_allclose(ordered.shapes.roughness, spreads, rtol=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1e-3, 1e6])
def test_the_scale_of_the_data_does_not_matter_to_a_linear_residual(scale):
    model = SingleLobeModel(lobe="ggx")
    weights = jnp.array([[0.1, 0.2, 0.05], [0.3, 0.2, 0.4]])
    brdf = model.assemble(Shapes(jnp.array([0.25]), jnp.array(0.2)), weights)
    values = scale * np.asarray(brdf.evaluate(jnp.asarray(GRID.wi), jnp.asarray(GRID.wo)))
    samples = samples_of(values)
    objective = RESIDUALS["cosine"]()
    found = minimize(make_problem(model, objective, samples, objective.prepare(samples)), max_steps=200)
    np.testing.assert_allclose(found.shapes.roughness, [0.25], rtol=1e-6)
    np.testing.assert_allclose(found.weights, scale * weights, rtol=1e-5)
