"""The slice table, exhaustively: which k come back under which decode and rounding."""

import numpy as np
import pytest

from axffit.quantization.slice_lut import DECODES, lut_json, lut_readings

FAILURES = {
    ("float32", "truncated"): 0,
    ("float32, 0.6 ULP low", "truncated"): 55,
    ("float32, one ULP low", "truncated"): 255,
    ("half texel, float32 product", "truncated"): 131,
    ("half texel, half product", "truncated"): 0,
    ("R8_UINT", "truncated"): 0,
}
"""Documented counts; rounding never fails."""


@pytest.mark.parametrize("reading", lut_readings(), ids=lambda r: f"{r.decode}, {r.rounding}")
def test_failures_are_the_documented_ones(reading):
    assert len(reading.failures) == FAILURES.get((reading.decode, reading.rounding), 0)
    assert all(0 <= k <= 255 for k in reading.failures)


def test_every_listed_k_really_fails_and_no_other():
    texel = (np.arange(256) / 255).astype(np.float16)
    product = texel.astype(np.float32) * np.float32(255)
    expected = [k for k in range(256) if int(product[k]) != k]
    got = next(r for r in lut_readings() if r.decode.startswith("half texel, float32") and r.rounding == "truncated")
    assert list(got.failures) == expected


@pytest.mark.parametrize(
    ("name", "ulps"), [("float32", 0.5), ("float32, 0.6 ULP low", 0.6), ("float32, one ULP low", 1.5)]
)
def test_decodes_err_by_no_more_than_they_say(name, ulps):
    held = DECODES[name]().astype(np.float64)[1:]
    below = np.nextafter(DECODES["float32"](), np.float32(-1)).astype(np.float64)[1:]
    ulp = DECODES["float32"]().astype(np.float64)[1:] - below
    assert np.all(np.abs(held - np.arange(1, 256) / 255) <= ulps * ulp)


def test_failures_among_the_entries_in_use():
    content = lut_json(np.array([0, 7, 14, 3]))
    row = next(r for r in content["readings"] if r["decode"] == "float32, one ULP low" and r["rounding"] == "truncated")
    assert row["failures_used"] == [3, 7, 14]
    assert content["entries"] == [0, 7, 14, 3]
