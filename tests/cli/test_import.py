"""`axffit import` reverses `axffit export`."""

import json
import re

import pytest

from axffit import axf
from axffit.axf import AxfFile
from axffit.cli import dispatch, import_
from axffit.targets import unity_2018
from tests.conftest import PROJECT
from tests.targets.materials import paint, ward

PACKAGES = sorted((PROJECT / "data_synthetic").glob("*/*.axf"))


@pytest.fixture
def exported(tmp_path):
    """The folders of two small materials."""
    axf.write(tmp_path / "both.axf", AxfFile((ward(), paint()), version=(1, 2, 3)))
    assert dispatch(["export", str(tmp_path / "both.axf"), "--out", str(tmp_path / "out")]) == 0
    return tmp_path / "out"


@pytest.mark.parametrize("path", PACKAGES, ids=lambda path: path.stem)
def test_what_was_exported_comes_back_as_the_engine_sees_it(path, tmp_path, capsys):
    out, new = tmp_path / "out", tmp_path / "new.axf"
    assert dispatch(["export", str(path), "--out", str(out)]) == 0
    assert dispatch(["import", str(out), "--out", str(new)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(new)
    before, after = axf.read(path), axf.read(new)
    assert after.version == before.version
    assert len(after.materials) == len(before.materials)
    for material, found in zip(before.materials, after.materials, strict=True):
        assert found.identical(unity_2018.unpack(unity_2018.pack(material), defaults=False))


def test_importing_and_exporting_again_changes_nothing(exported, tmp_path):
    new, again = tmp_path / "new.axf", tmp_path / "again"
    assert dispatch(["import", str(exported), "--out", str(new)]) == 0
    assert dispatch(["export", str(new), "--out", str(again)]) == 0
    for path in exported.rglob("*"):
        if path.is_file() and path.suffix != ".json":
            assert (again / path.relative_to(exported)).read_bytes() == path.read_bytes()


def test_one_folder_of_several(exported, tmp_path, capsys):
    assert dispatch(["import", str(exported / "paint"), "--out", str(tmp_path / "paint.axf")]) == 0
    assert [material.id for material in axf.read(tmp_path / "paint.axf").materials] == ["paint"]
    assert "synthetic paint (paint): CarPaint2, btfflakes" in capsys.readouterr().out.replace("brdfcolors, ", "")


def drop_values(content):
    content["values"] = {}


def unknown_target(content):
    content["target"] = "unity_1850"


@pytest.mark.parametrize(("change", "message"), [(unknown_target, "'unity_1850'"), (drop_values, "")])
def test_a_changed_description_never_ends_in_a_traceback(change, message, exported, tmp_path, capfd):
    path = exported / "paint" / "material.json"
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))
    capfd.readouterr()
    code = dispatch(["import", str(exported), "--out", str(tmp_path / "new.axf")])
    shown = capfd.readouterr()
    assert code == (2 if message else 0), shown.err
    assert "Traceback" not in shown.err
    assert message in shown.err


@pytest.mark.parametrize("name", ["_SVBRDF_NormalMap.png", "_SVBRDF_HeightMap.exr", "material.json"])
def test_a_file_that_is_cut_off_is_named_and_nothing_is_written(name, exported, tmp_path, capfd):
    path = exported / "ward" / name
    path.write_bytes(path.read_bytes()[:-20])
    capfd.readouterr()
    assert dispatch(["import", str(exported), "--out", str(tmp_path / "new.axf")]) == 2
    shown = capfd.readouterr()
    assert re.fullmatch(rf"axffit: [^\n]*{re.escape(name)}[^\n]*\n", shown.err), shown.err
    assert shown.out == ""
    assert not (tmp_path / "new.axf").exists()


def test_folders_that_are_none_are_refused(tmp_path, capfd):
    for folder in (tmp_path, tmp_path / "missing"):
        assert dispatch(["import", str(folder), "--out", str(tmp_path / "new.axf")]) == 2
        assert re.fullmatch(r"axffit: [^\n]+axffit export wrote\n", capfd.readouterr().err)


def test_two_materials_of_one_id_are_refused(exported, tmp_path, capfd):
    (exported / "paint").rename(tmp_path / "aside")
    axf.write(tmp_path / "ward.axf", ward())
    assert dispatch(["export", str(tmp_path / "ward.axf"), "--out", str(tmp_path / "more")]) == 0
    (tmp_path / "more" / "ward").rename(exported / "again")
    capfd.readouterr()
    assert dispatch(["import", str(exported), "--out", str(tmp_path / "new.axf")]) == 2
    assert "share the id 'ward'" in capfd.readouterr().err


def test_run_needs_no_command_line(exported, tmp_path):
    stages = []
    file = import_.run(exported, tmp_path / "new.axf", progress=lambda stage, fraction: stages.append(stage))
    assert [material.id for material in file.materials] == ["ward", "paint"]
    assert file.version == (1, 2, 3)
    assert "writing new.axf" in stages
