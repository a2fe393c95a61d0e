"""Tone curve, sRGB, differences and the PNG writer."""

import io

import numpy as np
import pytest
from PIL import Image

from axffit.preview.picture import (
    difference_to_display,
    display_steps,
    encode_srgb,
    indexed_png_bytes,
    inverse_tone_curve,
    png_bytes,
    to_display,
    tone_curve,
)


def test_tone_curve_keeps_what_is_not_highlight_and_never_turns():
    x = np.linspace(0, 40, 4001)
    y = tone_curve(x)
    np.testing.assert_array_equal(y[x <= 0.6], x[x <= 0.6])
    assert np.all(np.diff(y) >= 0)
    assert y[-1] <= 1.0
    slope = np.diff(tone_curve(np.array([0.6 - 1e-6, 0.6, 0.6 + 1e-6]))) / 1e-6
    np.testing.assert_allclose(slope, 1.0, atol=1e-4)
    np.testing.assert_allclose(inverse_tone_curve(tone_curve(x[x < 3])), x[x < 3], rtol=1e-4)


def test_srgb_at_published_values():
    # IEC 61966-2-1: the linear toe meets the power law, 18 % gray is code 118, white 255.
    np.testing.assert_allclose(
        encode_srgb(np.array([0.0, 0.0031308, 0.18, 1.0])) * 255, [0, 10.31, 117.6, 255], atol=0.05
    )


def test_to_display_shows_gray_as_neutral_and_does_not_depend_on_the_picture():
    dark = to_display(np.full((2, 2, 3), 0.18))
    beside_a_light = to_display(np.concatenate([np.full((1, 2, 3), 0.18), np.full((1, 2, 3), 900.0)]))
    assert np.all(dark == 118)
    np.testing.assert_array_equal(beside_a_light[0], dark[0])
    assert np.all(beside_a_light[1] == 255)


def test_difference_is_amplified_and_blind_to_order():
    a, b = np.full((1, 1, 3), 0.20), np.full((1, 1, 3), 0.21)
    expected = 8 * 255 * (encode_srgb(np.array(0.21)) - encode_srgb(np.array(0.20)))
    assert abs(int(difference_to_display(a, b)[0, 0, 0]) - expected) <= 0.5
    np.testing.assert_array_equal(difference_to_display(a, b), difference_to_display(b, a))
    assert not difference_to_display(a, a).any()


def test_png_is_read_back_by_pillow():
    rng = np.random.default_rng(7)
    picture = rng.integers(0, 256, (37, 53, 3)).astype(np.uint8)
    data = png_bytes(picture)
    with Image.open(io.BytesIO(data)) as image:
        np.testing.assert_array_equal(np.asarray(image), picture)
    assert png_bytes(picture) == data


@pytest.mark.parametrize("picture", [np.zeros((4, 4, 3)), np.zeros((4, 4), np.uint8), np.zeros((4, 4, 4), np.uint8)])
def test_png_refuses_other_pictures(picture):
    with pytest.raises(ValueError, match="uint8 pictures of shape"):
        png_bytes(picture)


def test_indexed_png_is_read_back_by_pillow():
    rng = np.random.default_rng(8)
    palette = rng.integers(0, 256, (256, 3)).astype(np.uint8)
    indices = rng.integers(0, 256, (9, 14)).astype(np.uint8)
    with Image.open(io.BytesIO(indexed_png_bytes(indices, palette))) as image:
        np.testing.assert_array_equal(np.asarray(image.convert("RGB")), palette[indices])
    with pytest.raises(ValueError, match="make no indexed PNG"):
        indexed_png_bytes(indices, palette[:4])


def test_display_steps_count_8_bit_steps():
    a = np.full((1, 2, 3), 0.2)
    b = a.copy()
    b[0, 1, 2] = 0.21
    expected = 255 * (encode_srgb(np.array(0.21)) - encode_srgb(np.array(0.2)))
    np.testing.assert_allclose(display_steps(a, b), [[0.0, expected]], rtol=1e-12)
