"""Error maps as pictures."""

import base64
import io

import numpy as np
from PIL import Image

from axffit.brdf import Lambert
from axffit.report.pictures import LARGEST_SIDE, PALETTE, affordable, error_map_picture


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
