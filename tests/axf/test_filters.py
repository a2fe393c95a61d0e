"""Filters are run only where they cannot crash."""

import subprocess
import sys

import h5py
import numpy as np
import pytest

from axffit import axf
from axffit.errors import InputError

COLOR = "com.xrite.Materials/m/DiffuseColor"
VALUES = np.random.default_rng(0).random((6, 6, 3)).astype(np.float32)


def stored(path, name=COLOR, values: np.ndarray = VALUES, **options):
    with h5py.File(path, "a", libver="earliest") as file:
        file.create_dataset(name, data=values, chunks=tuple(min(3, n) for n in values.shape), **options)
    return path


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"compression": "gzip"},
        {"compression": "lzf"},
        {"shuffle": True, "compression": "gzip", "fletcher32": True},
        {"fletcher32": True},
    ],
    ids=str,
)
def test_the_usual_filters_are_read(tmp_path, options):
    found = axf.read(stored(tmp_path / "a.axf", **options)).material().textures["diffusecolor"]
    np.testing.assert_array_equal(found.data, VALUES)


def short_chunk(path):
    """A file whose first chunk states 2 bytes, below the 4 of its checksum."""
    stored(path, fletcher32=True)
    with h5py.File(path) as file:
        dataset = file[COLOR]
        assert isinstance(dataset, h5py.Dataset)
        size = dataset.id.get_chunk_info(0).size
    content = bytearray(path.read_bytes())
    # In the chunks' B-tree each key begins with the size and a filter mask of 0.
    place = content.index(size.to_bytes(4, "little") + bytes(4), content.index(b"TREE\1"))
    content[place : place + 4] = (2).to_bytes(4, "little")
    path.write_bytes(content)
    return path


def test_a_chunk_too_short_for_its_checksum_is_refused(tmp_path):
    with pytest.raises(InputError, match=f"/{COLOR}: cannot be read .a chunk is too short for its checksum"):
        axf.read(short_chunk(tmp_path / "a.axf"))


def test_libhdf5_itself_crashes(tmp_path):
    """The control; where this fails, libhdf5 was mended and the check can go."""
    path = short_chunk(tmp_path / "a.axf")
    command = [sys.executable, "-c", f"import h5py; h5py.File({str(path)!r})[{COLOR!r}][()]"]
    assert subprocess.run(command, timeout=30, check=False, capture_output=True).returncode < 0


def test_another_filter_is_named_and_where_nobody_needs_it_listed(tmp_path):
    numbers = np.arange(9, dtype=np.int32)
    path = stored(tmp_path / "a.axf")
    stored(path, "com.xrite.Materials/m/note", numbers, scaleoffset=0)
    material = axf.read(path).material()
    (line,) = material.unrecognized
    assert "m/note (not kept: its filter 6 is not read; those that are: deflate, shuffle, fletcher32, lzf)" in line
    with h5py.File(path, "a") as file:
        del file[COLOR]
    stored(path, COLOR, VALUES, scaleoffset=4)
    with pytest.raises(InputError, match="DiffuseColor: cannot be read .its filter 6 is not read"):
        axf.read(path)


def test_a_checksum_below_another_filter_is_refused(tmp_path):
    """Behind deflate a chunk may have any size, also below the checksum's."""
    with h5py.File(tmp_path / "a.axf", "w") as file:
        group = file.create_group("com.xrite.Materials/m")
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        properties.set_chunk((1, 1, 3))
        properties.set_fletcher32()
        properties.set_deflate(1)
        space = h5py.h5s.create_simple((1, 1, 3))
        dataset = h5py.h5d.create(group.id, b"DiffuseColor", h5py.h5t.IEEE_F32LE, space, properties)
        dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, np.ones((1, 1, 3), np.float32))
    with pytest.raises(InputError, match="its filter fletcher32 is not the last one"):
        axf.read(tmp_path / "a.axf")
