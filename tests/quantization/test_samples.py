"""Texels of the BRDF sample: the worst ones first, the rest at random, the same every time."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.axf import AxfTexture
from axffit.quantization import samples
from axffit.quantization.maps import map_errors
from axffit.quantization.samples import sample_texels
from axffit.targets import unity_2018
from tests.targets.materials import texture, unit_normals, ward


def errors_of(material):
    packed = unity_2018.pack(material)
    return {
        t.axf_name: map_errors(material.textures[t.axf_name], t, unity_2018.reading(t, packed.values))
        for t in packed.textures.values()
        if not t.defaulted
    }


def cell(uv, size):
    return {tuple(int(i) for i in pair) for pair in np.floor(uv * size).astype(int)}


def test_a_small_grid_is_taken_whole():
    uv = sample_texels(ward(size=8), {}, 64)
    assert len(cell(uv, 8)) == 64


def test_the_worst_texel_of_every_map_is_in():
    material = ward(size=64)
    errors = errors_of(material)
    taken = cell(sample_texels(material, errors, 256), 64)
    assert len(taken) == 256
    for key in errors:
        place = errors[key].statistics[0].where
        assert (place.column, place.row) in taken
    lobe = material.textures["specularlobe"].data[..., 0]
    row, column = np.unravel_index(np.argmin(lobe), lobe.shape)
    assert (int(column), int(row)) in taken


def test_the_sample_is_the_same_every_time():
    material = ward(size=64)
    errors = errors_of(material)
    np.testing.assert_array_equal(sample_texels(material, errors, 100), sample_texels(material, errors, 100))


def test_maps_of_other_sizes_are_met_at_the_same_place():
    material = ward(size=64)
    normals = unit_normals(np.random.default_rng(1), (16, 16))
    half_size = AxfTexture((normals.astype(np.float32),), 15.0, 15.0)
    material = replace(
        material, textures={**material.textures, "normal": half_size, "height": texture(np.zeros((1, 1, 1)))}
    )
    errors = errors_of(material)
    place = errors["normal"].statistics[0].where
    taken = cell(sample_texels(material, errors, 256), 64)
    # 15 of 30 mm in 16 texels: texel (r, c) covers two by two texels of the grid's first quarter.
    assert (2 * place.column + 1, 2 * place.row + 1) in taken


@pytest.mark.parametrize("values", ["noise", "rising", "equal", "few", "with NaN"])
def test_the_ends_of_a_channel_are_found_run_by_run(values, monkeypatch):
    monkeypatch.setattr(samples, "_RUN", 7)
    rng = np.random.default_rng(4)
    channel = {
        "noise": rng.normal(size=100),
        "rising": np.arange(100.0),
        "equal": np.ones(100),
        "few": np.array([2.0, 1.0]),
        "with NaN": np.where(rng.random(100) < 0.2, np.nan, rng.normal(size=100) + 0.5),
    }[values].astype(np.float32)
    numbers = np.nan_to_num(channel)
    count = min(samples.EXTREMES, channel.size)
    ends = samples._ends(channel)
    np.testing.assert_array_equal(numbers[ends[:count]], np.sort(numbers)[::-1][:count])
    np.testing.assert_array_equal(numbers[ends[count:]], np.sort(numbers)[:count])
