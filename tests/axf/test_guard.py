"""Files on which libhdf5 itself fails end another process, not this one."""

import os
import subprocess
import sys
import time
import zlib
from pathlib import Path

import pytest

from axffit import axf
from axffit.axf import guard
from axffit.errors import InputError

HOSTILE = sorted((Path(__file__).parent / "hostile_files").glob("*.z"))


@pytest.fixture
def good(tmp_path):
    axf.write(tmp_path / "good.axf", axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF))
    return tmp_path / "good.axf"


@pytest.fixture
def program(monkeypatch):
    """Put another program in the place of the one that reads first."""
    guard._end()

    def put(text):
        monkeypatch.setattr(guard, "_COMMAND", (sys.executable, "-c", text))

    yield put
    guard._end()


def test_there_are_files():
    assert len(HOSTILE) == 3


@pytest.mark.parametrize("path", HOSTILE, ids=lambda path: path.name.split(".")[0])
def test_a_file_that_hdf5_fails_on_is_refused(path, tmp_path, good):
    """Changed bytes that crash HDF5 2.0.0 or keep it for ever; a library that was mended may say what is wrong."""
    hostile = tmp_path / "hostile.axf"
    hostile.write_bytes(zlib.decompress(path.read_bytes()))
    start = time.perf_counter()
    with pytest.raises(InputError, match="hostile.axf: "):
        axf.read(hostile)
    assert time.perf_counter() - start < 5.0
    assert axf.read(good).material().id == "m"


def test_without_it_the_crash_is_this_process(tmp_path):
    """The control; where this fails, libhdf5 was mended."""
    hostile = tmp_path / "hostile.axf"
    hostile.write_bytes(zlib.decompress(next(path for path in HOSTILE if "crash" in path.name).read_bytes()))
    program = f"from axffit import axf; axf.read({str(hostile)!r}, guarded=False)"
    done = subprocess.run([sys.executable, "-c", program], check=False, capture_output=True, timeout=60)
    assert done.returncode < 0


CASES = {
    "import os; print('ready', flush=True); input(); os.abort()": "HDF5's library crashes on it",
    "print('ready', flush=True); input(); print('declared 0', flush=True); raise SystemExit": "crashes on it",
    "import time; print('ready', flush=True); time.sleep(60)": "does not come back from it within 0 s",
    "raise SystemExit": "damaged HDF5|does not start",
}


@pytest.mark.parametrize("text", CASES)
def test_what_becomes_of_the_other_process_is_said(program, good, monkeypatch, text):
    program(text)
    if "sleep" in text:
        monkeypatch.setattr(guard, "SECONDS", 0.3)
    with pytest.raises(InputError, match=CASES[text]):
        axf.read(good)
    monkeypatch.undo()
    assert axf.read(good).material().id == "m"


def test_a_program_that_is_not_there(monkeypatch, good):
    guard._end()
    monkeypatch.setattr(guard, "_COMMAND", (str(good.parent / "nothing"),))
    with pytest.raises(InputError, match="no process can be started to read untrusted files first"):
        axf.read(good)
    assert axf.read(good, guarded=False).material().id == "m"


def test_one_process_reads_many_files(good):
    axf.read(good)
    process = guard._GUARDS[0].process.pid
    axf.read(good)
    assert guard._GUARDS[0].process.pid == process
    os.kill(process, 9)
    guard._GUARDS[0].process.wait()
    assert axf.read(good).material().id == "m"
    assert guard._GUARDS[0].process.pid != process


def test_names_of_all_sorts_reach_it(tmp_path, monkeypatch):
    path = tmp_path / "ä \n\udcff.axf"
    axf.write(path, axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF))
    monkeypatch.chdir(tmp_path)
    assert axf.read(path.name).material().id == "m"


def test_what_lies_in_the_working_folder_is_not_imported(tmp_path, good, monkeypatch):
    guard._end()
    (tmp_path / "h5py.py").write_text("raise SystemExit('hijacked')")
    monkeypatch.chdir(tmp_path)
    assert axf.read(good).material().id == "m"
    assert guard._GUARDS[0].is_usable


def test_it_does_not_import_jax(good):
    """It would start four times slower."""
    axf.read(good)
    maps = Path(f"/proc/{guard._GUARDS[0].process.pid}/maps")
    if not maps.exists():
        pytest.skip("no /proc here")
    assert "jaxlib" not in maps.read_text()
    assert "libhdf5" in maps.read_text()
