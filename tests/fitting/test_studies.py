"""Profile likelihood and bootstrap, held against what is known in closed form and against standard errors."""

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.errors import InputError
from axffit.fitting import CarPaintModel, Coat, FitResult, LambertModel, NoiseWeighted, SingleLobeModel, Study, fit
from axffit.fitting.models import Shapes
from axffit.fitting.result import schema
from axffit.measured import reference_grid

from .paints import paint, sampled

SMALL = reference_grid(8, 6, 6)
NOISE = NoiseWeighted()


def checked(result: FitResult) -> FitResult:
    jsonschema.validate(result.to_json(), schema())
    return result


def test_of_a_linear_model_the_profile_is_a_parabola():
    data = sampled(Lambert(jnp.array([0.1, 0.2, 0.3])), noise=0.05, grid=SMALL)
    result = checked(fit(LambertModel(), data, residual=NOISE, study=Study(profiles=("all",))))
    assert [profile.name for profile in result.profiles] == ["diffuse R", "diffuse G", "diffuse B"]
    for profile in result.profiles:
        parameter = result.parameter(profile.name)
        assert parameter.standard_error is not None
        parabola = ((profile.values - parameter.value) / parameter.standard_error) ** 2
        np.testing.assert_allclose(profile.excess, parabola, rtol=1e-5, atol=1e-6)
        assert (profile.low, profile.high) == pytest.approx(parameter.interval, rel=2e-4)
        assert not profile.lower_cost_found


@pytest.fixture(scope="module")
def single():
    model = SingleLobeModel(lobe="ggx")
    shapes, weights = Shapes(jnp.array([0.2]), jnp.array(0.3)), jnp.array([[0.1, 0.2, 0.3], [0.5, 0.4, 0.3]])
    data = sampled(model.assemble(shapes, weights), noise=0.01, seed=4, grid=SMALL)
    asked = Study(profiles=("roughness", "f0", "specular G"), bootstrap=200, seed=1)
    return checked(fit(model, data, residual=NOISE, study=asked))


@pytest.mark.slow
@pytest.mark.parametrize("index", range(3))
def test_at_little_noise_profile_and_standard_error_agree(single, index):
    profile = single.profiles[index]
    parameter = single.parameter(profile.name)
    ends = (np.array([profile.low, profile.high], float) - parameter.value) / parameter.standard_error
    np.testing.assert_allclose(ends, [-1.96, 1.96], atol=0.1)


@pytest.mark.slow
def test_the_bootstrap_finds_the_standard_errors(single):
    assert single.bootstrap.converged == 200
    assert [one.name for one in single.bootstrap.parameters] == [one.name for one in single.parameters]
    for one, parameter in zip(single.bootstrap.parameters, single.parameters, strict=True):
        # 200 draws know a standard deviation to 5 %; the sample's own noise adds as much. Six times that.
        assert one.standard_deviation == pytest.approx(parameter.standard_error, rel=0.4)
        assert one.low < parameter.value < one.high
        half = 1.96 * parameter.standard_error
        assert (one.low, one.high) == pytest.approx((parameter.value - half, parameter.value + half), abs=0.6 * half)


@pytest.mark.slow
def test_what_the_data_do_not_determine_is_open():
    model = CarPaintModel(lobes=1, coat=Coat())
    shapes, weights = Shapes(jnp.array([0.3])), jnp.array([[0.05], [0.1], [0.1]])
    data = sampled(model.assemble(shapes, weights), noise=0.02, grid=SMALL)
    asked = Study(profiles=("f0 1", "spread 1"), bootstrap=40)
    result = checked(fit(model, data, residual=NOISE, color_table=0, study=asked))
    f0, spread = result.profiles
    assert f0.low is None or f0.high is None
    assert spread.low is not None
    assert spread.high is not None
    assert spread.low < 0.3 < spread.high
    assert result.bootstrap is not None
    resampled = {one.name: one for one in result.bootstrap.parameters}
    assert result.parameter("f0 1").status == "not identified"
    assert resampled["f0 1"].low is None
    assert resampled["spread 1"].low is not None


@pytest.mark.slow
def test_lobes_of_a_paint_in_the_log_metric():
    asked = Study(profiles=("spread 1", "coefficient 2"), bootstrap=100)
    result = checked(fit(CarPaintModel(), sampled(paint(), noise=0.01), color_table=0, study=asked))
    for profile in result.profiles:
        parameter = result.parameter(profile.name)
        assert parameter.standard_error is not None
        ends = (np.array([profile.low, profile.high], float) - parameter.value) / parameter.standard_error
        np.testing.assert_allclose(ends, [-1.96, 1.96], atol=0.2)


def test_an_unknown_parameter_and_too_few_fits_are_refused():
    data = sampled(Lambert(jnp.full(3, 0.2)), noise=0.05, grid=SMALL)
    with pytest.raises(InputError, match="no profile of 'gloss': this model has diffuse R"):
        fit(LambertModel(), data, study=Study(profiles=("gloss",)))
    with pytest.raises(InputError, match="at least 40"):
        fit(LambertModel(), data, study=Study(bootstrap=10))
