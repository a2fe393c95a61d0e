"""Filtering: AxF's maps in what they mean, packed ones in what the hardware holds; mip levels."""

import numpy as np
import pytest

from axffit.axf import AxfMaterial, AxfTexture, MaterialKind
from axffit.preview.textures import original_texture, packed_texture
from axffit.targets import PackedMaterial, unity_2018

ONE = np.ones(2)
BETWEEN = np.array([[0.5, 0.5]])
POINT = np.zeros(1)


def texture(values) -> AxfTexture:
    return AxfTexture((np.asarray(values, np.float32),), 10.0, 10.0)


def packed(**maps) -> PackedMaterial:
    textures = {name: texture(values) for name, values in maps.items()}
    return unity_2018.pack(AxfMaterial("m", "m", MaterialKind.SVBRDF, anisotropic=False, textures=textures))


def seen(material: PackedMaterial, axf_name: str, uv: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    one = next(t for t in material.textures.values() if t.axf_name == axf_name)
    return packed_texture(one, unity_2018.reading(one, material.values), ONE).fetch(uv, footprint)


ANGLES = np.deg2rad(np.array([[[89.0], [-89.0]], [[89.0], [-89.0]]]))


def test_axes_are_averaged_modulo_pi_by_axf_and_as_numbers_by_the_hardware():
    original = original_texture("anisrotation", texture(ANGLES), ONE).fetch(BETWEEN, POINT)
    np.testing.assert_allclose(np.abs(np.degrees(original)), 90.0, atol=1e-5)
    hardware = seen(packed(anisrotation=ANGLES), "anisrotation", BETWEEN, POINT)
    np.testing.assert_allclose(hardware, 0.0, atol=1e-4)


def test_the_hardware_averages_f0_and_not_the_index():
    indices = np.array([[[1.2], [2.4]], [[1.2], [2.4]]])
    original = original_texture("clearcoatior", texture(indices), ONE).fetch(BETWEEN, POINT)
    np.testing.assert_allclose(original, 1.8, rtol=1e-6)
    f0 = np.mean([((n - 1) / (n + 1)) ** 2 for n in (1.2, 2.4)])
    hardware = seen(packed(clearcoatior=indices), "clearcoatior", BETWEEN, POINT)
    np.testing.assert_allclose(hardware, (1 + np.sqrt(f0)) / (1 - np.sqrt(f0)), rtol=1e-3)


def test_filtered_normals_stay_shorter_than_one():
    normals = np.array([[[0.6, 0, 0.8], [-0.6, 0, 0.8]]] * 2)
    hardware = seen(packed(normal=normals), "normal", BETWEEN, POINT)
    np.testing.assert_allclose(hardware, [[0, 0, 0.8]], atol=1e-4)


def test_texel_centers_give_the_codes_values_and_repeat():
    values = np.random.default_rng(2).uniform(0, 1, (3, 5, 1))
    centers = np.array([[(c + 0.5) / 5 + shift, (r + 0.5) / 3] for r in range(3) for c in range(5) for shift in (0, 7)])
    got = seen(packed(specularlobe=values), "specularlobe", centers, np.zeros(30))
    expected = np.repeat(values.reshape(-1, 1).astype(np.float16).astype(float), 2, axis=0)
    np.testing.assert_allclose(got, expected, atol=1e-9)


@pytest.mark.parametrize(("texels", "expected"), [(1, [0.0, 1.0]), (2, [0.5, 0.5]), (1.4142135623730951, [0.25, 0.75])])
def test_levels_follow_the_footprint(texels, expected):
    """Columns 0, 1, 0, 1 ... average to 1/2 from the second level on; halfway lies between."""
    stripes = np.broadcast_to(np.tile([0.0, 1.0], 4)[None, :, None], (8, 8, 1))
    centers = np.array([[0.5 / 8, 0.5], [1.5 / 8, 0.5]])
    original = original_texture("specularlobe", texture(stripes), ONE).fetch(centers, np.full(2, texels / 8))
    np.testing.assert_allclose(original[:, 0], expected, atol=1e-9)


def test_made_levels_are_stored_in_the_format():
    """The mean of codes 0 and 1 of R8_UNORM is no code: a level holds the nearest one."""
    half_code = np.tile(np.array([0.0, 1.0]) / 255, 2).reshape(1, 4, 1).repeat(4, axis=0)
    got = seen(packed(opacity=half_code), "opacity", BETWEEN, np.array([0.5]))
    np.testing.assert_allclose(got * 255, np.rint(got * 255), atol=1e-9)


def test_levels_of_odd_sizes_end_at_one_texel():
    one = original_texture("height", texture(np.ones((5, 3, 1))), ONE)
    assert [level.shape[:2] for level in one.levels] == [(5, 3), (3, 2), (2, 1), (1, 1)]
