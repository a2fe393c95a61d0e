"""Global heaps: what is whole passes, what libhdf5 would walk for ever is refused."""

import subprocess
import sys

import h5py
import pytest

from axffit import axf
from axffit.axf.heaps import check_heaps
from axffit.errors import InputError


@pytest.fixture
def texts(tmp_path):
    """A file with texts of any length, and where its heap begins."""
    path = tmp_path / "a.axf"
    with h5py.File(path, "w", libver="earliest") as file:
        material = file.create_group("com.xrite.Materials/m")
        material["DiffuseColor"] = [[[1.0, 1.0, 1.0]]]
        for number in range(40):
            material.attrs[f"note {number}"] = "x" * number
    content = path.read_bytes()
    assert content.count(b"GCOL") == 1
    return path, content.index(b"GCOL")


def free_space(path, heap):
    """Where the header of the collection's free space lies."""
    content = path.read_bytes()
    place = heap + 16
    while content[place : place + 2] != b"\0\0":
        place += 16 + (int.from_bytes(content[place + 8 : place + 16], "little") + 7) // 8 * 8
    return place


def put(path, place, value):
    content = bytearray(path.read_bytes())
    content[place : place + 8] = value.to_bytes(8, "little")
    path.write_bytes(content)


def test_a_heap_that_is_whole_passes(texts):
    check_heaps(texts[0], 8)
    assert len(axf.read(texts[0]).material().extras) == 40


@pytest.mark.parametrize("case", ["free space of size 0", "a size that comes round"])
def test_a_heap_without_end_is_refused(texts, case):
    path, heap = texts
    if case == "free space of size 0":
        put(path, free_space(path, heap) + 8, 0)
    else:
        put(path, heap + 16 + 8, 2**64 - 16)
    with pytest.raises(InputError, match=rf"a.axf: damaged: the heap at byte {heap} has an object of size 0"):
        axf.read(path)


def test_libhdf5_itself_does_not_come_back(texts):
    """The control; where this fails, libhdf5 was mended and the check can go."""
    path, heap = texts
    put(path, free_space(path, heap) + 8, 0)
    command = [sys.executable, "-c", f"import h5py; h5py.File({str(path)!r})['com.xrite.Materials/m'].attrs['note 7']"]
    with pytest.raises(subprocess.TimeoutExpired):
        subprocess.run(command, timeout=3, check=False, capture_output=True)


def test_any_heap_with_changed_sizes_comes_to_an_end(texts):
    """Sizes of 0 to 2^64 - 1 in every object: either refused or walked in bounded time."""
    path, heap = texts
    for size in (0, 1, 7, 8, 2**31, 2**63, 2**64 - 8, 2**64 - 15, 2**64 - 17, 2**64 - 1):
        put(path, heap + 16 + 8, size)
        refused = (16 + (size + 7 & ~7)) % 2**64 == 0
        if refused:
            with pytest.raises(InputError):
                check_heaps(path, 8)
        else:
            check_heaps(path, 8)
