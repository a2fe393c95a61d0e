"""dE2000 under D65 and A: neutral for neutrals, the same exposure before and after, by hand for a pair."""

import colour
import numpy as np
import pytest

from axffit.quantization.colors import ILLUMINANTS, color_differences, color_errors, exposed
from axffit.quantization.measures import delta_e_2000

GRAY = np.array([[0.18, 0.18, 0.18]])


@pytest.mark.parametrize("illuminant", ILLUMINANTS)
def test_grays_differ_alike_under_every_light(illuminant):
    """The perfect diffuser is white under each: a gray stays a gray, and its lightness does not change."""
    after = 1.1 * GRAY
    assert color_differences(GRAY, after, illuminant) == pytest.approx(delta_e_2000(GRAY, after), rel=1e-6)


def test_a_difference_by_hand():
    before, after = np.array([[0.5, 0.1, 0.05]]), np.array([[0.5, 0.11, 0.05]])
    whites = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]
    space = colour.RGB_Colourspace("E", colour.RGB_COLOURSPACES["sRGB"].primaries, whites["E"])
    labs = []
    for rgb in (before, after):
        xyz = colour.RGB_to_XYZ(rgb, space, illuminant=whites["A"], chromatic_adaptation_transform="Bradford")
        labs.append(colour.XYZ_to_Lab(xyz, whites["A"]))
    assert color_differences(before, after, "A") == pytest.approx(colour.delta_E(*labs, method="CIE 2000"), rel=1e-3)


def test_reds_and_blues_change_differently_under_a():
    red, blue = np.array([[0.4, 0.05, 0.05]]), np.array([[0.05, 0.05, 0.4]])
    changes = {light: [float(color_differences(c, c * 1.02, light)[0]) for c in (red, blue)] for light in ILLUMINANTS}
    assert changes["A"][0] > changes["D65"][0]
    assert changes["A"][1] < changes["D65"][1]


def test_a_highlight_is_exposed_for_and_a_matte_view_is_not():
    f = np.full((1, 2, 3, 3), 0.1 / np.pi)
    f[0, 1, 0] = 20 / np.pi
    clear = np.ones((1, 2, 3), bool)
    clear[0, 0, 2] = False
    before, after = exposed(f, 1.5 * f, clear)
    np.testing.assert_allclose(before[:, 0], [0.1, 0.1, 1.0, 0.1 / 20, 0.1 / 20])
    np.testing.assert_allclose(after, 1.5 * before)


def test_the_summary():
    (error,) = color_errors({"A": [np.arange(100.0), np.array([1000.0])]})
    assert (error.illuminant, error.max, error.pairs, error.p95) == ("A", 1000.0, 101, 95.0)
    assert color_errors({}) == ()
