"""The committed synthetic packages are what the generator makes, bit for bit."""

import runpy
import sys
from pathlib import Path

import pytest

from axffit import axf
from axffit.errors import InputError
from axffit.synthesis import PACKAGES, generate

COMMITTED = Path(__file__).resolve().parents[2] / "data_synthetic"


@pytest.fixture(scope="module")
def regenerated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("synthetic")
    return folder, generate(folder)


@pytest.mark.parametrize("name", sorted(PACKAGES))
def test_the_committed_files_are_reproduced(regenerated, name):
    folder, written = regenerated
    paths = [path for path in written if path.parent.name == name]
    assert sorted(path.name for path in paths) == sorted(path.name for path in (COMMITTED / name).iterdir())
    for path in paths:
        committed = COMMITTED / path.relative_to(folder)
        if path.suffix == ".axf":
            # The container may differ by the versions of HDF5 and zlib; the content may not.
            found, expected = axf.read(path), axf.read(committed)
            assert found.version == expected.version
            assert len(found.materials) == len(expected.materials)
            for a, b in zip(found.materials, expected.materials, strict=True):
                assert a.identical(b)
        else:
            assert path.read_bytes() == committed.read_bytes()


def test_one_generator_writes_the_same_bytes_twice(regenerated, tmp_path):
    folder, _ = regenerated
    for path in generate(tmp_path, packages=["metallic_paint"]):
        assert path.read_bytes() == (folder / path.relative_to(tmp_path)).read_bytes()


def test_the_committed_files_stay_small():
    files = [path for path in COMMITTED.rglob("*") if path.is_file() and path.suffix != ".py"]
    assert sum(path.stat().st_size for path in files if "__pycache__" not in path.parts) <= 5e6


@pytest.mark.parametrize("path", sorted(COMMITTED.glob("*/*.axf")), ids=lambda path: path.name)
def test_every_material_is_labeled_synthetic_and_read_completely(path):
    file = axf.read(path)
    assert not file.unrecognized
    assert not file.inferred
    for material in file.materials:
        assert material.metadata["synthetic"].startswith("yes")
        assert not material.unrecognized
        assert not material.inferred


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": 100}, "size 100; allowed: 64, 512"),
        ({"packages": ["nothing"]}, "unknown package 'nothing'; allowed: brushed_carbon"),
    ],
    ids=str,
)
def test_what_is_not_made_is_refused(tmp_path, options, message):
    with pytest.raises(InputError, match=message):
        generate(tmp_path, **options)
    assert not list(tmp_path.iterdir())


def test_the_script_writes_where_it_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["generate.py", "--out", str(tmp_path)])
    runpy.run_path(str(COMMITTED / "generate.py"), run_name="__main__")
    assert {path.name for path in tmp_path.iterdir()} == set(PACKAGES)
    assert "metallic_paint.axf" in capsys.readouterr().out
