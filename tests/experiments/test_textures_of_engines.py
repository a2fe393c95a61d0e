"""Experiments 01 to 04: a part of each committed report, computed again."""

from typing import Any

import jax
import numpy as np
import pytest

from experiments import common


def assert_same(found: Any, committed: Any, where: str = "") -> None:
    """Equal to what 6 digits and another processor's float32 leave; texts and counts exactly."""
    if isinstance(committed, dict):
        assert set(map(str, found)) == set(committed), where
        for key, value in found.items():
            assert_same(value, committed[str(key)], f"{where}.{key}")
    elif isinstance(committed, list):
        assert len(found) == len(committed), where
        for number, (one, other) in enumerate(zip(found, committed, strict=True)):
            assert_same(one, other, f"{where}[{number}]")
    elif isinstance(committed, float) and isinstance(found, float):
        np.testing.assert_allclose(found, committed, rtol=2e-3, atol=1e-9, err_msg=where)
    else:
        assert found == committed, where


def recomputed(name: str) -> dict[str, Any]:
    with jax.enable_x64(new_val=True):
        return common.rounded(common.load(name).subset())


def test_half_or_unorm():
    assert_same(recomputed("02_half_or_unorm"), common.committed("02_half_or_unorm")["subset"])


def test_slice_lut():
    found, committed = recomputed("04_slice_lut"), common.committed("04_slice_lut")
    assert_same(found["lost"], committed["lost"])
    for name, rows in found["paint"].items():
        assert_same(rows, committed["paints"][name])


def test_the_slice_tables_answer():
    """Rounding loses nothing; truncation loses what the design's own count says."""
    lost = common.committed("04_slice_lut")["lost"]
    assert all(row["lost"] == 0 for way, row in lost.items() if way.endswith("rounded"))
    assert lost["half texel, float32 product, truncated"]["lost"] == 131
    assert lost["float32, 0.6 ULP low, truncated"]["lost"] == 55
    assert lost["R8_UINT, truncated"]["lost"] == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["01_what_importers_lose", "03_is_half_enough"])
def test_pictures_of_one_paint(name):
    found, committed = recomputed(name), common.committed(name)["materials"]
    assert found
    for material, rows in found.items():
        assert_same(rows, committed[material])
