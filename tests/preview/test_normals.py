"""Normals that face away from the viewer."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.brdf import ClearCoat, Framed, Lambert
from axffit.preview.normals import LOWEST_MIRROR, bent_normal, facing, lobe_normal

angles = st.floats(0.0, 2 * np.pi)


def direction(polar: float, azimuth: float) -> np.ndarray:
    return np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])


@given(tilt=st.floats(0.0, 1.6), azimuth=angles, view=st.floats(0.0, np.radians(88.9)), length=st.floats(0.1, 3.0))
def test_the_view_lies_above_the_normal_and_its_mirror_image_above_the_surface(tilt, azimuth, view, length):
    wo = direction(view, 0.0)
    given_normal = length * direction(tilt, azimuth)
    bent = np.asarray(bent_normal(jnp.asarray(given_normal), jnp.asarray(wo)))
    normal = bent / np.linalg.norm(bent)
    mirrored = 2 * (normal @ wo) * normal - wo
    assert normal @ wo > 0
    assert mirrored[2] >= min(0.9 * wo[2], LOWEST_MIRROR) - 1e-9
    # It stays in the plane of both normals, no further from the surface's own than it was.
    cross = normal[0] * given_normal[1] - normal[1] * given_normal[0]
    assert abs(cross) < 1e-6
    assert np.arccos(min(normal[2], 1.0)) <= tilt + 1e-6


def test_a_normal_that_needs_nothing_is_not_touched():
    normal = jnp.array([0.1, 0.2, 0.7])
    np.testing.assert_array_equal(bent_normal(normal, jnp.array([0.0, 0.6, 0.8])), normal)


def test_the_closed_form_is_the_least_bending():
    """Against a search over the tilts: the largest that keeps the mirror image at the limit."""
    wo = direction(np.radians(70.0), 0.0)
    along = np.array([np.cos(2.5), np.sin(2.5)])
    tilts = np.linspace(0.0, np.radians(60.0), 200_001)
    normals = np.stack([np.sin(tilts) * along[0], np.sin(tilts) * along[1], np.cos(tilts)], axis=-1)
    mirrored = 2 * (normals @ wo) * normals[:, 2] - wo[2]
    largest = tilts[mirrored >= LOWEST_MIRROR].max()
    bent = np.asarray(bent_normal(jnp.asarray(normals[-1]), jnp.asarray(wo)))
    np.testing.assert_allclose(np.arccos(bent[2]), largest, atol=1e-5)


@pytest.mark.parametrize("coated", [False, True])
def test_coat_and_frame_are_both_bent(coated):
    away = (-0.9, 0.0, np.sqrt(1 - 0.81))
    framed = Framed(Lambert((0.5, 0.5, 0.5)), away)
    wo = jnp.asarray(direction(np.radians(60.0), 0.0))
    brdf = facing(ClearCoat(framed, 1.5, away) if coated else framed, wo)
    if coated:
        assert isinstance(brdf, ClearCoat)
        assert float(jnp.sum(brdf.normal * wo)) > 0
    assert float(jnp.sum(lobe_normal(brdf, wo) * wo)) > 0
