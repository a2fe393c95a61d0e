"""`axffit verify` on the bundled materials."""

import json
import re
import sys

import jsonschema
import pytest

from axffit.cli import dispatch, verify
from axffit.quantization.bounds import Bounds, TexelClass
from axffit.quantization.document import schema
from axffit.quantization.material_bounds import BoundedClass, MaterialBounds
from axffit.quantization.tolerances import KINDS, Kind
from tests.conftest import PROJECT

SVBRDF = PROJECT / "data_synthetic" / "brushed_carbon" / "brushed_carbon.axf"
PAINT = PROJECT / "data_synthetic" / "metallic_paint" / "metallic_paint.axf"


@pytest.mark.parametrize("path", [SVBRDF, PAINT], ids=lambda path: path.stem)
def test_bundled_materials_are_within_tolerance(path, tmp_path, capsys):
    results = tmp_path / "verdict.json", tmp_path / "page.html"
    code = dispatch(["verify", str(path), "--json", str(results[0]), "--html", str(results[1]), "--no-bounds"])
    shown = capsys.readouterr().out
    assert code == 0, shown
    document = json.loads(results[0].read_text())
    jsonschema.validate(document, schema())
    (entry,) = document["materials"]
    assert (entry["file"], entry["packed"]) == (str(path), None)
    content = entry["verdict"]
    # Each texture has its line, the outcome is the last.
    assert not [row["axf_name"] for row in content["textures"] if f"\n{row['axf_name']}" not in shown]
    assert shown.splitlines()[-1] == content["summary"]
    page = results[1].read_text()
    assert content["material"]["name"] in page
    assert f"axffit verify {path}" in page


def test_a_tolerance_that_is_exceeded_is_named_and_ends_in_1(tmp_path, capsys):
    limits = tmp_path / "strict.toml"
    limits.write_text("[textures.normal.angle]\nlimit = 1e-4\n")
    verdict = tmp_path / "verdict.json"
    assert dispatch(["verify", str(SVBRDF), "--tolerance", str(limits), "--json", str(verdict), "--no-bounds"]) == 1
    outside = [line for line in capsys.readouterr().out.splitlines() if line.startswith("OUTSIDE")]
    assert len(outside) == 1
    assert re.match(r"OUTSIDE: textures\.normal\.angle: 0\.00\d+ > 0\.0001", outside[0])
    assert not json.loads(verdict.read_text())["within"]


@pytest.mark.parametrize(("text", "says"), [("[textures.normal.angle]\nlimit = -1\n", "limit = -1"), ("]", "no TOML")])
def test_a_bad_tolerance_file_is_named(tmp_path, capsys, text, says):
    limits = tmp_path / "bad.toml"
    limits.write_text(text)
    assert dispatch(["verify", str(SVBRDF), "--tolerance", str(limits)]) == 2
    assert (shown := capsys.readouterr()).out == ""
    assert f"{limits}: " in shown.err
    assert says in shown.err


def test_another_engine_reads_the_angle_at_half_and_ends_in_1(tmp_path, capsys):
    verdict, page = tmp_path / "verdict.json", tmp_path / "page.html"
    engines = ["--packed-for", "unity_2018", "--read-by", "hdrp_10", "--no-bounds"]
    assert dispatch(["verify", str(SVBRDF), *engines, "--json", str(verdict), "--html", str(page)]) == 1
    shown = capsys.readouterr().out.splitlines()
    mismatch = next(line for line in shown if line.startswith("OUTSIDE: mismatch: _SVBRDF_AnisoRotationMap"))
    for words in ("anisrotation", "0.5 (1 + x / pi)", "0.5 (1 + x / (pi/2))", "degrees off"):
        assert words in mismatch
    content = json.loads(verdict.read_text())["materials"][0]["verdict"]
    row = next(row for row in content["textures"] if row["axf_name"] == "anisrotation")
    assert (row["unit"], row["within"]) == ("degrees", False)
    assert row["max"] > 80
    assert [each["axf_name"] for each in content["textures"] if not each["within"]] == ["anisrotation"]
    assert shown[0] == "Brushed steel in carbon fiber (synthetic), packed for unity_2018, read by hdrp_10"
    text = page.read_text()
    assert f"axffit verify {SVBRDF} --packed-for unity_2018 --read-by hdrp_10 --no-bounds" in text
    assert "<h1>Brushed steel in carbon fiber (synthetic), packed for unity_2018, read by hdrp_10</h1>" in text


def test_an_unknown_engine_is_named(capsys):
    assert dispatch(["verify", str(SVBRDF), "--read-by", "godot"]) == 2
    assert "unknown target 'godot'; allowed: unity_2018, hdrp_10, png16, unreal, mdl" in capsys.readouterr().err


def test_what_is_found_and_what_is_proved_is_shown(tmp_path, capsys, few_texels, monkeypatch):
    def shown(*arguments):
        dispatch(["verify", str(PAINT), *arguments])
        return [line for line in capsys.readouterr().out.splitlines() if line.startswith("reflectance, ")]

    for line in shown("--no-bounds"):
        assert re.search(r"0\.00\d+, found only: left out on request \(tolerance", line)
    bounds: dict[Kind, Bounds] = {kind: Bounds(0.002, 1) for kind in KINDS}
    proved = MaterialBounds((BoundedClass(TexelClass(1e-5), 4096, 0, bounds),), 3)
    monkeypatch.setattr(sys.modules["axffit.quantization.verify"], "material_bounds", lambda *_: proved)
    page, junit = tmp_path / "page.html", tmp_path / "junit.xml"
    for line in shown("--html", str(page), "--junit", str(junit)):
        assert re.search(r"\[found, bound\] = \[0\.00\d+, 0\.002\d*\] \(tolerance 0\.\d+\), within", line)
    assert re.search(r"0\.200?\s%", page.read_text())
    assert junit.read_text().count("[found, bound] = [0.00") == 2


def test_run_needs_no_command_line():
    stages = []
    (verified,) = verify.run([PAINT], bounds=False, progress=lambda stage, fraction: stages.append((stage, fraction)))
    assert verified.verdict.within
    assert verified.material.id == "metallic_paint"
    assert all(0.0 <= fraction <= 1.0 for _, fraction in stages)
    assert len({stage for stage, _ in stages}) > 1
