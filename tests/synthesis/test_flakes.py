"""Flakes follow their recipe: number, size, orientation, color and lifetime, measured on the slices themselves.

Seeds are fixed; each tolerance is at least four standard errors of the statistic at the sizes used, so that a change
of the stream of chance raises a false alarm in fewer than 1 of 10 000 runs.
"""

import numpy as np
import pytest

from axffit.synthesis import FlakeRecipe, flake_stack
from axffit.synthesis.flakes import LAST_TILT, Flakes, flash, scatter_flakes, slice_table, slices_of_bins


def rng(seed=7):
    return np.random.Generator(np.random.PCG64(seed))


def seen_at(recipe, degrees, *, size=128, extent=128 * 0.02):
    """What the recipe's flakes reflect at theta_d = 0 and each theta_h."""
    flakes = scatter_flakes(rng(), recipe, extent)
    return np.stack([flash(flakes, recipe, size, extent, np.deg2rad(theta_h), 0.0) for theta_h in degrees])


@pytest.mark.parametrize("degrees", [5.0, 9.0, 12.0])
def test_tilts_have_the_spread_of_the_recipe(degrees):
    spread = np.deg2rad(degrees)
    flakes = scatter_flakes(rng(), FlakeRecipe(density=20_000.0, orientation_spread=spread), 1.0)
    # The few flakes past 42 degrees are left out, which matters for the widest spread only.
    kept = 1 - np.exp(-0.5 * (LAST_TILT / spread) ** 2)
    assert len(flakes.tilt) == pytest.approx(20_000 * kept, rel=0.005)
    assert flakes.tilt.std(axis=0) == pytest.approx([spread, spread], rel=0.025)
    assert flakes.tilt.mean(axis=0) == pytest.approx([0, 0], abs=0.03 * spread)


@pytest.mark.parametrize("degrees", [6.0, 10.0])
def test_mean_radiance_over_theta_h_is_the_distribution_of_tilts(degrees):
    """A slice's mean is the tilts' density at theta_h, smoothed by the flash: a Gaussian of known width."""
    spread, recipe = np.deg2rad(degrees), FlakeRecipe(density=12_000.0, orientation_spread=np.deg2rad(degrees))
    theta = spread * np.linspace(0, 1.8, 7)
    means = seen_at(recipe, np.rad2deg(theta)).mean(axis=(1, 2, 3))
    flash_variance = recipe.lifetime**2 / (8 * np.log(2))
    width2 = spread**2 + flash_variance
    slope = np.polyfit(theta**2, np.log(means), 1)[0]
    assert -1 / (2 * slope) == pytest.approx(width2, rel=0.12)


@pytest.mark.parametrize("density", [40.0, 160.0])
def test_coverage_is_that_of_independent_spots(density):
    """The share of texels that some flashing flake brightens, against the Poisson law of independent spots."""
    diameter, strength = 0.05, 1.0
    recipe = FlakeRecipe(density, (diameter, diameter), strength=strength, brightness_spread=0.0, hue_spread=0.0)
    face = seen_at(recipe, [0.0], size=256, extent=256 * 0.01)[0, :, :, 1]
    threshold = 0.05
    covered = (face > threshold).mean()
    # A flake at tilt t is brighter than the threshold out to r = radius sqrt(ln(flash(t) / threshold)).
    tilt = np.linspace(0, LAST_TILT, 4001)
    flash = np.exp(-4 * np.log(2) * (tilt / recipe.lifetime) ** 2)
    area = np.pi * (diameter / 2) ** 2 * np.log(np.maximum(flash / threshold, 1.0))
    spread2 = recipe.orientation_spread**2
    pdf = tilt / spread2 * np.exp(-0.5 * tilt**2 / spread2)
    mean_area = np.sum(pdf * area) * (tilt[1] - tilt[0])
    assert covered == pytest.approx(1 - np.exp(-density * mean_area), rel=0.25)


def test_lifetime_is_the_width_of_a_flash_at_half_its_height():
    """One flake at 20 degrees, followed through fine slices."""
    recipe = FlakeRecipe()
    one = Flakes(np.asarray([[0.5, 0.5]]), np.asarray([0.05]), np.deg2rad([[20.0, 0.0]]), np.ones((1, 3)))
    degrees = np.arange(10.0, 30.0, 0.05)
    curve = np.asarray([flash(one, recipe, 16, 0.32, np.deg2rad(theta_h), 0.0).max() for theta_h in degrees])
    bright = degrees[curve > 0.5 * curve.max()]
    assert np.ptp(bright) == pytest.approx(np.rad2deg(recipe.lifetime), abs=0.1)
    assert 6.0 <= np.rad2deg(recipe.lifetime) <= 7.0
    assert bright.mean() == pytest.approx(20.0, abs=0.05)


def test_size_scales_the_spots():
    """Twice the diameter, a quarter of the flakes: the correlation length doubles."""

    def length(recipe):
        face = seen_at(recipe, [0.0], extent=128 * 0.01)[0, :, :, 1]
        face = face - face.mean()
        spectrum = np.abs(np.fft.fft2(face)) ** 2
        correlation = np.real(np.fft.ifft2(spectrum))[0]
        return np.interp(-0.5, -correlation[:40] / correlation[0], np.arange(40.0))

    small = length(FlakeRecipe(400.0, (0.04, 0.04)))
    large = length(FlakeRecipe(100.0, (0.08, 0.08)))
    assert large / small == pytest.approx(2.0, rel=0.2)


def test_color_and_strength_scale_the_slices():
    plain = seen_at(FlakeRecipe(hue_spread=0.0), [0.0, 10.0])
    tinted = seen_at(FlakeRecipe(hue_spread=0.0, color=(0.5, 1.0, 2.0), strength=0.2), [0.0, 10.0])
    ratio = tinted.mean(axis=(0, 1, 2)) / plain.mean(axis=(0, 1, 2))
    assert ratio == pytest.approx([1.0, 2.0, 4.0], rel=1e-9)


def test_no_flake_flashes_past_45_degrees():
    wide = FlakeRecipe(density=5000.0, orientation_spread=np.deg2rad(30.0))
    before, past = seen_at(wide, [36.0, 46.0], size=64).mean(axis=(1, 2, 3))
    assert past < 0.2 * before
    assert seen_at(wide, [52.0], size=64).max() == 0


@pytest.mark.parametrize("bins", [6, 12, 24])
def test_the_table_bounds_every_slice(bins):
    lut = slice_table(bins)
    assert np.diff(lut[:bins]).tolist() == list(slices_of_bins(bins))
    stack = flake_stack(rng(), 8, 0.2, FlakeRecipe(), bins=bins)
    assert stack.levels[0].shape[0] == sum(slices_of_bins(bins)) == max(lut)


def test_a_recipe_without_sense_is_refused():
    with pytest.raises(ValueError, match="positive"):
        FlakeRecipe(density=0.0)
    with pytest.raises(ValueError, match="positive"):
        FlakeRecipe(diameter_mm=(0.05, 0.02))
