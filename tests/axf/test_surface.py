"""An AxF material as a surface agrees with its texels, and its flakes with the stack in the file."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from axffit import axf
from axffit.brdf import CarPaint, ClearCoat
from axffit.frames import NORMAL
from tests.conftest import PROJECT

WI, WO = jnp.asarray([0.48, 0.36, 0.8]), jnp.asarray([-0.6, 0.0, 0.8])


@pytest.fixture(scope="module")
def carbon():
    return axf.read(next((PROJECT / "data_synthetic" / "brushed_carbon").glob("*.axf"))).material()


@pytest.fixture(scope="module")
def paint():
    return axf.read(next((PROJECT / "data_synthetic" / "metallic_paint").glob("*.axf"))).material()


def test_at_texel_centers_the_surface_is_the_texels(carbon):
    surface = axf.to_svbrdf(carbon)
    height, width = carbon.textures["diffusecolor"].data.shape[:2]
    rows, columns = np.asarray([0, 5, 40]), np.asarray([3, 63, 17])
    uv = jnp.asarray(np.stack([(columns + 0.5) / width, (rows + 0.5) / height], axis=-1))
    texels = axf.to_brdf(carbon, rows, columns)
    expected = eqx.filter_vmap(lambda b: b.evaluate(WI, WO))(texels)
    np.testing.assert_allclose(surface.evaluate(uv, WI, WO), expected, rtol=1e-5)


def test_a_wide_footprint_sees_the_mean_texel(carbon):
    surface = axf.to_svbrdf(carbon)
    whole = surface.maps["diffuse"].fetch(jnp.asarray([0.3, 0.7]), surface.maps["diffuse"].level_of(jnp.asarray(1.0)))
    mean = carbon.textures["diffusecolor"].data.astype(np.float64).mean(axis=(0, 1))
    np.testing.assert_allclose(whole, mean, rtol=1e-4)


def test_sizes_come_from_the_largest_map(carbon):
    texture = carbon.textures["diffusecolor"]
    np.testing.assert_allclose(axf.to_svbrdf(carbon).size_mm, [texture.width_mm, texture.height_mm], rtol=1e-6)


def test_a_paints_flakes_are_those_of_the_file(paint):
    surface = axf.to_svbrdf(paint)
    stack = paint.textures["btfflakes"].levels[0]
    _, height, width, _ = stack.shape
    row, column, bin_f, bin_i = 5, 9, 2, 3
    # The flakes' tile is smaller than the coat's maps, whose extent is uv = 1.
    coat, tile = paint.textures["clearcoatnormal"], paint.textures["btfflakes"]
    tiles = np.asarray([coat.width_mm / tile.width_mm, coat.height_mm / tile.height_mm])
    assert (tiles > 1).all()
    model = surface.at(jnp.asarray(np.asarray([(column + 0.5) / width, (row + 0.5) / height]) / tiles))
    assert isinstance(model, ClearCoat)
    assert isinstance(model.base, CarPaint)
    flakes = model.base.flakes
    assert flakes is not None
    theta = jnp.asarray(np.pi / 2) / int(paint.properties["num_thetaF"])
    value = flakes.lookup((bin_f - 0.5) * theta, (bin_i - 0.5) * theta)
    lut = paint.properties["thetaFI_sliceLUT"]
    np.testing.assert_allclose(value, stack[lut[bin_i] + bin_f, row, column].astype(float), rtol=1e-3, atol=1e-6)


def test_flakes_sparkle_and_fade_with_the_footprint(paint):
    """Seen from afar the stack's own coarsest level shows: the mean, the same everywhere."""
    surface = axf.to_svbrdf(paint)
    uv = jnp.asarray(np.random.default_rng(1).random((60, 2)))
    wi = wo = jnp.asarray(NORMAL)
    near, far = (np.asarray(surface.evaluate(uv, wi, wo, jnp.asarray(side))) for side in (0.0, 1.0))
    assert near[:, 1].std() > 20 * far[:, 1].std()
    assert near[:, 1].mean() == pytest.approx(far[:, 1].mean(), rel=0.5)
    without = axf.to_brdf(paint).evaluate(wi, wo)
    assert (far[:, 1] > float(without[1])).all()
