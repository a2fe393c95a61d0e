"""Tiles and chosen texels: the values that whole materials have there, before and after."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.axf import AxfTexture
from axffit.axf.maps import SPATIAL_KEYS, gather, grid_shape
from axffit.quantization.tiles import centers, of_packed_texels, of_texels, tiles
from axffit.targets import hdrp_10, unity_2018, unreal
from tests.targets.materials import paint, ward, with_texture


def mixed():
    """Maps of other sizes in texels and in millimeters, an absent one and a constant one."""
    material = ward(size=16)
    textures = {key: texture for key, texture in material.textures.items() if key != "opacity"}
    textures["fresnel"] = replace(textures["fresnel"], levels=(textures["fresnel"].data[:5, :7],))
    textures["diffusecolor"] = replace(textures["diffusecolor"], width_mm=11.0)
    textures["clearcoatior"] = AxfTexture((np.full((1, 1, 1), 1.4, np.float32),))
    return replace(material, textures=textures)


MATERIALS = {"ward": ward, "mixed": mixed, "paint": paint}
TARGETS = {"unity_2018": unity_2018, "hdrp_10": hdrp_10, "unreal": unreal}
CASES = [("ward", "unity_2018"), ("mixed", "hdrp_10"), ("mixed", "unity_2018"), ("paint", "unreal"), ("ward", "unreal")]


@pytest.mark.parametrize(("name", "target"), CASES)
@pytest.mark.parametrize("texels", [37, 1024])
def test_tiles_hold_what_both_materials_hold_everywhere(name, target, texels):
    material, module = MATERIALS[name](), TARGETS[target]
    packed = module.pack(material)
    seen = module.unpack(packed)
    height, width = grid_shape(material)
    found = list(tiles(material, packed, texels))
    assert [tile.start for tile in found] == list(range(0, height * width, texels))
    assert sum(len(tile.uv) for tile in found) == height * width
    for tile in found:
        for values, whole in ((tile.before, material), (tile.after, seen)):
            wanted = gather(whole, tile.uv)
            assert set(values) == set(SPATIAL_KEYS)
            for key in SPATIAL_KEYS:
                np.testing.assert_array_equal(values[key], wanted[key], err_msg=key)
                assert values[key].dtype == np.float32


@pytest.mark.parametrize(("name", "target"), CASES)
@pytest.mark.parametrize("count", [1, 9])
def test_a_material_of_some_texels_holds_what_the_whole_one_holds_there(name, target, count):
    material, module = MATERIALS[name](), TARGETS[target]
    packed = module.pack(material)
    uv = np.random.default_rng(3).random((count, 2))
    few = of_texels(material, uv), module.unpack(of_packed_texels(packed, material, uv))
    for small, whole in zip(few, (material, module.unpack(packed)), strict=True):
        values, wanted = gather(small, centers(count)), gather(whole, uv)
        for key in SPATIAL_KEYS:
            np.testing.assert_array_equal(values[key], wanted[key], err_msg=key)
        # What does not vary over the surface is the same.
        assert small.properties.keys() == whole.properties.keys()
        assert (small.has_clear_coat, small.anisotropic) == (whole.has_clear_coat, whole.anisotropic)


def test_a_material_without_varying_maps_has_one_texel():
    material = with_texture(paint(), "clearcoatnormal", np.array([[[0.0, 0.0, 1.0]]]))
    (tile,) = tiles(material, unity_2018.pack(material))
    assert tile.uv.tolist() == [[0.5, 0.5]]
    assert tile.before["clearcoatnormal"].tolist() == [[0, 0, 1]]
