"""Measures: formulas with known answers, and the reference figures for unit normals."""

import numpy as np
import pytest

from axffit.quantization.measures import (
    MEASURES,
    absolute,
    angle_between,
    axis_angle,
    delta_e_2000,
    f0_of_ior,
    has_color_science,
    ior,
    measures_of,
    relative_color,
    relative_roughness,
)
from axffit.targets.unity_properties import TEXTURE_ROWS
from axffit.textures import format_named
from axffit.textures.rerange import Identity, UnitOffset

UNORM16, HALF = "RGB16_UNORM", "RGB16F"
ROOT3 = 3**0.5

REFERENCE_FIGURES = {
    "UNORM16": (UNORM16, UnitOffset(), "nearest_even", 0.000660, 0.00149, ROOT3 / 65535),
    "UNORM16, floor": (UNORM16, UnitOffset(), "floor", 0.001319, 0.00299, 2 * ROOT3 / 65535),
    "UNORM16, 0.6 ULP": (UNORM16, UnitOffset(), "device", 0.000692, 0.00180, 1.2 * ROOT3 / 65535),
    "half of n": (HALF, Identity(), "nearest_even", 0.00606, 0.0228, 2.0**-11),
    "half of n, toward zero": (HALF, Identity(), "toward_zero", 0.00635, 0.0253, 2.0**-10),
    "half of 0.5 (n + 1)": (HALF, UnitOffset(), "nearest_even", 0.0177, 0.0475, 2 * ROOT3 * 2.0**-12),
    "UNORM8": ("RGB8_UNORM", UnitOffset(), "nearest_even", 0.1696, 0.385, ROOT3 / 255),
}
"""Format, re-ranging, rounding; mean and largest sampled angle in degrees; proven bound on the error vector."""


@pytest.fixture(scope="module")
def million_normals():
    normals = np.random.default_rng(6).normal(size=(1_000_000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[:, 2] = np.abs(normals[:, 2])
    return normals


@pytest.mark.parametrize("name", REFERENCE_FIGURES)
def test_reference_figures_for_normals(name, million_normals):
    format, reranging, rounding, mean, largest, bound = REFERENCE_FIGURES[name]
    form = format_named(format)
    codes = form.encode(reranging.forward(million_normals), rounding)
    errors = angle_between(million_normals, reranging.inverse(form.decode(codes)))
    assert errors.mean() == pytest.approx(mean, rel=0.01)
    assert 0.97 * largest <= errors.max() <= np.degrees(np.arcsin(bound)) * (1 + 1e-9)


def test_angles_are_precise_from_tiny_to_opposite():
    angles = np.array([0.0, 1e-9, 1e-3, 45.0, 90.0, 180.0])
    radians = np.radians(angles)
    vectors = np.stack([np.sin(radians), np.zeros_like(radians), np.cos(radians)], axis=-1)
    up = np.broadcast_to([0.0, 0.0, 2.0], vectors.shape)
    np.testing.assert_allclose(angle_between(up, vectors), angles, rtol=1e-9, atol=1e-14)


def test_axes_are_the_same_after_half_a_turn():
    before = np.array([[0.0], [0.1], [np.pi / 2], [-np.pi], [0.0]])
    after = np.array([[np.pi], [0.1 - np.pi], [-np.pi / 2], [np.pi], [np.pi / 2]])
    np.testing.assert_allclose(axis_angle(before, after), [0, 0, 0, 0, 90], atol=1e-10)
    np.testing.assert_allclose(axis_angle(np.array([[np.radians(179.5)]]), np.array([[np.radians(0.25)]])), 0.75)


def test_errors_take_the_worst_channel():
    before, after = np.array([[1.0, 2.0]]), np.array([[1.1, 2.15]])
    assert absolute(before, after)[0] == pytest.approx(0.15)
    assert relative_roughness(before, after)[0] == pytest.approx(0.1)


def test_roughness_is_compared_from_the_floor_on():
    assert relative_roughness(np.array([[0.0]]), np.array([[1e-5]]))[0] == 0
    assert relative_roughness(np.array([[0.0]]), np.array([[2e-4]]))[0] == pytest.approx(1.0)


def test_negative_colors_count_as_zero_and_black_is_not_infinitely_wrong():
    before = np.array([[-0.5, 0.0, 1.0]])
    assert relative_color(before, np.array([[0.0, 0.0, 1.0]]))[0] == 0
    assert relative_color(before, np.array([[0.0, 2.0**-24, 1.0]]))[0] == pytest.approx(2.0**-10)


def test_ior_errors():
    before = np.array([[1.5], [np.nan], [0.5], [np.inf], [1e9], [-1.0]])
    after = np.array([[1.51], [1.5], [2.0], [np.inf], [np.inf], [1.5]])
    np.testing.assert_allclose(ior(before, after), [0.01, 0, 1.5, 0, np.inf, 0], atol=1e-12)
    np.testing.assert_allclose(f0_of_ior(before, after)[1:4], 0, atol=1e-12)
    assert f0_of_ior(before, after)[0] == pytest.approx((0.51 / 2.51) ** 2 - 0.04)


def test_delta_e_agrees_with_known_pairs():
    pytest.importorskip("colour")
    gray, lighter = np.full((1, 3), 0.184187), np.full((1, 3), 0.194187)
    # Neutral pair: L* 50 and 51.17 for these reflectances; dE2000 = dL / S_L, S_L = 1 + 0.015 d² / sqrt(20 + d²).
    lightness = [116 * np.cbrt(x[0, 0]) - 16 for x in (gray, lighter)]
    offset = np.mean(lightness) - 50
    expected = (lightness[1] - lightness[0]) / (1 + 0.015 * offset**2 / np.sqrt(20 + offset**2))
    assert delta_e_2000(gray, lighter)[0] == pytest.approx(expected, rel=1e-4)
    white = np.ones((1, 3))
    assert delta_e_2000(white, white)[0] == pytest.approx(0, abs=1e-9)
    # Black against white is 100 by definition of L* when the perfect diffuser is the white.
    assert delta_e_2000(np.zeros((1, 3)), white)[0] == pytest.approx(100, rel=1e-4)


def test_every_texture_has_measures_and_the_names_are_unique():
    assert set(MEASURES) == {row.axf_name for row in TEXTURE_ROWS} - {"thetaFI_sliceLUT"}
    for axf_name, measures in MEASURES.items():
        assert len({m.name for m in measures}) == len(measures)
        offered = {m.name for m in measures_of(axf_name)}
        assert offered == {m.name for m in measures} - (set() if has_color_science() else {"delta_e_2000"})
