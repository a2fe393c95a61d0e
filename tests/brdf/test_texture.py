"""Texture lookups: centers, weights, wrap, mirrored tiles, mip levels and slices."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.brdf import TextureMap, constant_map, texture_map

RNG = np.random.default_rng(5)
GRID = RNG.normal(size=(4, 8, 2))


def fetch(texture, u, v, *args):
    return np.asarray(texture.fetch(jnp.asarray([u, v], float), *args))


def test_texel_centers_return_the_texels_and_u_is_the_column():
    texture = texture_map([GRID])
    for row, column in ((0, 0), (3, 7), (2, 5)):
        np.testing.assert_allclose(fetch(texture, (column + 0.5) / 8, (row + 0.5) / 4), GRID[row, column], rtol=1e-14)


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_bilinear_lookup_repeats_and_agrees_with_its_definition(u, v):
    x, y = u * 8 - 0.5, v * 4 - 0.5
    c, r = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - c, y - r
    expected = sum(
        weight * GRID[(r + dr) % 4, (c + dc) % 8]
        for dr, dc, weight in (
            (0, 0, (1 - fx) * (1 - fy)),
            (0, 1, fx * (1 - fy)),
            (1, 0, (1 - fx) * fy),
            (1, 1, fx * fy),
        )
    )
    np.testing.assert_allclose(fetch(texture_map([GRID]), u, v), expected, atol=1e-12)


@given(st.floats(-2, 2), st.floats(-2, 2))
def test_mirrored_tiles_are_mirror_images(u, v):
    texture = texture_map([GRID], mirrored=True)
    np.testing.assert_allclose(fetch(texture, u, v), fetch(texture, -u, 2.0 - v), atol=1e-9)


def test_levels_are_mixed_linearly_and_clamped():
    coarse = RNG.normal(size=(2, 4, 2))
    texture = texture_map([GRID, coarse])
    low, high = fetch(texture_map([GRID]), 0.3, 0.6), fetch(texture_map([coarse]), 0.3, 0.6)
    for level, expected in ((-1.0, low), (0.25, 0.75 * low + 0.25 * high), (1.0, high), (9.0, high)):
        np.testing.assert_allclose(fetch(texture, 0.3, 0.6, jnp.asarray(level)), expected, rtol=1e-13)


def test_slices_do_not_mix():
    stack = RNG.normal(size=(3, 4, 8, 2))
    texture = texture_map([stack, stack[:, ::2, ::2]])
    for k in range(3):
        alone = texture_map([stack[k], stack[k, ::2, ::2]])
        for level in (0.0, 0.5, 1.0):
            at = jnp.asarray(level)
            np.testing.assert_array_equal(fetch(texture, 0.9, 0.1, at, jnp.asarray(k)), fetch(alone, 0.9, 0.1, at))


def test_constant_map_is_constant_with_gradient_zero_in_uv():
    texture = constant_map(np.asarray([0.2, 0.7]))
    np.testing.assert_allclose(fetch(texture, 0.123, -4.5), [0.2, 0.7], rtol=1e-15)
    np.testing.assert_allclose(jax.jacobian(texture.fetch)(jnp.asarray([0.3, 0.4])), np.zeros((2, 2)), atol=1e-15)


def test_gradient_in_the_texels_is_the_weights():
    uv = jnp.asarray([(5 + 0.75) / 8, (2 + 0.6) / 4])
    texture = texture_map([GRID])
    gradient = jax.grad(lambda texels: TextureMap(texels, texture.shapes).fetch(uv)[1])(texture.texels).reshape(4, 8, 2)
    expected = np.zeros((4, 8, 2))
    expected[2:4, 5:7, 1] = np.outer([0.9, 0.1], [0.75, 0.25])
    np.testing.assert_allclose(gradient, expected, atol=1e-13)


def test_bad_shapes_are_refused():
    with pytest.raises(ValueError, match=r"\[H, W, C\]"):
        texture_map([np.zeros((4, 4))])
    with pytest.raises(ValueError, match="do not fill"):
        TextureMap(np.zeros((5, 3)), ((1, 2, 2),))


def test_tiles_repeat_the_texture():
    twice = texture_map([GRID], tiles=(2.0, 3.0))
    np.testing.assert_allclose(fetch(twice, 0.3, 0.2), fetch(texture_map([GRID]), 0.6, 0.6), atol=1e-13)
    assert float(twice.level_of(jnp.asarray(1.0))) == np.log2(16.0)
