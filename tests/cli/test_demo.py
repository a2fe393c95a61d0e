"""`axffit demo`: the page, its JSON, and where they go."""

import json
import os
from pathlib import Path

import pytest

import axffit
from axffit.cli import demo, dispatch
from tests.conftest import PROJECT


@pytest.mark.slow
def test_quick_demo_writes_the_page_and_names_it_last(tmp_path, capsys):
    out = tmp_path / "reports" / "latest"
    assert dispatch(["demo", "--quick", "--out", str(out)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(out / "index.html")
    assert sorted(path.name for path in out.iterdir()) == ["index.html", "materials", "report.json"]
    content = json.loads((out / "report.json").read_text())
    assert [section["kind"] for section in content["sections"]] == ["verify", "verify", "fit"]
    assert content["within"]
    assert content["sections"][2]["result"]["ok"]
    page = (out / "index.html").read_text()
    assert not [section["title"] for section in content["sections"] if section["title"] not in page]


def test_a_folder_that_cannot_be_made_is_named(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert dispatch(["demo", "--out", str(tmp_path / "file" / "demo")]) == 2
    assert "file/demo: the folder cannot be made" in capsys.readouterr().err


def test_a_size_that_is_not_made_is_refused(tmp_path, capsys):
    assert dispatch(["demo", "--size", "63", "--out", str(tmp_path)]) == 2
    assert "size 63; allowed: 64, 512" in capsys.readouterr().err


def test_without_a_folder_the_page_goes_to_the_clone_or_to_a_temporary_one(monkeypatch, tmp_path):
    assert demo.clone() == PROJECT
    assert demo.default_folder() == PROJECT / "reports" / "latest"
    monkeypatch.setattr(axffit, "__file__", str(tmp_path / "site-packages" / "axffit" / "__init__.py"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    assert demo.clone() is None
    assert demo.default_folder().parent == tmp_path


def test_real_paints_are_those_of_the_named_folder_that_are_there(monkeypatch, tmp_path):
    monkeypatch.setenv("AXFFIT_REFERENCE_DATA", str(tmp_path))
    assert demo.reference_samples() == []
    there = tmp_path / demo.REFERENCES[0].file
    there.parent.mkdir()
    there.write_bytes(b"")
    assert demo.reference_samples() == [demo.REFERENCES[0]._replace(file=there)]


def test_without_a_named_folder_and_a_clone_there_are_no_real_paints(monkeypatch):
    monkeypatch.delenv("AXFFIT_REFERENCE_DATA", raising=False)
    monkeypatch.setattr(demo, "clone", lambda: None)
    assert demo.reference_samples() == []


def test_the_reference_data_hold_every_real_paint(reference_data, monkeypatch):
    folder = Path(os.path.commonpath([reference_data(samples.file.parts[0]) for samples in demo.REFERENCES]))
    monkeypatch.setenv("AXFFIT_REFERENCE_DATA", str(folder))
    assert [samples.file.name for samples in demo.reference_samples()] == [s.file.name for s in demo.REFERENCES]
