"""`axffit export` on the bundled materials."""

import json
import os
import re
import subprocess
import sys

import jsonschema
import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch, export
from axffit.targets.folder_json import schema
from tests.conftest import PROJECT
from tests.targets.materials import paint, ward

SVBRDF = PROJECT / "data_synthetic" / "brushed_carbon" / "brushed_carbon.axf"
PAINT = PROJECT / "data_synthetic" / "metallic_paint" / "metallic_paint.axf"


@pytest.fixture
def both(tmp_path):
    """A file of two small materials."""
    path = tmp_path / "both.axf"
    axf.write(path, axf.AxfFile((ward(), paint())))
    return path


@pytest.mark.parametrize("path", [SVBRDF, PAINT], ids=lambda path: path.stem)
def test_bundled_materials_are_exported(path, tmp_path, capsys):
    out = tmp_path / "out"
    assert dispatch(["export", str(path), "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    folder = out / path.stem
    assert shown.splitlines()[-1] == str(folder)
    content = json.loads((folder / "material.json").read_text())
    jsonschema.validate(content, schema())
    assert content["axf"]["file"] == path.name
    for entry in content["textures"]:
        assert f"\n{entry['name']} " in shown
        assert all((folder / file["file"]).is_file() for file in entry["files"])
    assert str(tmp_path) not in (folder / "material.json").read_text()


def test_every_material_gets_a_folder_unless_one_is_named(both, tmp_path, capsys):
    assert dispatch(["export", str(both), "--out", str(tmp_path / "all")]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == [str(tmp_path / "all" / name) for name in ("ward", "paint")]
    assert dispatch(["export", str(both), "--out", str(tmp_path / "one"), "--material", "paint"]) == 0
    assert os.listdir(tmp_path / "one") == ["paint"]


@pytest.mark.parametrize("kind", ["exr", "dds", "ktx2"])
def test_one_kind_of_file_for_all(kind, both, tmp_path, capsys):
    assert dispatch(["export", str(both), "--out", str(tmp_path / "out"), "--format", kind]) == 0
    suffixes = {path.suffix for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert suffixes == {f".{kind}", ".json"}


def test_formats_and_rounding_are_those_asked_for(both, tmp_path, capsys):
    arguments = ["--texture-format", "normal=RGBA32F", "--texture-format", "_CarPaint_thetaFI_sliceLUTMap=R8_UINT"]
    out = tmp_path / "out"
    assert dispatch(["export", str(both), "--out", str(out), *arguments, "--rounding", "floor"]) == 0
    formats = {}
    for name in ("ward", "paint"):
        for entry in json.loads((out / name / "material.json").read_text())["textures"]:
            assert entry["rounding"] == "floor"
            formats[entry["axf_name"]] = entry["format"]
    assert (formats["normal"], formats["thetaFI_sliceLUT"]) == ("RGBA32F", "R8_UINT")
    assert formats["clearcoatnormal"] == "RGBA16_UNORM"


REFUSED = {
    "missing file": (["gone.axf"], "gone.axf"),
    "unknown target": (["{}", "--target", "unity_1850"], "unknown target 'unity_1850'"),
    "unknown material": (["{}", "--material", "gold"], "no material 'gold'"),
    "unknown kind of file": (["{}", "--format", "tiff"], "unknown image format 'tiff'; allowed: auto, exr"),
    "floats as PNG": (["{}", "--format", "png"], "choose auto or exr, dds, ktx2"),
    "no equals sign": (["{}", "--texture-format", "normal"], "give NAME=FORMAT"),
    "a texture twice": (["{}", *["--texture-format", "normal=RGBA32F"] * 2], "names 'normal' twice"),
    "unknown texture": (["{}", "--texture-format", "bump=R8_UNORM"], "'bump'"),
    "unknown rounding": (["{}", "--rounding", "up"], "unknown rounding 'up'"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_exported_is_one_line_and_leaves_nothing(name, both, tmp_path, capfd):
    arguments, message = REFUSED[name]
    out = tmp_path / "out"
    assert dispatch(["export", *(text.replace("{}", str(both)) for text in arguments), "--out", str(out)]) == 2
    shown = capfd.readouterr()
    assert shown.out == ""
    assert re.fullmatch(r"axffit: [^\n]+\n", shown.err), shown.err
    assert message in shown.err
    assert not out.exists()


FULL = """
import resource, signal, sys
from axffit.cli import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
limit = int(sys.argv.pop(1))
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
main(sys.argv[1:])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limit on file sizes on Windows")
@pytest.mark.parametrize(
    ("kind", "limit"),
    [
        ("auto", 20_000),
        pytest.param("exr", 9_000, marks=pytest.mark.slow),
        pytest.param("dds", 5_000, marks=pytest.mark.slow),
        pytest.param("ktx2", 30_000, marks=pytest.mark.slow),
    ],
)
def test_a_full_disk_leaves_what_was_there(kind, limit, tmp_path):
    out = tmp_path / "out"
    assert dispatch(["export", str(SVBRDF), "--out", str(out)]) == 0
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    command = ["export", str(SVBRDF), "--out", str(out), "--format", kind, "--rounding", "floor"]
    shown = subprocess.run(
        [sys.executable, "-c", FULL, str(limit), *command], capture_output=True, text=True, check=False
    )
    assert shown.returncode == 2, shown.stderr
    # Progress may stand before it, when this takes over a second.
    last = shown.stderr.splitlines()[-1]
    assert re.fullmatch(r"axffit: \S*brushed_carbon\S+: .*too large.*", last, re.IGNORECASE), shown.stderr
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before
    assert os.listdir(out) == ["brushed_carbon"]


def test_run_needs_no_command_line(tmp_path):
    stages = []
    (exported,) = export.run(SVBRDF, tmp_path, progress=lambda stage, fraction: stages.append(stage))
    assert exported.folder == tmp_path / "brushed_carbon"
    assert len(set(stages)) == 2
    assert np.all([not problem for problem in exported.problems])
