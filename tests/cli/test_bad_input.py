"""Input that cannot be used: one line that names file, node and mend, exit code 2, and nothing left behind."""

import json
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch, main
from tests.conftest import PROJECT

SVBRDF = PROJECT / "data_synthetic" / "brushed_carbon" / "brushed_carbon.axf"
PAINT = PROJECT / "data_synthetic" / "metallic_paint" / "metallic_paint.axf"
SAMPLES = PROJECT / "data_synthetic" / "noisy_car_paint" / "noisy_car_paint.mbsdf"


def missing(folder: Path) -> Path:
    return folder / "missing.axf"


def text_called_axf(folder: Path) -> Path:
    path = folder / "text.axf"
    path.write_text("this is no HDF5 file\n")
    return path


def empty_hdf5(folder: Path) -> Path:
    path = folder / "empty.axf"
    h5py.File(path, "w").close()
    return path


def empty_file(folder: Path) -> Path:
    path = folder / "nothing.axf"
    path.write_bytes(b"")
    return path


def truncated(source: Path) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = folder / f"truncated{source.suffix}"
        content = source.read_bytes()
        path.write_bytes(content[: len(content) // 2])
        return path

    return make


def edited(source: Path, change: Callable[[h5py.File], None]) -> Callable[[Path], Path]:
    """A copy of an .axf file after `change` has been at its nodes."""

    def make(folder: Path) -> Path:
        path = folder / f"edited_{source.name}"
        path.write_bytes(source.read_bytes())
        with h5py.File(path, "r+") as file:
            change(file)
        return path

    return make


def node_of(file: h5py.File, ending: str) -> h5py.Dataset:
    """The one dataset whose path ends so."""
    found: list[h5py.Dataset] = []
    file.visititems(
        lambda name, node: found.append(node) if isinstance(node, h5py.Dataset) and name.endswith(ending) else None
    )
    assert len(found) == 1, [node.name for node in found]
    return found[0]


def set_one(ending: str, value: float) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        node = node_of(file, ending)
        content = node[...]
        content.reshape(-1)[-1] = value
        node[...] = content

    return change


def flatten(ending: str) -> Callable[[h5py.File], None]:
    """The dataset with its last two axes made one."""

    def change(file: h5py.File) -> None:
        node = node_of(file, ending)
        name, content = node.name, node[...]
        assert name is not None
        del file[name]
        file[name] = content.reshape(len(content), -1)

    return change


class Case(NamedTuple):
    """Bad input: how to make it, the command for it, and what the one line must name."""

    make: Callable[[Path], Path]
    command: tuple[str, ...]
    says: tuple[str, ...]


NORMALS, LUT, COLORS = "DiffuseModel/Normal/Data", "thetaFI_sliceLUT", "BRDFcolors/Data"
VERIFY = ("verify", "{}")
FIT = ("fit", "{}", "--model", "carpaint+coat")

CASES = {
    "missing file": Case(missing, VERIFY, ("missing.axf", "no such file; give the path")),
    "text called .axf": Case(text_called_axf, VERIFY, ("text.axf", "HDF5")),
    "empty file": Case(empty_file, VERIFY, ("nothing.axf", "HDF5")),
    "empty HDF5": Case(empty_hdf5, VERIFY, ("empty.axf", "no material", "/com.xrite.Materials/")),
    "truncated .axf": Case(truncated(SVBRDF), VERIFY, ("truncated.axf", "HDF5")),
    "folder without .axf files": Case(lambda folder: folder, VERIFY, ("holds no .axf file",)),
    "NaN in a map": Case(edited(SVBRDF, set_one(NORMALS, np.nan)), VERIFY, ("edited_", "DiffuseModel/Normal", "nan")),
    "LUT entry of 300": Case(edited(PAINT, set_one(LUT, 300)), VERIFY, ("edited_", LUT, "300", "255")),
    "color table of rank 2": Case(
        edited(PAINT, flatten(COLORS)), VERIFY, ("edited_", "BRDFcolors", "rank 2", "rank 3")
    ),
    "unknown material": Case(lambda _: PAINT, (*VERIFY, "--material", "nothing"), ("'nothing'", "metallic_paint")),
    "unknown target": Case(lambda _: PAINT, (*VERIFY, "--target", "unity_1850"), ("'unity_1850'", "unity_2018")),
    "missing samples": Case(missing, FIT, ("missing.axf", "cannot be read")),
    "truncated .mbsdf": Case(truncated(SAMPLES), FIT, ("truncated.mbsdf",)),
    "no samples at all": Case(text_called_axf, FIT, ("text.axf", "no known sample format", ".mbsdf")),
    "unknown model": Case(lambda _: SAMPLES, ("fit", "{}", "--model", "ggxx"), ("'ggxx'", "carpaint", "ggx")),
    "unknown residual": Case(lambda _: SAMPLES, (*FIT, "--residual", "sine"), ("'sine'", "log", "cosine")),
    "nine lobes": Case(lambda _: SAMPLES, (*FIT, "--lobes", "9"), ("9 lobes", "1 to 4")),
    "polar limit of 0": Case(lambda _: SAMPLES, (*FIT, "--polar-limit", "0"), ("0 degrees", "at most 90")),
    "compare a text": Case(text_called_axf, ("compare", "{}", str(SAMPLES)), ("text.axf", "HDF5")),
    "compare with a text": Case(text_called_axf, ("compare", str(PAINT), "{}"), ("text.axf", "sample format")),
}


@pytest.mark.parametrize("name", CASES)
def test_one_line_names_what_is_wrong_and_nothing_is_left(name, tmp_path, capfd):
    case = CASES[name]
    results = tmp_path / "results"
    results.mkdir()
    (tmp_path / "input").mkdir()
    path = case.make(tmp_path / "input")
    command = [part.replace("{}", str(path)) for part in case.command]
    code = dispatch([*command, "--json", str(results / "a.json"), "--html", str(results / "a.html")])
    shown = capfd.readouterr()
    assert code == 2, shown
    assert shown.out == ""
    assert re.fullmatch(r"axffit: [^\n]+\n", shown.err), shown.err
    assert not [text for text in case.says if text not in shown.err], shown.err
    assert "Traceback" not in shown.err
    assert list(results.iterdir()) == []


def test_the_process_itself_says_one_line(tmp_path):
    path = text_called_axf(tmp_path)
    shown = subprocess.run(
        [sys.executable, "-m", "axffit", "verify", str(path)], capture_output=True, text=True, check=False
    )
    assert shown.returncode == 2
    assert shown.stdout == ""
    assert re.fullmatch(r"axffit: \S*text\.axf: [^\n]+\n", shown.stderr), shown.stderr


def test_results_go_nowhere_they_cannot(tmp_path, capfd):
    assert dispatch(["verify", str(PAINT), "--json", str(tmp_path / "no" / "a.json")]) == 2
    assert "does not exist; create it" in capfd.readouterr().err
    copy = tmp_path / "paint.axf"
    copy.write_bytes(PAINT.read_bytes())
    assert dispatch(["verify", str(copy), "--json", str(copy)]) == 2
    assert "is read by this run" in capfd.readouterr().err
    assert copy.read_bytes() == PAINT.read_bytes()


def test_nan_in_the_index_of_refraction_is_counted_and_not_refused(tmp_path):
    material = axf.read(SVBRDF).material()
    ior = material.textures["clearcoatior"]
    holes = ior.data.copy()
    holes[0, :3] = np.nan
    path = tmp_path / "holes.axf"
    textures = {**material.textures, "clearcoatior": replace(ior, levels=(holes,))}
    axf.write(path, replace(material, textures=textures))
    assert dispatch(["verify", str(path), "--no-bounds", "--json", str(tmp_path / "verdict.json")]) in (0, 1)
    (entry,) = json.loads((tmp_path / "verdict.json").read_text())["materials"]
    replaced = {row["axf_name"]: row["replaced"] for row in entry["verdict"]["textures"]}
    assert replaced["clearcoatior"] == np.isnan(holes).sum()


def test_a_fault_of_axffit_is_told_apart_from_bad_input(monkeypatch, capfd):
    from axffit.cli import verify

    def breaks(*_, **__):
        raise ZeroDivisionError("oh")

    monkeypatch.setattr(verify, "run", breaks)
    with pytest.raises(SystemExit) as end:
        main(["verify", str(PAINT)])
    assert end.value.code == 70
    assert isinstance(end.value.__cause__, ZeroDivisionError)
    assert "Traceback" in (shown := capfd.readouterr().err)
    assert "fault of axffit" in shown
