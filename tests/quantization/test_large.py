"""A large material, verified by the program in a process of its own: memory, progress, and every texel measured.

The material of 4096² texels is experiments/11_large_material.py; here it is one of 1024², and one whose arrays are made
to lie in files.
"""

import json

import numpy as np
import pytest

from axffit import axf
from axffit.axf import scratch
from axffit.quantization.maps import map_errors
from axffit.targets import unity_2018
from experiments import common

NAME = "11_large_material"


@pytest.fixture(scope="module")
def large():
    return common.load(NAME)


@pytest.mark.slow
def test_a_material_of_1024_texels_a_side(large, tmp_path):
    axf.write(tmp_path / "large.axf", large.material(1024))
    result = large.measured(tmp_path / "large.axf")
    assert result["verdict"] is not None, result["progress"]
    # 96 MiB of maps, and their codes and errors; Python, JAX and its compiler are half a GiB without any.
    assert result["peak"] < 2**30
    assert any("measuring map errors" in line for line in result["progress"])
    errors = large.errors(result["verdict"])
    assert {name.split()[0] for name in errors} == set(large.material(2).textures)
    for name, row in errors.items():
        assert row["total"] == 1024**2
        assert row["texels"] == row["total"] or name.endswith("delta_e_2000")


def test_arrays_in_files_make_no_difference(large, tmp_path, monkeypatch):
    def verified():
        axf.write(tmp_path / "small.axf", material := large.material(64))
        (read,) = axf.read(tmp_path / "small.axf", guarded=False).materials
        packed = unity_2018.pack(read)
        return material, {
            t.axf_name: map_errors(read.textures[t.axf_name], t, unity_2018.reading(t, packed.values))
            for t in packed.textures.values()
        }

    _, in_memory = verified()
    monkeypatch.setattr(scratch, "LARGE", 1000)
    material, in_files = verified()
    assert set(in_memory) == set(in_files) == set(material.textures)
    for key, errors in in_files.items():
        assert [s.to_json() for s in errors.statistics] == [s.to_json() for s in in_memory[key].statistics]
        np.testing.assert_array_equal(errors.picture, in_memory[key].picture)


def test_the_report_is_within_the_limit_and_of_every_texel(large):
    content = common.committed(NAME)
    whole = content["large"]
    assert whole["size"] == large.SIZE == 4096
    assert whole["peak_mib"] * 2**20 < large.LIMIT
    assert len(whole["progress"]) >= 3
    for name, row in whole["errors"].items():
        assert row["total"] == 4096**2
        assert row["texels"] == row["total"] or name.endswith("delta_e_2000")
    assert json.dumps(content["small"])


@pytest.mark.slow
def test_the_small_material_errs_as_reported(large):
    reported, found = common.committed(NAME)["small"]["errors"], large.subset()["small"]["errors"]
    assert set(found) == set(reported)
    for name, row in found.items():
        assert row["max"] == pytest.approx(reported[name]["max"], rel=1e-3), name
