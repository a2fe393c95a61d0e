import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.errors import InputError
from axffit.fitting import Coat, LambertModel, Outcome, SingleLobeModel, fit
from axffit.fitting.models import Shapes
from axffit.fitting.passive import VIEWERS, albedos
from axffit.hemisphere import gauss_legendre_hemisphere

from .paints import sampled


def brdf(scale):
    model = SingleLobeModel(lobe="ggx")
    weights = scale * jnp.array([[0.3, 0.2, 0.1], [0.3, 0.5, 0.7]])
    return model, Shapes(jnp.array([0.2]), jnp.array(0.9)), weights


def test_the_albedo_is_that_of_a_plain_quadrature():
    model, shapes, weights = brdf(1.0)
    wi, solid_angle = gauss_legendre_hemisphere(160, 160)
    for viewer, found in zip(VIEWERS, albedos(model, shapes, weights), strict=True):
        wo = jnp.array([np.sin(viewer), 0.0, np.cos(viewer)])
        values = model.assemble(shapes, weights).evaluate(wi, jnp.broadcast_to(wo, wi.shape))
        np.testing.assert_allclose(found, jnp.sum(values * (wi[:, 2] * solid_angle)[:, None], axis=0), rtol=0.01)


def test_a_lambert_term_above_1_ends_at_1_in_the_channels_that_are():
    samples = sampled(Lambert(jnp.array([0.5, 1.2, 0.9])))
    result = fit("lambert", samples, passive=True)
    for channel, value in zip("RGB", (0.5, 1.0, 0.9), strict=True):
        assert result.parameter(f"diffuse {channel}").value == pytest.approx(value, rel=5e-3)
    assert "albedo of 1" in result.notes[0]


@pytest.mark.slow
def test_bright_data_are_held_at_an_albedo_of_1_and_better_than_by_scaling():
    model, shapes, weights = brdf(3.0)
    samples = sampled(model.assemble(shapes, weights))
    result = fit(model, samples, passive=True)
    assert result.outcome is Outcome.CONVERGED
    assert result.model is not None
    wi, solid_angle = gauss_legendre_hemisphere(160, 160)
    wo = jnp.broadcast_to(jnp.array([np.sin(VIEWERS[2]), 0.0, np.cos(VIEWERS[2])]), wi.shape)
    albedo = jnp.sum(result.model.evaluate(wi, wo) * (wi[:, 2] * solid_angle)[:, None], axis=0)
    assert float(albedo.max()) <= 1.01
    largest = albedos(model, shapes, weights).max(axis=0)
    scaled = fit(model, sampled(model.assemble(shapes, weights / largest[None])))
    from axffit.fitting import evaluate_samples, metrics_of

    assert result.metrics is not None
    assert scaled.model is not None
    assert result.metrics.log < metrics_of(samples, evaluate_samples(scaled.model, samples)).log


def test_dim_data_are_fitted_as_without():
    samples = sampled(Lambert(jnp.array([0.5, 0.2, 0.9])))
    assert fit("lambert", samples, passive=True).parameters == fit("lambert", samples).parameters


@pytest.mark.parametrize("model", ["carpaint", "ggx+coat"])
def test_it_is_not_asked_of_what_it_means_nothing_for(model):
    with pytest.raises(InputError, match="passivity"):
        fit(model, sampled(Lambert(jnp.full(3, 0.5))), passive=True)
    assert fit(LambertModel(coat=Coat(refracting=False)), sampled(Lambert(jnp.full(3, 0.5))), passive=True).model
