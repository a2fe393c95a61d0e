"""Arrays outside of memory: ordinary arrays whose pages can be given back and come again."""

import os
from pathlib import Path

import numpy as np
import pytest

from axffit.axf import scratch
from axffit.axf.scratch import LARGE, empty, let_go

SHAPE = (LARGE // 4096, 1024)
STATM = Path("/proc/self/statm")


def resident() -> int:
    """Bytes of this process in memory."""
    if not STATM.exists():
        pytest.skip("the system has no /proc/self/statm")
    return int(STATM.read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_is_given_back_and_the_values_stay():
    array = empty((4 * SHAPE[0], SHAPE[1]), np.float32)
    array[:] = np.arange(SHAPE[1])
    view = array.view()
    view.flags.writeable = False
    before = resident()
    let_go(view[5:9])
    assert before - resident() > 0.9 * array.nbytes
    np.testing.assert_array_equal(array, np.broadcast_to(np.arange(SHAPE[1]), array.shape))
    array[3, 4] = -1.0
    let_go(array)
    assert (array[3, 4], array[3, 5]) == (-1.0, 5.0)


def test_a_small_array_and_one_of_another_kind_are_left_alone():
    for array in (empty((3, 5), np.float16), np.ones(SHAPE)):
        array[:] = 7
        let_go(array, array[1])
        assert np.all(array == 7)


def test_pages_of_others_are_not_touched(tmp_path):
    (tmp_path / "zeros").write_bytes(bytes(LARGE))
    # Copy on write: given back, these pages would lose what was written.
    others = np.memmap(tmp_path / "zeros", np.uint8, mode="c")
    others[:] = 9
    let_go(others)
    assert np.all(others == 9)


def test_without_room_the_array_is_in_memory(monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full, raising=False)
    array = empty(SHAPE, np.float32)
    assert array.shape == SHAPE
    assert array.base is None
    monkeypatch.delattr(os, "posix_fallocate")
    assert scratch.empty(SHAPE, np.uint8).base is None


@pytest.mark.parametrize("dtype", ["<f4", ">f4", "<f2"])
def test_large_maps_of_a_file_are_read_as_they_are(tmp_path, dtype, monkeypatch):
    import h5py

    from axffit.axf.hdf5 import walk

    monkeypatch.setattr(scratch, "LARGE", 1000)
    values = np.random.default_rng(2).normal(size=(40, 30, 3)).astype(dtype)
    with h5py.File(tmp_path / "map.h5", "w") as file:
        file.create_dataset("map", data=values, compression="gzip")
        (leaf,) = walk(file).leaves
        found = leaf.array()
    assert found.dtype == np.dtype(dtype).newbyteorder("=")
    assert found.base is not None
    np.testing.assert_array_equal(found, values)
