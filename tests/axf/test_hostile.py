"""Tens of thousands of hostile files: each is read, or refused in one clean way, within its limits."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from axffit import axf
from axffit.errors import InputError

PROJECT = Path(__file__).resolve().parents[2]
MATERIAL = "com.xrite.Materials/m"


def outcomes(folder, first, count, timeout):
    """What came of the inputs with the numbers first … first + count - 1; reads them in a program of its own."""
    report = folder / "outcomes.json"
    command = [sys.executable, "-m", "tests.axf.hostile_driver", str(first), str(count), str(report)]
    done = subprocess.run(command, cwd=PROJECT, capture_output=True, text=True, timeout=timeout, check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    found = json.loads(report.read_text())
    assert found["count"] == sum(found["outcomes"].values()) == count
    assert found["bad"] == {}, done.stderr[-4000:]
    return found


def test_hostile_files_are_read_or_refused(tmp_path):
    found = outcomes(tmp_path, 0, 300, 120)
    assert found["outcomes"]["read"] > 30
    assert found["outcomes"]["refused"] > 100
    assert found["valid_headers"] > 150


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_twenty_thousand_hostile_files_are_read_or_refused(tmp_path, part):
    found = outcomes(tmp_path, part * 5000, 5000, 600)
    # In all four parts at least 20 000 and 5 000.
    assert found["valid_headers"] >= 1250
    assert found["outcomes"]["read"] >= 500


def refused_unopened(path, message, named):
    """The file is refused without a look at what it names: a pipe that would wait for a writer, a file by its atime."""
    start = time.perf_counter()
    with pytest.raises(InputError, match=message):
        axf.read(path)
    assert time.perf_counter() - start < 2.0
    if named is not None:
        assert os.stat(named).st_atime_ns == LONG_AGO


LONG_AGO = 10**18
"""2001-09-09; a read makes the access time newer, also under `relatime`, since the change is newer than it."""


@pytest.fixture(params=["pipe", "file"])
def target(tmp_path, request):
    """(path, the same path if its access time tells whether it was read)."""
    path = tmp_path / "target.h5"
    if request.param == "pipe":
        os.mkfifo(path)
        return path, None
    with h5py.File(path, "w") as file:
        file["data"] = np.zeros((2, 2, 3), np.float32)
    os.utime(path, ns=(LONG_AGO, time.time_ns()))
    return path, path


def test_a_file_that_is_read_shows_it(tmp_path):
    """Without this the access times below would prove nothing."""
    path = tmp_path / "a"
    path.write_bytes(b"x")
    os.utime(path, ns=(LONG_AGO, time.time_ns()))
    path.read_bytes()
    if os.stat(path).st_atime_ns == LONG_AGO:
        pytest.skip("this file system keeps no access times (noatime)")


def test_an_external_link_is_refused_unopened(tmp_path, target):
    with h5py.File(tmp_path / "a.axf", "w") as file:
        file.create_group(MATERIAL)["Color"] = h5py.ExternalLink(str(target[0]), "/data")
    refused_unopened(tmp_path / "a.axf", "external link to another file", target[1])


def test_external_storage_is_refused_unopened(tmp_path, target):
    with h5py.File(tmp_path / "a.axf", "w") as file:
        file.create_group(MATERIAL).create_dataset("DiffuseColor", (1, 1, 3), "f4", external=[(str(target[0]), 0, 12)])
    refused_unopened(tmp_path / "a.axf", "data in an external file", target[1])


def test_a_virtual_dataset_is_refused_unopened(tmp_path, target):
    layout = h5py.VirtualLayout((2, 2, 3), "f4")
    layout[...] = h5py.VirtualSource(str(target[0]), "data", (2, 2, 3))
    with h5py.File(tmp_path / "a.axf", "w") as file:
        file.create_group(MATERIAL).create_virtual_dataset("DiffuseColor", layout)
    refused_unopened(tmp_path / "a.axf", "virtual dataset", target[1])


def test_a_virtual_dataset_over_a_pipe_would_wait(tmp_path):
    """The control: HDF5 itself opens what a virtual dataset names, and a pipe without a writer holds it up."""
    os.mkfifo(tmp_path / "target.h5")
    layout = h5py.VirtualLayout((2, 2, 3), "f4")
    layout[...] = h5py.VirtualSource(str(tmp_path / "target.h5"), "data", (2, 2, 3))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_virtual_dataset("a", layout)
    command = [sys.executable, "-c", f"import h5py; h5py.File({str(tmp_path / 'a.h5')!r})['a'][()]"]
    with pytest.raises(subprocess.TimeoutExpired):
        subprocess.run(command, timeout=3, check=False, capture_output=True)
