"""Numbers behind the plots."""

import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.report.curves import INCIDENCE_DEGREES, failure_map, incidence_plane, view_angles
from tests.report.examples import ggx, samples


def test_lambert_curves_are_flat_at_the_luminance_of_its_albedo():
    curves = incidence_plane(Lambert(np.array([0.3, 0.6, 0.9])), ggx())
    expected = (0.3 * 0.2126 + 0.6 * 0.7152 + 0.9 * 0.0722) / np.pi
    assert [curve["incidence_degrees"] for curve in curves] == list(INCIDENCE_DEGREES)
    for curve in curves:
        np.testing.assert_allclose(curve["measured"], expected, rtol=1e-4)


def test_lobes_peak_on_the_positive_side_near_the_mirror_direction():
    for curve in incidence_plane(ggx(), ggx())[:4]:
        peak = curve["view_degrees"][int(np.argmax(curve["modeled"]))]
        assert abs(peak - curve["incidence_degrees"]) < 10
        assert curve["modeled"] == curve["measured"]


@pytest.mark.parametrize("incidence", INCIDENCE_DEGREES)
def test_view_angles_rise_and_hold_the_mirror_direction(incidence):
    angles = view_angles(incidence)
    assert np.all(np.diff(angles) > 1e-6)
    assert incidence in angles
    assert np.abs(angles).max() <= 85


def test_failure_map_of_a_model_twice_as_bright_is_one_everywhere():
    data = samples()
    exact = Lambert(np.array([0.1, 0.05, 0.02])) + ggx()
    cells = failure_map(data, exact + exact)["log2_ratio"]
    found = np.array([x for row in cells for x in row if x is not None])
    assert found.size > 20
    # Samples that are nearly black count as 10^-3 of the peak: there the ratio is smaller, never larger.
    assert found.max() <= 1 + 1e-6
    assert np.mean(found > 1 - 1e-6) > 0.5
    zero = np.array([x for row in failure_map(data, exact)["log2_ratio"] for x in row if x is not None])
    np.testing.assert_allclose(zero, 0.0, atol=1e-6)
