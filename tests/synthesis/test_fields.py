"""Patterns repeat, and are what they are named: cells of points, discs over discs, normals of a height."""

import numpy as np
import pytest

from axffit.synthesis import fields
from axffit.synthesis.noise import unit_grid

SIZE = 48


def rng(seed=3):
    return np.random.Generator(np.random.PCG64(seed))


@pytest.mark.parametrize("counts", [(5, 5), (4, 6)])
def test_cells_measure_the_distance_to_the_nearest_of_all_points_and_their_repetitions(counts):
    across, down = counts
    u, v = unit_grid(SIZE)
    points = fields.jittered(rng(), counts, 0.9)
    column, row = np.meshgrid(np.arange(across), np.arange(down))
    place = np.stack([(column + points[..., 0]) / across, (row + points[..., 1]) / down], axis=-1).reshape(-1, 2)
    copies = np.concatenate([place + (a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])
    away = across * np.hypot(u[..., None] - copies[:, 0], v[..., None] - copies[:, 1])
    near = np.sort(away, axis=-1)
    found = fields.cells(u, v, points)
    np.testing.assert_allclose(found.nearest, near[..., 0], atol=1e-12)
    np.testing.assert_allclose(found.second, near[..., 1], atol=1e-12)
    np.testing.assert_allclose(np.hypot(*np.moveaxis(found.offset, -1, 0)), found.nearest, atol=1e-12)
    own = np.argmin(away, axis=-1) % (across * down)
    np.testing.assert_array_equal(found.row * across + found.column, own)


def test_a_staggered_lattice_needs_an_even_number_of_rows():
    shifted = fields.staggered((3, 4))
    assert shifted[0, 0, 0] - shifted[1, 0, 0] == 0.5
    with pytest.raises(ValueError, match="3 rows; a staggered lattice repeats with an even number only"):
        fields.staggered((4, 3))


def test_overlapping_discs_cover_the_plane_and_each_cuts_those_before_it():
    u, v = unit_grid(SIZE)
    found = fields.overlapping_discs(u, v, (4, 4), 0.74)
    assert found.nearest.max() < 0.74
    np.testing.assert_allclose(found.second, 0.74 - found.nearest)
    # A disc's share of the plane is one cell: equal for all, though no disc is shown whole.
    shown = np.bincount((4 * found.row + found.column).ravel(), minlength=16)
    assert (shown == SIZE**2 // 16).all()
    # What the next disc to the right reaches is always its own.
    assert not (np.hypot(found.offset[..., 0] - 1.0, found.offset[..., 1]) < 0.74).any()


def test_normals_are_those_of_the_height_in_millimeters():
    extent, depth = 8.0, 0.3
    u, v = unit_grid(256)
    height = depth * np.sin(2 * np.pi * u) * np.cos(4 * np.pi * v)
    exact = np.stack(
        [
            -depth * 2 * np.pi / extent * np.cos(2 * np.pi * u) * np.cos(4 * np.pi * v),
            depth * 4 * np.pi / extent * np.sin(2 * np.pi * u) * np.sin(4 * np.pi * v),
        ],
        axis=-1,
    )
    normals = fields.normals_of(height, extent)
    np.testing.assert_allclose(normals[..., :2] / normals[..., 2:], exact, atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-12)


def test_halved_takes_means():
    assert fields.halved(np.arange(16.0).reshape(4, 4)).tolist() == [[2.5, 4.5], [10.5, 12.5]]
    assert fields.halved(np.ones((4, 4, 3))).shape == (2, 2, 3)


def test_smooth_step_and_blend_run_between_their_ends():
    x = np.array([-1.0, 0.2, 0.5, 0.8, 3.0])
    step = fields.smooth_step(0.2, 0.8, x)
    np.testing.assert_allclose(step, [0, 0, 0.5, 1, 1], atol=1e-12)
    np.testing.assert_allclose(fields.blend((0.0, 1.0), (2.0, 3.0), step[2:4]), [[1, 2], [2, 3]])
