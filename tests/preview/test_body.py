"""The car-body-like shape: points on its surface, frames, coverage, hollow flanks and creases."""

import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.preview import Samples, Uniform, body_scene, render_body
from axffit.preview.body import _TO_BODY, _gradient, implicit

WIDTH = 96


@pytest.fixture(scope="module")
def scene():
    return body_scene(WIDTH)


def test_frames_are_orthonormal_and_face_the_viewer(scene):
    frames, wo = scene.points.frames.astype(float), scene.points.wo
    unit = np.broadcast_to(np.eye(3), frames.shape)
    np.testing.assert_allclose(np.einsum("pij,pkj->pik", frames, frames), unit, atol=1e-5)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(wo, axis=-1), 1.0, atol=1e-5)
    assert wo[:, 2].min() > 0.005


def test_the_shape_fills_the_picture_but_leaves_a_margin(scene):
    assert scene.coverage.shape == (WIDTH // 2, WIDTH)
    assert not scene.coverage[0].any()
    assert not scene.coverage[:, [0, -1]].any()
    assert 0.25 < scene.coverage.mean() < 0.6
    assert 0.0 <= scene.shadow.min()
    assert scene.shadow.max() <= 1.0


def test_a_white_body_under_uniform_light_is_white(scene):
    picture = render_body(Lambert((0.6, 0.6, 0.6)), Uniform(), width=WIDTH, samples=Samples(lobe=8, cosine=48, light=8))
    np.testing.assert_allclose(picture[scene.coverage == 1.0], 0.6, rtol=0.03)


def flank(y: np.ndarray) -> np.ndarray:
    """Half width of the body at mid length and height y, by bisection."""
    low, high = np.zeros_like(y), np.full_like(y, 1.5)
    for _ in range(50):
        middle = 0.5 * (low + high)
        outside = implicit(np.stack([np.full_like(y, 0.1), y, middle], axis=-1)) > 0
        low, high = np.where(outside, low, middle), np.where(outside, middle, high)
    return low


def test_the_flank_is_hollow_and_breaks_at_the_character_line():
    y = np.linspace(0.15, 0.55, 401)
    bend = np.gradient(np.gradient(flank(y), y), y)
    assert bend[5:-5].max() > 2.0, "no hollow: the flank curves outwards everywhere"
    y = np.linspace(0.50, 0.62, 401)
    bend = np.gradient(np.gradient(flank(y), y), y)
    assert bend[5:-5].min() < -5.0, "no crease: the flank turns nowhere within centimeters"


def test_normals_are_the_gradient():
    point = np.array([[0.3, 0.4, flank(np.array([0.4]))[0]]])
    toward = _gradient(point)[0]
    assert implicit(point + 1e-3 * toward / np.linalg.norm(toward)) > 0 > implicit(point - 1e-3 * toward)
    np.testing.assert_allclose(_TO_BODY @ _TO_BODY.T, np.eye(3), atol=1e-12)
