"""`axffit fit`: exit codes, results, and a fitted paint that goes back into AxF."""

import json

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit import axf, brdf, fitting, measured
from axffit.cli import compare, dispatch, fit
from axffit.fitting.result import FitResult, Outcome, schema
from axffit.measured import mbsdf
from tests.conftest import PROJECT

SAMPLES = PROJECT / "data_synthetic" / "noisy_car_paint" / "noisy_car_paint.mbsdf"


def test_a_fit_shows_parameters_metrics_and_outcome(tmp_path, capsys):
    results = tmp_path / "fit.json", tmp_path / "page.html"
    command = ["fit", str(SAMPLES), "--model", "lambert+coat", "--json", str(results[0]), "--html", str(results[1])]
    assert dispatch(command) == 0
    content = json.loads(results[0].read_text())
    jsonschema.validate(content, schema())
    shown = capsys.readouterr().out
    assert shown.splitlines()[0] == "lambert+coat fitted to noisy_car_paint"
    assert shown.splitlines()[-1] == content["advice"]
    assert not [p["name"] for p in content["parameters"] if f"\n{p['name']} " not in shown]
    assert f"axffit fit {SAMPLES} --model lambert+coat --ior 1.5" in results[1].read_text()


def test_profiles_and_bootstrap_are_shown_on_request(tmp_path, capsys):
    result = tmp_path / "fit.json"
    options = ["--model", "lambert", "--profile", "diffuse G", "--bootstrap", "40", "--json", str(result)]
    assert dispatch(["fit", str(SAMPLES), *options]) == 0
    content = json.loads(result.read_text())
    jsonschema.validate(content, schema())
    assert [profile["name"] for profile in content["profiles"]] == ["diffuse G"]
    assert content["bootstrap"]["count"] == 40
    shown = capsys.readouterr().out
    assert "95 % by profile" in shown
    assert "95 % by bootstrap, 40 of 40 fits" in shown
    assert dispatch(["fit", str(SAMPLES), "--model", "lambert", "--profile", "gloss"]) == 2
    assert "no profile of 'gloss': this model has diffuse R" in capsys.readouterr().err


def test_samples_that_allow_no_fit_end_in_1_with_advice_and_without_a_page(tmp_path, capsys):
    path = tmp_path / "black.mbsdf"
    mbsdf.write_table(path, np.zeros((4, 4, 8, 3)))
    results = [tmp_path / name for name in ("fit.json", "page.html", "fitted.axf")]
    flags = ("--json", "--html", "--out")
    options = [word for pair in zip(flags, map(str, results), strict=True) for word in pair]
    assert dispatch(["fit", str(path), *options]) == 1
    shown = capsys.readouterr()
    assert "a black material has no parameters to find" in shown.out
    assert [result.exists() for result in results] == [True, False, False]
    assert "not written: page.html, fitted.axf" in shown.err


def test_a_passive_fit_reflects_no_more_than_arrives(tmp_path, capsys):
    path, result = tmp_path / "bright.mbsdf", tmp_path / "fit.json"
    mbsdf.write_table(path, np.full((4, 4, 8, 3), 1.5 / np.pi))
    options = ["--model", "lambert", "--residual", "cosine", "--json", str(result)]
    assert dispatch(["fit", str(path), *options]) == 0
    assert json.loads(result.read_text())["parameters"][0]["value"] == pytest.approx(1.5)
    assert dispatch(["fit", str(path), *options, "--passive"]) == 0
    # The albedo is an integral over a fixed grid, good to 1 %.
    assert 0.99 <= json.loads(result.read_text())["parameters"][0]["value"] <= 1.0
    assert dispatch(["fit", str(path), "--model", "carpaint", "--passive"]) == 2
    assert "choose another model" in capsys.readouterr().err


def test_models_are_compared_first_and_the_chosen_one_is_fitted(tmp_path, capsys, monkeypatch):
    few = (fitting.LambertModel(), fitting.LambertModel(coat=fitting.Coat(1.4)))
    monkeypatch.setattr("axffit.fitting.selection.default_candidates", lambda: few)
    out, page = tmp_path / "fit.json", tmp_path / "page.html"
    assert dispatch(["fit", str(SAMPLES), "--select", "--json", str(out), "--html", str(page)]) == 0
    content, shown = json.loads(out.read_text()), capsys.readouterr().out.splitlines()
    jsonschema.validate(content, schema())
    assert shown[0].split() == ["model", "parameters", "log", "error", "AIC", "BIC", "held", "back"]
    assert [line.split()[0] for line in shown[1:3]] == ["lambert", "lambert+coat"]
    starred = [line.split()[0] for line in shown[1:3] if "*" in line]
    assert starred == [content["model"]]
    assert any(f"{content['model']} chosen among 2 models" in note for note in content["notes"])
    assert page.read_text().count("--select") == 1


@pytest.mark.parametrize(
    "options",
    [
        ["--select", "--model", "ggx"],
        ["--select", "--lobes", "2"],
        ["--f0", "some"],
        ["--model", "ggx", "--lobes", "9"],
    ],
)
def test_options_that_contradict_each_other_or_are_out_of_range_are_refused(options, capsys):
    assert dispatch(["fit", str(SAMPLES), *options]) == 2
    assert capsys.readouterr().out == ""


def test_only_car_paints_are_written(tmp_path, capsys):
    assert dispatch(["fit", str(SAMPLES), "--model", "ggx", "--out", str(tmp_path / "a.axf")]) == 2
    assert "--out writes car paints only" in capsys.readouterr().err


@pytest.mark.parametrize("refracting", [None, False, True])
def test_a_fitted_paint_reflects_the_same_after_a_trip_through_axf(tmp_path, refracting):
    colors = np.random.default_rng(5).uniform(0.2, 1.2, (8, 8, 3)).astype(np.float32)
    paint = brdf.CarPaint(0.1, [0.4, 0.2], [0.3, 0.9], [0.1, 0.5], brdf.ColorTable(colors))
    model = paint if refracting is None else brdf.ClearCoat(paint, 1.5, refracting=refracting)
    samples = measured.read(SAMPLES)
    fitted = fit.Fitted(FitResult(model, "carpaint", Outcome.CONVERGED), samples, measured.interpolant(SAMPLES))
    axf.write(tmp_path / "fitted.axf", fit.as_material(fitted))
    back = axf.to_brdf(axf.read(tmp_path / "fitted.axf").material("noisy_car_paint"))
    wi, wo = (jnp.asarray(side[::1000]) for side in (samples.wi, samples.wo))
    # AxF stores float32.
    np.testing.assert_allclose(back.evaluate(wi, wo), model.evaluate(wi, wo), rtol=2e-5)


@pytest.mark.slow
def test_a_car_paint_is_fitted_to_its_noise_and_written(tmp_path):
    out = tmp_path / "fitted.axf"
    assert dispatch(["fit", str(SAMPLES), "--model", "carpaint+coat", "--out", str(out)]) == 0
    metrics = compare.run(out, SAMPLES).comparison.metrics
    assert metrics.relative_cosine_rms == pytest.approx(0.01, rel=0.15)
