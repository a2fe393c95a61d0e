"""`axffit verify` on several files and folders: one verdict a material, one document, one page, JUnit."""

import json
from dataclasses import replace
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch, verify
from axffit.cli._materials import axf_files
from axffit.quantization.document import schema
from tests.targets.materials import paint, texture, ward

pytestmark = pytest.mark.usefixtures("few_texels")


@pytest.fixture
def files(tmp_path):
    """A file of two materials, and a folder with one more below it, which is outside tolerance."""
    both, folder = tmp_path / "both.axf", tmp_path / "folder" / "deep"
    folder.mkdir(parents=True)
    axf.write(both, axf.AxfFile((ward(size=8), paint(size=8))))
    # The F0 of an index of 3e5 is 1 as a half, and comes back as infinity.
    indices = texture(np.full((4, 4, 1), 3e5))
    outside = replace(ward(1, size=8), id="glass", textures={**ward(1, size=8).textures, "clearcoatior": indices})
    axf.write(folder / "glass.AXF", outside)
    (folder / "notes.txt").write_text("no material\n")
    return [both, folder.parent]


def test_every_material_has_its_verdict_line_case_and_section(files, tmp_path, capsys):
    results = {kind: tmp_path / f"verdicts.{kind}" for kind in ("json", "junit", "html")}
    options = [word for kind, path in results.items() for word in (f"--{kind}", str(path))]
    assert dispatch(["verify", *map(str, files), *options]) == 1
    lines = capsys.readouterr().out.splitlines()
    glass = files[1] / "deep" / "glass.AXF"

    document = json.loads(results["json"].read_text())
    jsonschema.validate(document, schema())
    entries = [(entry["file"], entry["verdict"]["material"]["id"]) for entry in document["materials"]]
    assert entries == [(str(files[0]), "ward"), (str(files[0]), "paint"), (str(glass), "glass")]
    assert [entry["verdict"]["within"] for entry in document["materials"]] == [True, True, False]
    assert not document["within"]

    assert lines[-1] == document["summary"] == "1 of 3 materials outside tolerance: glass"
    assert lines[0] == f"{files[0]}: ward for unity_2018: 11 textures, within tolerance"
    assert lines[1].startswith(f"{files[0]}: paint for unity_2018: ")
    assert [line for line in lines if line.startswith("  OUTSIDE: textures.clearcoatior.ior: inf")]

    suites = ElementTree.parse(results["junit"]).getroot().findall("testsuite")
    assert [suite.get("name") for suite in suites] == [f"{file}: {id}" for file, id in entries]
    assert [suite.get("failures") != "0" for suite in suites] == [False, False, True]

    page = results["html"].read_text()
    assert page.count("<section id=") == 3
    assert "3 materials" in page
    assert f"axffit verify {files[0]} {files[1]}" in page


def test_all_within_is_one_sentence(files, capsys):
    assert dispatch(["verify", str(files[0])]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[-1] == "2 materials, 16 textures: all within tolerance"
    assert len(shown) == 3


def test_a_material_of_each_file(files, tmp_path, capsys):
    again = tmp_path / "again.axf"
    axf.write(again, paint(size=8))
    assert dispatch(["verify", str(files[0]), str(again), "--material", "paint"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3
    assert dispatch(["verify", *map(str, files), "--material", "paint"]) == 2
    assert "glass.AXF: no material 'paint'; it holds 'glass'" in capsys.readouterr().err


def test_a_file_that_cannot_be_read_ends_the_run_before_any_work(files, tmp_path, capsys, monkeypatch):
    broken, out = tmp_path / "broken.axf", tmp_path / "verdicts.json"
    broken.write_bytes(files[0].read_bytes()[:1000])
    monkeypatch.setattr("axffit.quantization.verify", lambda *_, **__: pytest.fail("judged something"))
    assert dispatch(["verify", str(files[0]), str(broken), "--json", str(out)]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "broken.axf" in shown.err
    assert not out.exists()


def test_files_are_found_once_and_in_order(files, tmp_path):
    link = tmp_path / "link.axf"
    link.symlink_to(files[0])
    found = axf_files([files[1], files[0], link, files[0]])
    assert found == [files[1] / "deep" / "glass.AXF", files[0]]
    assert axf_files([tmp_path]) == [tmp_path / "both.axf", files[1] / "deep" / "glass.AXF"]


def test_a_result_may_not_overwrite_a_file_of_a_folder(files, capsys):
    glass = files[1] / "deep" / "glass.AXF"
    assert dispatch(["verify", str(files[1]), "--json", str(glass)]) == 2
    assert "is read by this run" in capsys.readouterr().err


def test_engines_are_checked_before_files_are_read(tmp_path, capsys):
    assert dispatch(["verify", str(tmp_path / "gone.axf"), "--target", "godot"]) == 2
    assert "unknown target 'godot'" in capsys.readouterr().err


def test_run_gives_one_after_the_other(files):
    stages = set()
    judged = verify.run(files, progress=lambda stage, fraction: stages.add(stage))
    assert not stages
    first = next(judged)
    assert (first.file, first.material.id, first.packed) == (files[0], "ward", None)
    assert {stage.partition(": ")[0] for stage in stages} == {"ward"}
