"""The synthetic SVBRDFs are the materials they are named for: statistics of grain, brush, dimples and holes."""

import numpy as np
import pytest

from axffit.axf.maps import gather, texel_centers
from axffit.axf.validation import problems
from axffit.synthesis import fields, leathers, metal
from axffit.synthesis import variants as others
from axffit.synthesis.carbon import carbon_twill
from axffit.synthesis.fabrics import lace
from axffit.synthesis.leathers import leather, patent_leather, perforated_leather
from axffit.synthesis.material import with_dark_noise, with_highlights
from axffit.synthesis.metal import brushed_metal, hammered_copper, turned_brass
from axffit.synthesis.noise import unit_grid
from axffit.synthesis.wood import lacquered_walnut

MAKERS = (
    leather,
    patent_leather,
    perforated_leather,
    others.nappa_leather,
    others.seat_leather,
    brushed_metal,
    others.brushed_trim,
    others.brushed_titanium,
    turned_brass,
    hammered_copper,
    carbon_twill,
    others.carbon_trim,
    lacquered_walnut,
    lace,
)
SIZE = 128
MADE = {make.__name__: make(SIZE) for make in MAKERS}

named = pytest.mark.parametrize("name", list(MADE))


def texels(material, key):
    return material.textures[key].data.astype(np.float64)


def slopes_of(normal):
    return np.moveaxis(normal[..., :2] / normal[..., 2:], -1, 0)


@named
def test_no_rule_is_broken_and_every_map_has_its_size(name):
    material = MADE[name]
    assert list(problems(material)) == []
    for key, texture in material.textures.items():
        height, width = texture.data.shape[:2]
        assert (height, width) in {(SIZE, SIZE), (SIZE // 2, SIZE // 2), (1, 1)}, key
        assert texture.is_constant == (height == 1), key


@named
def test_maps_repeat_without_a_seam(name):
    """Between the last and the first row (column) no more changes than between some two rows within the map."""
    for key, texture in MADE[name].textures.items():
        values = texture.data.astype(np.float64)
        if texture.is_constant:
            continue
        if key == "anisrotation":
            values = np.concatenate([np.cos(2 * values), np.sin(2 * values)], axis=-1)
        for axis in (0, 1):
            steps = np.nanmean(np.abs(values - np.roll(values, 1, axis)), axis=(1 - axis, 2))
            assert steps[0] <= 1.3 * steps[1:].max(), (key, axis)


@named
def test_base_reflects_no_more_than_it_receives(name):
    """Diffuse plus specular at normal incidence; a Ward lobe's albedo is below s F, AxF's GGX below 4 s F."""
    material = MADE[name]
    maps = gather(material, texel_centers(material, np.arange(SIZE)[:, None], np.arange(SIZE)))
    lobe = maps["specularcolor"] * (4.0 if material.specular_model == "GGX" else 1.0)
    total = maps["diffusecolor"] + lobe * (maps["fresnel"] if material.fresnel_variant else 1.0)
    planted = (maps["specularcolor"] > 1).any(axis=-1)
    assert planted.mean() <= 0.002
    assert total[~planted].max() <= 1.0
    # Schlick's factor tends to 1 at grazing incidence, where only the lobe's weight is left to bound it.
    assert lobe[~planted].max() <= 1.0


@named
def test_some_texels_are_negative_and_few(name):
    diffuse = texels(MADE[name], "diffusecolor")
    assert 0.001 < (diffuse < 0).any(axis=-1).mean() < 0.03
    assert diffuse.min() > -0.01


@pytest.mark.parametrize("make", [brushed_metal, turned_brass, hammered_copper])
def test_glints_of_metals_exceed_one_and_are_few(make):
    specular = texels(make(SIZE), "specularcolor").max(axis=-1)
    assert (specular > 1).sum() == round(0.001 * SIZE**2)
    assert 1.5 < specular.max() < 1.7


@pytest.mark.parametrize("make", [patent_leather, turned_brass, carbon_twill, lacquered_walnut])
def test_coats_are_passive_and_their_index_has_gaps(make):
    material = make(SIZE)
    index = texels(material, "clearcoatior")
    assert 0.001 < np.isnan(index).mean() < 0.006
    assert 1.4 < np.nanmin(index) <= np.nanmax(index) < 1.6
    assert 0.9 < texels(material, "clearcoatcolor").min() <= texels(material, "clearcoatcolor").max() <= 1.0


@pytest.mark.parametrize("make", [leather, patent_leather, lacquered_walnut, hammered_copper, lace])
def test_a_larger_map_shows_the_same_material(make):
    small, fine = texels(make(64), "diffusecolor"), texels(make(256), "diffusecolor")
    mean = fine.reshape(64, 4, 64, 4, 3).mean(axis=(1, 3))
    assert np.corrcoef(mean.ravel(), small.ravel())[0, 1] > 0.9


@pytest.mark.parametrize("pebbles", [9, 14, 20])
def test_leather_has_as_many_pebbles_as_it_should_in_every_direction(pebbles):
    grain = leathers.leather_grain(np.random.Generator(np.random.PCG64(1)), 256, pebbles=pebbles)
    spectrum = np.abs(np.fft.fft2(grain.pebble - grain.pebble.mean())) ** 2
    frequency = np.fft.fftfreq(256, 1 / 256)
    radius = np.hypot(frequency[:, None], frequency)
    power = np.bincount(radius.round().astype(int).ravel(), spectrum.ravel())[: 3 * pebbles]
    # Creases close here and there, which adds long waves; the peak per wavenumber is that of the pebbles.
    rings = np.arange(len(power))
    near = (rings > 0.6 * pebbles) & (rings < 1.6 * pebbles)
    assert power[near].mean() > 2.0 * power[(rings > 2.2 * pebbles)].mean()
    along, across = slopes_of(fields.normals_of(grain.height_mm, leathers.EXTENT_MM))
    assert along.std() == pytest.approx(across.std(), rel=0.15)


def test_leather_is_darker_rougher_and_duller_in_its_creases():
    material = leather(SIZE, with_height=True)
    height = texels(material, "height")[..., 0]
    color, gloss = texels(material, "diffusecolor")[..., 0], texels(material, "specularcolor")[..., 0]
    assert np.corrcoef(color.ravel(), height.ravel())[0, 1] > 0.4
    assert np.corrcoef(gloss.ravel(), height.ravel())[0, 1] > 0.6
    rough = texels(material, "specularlobe")[..., 0]
    assert np.corrcoef(rough.ravel(), fields.halved(height).ravel())[0, 1] < -0.6
    assert 0.03 < np.ptp(height) < 0.2


@pytest.mark.parametrize("make", [brushed_metal, others.brushed_trim, others.brushed_titanium])
def test_a_brush_leaves_long_scratches_one_way(make):
    material = make(SIZE)
    shade = np.minimum(texels(material, "specularcolor")[..., 0], 1.0)

    def change(axis):
        return np.abs(np.diff(shade, axis=axis)).mean()

    assert change(1) > 3 * change(0)
    along, across = slopes_of(texels(material, "normal"))
    assert along.std() > 4 * across.std()
    lobe = texels(material, "specularlobe")
    assert 2.5 < np.median(lobe[..., 1] / lobe[..., 0]) < 5.0
    rotation = texels(material, "anisrotation")
    assert np.abs(rotation - np.pi / 2).max() < np.deg2rad(12)
    # Unwrapped, as in real files: the angles leave [-pi/2, pi/2) on one side.
    assert 0.2 < (rotation >= np.pi / 2).mean() < 0.8


def test_engine_turned_scratches_run_around_the_disc_on_top():
    material = turned_brass(SIZE)
    rotation = texels(material, "anisrotation")[..., 0]
    disc = fields.overlapping_discs(*unit_grid(SIZE), (metal.DISCS, metal.DISCS), 0.74)
    along = np.cos(rotation) * disc.offset[..., 0] + np.sin(rotation) * disc.offset[..., 1]
    np.testing.assert_allclose(along, 0.0, atol=1e-6)
    shares, _ = np.histogram(rotation, bins=8, range=(-np.pi, np.pi))
    assert shares.min() > 0.03 * shares.sum()


@pytest.mark.parametrize(
    ("material", "extent"),
    [(leather(SIZE, with_height=True), leathers.EXTENT_MM), (perforated_leather(SIZE), leathers.EXTENT_MM)]
    + [(lace(SIZE), 30.0)],
    ids=["leather", "perforated_leather", "lace"],
)
def test_normals_are_those_of_the_height_map(material, extent):
    height = texels(material, "height")[..., 0]
    assert material.textures["height"].width_mm == extent
    expected = fields.normals_of(height, extent)
    # Half of n itself is exact to 0.028 degrees.
    cosine = np.clip(np.sum(expected * texels(material, "normal"), axis=-1), -1, 1)
    sine = np.linalg.norm(np.cross(expected, texels(material, "normal")), axis=-1)
    assert np.rad2deg(np.arctan2(sine, cosine)).max() < 0.03


def test_the_half_size_height_of_copper_agrees_with_its_normals():
    material = hammered_copper(256)
    height = material.textures["height"]
    assert height.data.shape[0] == 128
    coarse = slopes_of(fields.normals_of(height.data[..., 0].astype(np.float64), height.width_mm))
    fine = slopes_of(texels(material, "normal"))
    for a, b in zip(coarse, fine, strict=True):
        assert np.corrcoef(a.ravel(), fields.halved(b).ravel())[0, 1] > 0.97
    assert 5 < np.rad2deg(np.arctan(np.hypot(*fine))).mean() < 25


def test_perforated_leather_has_a_hole_at_each_point_of_its_lattice():
    opacity = texels(perforated_leather(256), "opacity")[..., 0]
    assert set(np.unique(opacity)) >= {0.0, 1.0}
    rows = leathers.HOLE_ROWS
    assert 1 - opacity.mean() == pytest.approx(np.pi * 0.24**2, rel=0.03)
    distance = fields.cells(*unit_grid(256), fields.staggered((rows, rows))).nearest
    assert opacity[distance < 0.2].max() == 0
    assert opacity[distance > 0.28].min() == 1


def test_lace_is_mostly_either_thread_or_nothing():
    material = lace(512)
    opacity = texels(material, "opacity")[..., 0]
    assert 0.3 < opacity.mean() < 0.65
    assert ((opacity < 0.02) | (opacity > 0.98)).mean() > 0.85
    height = texels(material, "height")[..., 0]
    assert height[opacity == 1].mean() > height[opacity == 0].mean() + 0.1


def test_dark_noise_turns_the_darkest_texels_negative_and_highlights_the_brightest():
    rng = np.random.Generator(np.random.PCG64(2))
    ramp = np.repeat(np.linspace(0.2, 1.2, 1000).reshape(25, 40, 1), 3, axis=-1)
    dark = with_dark_noise(rng, ramp, share=0.01)
    assert (dark < 0).all(axis=-1).sum() == 10
    assert (np.argwhere((dark < 0).any(axis=-1))[:, 0] == 0).all()
    assert np.abs(dark - ramp)[1:].max() < 0.004
    bright = with_highlights(ramp, share=0.01)
    assert (bright > 1).all(axis=-1).sum() == 10
    assert bright.max() == pytest.approx(1.6)
    np.testing.assert_array_equal(bright[:20], np.minimum(ramp[:20], 1.0))
