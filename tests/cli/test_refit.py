"""`axffit refit`: what it writes, what it says, what it refuses."""

import json

import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch
from tests.conftest import PROJECT
from tests.targets.materials import paint, ward

LEATHER = PROJECT / "data_synthetic" / "AxFSvbrdf_1_0_Dir" / "leather.axf"


@pytest.fixture
def both(tmp_path):
    path = tmp_path / "both.axf"
    axf.write(path, axf.AxfFile((ward(), paint())))
    return path


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (["--to", "ggx"], "it holds several materials"),
        (["--to", "disney", "--material", "ward"], "unknown model 'disney'"),
        (["--to", "ggx", "--material", "ward"], "ggx+coat keeps it"),
        (["--to", "ggx+coat", "--material", "ward", "--residual", "noise"], "no noise"),
        (["--to", "ggx+coat", "--material", "ward", "--normalization", "microfacet"], "for --textures alone"),
        (["--to", "ggx+coat", "--material", "ward", "--normalization", "pbr"], "unknown normalization 'pbr'"),
        (["--to", "ggx+coat", "--material", "ward", "--texels", "0"], "--texels 0"),
    ],
)
def test_what_cannot_be_done_is_said(both, options, problem, capsys):
    assert dispatch(["refit", str(both), *options]) == 2
    assert problem in capsys.readouterr().err


@pytest.mark.slow
def test_a_material_is_refitted_and_written(tmp_path, capsys):
    out, textures, content = tmp_path / "ggx.axf", tmp_path / "engine", tmp_path / "refit.json"
    options = ["--to", "ggx", "--texels", "2", "--out", str(out), "--textures", str(textures), "--json", str(content)]
    assert dispatch(["refit", str(LEATHER), *options]) == 0
    shown = capsys.readouterr().out
    assert "as ggx, loss at 2 texels" in shown
    (before,), (after,) = (axf.read(path).materials for path in (LEATHER, out))
    assert (before.specular_model, after.specular_model) == ("Ward", "GGX")
    np.testing.assert_array_equal(after.textures["normal"].data, before.textures["normal"].data)
    assert after.metadata["refitted_from"].startswith("Ward")
    written = json.loads((textures / after.id / "material.json").read_text(encoding="utf-8"))
    assert written["target"] == "unity_2018"
    said = json.loads(content.read_text(encoding="utf-8"))
    assert said["schema"] == "axffit.refit"
    assert 0 < said["loss"]["metrics"]["log"]["mean"] <= said["loss"]["metrics"]["log"]["max"]
    assert said["loss"]["brdf_found"]["peak_relative"] > 0
    assert said["interpolation"] < 0.05
