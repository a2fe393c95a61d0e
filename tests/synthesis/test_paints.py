"""The synthetic car paints look as their names say: brightness, flop, hue, flakes."""

import jax.numpy as jnp
import numpy as np
import pytest

from axffit import axf, brdf, measured
from axffit.axf.validation import problems
from axffit.brdf.albedo import albedo
from axffit.synthesis import paints
from axffit.synthesis.paints import pearlescent, ruby_metallic, silver_metallic, solid_yellow

MAKERS = (silver_metallic, solid_yellow, pearlescent, ruby_metallic)
PAINTS = {make.__name__: make(64) for make in MAKERS}

named = pytest.mark.parametrize("name", list(PAINTS))


def seen(material, light, viewer):
    """Linear RGB in the plane of incidence; polar angles in degrees, the viewer's counted towards the light's."""
    light, viewer = np.deg2rad(light), np.deg2rad(viewer)
    wi = jnp.asarray([np.sin(light), 0.0, np.cos(light)])
    wo = jnp.asarray([np.sin(viewer), 0.0, np.cos(viewer)])
    return np.asarray(axf.to_brdf(material).evaluate(wi, wo))


@named
def test_it_breaks_no_rule_and_has_a_refracting_coat(name):
    material = PAINTS[name]
    assert list(problems(material)) == []
    assert material.has_clear_coat
    assert material.coat_refracts
    assert material.properties["IOR"] == 1.5
    assert material.id == name
    assert material.metadata["generator"].startswith(f"axffit.synthesis.{name}, size 64")


@named
def test_flakes_come_with_all_mip_levels_and_a_solid_paint_has_none(name):
    material = PAINTS[name]
    flakes = material.textures.get("btfflakes")
    assert (flakes is None) == (name == "solid_yellow") == ("thetaFI_sliceLUT" not in material.properties)
    if flakes is not None:
        assert [level.shape for level in flakes.levels] == [(62, s, s, 3) for s in (16, 8, 4, 2, 1)]
        face, past = flakes.data[0].astype(np.float64), flakes.data[6].astype(np.float64)
        assert face.std() > 20 * past.std() > 0
        assert (flakes.data < 0).any()


@named
def test_a_color_table_exceeds_one_and_ends_at_the_diagonal(name):
    table = PAINTS[name].textures["brdfcolors"].data
    assert 1.1 < table.max() < 3.0
    assert (table[40, 40] == 0).all()
    if name != "silver_metallic":
        assert -0.1 < table.min() < 0


@named
def test_the_base_below_the_coat_is_passive(name):
    model = axf.to_brdf(PAINTS[name])
    assert isinstance(model, brdf.ClearCoat)
    straight = jnp.asarray([[0.0, 0.0, 1.0], [np.sin(0.7), 0.0, np.cos(0.7)]], jnp.float32)
    reflected = np.asarray(albedo(model.base, straight, samples=512))
    assert reflected.max() < 0.9
    assert reflected.min() > -0.03


@pytest.mark.parametrize(("name", "least"), [("silver_metallic", 4), ("ruby_metallic", 6), ("pearlescent", 4)])
def test_metallic_paints_flop_and_a_solid_one_does_not(name, least):
    def ratio(material):
        near, far = (seen(material, 45.0, angle) @ measured.REC709_LUMINANCE for angle in (-30.0, 65.0))
        return near / far

    assert ratio(PAINTS[name]) > least
    assert ratio(PAINTS["solid_yellow"]) < 2


def test_silver_is_neutral_and_the_others_have_their_hue():
    silver, yellow, ruby = (seen(PAINTS[n], 45.0, -20.0) for n in ("silver_metallic", "solid_yellow", "ruby_metallic"))
    assert silver.max() < 1.15 * silver.min()
    assert yellow[0] > yellow[1] > 10 * abs(yellow[2])
    assert ruby[0] > 5 * ruby[1:].max()


def test_the_hue_of_the_pearlescent_paint_travels_from_green_to_blue():
    """Light and viewer on either side of the normal, ever further apart, a little off the mirror direction."""
    hues = [seen(PAINTS["pearlescent"], angle + 10.0, -angle) for angle in (5.0, 30.0, 50.0)]
    assert [int(np.argmax(hue)) for hue in hues] == [1, 1, 2]
    blue = [hue[2] / hue[1] for hue in hues]
    assert blue[0] < 0.5 < blue[1] < 1.0 < 2.5 < blue[2]


def test_the_film_is_green_where_its_two_sides_reflect_in_phase():
    peak = 2 * paints._FILM_INDEX * paints._FILM_NM / 1.5
    assert 530 < peak < 560
    table = paints.travel_table()
    assert np.argmax(table[0, 0]) == 1
    assert table[0, 0] @ measured.REC709_LUMINANCE == pytest.approx(1.0, abs=1e-12)
