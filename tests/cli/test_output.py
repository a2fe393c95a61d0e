"""Results appear whole or not at all."""

import json

import pytest

from axffit.cli._output import check_outputs, json_text, write_all
from axffit.errors import InputError


def test_all_results_are_written(tmp_path):
    write_all(
        {
            tmp_path / "a.json": "{}",
            tmp_path / "b.html": b"<html>",
            tmp_path / "c.axf": lambda path: path.write_text("from a writer"),
        }
    )
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "a.json": "{}",
        "b.html": "<html>",
        "c.axf": "from a writer",
    }


def test_a_failing_writer_leaves_no_new_file_and_the_old_one_unchanged(tmp_path):
    old = tmp_path / "a.json"
    old.write_text("old")

    def fails(path):
        path.write_text("half")
        raise OSError("the disk is full")

    with pytest.raises(OSError, match="full"):
        write_all({old: "new", tmp_path / "b.axf": fails})
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert old.read_text() == "old"


def test_results_have_the_permissions_of_any_new_file(tmp_path):
    usual = tmp_path / "usual"
    usual.write_text("")
    write_all({tmp_path / "result": "x"})
    assert (tmp_path / "result").stat().st_mode == usual.stat().st_mode


def test_json_holds_no_nan():
    assert json.loads(json_text({"a": [1.5, "µ"]})) == {"a": [1.5, "µ"]}
    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text({"a": float("nan")})


def test_outputs_that_cannot_be_written_are_refused_before_any_work(tmp_path):
    source = tmp_path / "material.axf"
    source.write_text("")
    check_outputs([None, tmp_path / "page.html"], [source])
    with pytest.raises(InputError, match=r"page\.html: the folder .*nowhere does not exist; create it"):
        check_outputs([tmp_path / "nowhere" / "page.html"])
    with pytest.raises(InputError, match="is read by this run; choose another name"):
        check_outputs([tmp_path / "." / "material.axf"], [source])
    with pytest.raises(InputError, match="is already the name of another result"):
        check_outputs([tmp_path / "page.html", tmp_path / "page.html"])
    with pytest.raises(InputError, match="is a folder; give the name of a file"):
        check_outputs([tmp_path])
