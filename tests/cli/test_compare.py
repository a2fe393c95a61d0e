"""`axffit compare`: models against samples, without fitting."""

import json

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit import axf
from axffit.brdf import Lambert
from axffit.cli import _texel_mean, dispatch
from axffit.cli._texel_mean import TexelMean, brdf_of
from axffit.fitting.compare import schema
from axffit.hemisphere import gauss_legendre_hemisphere
from tests.conftest import PROJECT

SVBRDF = PROJECT / "data_synthetic" / "brushed_carbon" / "brushed_carbon.axf"
PAINT = PROJECT / "data_synthetic" / "metallic_paint" / "metallic_paint.axf"
SAMPLES = PROJECT / "data_synthetic" / "noisy_car_paint" / "noisy_car_paint.mbsdf"


@pytest.mark.slow
def test_the_true_model_is_off_by_the_noise_of_the_samples(tmp_path, capsys):
    results = tmp_path / "comparison.json", tmp_path / "page.html"
    command = ["compare", str(PAINT), str(SAMPLES), "--json", str(results[0]), "--html", str(results[1])]
    assert dispatch(command) == 0
    content = json.loads(results[0].read_text())
    jsonschema.validate(content, schema())
    # The samples carry 1 % of relative noise.
    assert content["metrics"]["relative_cosine_rms"] == pytest.approx(0.01, rel=0.1)
    assert content["metrics"]["peak"] == pytest.approx(0.01, rel=0.2)
    shown = capsys.readouterr().out
    assert shown.splitlines()[0] == "Blue metallic paint (synthetic) against noisy_car_paint"
    assert shown.splitlines()[-1] == content["sentence"]
    assert content["sentence"] in results[1].read_text()


def test_a_textured_material_that_is_another_explains_them_worse(tmp_path, monkeypatch):
    monkeypatch.setattr(_texel_mean, "TEXELS", 64)
    results = tmp_path / "comparison.json", tmp_path / "page.html"
    command = ["compare", str(SVBRDF), str(SAMPLES), "--json", str(results[0]), "--html", str(results[1])]
    assert dispatch(command) == 0
    # The true model's log error on these samples is 4e-4.
    assert json.loads(results[0].read_text())["metrics"]["log"] > 2e-3
    assert "Brushed steel" in results[1].read_text()


def lamberts() -> tuple[np.ndarray, TexelMean]:
    colors = np.random.default_rng(3).uniform(0.1, 0.9, (5, 3))
    return colors, TexelMean(Lambert(colors))


def test_a_textured_material_counts_with_the_mean_of_its_texels():
    colors, mean = lamberts()
    directions, _ = gauss_legendre_hemisphere(4, 8)
    values = mean.evaluate(directions, directions[:1])
    np.testing.assert_allclose(values, np.broadcast_to(colors.mean(axis=0) / np.pi, values.shape), rtol=1e-12)


def test_the_mean_of_texels_draws_what_its_density_says():
    _, mean = lamberts()
    uniforms = jnp.asarray(np.random.default_rng(4).uniform(size=(2000, 3)))
    wo = jnp.asarray([[0.0, 0.6, 0.8]])
    drawn = mean.sample(wo, uniforms)
    assert np.all(np.asarray(drawn[:, 2]) > 0)
    # Each draw weighs by 1 / pdf: the hemisphere's cosine integral is pi.
    assert np.mean(drawn[:, 2] / mean.pdf(drawn, wo)) == pytest.approx(np.pi, rel=1e-9)


def test_the_mean_over_a_map_is_close_to_the_mean_over_all_its_texels():
    material = axf.read(SVBRDF).material()
    directions, _ = gauss_legendre_hemisphere(3, 5)
    wo = jnp.asarray([0.6, 0.0, 0.8])
    every = TexelMean(axf.to_brdf(material, rows=np.repeat(np.arange(64), 64), columns=np.tile(np.arange(64), 64)))
    found, true = (model.evaluate(directions, wo) for model in (brdf_of(material), every))
    assert np.sqrt(np.mean((found - true) ** 2)) < 0.03 * np.sqrt(np.mean(true**2))
