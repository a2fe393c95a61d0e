import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit.brdf import CarPaint, ClearCoat
from axffit.fitting import CarPaintModel, Coat, Outcome, fit
from axffit.fitting.carpaint import Lobes, angles_below_coat, canonical
from axffit.fitting.models import Shapes
from axffit.fitting.result import schema
from axffit.frames import directions_to_half_difference
from axffit.measured import REC709_LUMINANCE, reference_grid

from .paints import TRUTH, colored_table, paint, sampled

SEEDS = 20


def z_scores(brdf, model):
    """z of every identified parameter of the first stage over the seeds, by name."""
    found = {name: [] for name in TRUTH}
    for seed in range(SEEDS):
        result = fit(model, sampled(brdf, noise=0.01, seed=seed), color_table=0)
        assert result.outcome is Outcome.CONVERGED
        for parameter in result.parameters:
            if parameter.standard_error is not None:
                found[parameter.name].append((parameter.value - TRUTH[parameter.name]) / parameter.standard_error)
    return found


@pytest.mark.slow
def test_lobes_are_recovered_within_their_errors_from_noisy_samples():
    # 20 seeds x 13 parameters, three of them products of two others. If the errors are right, some |z| > 4.5 has
    # probability 0.18 %, and the RMS of 260 (with 200 independent ones) leaves 0.8-1.25 with less than 0.01 %.
    z = z_scores(paint(), "carpaint")
    assert {name: len(values) for name, values in z.items()} == dict.fromkeys(TRUTH, SEEDS)
    everything = np.concatenate(list(z.values()))
    assert np.max(np.abs(everything)) < 4.5
    assert 0.8 < np.sqrt(np.mean(everything**2)) < 1.25


@pytest.mark.slow
def test_below_a_refracting_coat_f0_is_open_and_the_rest_is_recovered_within_its_errors():
    # As above with 7 parameters; those of s_k and F0_k must not get an interval.
    z = z_scores(ClearCoat(paint(), 1.5), "carpaint+coat")
    for name, values in z.items():
        lost = name.startswith(("f0", "coefficient")) and " x " not in name
        assert len(values) == (0 if lost else SEEDS), name
    everything = np.concatenate(list(z.values()))
    assert np.max(np.abs(everything)) < 4.5
    assert 0.75 < np.sqrt(np.mean(everything**2)) < 1.3


@pytest.fixture(scope="module")
def whole():
    """A whole fit of exact samples of a paint whose table the fit can express."""
    return fit("carpaint", sampled(paint(colored_table(12))), color_table=12, smoothing=1e-6)


def test_the_stages_are_named_and_each_is_better(whole):
    names = [stage.name for stage in whole.stages]
    assert names == ["lobes on luminance, one color", "color table", "lobes and color table"]
    errors = [stage.metrics.log for stage in whole.stages]
    assert errors[0] > 10 * errors[1]
    assert whole.stages[2].cost <= whole.stages[1].cost
    assert whole.metrics.log < 1e-3
    assert whole.outcome is Outcome.CONVERGED


def test_errors_given_a_free_table_are_called_conditional_and_those_of_the_first_stage_are_not(whole):
    assert {p.status for p in whole.parameters} <= {"conditional", "at bound", "not identified"}
    assert "identified" in {p.status for p in whole.stages[0].parameters}


def test_the_gauge_is_the_data_weighted_mean_luminance(whole):
    measurements = sampled(paint(colored_table(12)))
    limit = np.cos(np.radians(80))
    used = measurements.select((measurements.wi[:, 2] >= limit) & (measurements.wo[:, 2] >= limit))
    theta_h, theta_d, _, _ = directions_to_half_difference(jnp.asarray(used.wi), jnp.asarray(used.wo))
    chi = np.stack([whole.model.color_table.lookup(h, d) for h, d in zip(theta_h[::9], theta_d[::9], strict=True)])
    weights = used.weights[::9]
    assert np.sum(weights * (chi @ REC709_LUMINANCE)) / weights.sum() == pytest.approx(1.0, abs=0.02)


def test_unmeasured_texels_are_marked_and_zero(whole):
    assert isinstance(whole.model, CarPaint)
    table = np.asarray(whole.model.color_table.values)
    assert whole.measured_texels.shape == (12, 12)
    assert 0 < whole.measured_texels.sum() < 144
    assert np.all(table[~whole.measured_texels] == 0)
    assert f"{whole.measured_texels.sum()} of 144 texels" in whole.notes[0]


def test_lobes_come_in_the_order_of_their_spreads(whole):
    spreads = np.asarray(whole.model.spreads)
    weighted = np.asarray(whole.model.coefficients) > 0
    assert np.all(np.diff(spreads[weighted]) > 0)
    mixed = Lobes(Shapes(jnp.array([0.5, 0.1, 0.3])), jnp.array([[9.0], [1.0], [2.0], [0.0], [0.0], [3.0], [4.0]]))
    ordered = canonical(mixed)
    np.testing.assert_array_equal(ordered.shapes.roughness, [0.3, 0.5, 0.1])
    np.testing.assert_array_equal(np.asarray(ordered.weights)[:, 0], [9, 3, 4, 1, 2, 0, 0])


def test_the_result_is_json_of_the_schema(whole):
    jsonschema.validate(whole.to_json(), schema())
    assert whole.to_json()["color_table"] == {
        "height": 12,
        "width": 12,
        "measured_texels": int(whole.measured_texels.sum()),
    }


@pytest.mark.slow
def test_under_a_coat_the_table_is_addressed_with_the_directions_below_it():
    measurements = sampled(paint(), grid=reference_grid(8, 6, 4))
    model = CarPaintModel(lobes=1, coat=Coat(1.5))
    theta_h, theta_d = angles_below_coat(model, measurements)
    assert theta_d.max() < np.radians(41.9)
    i = 100
    inside = [
        np.append(v[i, :2] / 1.5, np.sqrt(1 - np.sum(v[i, :2] ** 2) / 2.25)) for v in (measurements.wi, measurements.wo)
    ]
    half = inside[0] + inside[1]
    half /= np.linalg.norm(half)
    np.testing.assert_allclose([theta_h[i], theta_d[i]], np.arccos([half[2], half @ inside[0]]), atol=1e-7)
    flat = CarPaintModel(lobes=1, coat=Coat(1.5, refracting=False))
    np.testing.assert_allclose(angles_below_coat(flat, measurements)[1].max(), np.pi / 2 * 5.5 / 6, atol=1e-9)


@pytest.mark.slow
def test_a_coated_paint_with_a_table_is_explained_to_noise():
    brdf = ClearCoat(paint(colored_table(6)), 1.5)
    result = fit("carpaint+coat", sampled(brdf, grid=reference_grid(30, 16, 12)), color_table=12)
    assert isinstance(result.model, ClearCoat)
    assert result.metrics is not None
    assert result.metrics.log < 5e-3
    assert result.metrics.log < 0.2 * result.stages[0].metrics.log
    # With a free table nothing tells F0 from the coefficient below a coat that refracts.
    for k in (1, 2, 3):
        assert result.parameter(f"f0 {k}").standard_error is None
        assert result.parameter(f"coefficient {k}").status in ("not identified", "at bound")
