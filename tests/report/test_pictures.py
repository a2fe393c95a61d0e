"""Error maps as pictures; materials before and after."""

import base64
import io

import numpy as np
from PIL import Image

from axffit import axf
from axffit.brdf import Lambert
from axffit.report.pictures import LARGEST_SIDE, PALETTE, affordable, error_map_picture, material_pictures
from axffit.targets import unity_2018


def pixels(uri: str) -> np.ndarray:
    with Image.open(io.BytesIO(base64.b64decode(uri.split(",", 1)[1]))) as image:
        return np.asarray(image.convert("RGB"))


def test_colors_run_from_zero_to_the_largest_error_and_row_0_is_at_the_bottom():
    picture = error_map_picture(np.array([[0.0, 2.0], [1.0, 0.5]]))
    shown = pixels(picture.uri)
    assert picture.largest == 2.0
    np.testing.assert_array_equal(shown[1, 0], PALETTE[0])
    np.testing.assert_array_equal(shown[1, 1], PALETTE[255])
    np.testing.assert_array_equal(shown[0, 0], PALETTE[128])


def test_large_maps_keep_their_worst_texel():
    errors = np.zeros((700, 300), np.float32)
    errors[699, 299] = 3.0
    picture = error_map_picture(errors)
    shown = pixels(picture.uri)
    assert max(shown.shape) <= LARGEST_SIDE
    assert picture.block == 6
    np.testing.assert_array_equal(shown[0, -1], PALETTE[255])
    assert (shown == PALETTE[255]).all(axis=-1).sum() == 1


def test_infinite_errors_are_at_the_top_and_do_not_stretch_the_scale():
    picture = error_map_picture(np.array([[0.0, np.inf, 1.0]]))
    assert picture.largest == 1.0
    np.testing.assert_array_equal(pixels(picture.uri)[0, 1], PALETTE[255])
    only = error_map_picture(np.array([[0.0, np.inf]]))
    assert only.largest == 0.0
    np.testing.assert_array_equal(pixels(only.uri)[0, 1], PALETTE[255])


def test_a_simple_model_is_affordable():
    assert affordable(Lambert(np.array([0.1, 0.2, 0.3])))


def test_material_pictures_show_what_packing_does_and_say_how_much():
    material = axf.AxfMaterial(
        "m",
        "m",
        axf.MaterialKind.SVBRDF,
        textures={
            name: axf.AxfTexture((np.full((2, 2, len(value)), value, np.float32),), 10.0, 10.0)
            for name, value in {
                "diffusecolor": (0.5, 0.2, 0.1),
                "specularcolor": (0, 0, 0),
                "specularlobe": (0.3,),
            }.items()
        },
    )
    packed = unity_2018.pack(material, formats={"diffusecolor": "RGBA8_UNORM_SRGB"})
    pairs = material_pictures(material, packed, size=24)
    assert [(p.facts["shape"], p.facts["light"]) for p in pairs] == [
        ("sphere", "studio"), ("body", "studio"), ("sphere", "sun_sky"), ("body", "sun_sky")
    ]  # fmt: skip
    for pair in pairs:
        facts, shown = pair.facts, {name: pixels(uri).astype(int) for name, uri in pair.uris.items()}
        assert shown["before"].shape == (facts["height"], facts["width"], 3)
        # One code of 8-bit sRGB is half a step of the display off, at most.
        assert 0 < facts["most_steps"] < 1.5
        assert facts["psnr_db"] > 45
        assert 0 < facts["flip"]["mean"] < 0.05
        assert shown["difference"].max() <= np.ceil(8 * facts["largest_steps"])
        assert shown["amplified"].max() > 5 * shown["difference"].max()
