"""Where on a material the laws are checked."""

from typing import Any

import jax
import numpy as np
import pytest

from axffit import axf
from axffit.brdf import CarPaint, ClearCoat, Framed, Sum
from axffit.testing.places import MOST_EXTREME, places
from tests.testing.materials import METALLIC, constant, mapped, plain

EDGE = np.full((4, 8, 1), 0.3, np.float32)
EDGE[2, 5], EDGE[1, 7] = 0.05, 0.9


def terms_of(place) -> Any:
    """Diffuse part and lobe of an uncoated place."""
    assert isinstance(place.brdf, Framed)
    assert isinstance(place.brdf.base, Sum)
    return place.brdf.base.terms


def test_a_flat_material_has_one_place_without_a_name():
    (place,) = places(plain(), count=5)
    assert (place.name, place.extreme) == ("", False)
    assert isinstance(place.brdf, Framed)


def test_extreme_texels_come_first_and_hold_the_extremes():
    found = places(plain(specularlobe=mapped(EDGE)), count=3)
    assert [place.name.partition("), ")[2] for place in found] == [
        "smallest specularlobe",
        "largest specularlobe",
        *["at random"] * 3,
    ]
    assert [place.extreme for place in found] == [True, True, False, False, False]
    assert found[0].name.startswith("uv (0.6875, 0.625)")
    assert [float(terms_of(place)[1].roughness) for place in found[:2]] == [np.float32(0.05), np.float32(0.9)]


def test_a_map_of_another_size_is_looked_up_where_it_is_extreme():
    small = np.full((4, 4, 1), 0.3, np.float32)
    small[3, 0] = 0.8
    colors = np.linspace(0.1, 0.9, 8 * 8 * 3).reshape(8, 8, 3)
    found = places(plain(diffusecolor=mapped(colors, 20.0), specularlobe=mapped(small, 10.0)), count=0)
    (largest,) = (place for place in found if place.name.endswith("largest specularlobe"))
    assert largest.name.startswith("uv (0.0625, 0.4375)")
    assert float(terms_of(largest)[1].roughness) == np.float32(0.8)


def test_places_at_random_are_seeded():
    material = plain(specularlobe=mapped(EDGE))
    names = [[place.name for place in places(material, count=4, seed=seed)] for seed in (0, 0, 1)]
    assert names[0] == names[1] != names[2]


def test_there_are_not_too_many_extremes():
    rng = np.random.default_rng(0)
    keys = {
        "diffusecolor": 3,
        "specularcolor": 3,
        "normal": 3,
        "fresnel": 3,
        "specularlobe": 1,
        "opacity": 1,
    }
    maps = {key: mapped(rng.uniform(0.1, 0.9, (8, 8, channels))) for key, channels in keys.items()}
    assert len(places(plain(**maps), count=2)) == MOST_EXTREME + 2


def test_negative_colors_are_read_as_0():
    (place,) = places(plain(diffusecolor=constant(-0.25, 0.5, 0.5)))
    np.testing.assert_array_equal(terms_of(place)[0].color, np.asarray([0.0, 0.5, 0.5], np.float32))


def test_flakes_are_visited_at_random_places_that_share_one_structure():
    (material,) = axf.read(METALLIC).materials
    found = places(material, count=3)
    assert len({place.name for place in found}) == 3
    for place in found:
        assert isinstance(place.brdf, ClearCoat)
        assert isinstance(place.brdf.base, CarPaint)
        assert place.brdf.base.flakes is not None
        assert np.asarray(place.brdf.base.flakes.slices.texels).min() == 0
    # One compilation serves all.
    assert len({jax.tree.structure(place.brdf) for place in found}) == 1


@pytest.mark.parametrize("count", [0, 4])
def test_a_paint_that_does_not_vary_has_one_place(count):
    (material,) = axf.read(METALLIC).materials
    flat = {key: material.textures[key] for key in ("brdfcolors", "clearcoatcolor", "clearcoatior")}
    (place,) = places(axf.AxfMaterial(**{**vars(material), "textures": flat}), count=count)
    assert place.name == ""
