import dataclasses

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit.brdf import GGX, Lambert, Schlick1994, Sum
from axffit.errors import InputError
from axffit.fitting import Coat, LogCosine, Outcome, Robust, SingleLobeModel, fit, parse_model
from axffit.fitting.models import Shapes
from axffit.fitting.result import schema
from axffit.measured import Measurements, Wavelengths

from .paints import GRID, paint, sampled

SHAPES = Shapes(jnp.array([0.25]), jnp.array(0.2))
DIFFUSE, SPECULAR = np.array([0.1, 0.2, 0.05]), np.array([0.3, 0.2, 0.4])
TRUTH = {"roughness": 0.25, "f0": 0.2}
for _c, _name in enumerate("RGB"):
    TRUTH |= {
        f"diffuse {_name}": DIFFUSE[_c],
        f"specular {_name}": SPECULAR[_c],
        f"specular x f0 {_name}": 0.2 * SPECULAR[_c],
    }


def single(lobe, coat=None):
    model = SingleLobeModel(lobe=lobe, coat=coat)
    return model, model.assemble(SHAPES, jnp.asarray(np.stack([DIFFUSE, SPECULAR])))


SLOW = pytest.mark.slow


@pytest.mark.parametrize("lobe", [pytest.param("ward", marks=SLOW), pytest.param("cook-torrance", marks=SLOW), "ggx"])
def test_a_single_lobe_is_recovered_exactly_from_its_own_data(lobe):
    model, brdf = single(lobe)
    result = fit(model, sampled(brdf))
    assert result.outcome is Outcome.CONVERGED
    assert result.metrics is not None
    assert result.metrics.relative_cosine_rms < 1e-6
    for parameter in result.parameters:
        assert parameter.value == pytest.approx(TRUTH[parameter.name], rel=1e-5), parameter.name


@pytest.mark.parametrize("lobe", [pytest.param("ward", marks=SLOW), pytest.param("cook-torrance", marks=SLOW), "ggx"])
@pytest.mark.parametrize("residual", ["noise", "log"])
def test_standard_errors_are_those_of_the_scatter_over_repeated_measurements(lobe, residual):
    # 20 seeds x 11 parameters: |z| > 4.5 in 220 tries happens by chance with probability 0.15 %. The RMS bounds hold
    # for 20 x (the 8 independent ones) with a false alarm below 1 in 10 000 if the errors are right.
    from axffit.fitting import RESIDUALS

    model, brdf = single(lobe)
    z = []
    for seed in range(20):
        result = fit(model, sampled(brdf, noise=0.01, seed=seed), residual=RESIDUALS[residual]())
        for parameter in result.parameters:
            assert parameter.status == "identified", parameter
            assert parameter.standard_error is not None
            z.append((parameter.value - TRUTH[parameter.name]) / parameter.standard_error)
    assert np.max(np.abs(z)) < 4.5
    assert 0.75 < np.sqrt(np.mean(np.square(z))) < 1.3


@pytest.mark.slow
def test_below_a_refracting_coat_only_the_product_of_color_and_f0_is_called_known():
    model, brdf = single("ggx", Coat())
    result = fit(model, sampled(brdf, noise=0.1))
    for parameter in result.parameters:
        lost = parameter.name == "f0" or parameter.name in ("specular R", "specular G", "specular B")
        assert parameter.status == ("not identified" if lost else "identified"), parameter
        assert (parameter.standard_error is None) == lost
        assert (parameter.interval is None) == lost
        if not lost:
            low, high = parameter.interval or (np.nan, np.nan)
            assert low - (high - low) < TRUTH[parameter.name] < high + (high - low), parameter


def test_f0_at_a_bound_ends_exactly_there_and_says_so():
    brdf = Sum((Lambert(jnp.full(3, 0.1)), GGX(jnp.full(3, 0.2), 0.2, Schlick1994(1.0))))
    result = fit("ggx", sampled(brdf, noise=0.01))
    f0 = result.parameter("f0")
    assert f0.value == pytest.approx(1.0, abs=0.02)
    if f0.value == 1.0:
        assert f0.status == "at bound"
        assert f0.standard_error is None


def test_constant_data_give_the_diffuse_term_and_no_lobe():
    measurements = sampled(Lambert(jnp.array([0.2, 0.4, 0.6])))
    for name in ("ggx", "lambert"):
        result = fit(name, measurements)
        for channel, value in zip("RGB", (0.2, 0.4, 0.6), strict=True):
            assert result.parameter(f"diffuse {channel}").value == pytest.approx(value, rel=1e-6)
    lobe = fit("ggx", measurements)
    assert lobe.parameter("roughness").status == "not identified"
    assert lobe.parameter("specular R").value == 0
    assert lobe.parameter("specular R").status == "at bound"


def scaled(values):
    base = sampled(paint())
    return dataclasses.replace(base, values=values(base.values))


DEGENERATE = {
    "all NaN": (lambda: scaled(lambda v: np.full_like(v, np.nan)), Outcome.NO_SAMPLES),
    "all black": (lambda: scaled(np.zeros_like), Outcome.ALL_BLACK),
    "all negative": (lambda: scaled(lambda v: -v), Outcome.ALL_BLACK),
    "one direction": (lambda: sampled(paint()).select(np.full(50, 300)), Outcome.ONE_DIRECTION),
    "two samples": (lambda: sampled(paint()).select(np.array([300, 500])), Outcome.TOO_FEW_DIRECTIONS),
}


@pytest.mark.parametrize("model", ["ggx", "carpaint+coat"])
@pytest.mark.parametrize("kind", DEGENERATE)
def test_degenerate_data_end_in_a_named_outcome_with_advice_and_no_numbers(kind, model):
    make, outcome = DEGENERATE[kind]
    result = fit(model, make())
    assert result.outcome is outcome
    assert not result.outcome.ok
    assert (result.model, result.parameters, result.metrics) == (None, (), None)
    content = result.to_json()
    jsonschema.validate(content, schema())
    assert content["advice"] == outcome.value
    assert ":" in outcome.value


def test_one_direction_is_enough_for_a_diffuse_model():
    result = fit("lambert", sampled(Lambert(jnp.full(3, 0.3))).select(np.full(3, 300)))
    assert result.outcome is Outcome.CONVERGED
    assert result.parameter("diffuse G").value == pytest.approx(0.3)


@pytest.mark.slow
def test_order_and_repetition_of_samples_do_not_matter():
    base = sampled(paint(), noise=0.05)
    plain = dataclasses.replace(base, sigma=None)
    order = np.random.default_rng(2).permutation(len(base))
    # Every sample twice has the weights of every sample once.
    both = plain.select(np.concatenate([order, order]))
    one, other = (fit("cook-torrance", m) for m in (plain, both))
    for a, b in zip(one.parameters, other.parameters, strict=True):
        assert b.value == pytest.approx(a.value, rel=1e-4), a.name


def test_bright_data_are_fitted_like_dim_ones():
    _, brdf = single("ggx")
    base = sampled(brdf)
    bright = dataclasses.replace(base, values=1e6 * base.values)
    result = fit("ggx", bright)
    assert result.parameter("roughness").value == pytest.approx(0.25, rel=1e-4)
    assert result.parameter("specular R").value == pytest.approx(0.3e6, rel=1e-4)


@pytest.mark.slow
def test_progress_is_told_and_ends_at_one():
    told = []
    fit("carpaint", sampled(paint()), color_table=4, progress=lambda what, share: told.append((what, share)))
    assert told[-1] == ("fit", 1.0)
    assert all(0.0 <= share <= 1.0 for _, share in told)
    assert {"scan for starts", "lobes", "color table", "lobes and color table"} <= {what for what, _ in told}


@pytest.mark.parametrize(
    "arguments",
    [{"model": "phongg"}, {"color_table": 1}, {"smoothing": -1.0}, {"max_steps": 0}],
    ids=["model", "table", "smoothing", "steps"],
)
def test_unusable_arguments_are_refused(arguments):
    with pytest.raises(InputError):
        fit(**({"model": "carpaint", "measurements": sampled(paint())} | arguments))


def test_spectral_samples_are_refused_with_the_mend():
    n = len(GRID.wi)
    spectral = Measurements(
        GRID.wi,
        GRID.wo,
        np.ones((n, 4)),
        np.ones(n, bool),
        GRID.weights,
        channels=Wavelengths(np.array([4e2, 5e2, 6e2, 7e2])),
    )
    with pytest.raises(InputError, match="convert them to linear RGB"):
        fit("ggx", spectral)


def test_few_steps_end_as_not_converged_with_a_usable_model():
    result = fit(parse_model("ggx"), sampled(paint()), max_steps=2)
    assert result.outcome is Outcome.STEP_LIMIT
    assert result.model is not None
    assert result.metrics is not None
    with pytest.raises(KeyError, match="there are diffuse R"):
        result.parameter("gloss")


def test_wild_samples_pull_the_log_fit_and_not_the_robust_one():
    model, brdf = single("ggx")
    base = sampled(brdf)
    values = base.values.copy()
    values[::50] *= 30.0
    wild = dataclasses.replace(base, values=values)
    robust, plain = (fit(model, wild, residual=residual) for residual in (Robust(), LogCosine()))
    assert robust.outcome is Outcome.CONVERGED
    assert robust.residual == "robust"
    errors = [abs(result.parameter("diffuse G").value / 0.2 - 1.0) for result in (robust, plain)]
    assert errors[0] < 0.02
    assert errors[1] > 5 * errors[0]


def test_negative_samples_count_as_zero_or_are_left_out():
    base = sampled(Lambert(jnp.array([0.2, 0.4, 0.6])))
    values = base.values.copy()
    values[::4, 1] = -0.1
    negative = dataclasses.replace(base, values=values)
    clipped, without = (fit("lambert", negative, negatives=how) for how in ("clip", "leave out"))
    assert clipped.parameter("diffuse G").value < 0.35
    assert without.parameter("diffuse G").value == pytest.approx(0.4, rel=1e-6)
    assert clipped.samples is not None
    assert without.samples is not None
    left_out = clipped.samples["used"] - without.samples["used"]
    assert left_out == clipped.samples["clipped_negatives"] > 0
    assert without.samples["clipped_negatives"] == 0
