"""What axffit writes is read by others: h5py alone, and h5dump of Debian's HDF5 1.10; and by itself, bit for bit."""

import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given, settings

from axffit import axf
from axffit.axf.names import TEXTURES
from axffit.testing.strategies import axf_files
from tests.tools import find_tool, run_tool

PROJECT = Path(__file__).resolve().parents[2]
PACKAGES = sorted(PROJECT.glob("data_synthetic/*/*.axf"))


def test_there_are_packages():
    assert len(PACKAGES) >= 2


@pytest.fixture(params=PACKAGES, ids=lambda path: path.stem)
def package(request):
    return request.param


def test_a_package_is_written_and_read_bit_for_bit(package, tmp_path):
    first = axf.read(package)
    axf.write(tmp_path / "again.axf", first)
    second = axf.read(tmp_path / "again.axf")
    assert second.version == first.version
    assert first.unrecognized == second.unrecognized == ()
    for a, b in zip(first.materials, second.materials, strict=True):
        assert a.identical(b)
        assert a.unrecognized == b.unrecognized == a.inferred == b.inferred == ()


@pytest.mark.slow
@settings(max_examples=500)
@given(file=axf_files())
def test_500_materials_are_written_and_read_bit_for_bit(file, tmp_path_factory):
    path = tmp_path_factory.mktemp("round") / "a.axf"
    axf.write(path, file)
    found = axf.read(path)
    assert found.version == file.version
    for a, b in zip(found.materials, file.materials, strict=True):
        assert a.identical(b)
        assert a.unrecognized == a.inferred == ()


def test_h5py_alone_reads_a_package(package):
    with h5py.File(package) as file:
        root: Any = file.attrs
        version = tuple(int(root[f"axf.version.{part}"]) for part in ("major", "minor", "revision"))
        assert version == axf.read(package).version
        for material in axf.read(package).materials:
            resources: Any = file[f"com.xrite.Materials/{material.id}/com.xrite.Resources"]
            for key, texture in material.textures.items():
                node = resources[TEXTURES[key].node]
                assert node["Data"][()].tobytes() == texture.data.tobytes()
                assert node["Data"].dtype == texture.data.dtype
                assert (node["WidthMM"][()], node["HeightMM"][()]) == (texture.width_mm, texture.height_mm)


def test_h5dump_reads_a_package(package, tmp_path):
    """The values themselves: h5dump writes each map as raw bytes."""
    tool = find_tool("h5dump", mend="Debian: hdf5-tools")
    listing = run_tool([tool, "-n", package], tmp_path)
    for material in axf.read(package).materials:
        base = f"/com.xrite.Materials/{material.id}/com.xrite.Resources"
        for key, texture in material.textures.items():
            for number, level in enumerate(texture.levels):
                node = f"{base}/{TEXTURES[key].node}/" + ("Data" if number == 0 else f"Level{number}")
                assert re.search(rf"dataset\s+{re.escape(node)}\n", listing)
                run_tool([tool, "-d", node, "-b", "FILE", "-o", tmp_path / "raw.bin", package], tmp_path)
                raw = np.fromfile(tmp_path / "raw.bin", level.dtype.newbyteorder("<"))
                np.testing.assert_array_equal(raw.reshape(level.shape), level)


def test_h5dump_reads_what_was_written_back(tmp_path):
    tool = find_tool("h5dump", mend="Debian: hdf5-tools")
    with h5py.File(tmp_path / "a.axf", "w") as file:
        material = file.create_group("com.xrite.Materials/m")
        material["DiffuseColor"] = np.ones((1, 1, 3), np.float32)
        material["pair"] = np.array([(1, 2.5)], np.dtype([("x", "i4"), ("y", "f8")]))
        material["soft"] = h5py.SoftLink("/somewhere")
        material.attrs["author"] = "nobody"
    axf.write(tmp_path / "b.axf", axf.read(tmp_path / "a.axf"))
    dump = run_tool([tool, tmp_path / "b.axf"], tmp_path)
    assert re.search(r'DATASET "pair" \{\s+DATATYPE\s+H5T_COMPOUND', dump)
    assert re.search(r"\(0\): \{\s+1,\s+2.5\s+\}", dump)
    assert re.search(r'SOFTLINK "soft" \{\s+LINKTARGET "/somewhere"', dump)
    assert re.search(r'ATTRIBUTE "author"', dump)
