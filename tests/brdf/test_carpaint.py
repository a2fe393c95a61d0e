"""Car paint: color table lookups, and real paints against an importer's own pre-integrated albedo."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import CarPaint, ClearCoat, ColorTable
from axffit.hemisphere import directional_albedo


def lookup(table, theta_h, theta_d):
    return table.lookup(jnp.asarray(theta_h), jnp.asarray(theta_d))


def ramp(height, width):
    """Texel (r, c) holds (r, c, 1)."""
    row, column = np.meshgrid(np.arange(height), np.arange(width), indexing="ij")
    return np.stack([row, column, np.ones_like(row)], axis=-1).astype(float)


def test_width_is_theta_h_and_height_is_theta_d():
    table = ColorTable(ramp(4, 8))
    theta_h, theta_d = (5 + 0.5) / 8 * np.pi / 2, (2 + 0.5) / 4 * np.pi / 2
    np.testing.assert_allclose(lookup(table, theta_h, theta_d), [2, 5, 1], rtol=1e-14)


def test_bilinear_weights_belong_to_their_axes():
    table = ColorTable(ramp(4, 8))
    theta_h, theta_d = (5 + 0.75) / 8 * np.pi / 2, (2 + 0.6) / 4 * np.pi / 2
    np.testing.assert_allclose(lookup(table, theta_h, theta_d), [2.1, 5.25, 1], rtol=1e-13)


@pytest.mark.parametrize(("convention", "first", "last"), [("center", 0.5, 7.5), ("corner", 0, 8)])
def test_texel_conventions_place_the_ends(convention, first, last):
    table = ColorTable(ramp(8, 8), texel_convention=convention)
    np.testing.assert_allclose(lookup(table, first / 8 * np.pi / 2, 0.0), [0, 0, 1], atol=1e-14)
    np.testing.assert_allclose(lookup(table, last / 8 * np.pi / 2, np.pi / 2), [7, 7, 1], rtol=1e-14)
    np.testing.assert_allclose(lookup(table, 0.0, 0.0), [0, 0, 1], atol=1e-14)


def test_flipped_storage_is_the_same_table():
    values = ramp(4, 8)
    angles = (0.37, 0.81)
    np.testing.assert_allclose(
        lookup(ColorTable(values[::-1], flipped=True), *angles), lookup(ColorTable(values), *angles), rtol=1e-12
    )


def test_diagonal_clamp_never_looks_past_the_diagonal():
    values = ramp(32, 32)
    row, column = np.meshgrid(np.arange(32), np.arange(32), indexing="ij")
    values[row + column > 32] = np.nan  # not measured
    clamped = ColorTable(values, diagonal_clamp=True)
    inside, outside = (0.5, 0.6), (0.5, 1.4)
    np.testing.assert_array_equal(lookup(clamped, *inside), lookup(ColorTable(values), *inside))
    np.testing.assert_allclose(lookup(clamped, *outside), lookup(clamped, 0.5, np.pi / 2 - 0.5), rtol=1e-12)


def test_gradient_of_a_lookup_is_its_four_weights():
    def red(values):
        return ColorTable(values).lookup(
            jnp.asarray((5 + 0.75) / 8 * np.pi / 2), jnp.asarray((2 + 0.6) / 4 * np.pi / 2)
        )[0]

    gradient = jax.grad(red)(jnp.asarray(ramp(4, 8)))
    expected = np.zeros((4, 8, 3))
    expected[2:4, 5:7, 0] = np.outer([0.9, 0.1], [0.75, 0.25])
    np.testing.assert_allclose(gradient, expected, atol=1e-14)


def test_the_table_colors_diffuse_and_lobes_alike():
    values = np.full((2, 2, 3), [0.5, 2.97, 0.0])
    white, colored = (CarPaint(0.3, (1.0,), (0.1,), (0.2,), ColorTable(v)) for v in (np.ones((2, 2, 3)), values))
    wi, wo = jnp.asarray([0.6, 0, 0.8]), jnp.asarray([-0.6, 0, 0.8])
    np.testing.assert_allclose(colored.evaluate(wi, wo), white.evaluate(wi, wo) * values[0, 0], rtol=1e-14)


@pytest.mark.parametrize(
    ("slug", "tolerance"),
    [
        ("old_antiqua_gray_csa5461w_csk3401tc", 0.01),
        # The importer's Monte Carlo noise shows with a spread above 4.
        ("abstraction_blue_csb6061w", 0.06),
        ("googoosh_red_124_263", 0.06),
    ],
)
def test_lobes_under_a_refracting_coat_reproduce_the_importers_albedo(reference_data, slug, tolerance):
    folder = reference_data("axf_carpaint_basf")
    paints = json.loads((folder / "carpaint2_params.json").read_text())
    paint = next(p for p in paints if p["slug"] == slug)
    cosines, expected = np.loadtxt(folder / f"{slug}_fgd32.csv", delimiter=",", skiprows=1, usecols=(0, 1)).T
    lobes = CarPaint(0.0, paint["CT_coeffs"], paint["CT_F0s"], paint["CT_spreads"])
    coated = ClearCoat(lobes, paint["IOR"], fresnel="schlick")
    views = np.stack([np.sqrt(1 - cosines**2), np.zeros(32), cosines], axis=-1)
    albedo = [directional_albedo(coated, jnp.asarray(v), polar_count=400, azimuth_count=256)[0] for v in views]
    half_step = expected.max() / 510  # the column was stored in 8 bits
    np.testing.assert_allclose(albedo, expected, rtol=tolerance, atol=half_step)
