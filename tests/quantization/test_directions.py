"""Directions: where the lights are, and that each sees its view through the half vector it was made from."""

import jax.numpy as jnp
import numpy as np

from axffit.frames import refract, tangent_frame
from axffit.quantization.directions import LOWEST, even_lights, half_vectors, lobe_lights, views


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def frames_of(texels, tilt=0.2, seed=0):
    rng = np.random.default_rng(seed)
    normals = [unit(np.concatenate([tilt * rng.normal(size=(texels, 2)), np.ones((texels, 1))], -1)) for _ in range(2)]
    return normals[0], rng.uniform(-3, 3, texels), normals[1], rng.uniform(1.2, 1.9, texels)


def test_views_and_even_lights_are_unit_and_high_enough():
    for directions in (views(5), even_lights(100)):
        np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1, rtol=1e-12)
        assert directions[..., 2].min() >= LOWEST
    azimuths = np.arctan2(views(5)[..., 1], views(5)[..., 0])[:, 1:]
    assert len(np.unique(np.round(azimuths, 6))) == azimuths.size


def test_even_lights_are_even():
    assert abs(even_lights(400)[:, 2].mean() - 0.5) < 0.02
    assert np.all(np.abs(even_lights(400)[:, :2].mean(axis=0)) < 0.01)


def test_half_vectors_follow_the_roughness():
    roughness = np.array([[[0.01, 0.01]], [[0.3, 0.1]]])
    h = half_vectors(roughness, 24, 12)
    assert h.shape == (2, 1 + 24 * 12, 3)
    np.testing.assert_array_equal(h[:, 0], [[0, 0, 1], [0, 0, 1]])
    slopes = h[:, 1:, :2] / h[:, 1:, 2:] / roughness
    # In units of the roughness the core of a narrow and of a wide lobe are sampled alike.
    radius = np.linalg.norm(slopes, axis=-1).reshape(2, 24, 12)
    np.testing.assert_allclose(radius[0, :12], radius[0, :12, :1] * np.ones((1, 12)), rtol=1e-9)
    assert np.all(np.count_nonzero(radius[:, :, 0] < 2.63, axis=1) >= 6)
    assert np.linalg.norm(h[0, 1:, :2] / h[0, 1:, 2:], axis=-1).max() > 30


def below_coat(v, coat, index):
    """What enters the coat of each texel, for directions (n, views, k, 3)."""
    coat, index = (np.broadcast_to(a[:, None, None], s) for a, s in ((coat, v.shape), (index, v.shape[:-1])))
    return np.asarray(refract(jnp.asarray(v), jnp.asarray(coat), jnp.asarray(index)))


def test_lights_see_the_view_through_their_half_vector():
    normal, rotation, coat, ior = frames_of(6)
    h = half_vectors(np.full((6, 1, 2), 0.1), 8, 5)
    wo = views(6)
    for bends in (False, True):
        index = ior if bends else np.ones(6)
        arrays = [jnp.asarray(a) for a in (wo, h, normal, rotation, coat, index)]
        wi = np.asarray(lobe_lights(*arrays))
        found = np.linalg.norm(wi, axis=-1) > 0.5
        inside = [below_coat(v, coat, index) for v in (wi, np.broadcast_to(wo[:, :, None], wi.shape))]
        half = unit(inside[0] + inside[1])
        frame = np.asarray(tangent_frame(jnp.asarray(normal), jnp.asarray(rotation)))
        wanted = np.broadcast_to(np.einsum("nkj,nji->nki", h, frame)[:, None], half.shape)
        cosine = np.sum(half * wanted, axis=-1)
        # Lights that cannot leave the coat lie in its horizon; the rest are found.
        leaves = found & (np.sum(wi * coat[:, None, None], axis=-1) > 1e-6)
        assert leaves.mean() > 0.2
        # A view from behind a half vector sees its light through the opposite one.
        np.testing.assert_allclose(np.abs(cosine[leaves]), 1, atol=1e-9)
