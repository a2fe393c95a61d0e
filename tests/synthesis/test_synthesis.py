"""What the synthetic materials hold: content as real files have it."""

import json

import jax.numpy as jnp
import numpy as np
import pytest

from axffit import axf, brdf, measured, synthesis
from axffit.axf.validation import problems
from axffit.synthesis import carpaint, flakes


@pytest.fixture(scope="module")
def panel():
    return synthesis.brushed_carbon()


@pytest.fixture(scope="module")
def paint():
    return synthesis.metallic_paint()


@pytest.mark.parametrize("make", [synthesis.brushed_carbon, synthesis.metallic_paint])
def test_materials_break_no_rule(make):
    assert list(problems(make())) == []


def test_the_panel_has_every_map_of_a_coated_anisotropic_svbrdf(panel):
    expected = {"diffusecolor", "normal", "specularcolor", "specularlobe", "anisrotation", "fresnel"}
    assert set(panel.textures) == expected | {"clearcoatcolor", "clearcoatnormal", "clearcoatior"}
    assert panel.anisotropic
    assert panel.textures["specularlobe"].channels == 2


def test_the_panel_has_the_oddities_of_real_files(panel):
    diffuse = panel.textures["diffusecolor"].data
    assert 0 < np.mean(diffuse < 0) < 0.05
    rotation = panel.textures["anisrotation"].data
    assert np.abs(rotation).max() <= np.float32(np.pi)
    assert np.mean(np.abs(rotation) > np.pi / 2) > 0.01
    assert 0 < np.isnan(panel.textures["clearcoatior"].data).sum() < 40


def test_the_panel_looks_the_same_at_every_size(panel):
    """Means over 8x8 texels of the larger one are the smaller one's texels, up to what both cannot resolve."""
    large = synthesis.brushed_carbon(512)
    for key in ("specularcolor", "specularlobe", "fresnel", "clearcoatcolor"):
        small, fine = panel.textures[key].data, large.textures[key].data
        mean = fine.reshape(64, 8, 64, 8, -1).mean(axis=(1, 3))
        assert np.corrcoef(mean.ravel(), small.ravel())[0, 1] > 0.9, key


def test_normals_have_unit_length(panel, paint):
    for texture in (panel.textures["normal"], panel.textures["clearcoatnormal"], paint.textures["clearcoatnormal"]):
        np.testing.assert_allclose(np.linalg.norm(texture.data, axis=-1), 1.0, atol=1e-6)


def test_the_slice_table_is_the_documented_one():
    assert flakes.slice_table()[:14] == (0, 7, 14, 21, 28, 35, 42, 48, 53, 57, 60, 62, 0, 0)
    assert len(flakes.slice_table()) == 64


def test_the_flakes_fill_the_slices_that_the_table_names(paint):
    stack = paint.textures["btfflakes"]
    assert stack.data.shape == (62, 32, 32, 3)
    assert [level.shape[1] for level in stack.levels] == [32, 16, 8, 4, 2, 1]
    assert paint.properties["thetaFI_sliceLUT"].max() == 62


def test_every_mip_level_is_the_mean_of_the_one_before(paint):
    levels = [level.astype(np.float64) for level in paint.textures["btfflakes"].levels]
    for fine, coarse in zip(levels, levels[1:], strict=False):
        depth, height, width, _ = coarse.shape
        mean = fine.reshape(depth, height, 2, width, 2, 3).mean(axis=(2, 4))
        np.testing.assert_allclose(coarse, mean, atol=2e-3 * np.abs(fine).max())


def test_flakes_vanish_past_45_degrees(paint):
    slices = paint.textures["btfflakes"].data.astype(np.float64)
    by_angle = slices[:7].mean(axis=(1, 2, 3))
    assert by_angle[0] > 5 * by_angle[3] > 0
    # The bin at 45 degrees holds nothing but the noise of the measurement.
    assert np.abs(slices[6]).max() < 0.02 * slices[0].max()


def test_a_flake_lives_six_to_seven_degrees():
    """Neighboring bins of 7.5 degrees share few flakes, the same bin of a near theta_d most of them."""
    rng = np.random.Generator(np.random.PCG64(5))
    stack = flakes.flake_stack(rng, 64, 64 * 0.03, flakes.FlakeRecipe()).levels[0].astype(np.float64)

    def likeness(a, b):
        return np.corrcoef(stack[a].ravel(), stack[b].ravel())[0, 1]

    assert likeness(0, 1) < 0.5
    assert abs(likeness(0, 2)) < 0.1
    assert likeness(0, 7) > 0.8


def test_the_paint_flops(paint):
    """Lightness at the usual aspecular angles falls steeply, as a metallic paint's does."""
    model = axf.to_brdf(paint)
    aspecular = np.deg2rad(np.array([15.0, 45.0, 110.0]) - 45.0)
    wo = jnp.asarray(np.stack([np.sin(aspecular), 0 * aspecular, np.cos(aspecular)], axis=-1))
    wi = jnp.asarray([np.sin(np.pi / 4), 0.0, np.cos(np.pi / 4)])
    luminance = np.asarray(model.evaluate(wi, wo)) @ measured.REC709_LUMINANCE
    assert luminance[0] > 4 * luminance[1] > 8 * luminance[2] > 0


def test_the_color_table_exceeds_one_and_is_empty_beyond_the_diagonal():
    table = carpaint.flop_table()
    assert table.max() > 1.2
    assert table.min() < 0
    assert (table[40, 40] == 0).all()
    assert (table[30, 30] > 0).all()


@pytest.mark.parametrize("seed", range(3))
def test_unit_luminance_holds_in_every_cell_and_between_them(seed):
    paint = synthesis.unit_luminance_paint(seed)
    assert isinstance(paint, brdf.ClearCoat)
    assert isinstance(paint.base, brdf.CarPaint)
    table = paint.base.color_table
    np.testing.assert_allclose(table.values @ measured.REC709_LUMINANCE, 1.0, rtol=1e-12)
    between = table.lookup(jnp.asarray(0.3141), jnp.asarray(0.777))
    np.testing.assert_allclose(between @ measured.REC709_LUMINANCE, 1.0, rtol=1e-12)
    assert np.ptp(table.values) > 0.1


def test_relative_noise_has_its_level_and_its_seed():
    values = np.full((20000, 3), 2.0)
    noisy = synthesis.relative_noise(values, 0.01, seed=3)
    deviation = noisy / values - 1.0
    assert abs(deviation.std() - 0.01) < 1e-4
    assert abs(deviation.mean()) < 2e-4
    np.testing.assert_array_equal(noisy, synthesis.relative_noise(values, 0.01, seed=3))
    assert (noisy != synthesis.relative_noise(values, 0.01, seed=4)).all()


def test_the_sampled_paint_is_the_truth_with_one_percent_of_noise(tmp_path):
    samples, truth = synthesis.generate(tmp_path, packages=["noisy_car_paint"])
    stated = json.loads(truth.read_text())
    table = brdf.ColorTable(carpaint.flop_table().astype(np.float32).astype(np.float64))
    base = brdf.CarPaint(stated["CT_diffuse"], stated["CT_coeffs"], stated["CT_F0s"], stated["CT_spreads"], table)
    model = brdf.ClearCoat(base, stated["IOR"])
    data = measured.read(samples)
    exact = np.asarray(model.evaluate(jnp.asarray(data.wi), jnp.asarray(data.wo)))
    z = (data.values - exact) / (stated["noise"]["level"] * exact)
    assert 0.99 < z.std() < 1.01
    assert np.abs(z).max() < 6
