"""`axffit measured`, and fits and comparisons of any file that it reads."""

import json

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit import report
from axffit.brdf import GGX, Lambert
from axffit.cli import dispatch
from axffit.cli.compare import run as compare
from axffit.cli.fit import run as fit
from axffit.measured import Measurements, mbsdf, plain_csv
from axffit.measured.description import schema
from axffit.report.page import Run, measured_page
from tests.conftest import PROJECT
from tests.measured.makers import MAKERS

PAINT = PROJECT / "data_synthetic" / "metallic_paint" / "metallic_paint.axf"


@pytest.mark.parametrize("name", ["paint.mbsdf", "multiangle.csv"])
def test_it_says_what_a_file_holds(name, tmp_path, capsys):
    MAKERS[name](tmp_path / name)
    results = tmp_path / "out.json", tmp_path / "out.html"
    assert dispatch(["measured", str(tmp_path / name), "--json", str(results[0]), "--html", str(results[1])]) == 0
    content = json.loads(results[0].read_text())
    jsonschema.validate(content, schema())
    shown = capsys.readouterr().out
    assert shown.startswith(f"{name}: {content['provenance']['format']}\n")
    assert "reciprocity" in shown
    page = results[1].read_text()
    assert shown.splitlines()[-1] in page
    assert "Where there are samples" in page
    assert ("White furnace" in page) == bool(content["furnace"])


def test_a_file_that_is_none_is_unusable_input(tmp_path, capsys):
    (tmp_path / "a.csv").write_text("what,is,this\n1,2,3\n")
    assert dispatch(["measured", str(tmp_path / "a.csv")]) == 2
    assert "a.csv" in capsys.readouterr().err
    assert dispatch(["measured", str(tmp_path / "a.csv"), "--json", str(tmp_path / "a.csv")]) == 2


def test_the_pages_content_validates(tmp_path):
    wi, wo, weights = mbsdf.grid_directions(6, 6)
    values = np.asarray(Lambert(jnp.full(3, 0.5)).evaluate(jnp.asarray(wi), jnp.asarray(wo)))
    samples = Measurements(wi, wo, values, np.ones(len(wi), bool), weights, name="<b>made</b>")
    page = measured_page(samples, Run("axffit measured made"))
    jsonschema.validate(page.content, report.schema())
    assert "<b>made" not in page.html


@pytest.fixture
def csv(tmp_path):
    """GGX in the directions of a coarse grid, as plain CSV."""
    wi, wo, weights = mbsdf.grid_directions(12, 12)
    values = np.asarray(GGX(jnp.full(3, 0.3), jnp.array([0.4, 0.4])).evaluate(jnp.asarray(wi), jnp.asarray(wo)))
    path = tmp_path / "ggx.csv"
    plain_csv.write(path, Measurements(wi, wo, values, np.ones(len(wi), bool), weights, name="ggx"))
    return path


@pytest.mark.slow
def test_any_file_of_samples_is_fitted_and_compared(csv):
    fitted = fit(csv, model="ggx")
    assert fitted.result.outcome.ok
    assert fitted.result.metrics is not None
    assert fitted.result.metrics.relative_cosine_rms < 1e-5
    assert compare(PAINT, csv).comparison.metrics.sample_count > 1000


def test_spectra_are_fitted_as_rgb(tmp_path):
    pytest.importorskip("colour")
    path = tmp_path / "spectral.csv"
    theta = np.linspace(0, 70, 8)
    rows = [f"{a},0,{b},{phi}" + ",0.2" * 7 for a in theta for b in theta for phi in (0, 90, 180)]
    names = ",".join(str(x) for x in range(400, 701, 50))
    path.write_text(f"theta_i,phi_i,theta_o,phi_o,{names}\n" + "\n".join(rows) + "\n")
    fitted = fit(path, model="lambert")
    assert fitted.result.outcome.ok
    np.testing.assert_allclose(np.asarray(fitted.result.parameters[0].value), 0.2 * np.pi, rtol=1e-6)
