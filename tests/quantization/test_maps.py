"""Map errors: statistics with their place, over levels and slices, in blocks."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.quantization import maps
from axffit.quantization.maps import Place, map_errors
from axffit.targets import unity_2018
from tests.targets.materials import paint, texture, ward, with_texture


def errors_of(material, axf_name, change=None, **options):
    packed = unity_2018.pack(material, **options)
    packed_texture = next(t for t in packed.textures.values() if t.axf_name == axf_name)
    if change is not None:
        levels = tuple(level.copy() for level in packed_texture.levels)
        change(levels)
        packed_texture = replace(packed_texture, levels=levels)
    return map_errors(material.textures[axf_name], packed_texture, unity_2018.reading(packed_texture, packed.values))


def test_a_planted_error_is_found_where_it_is():
    def spoil(levels):
        levels[0][5, 9, 0] += 655

    found = errors_of(ward(), "normal", spoil).statistics[0]
    assert found.where == Place(0, None, 5, 9)
    assert 0.5 < found.max < 1.5
    assert found.p95 < 0.002
    assert found.mean < found.max / 50


def test_a_planted_error_in_a_mip_level_of_a_slice_is_found():
    def spoil(levels):
        levels[2][7, 1, 3, 1] = np.float16(9.0).view(np.uint16)

    found = errors_of(paint(), "btfflakes", spoil)
    assert found.statistics[0].where == Place(2, 7, 1, 3)
    # The picture is of level 0, which is right.
    assert found.picture.max() < 5e-4


def test_the_picture_of_an_array_is_the_slice_with_the_largest_error():
    def spoil(levels):
        levels[0][4, 2, 3, 1] = np.float16(9.0).view(np.uint16)

    found = errors_of(paint(), "btfflakes", spoil)
    assert found.picture.shape == (16, 16)
    assert np.unravel_index(np.argmax(found.picture), (16, 16)) == (2, 3)


def test_statistics_are_those_of_the_errors():
    found = errors_of(ward(size=64), "specularlobe")
    errors = found.picture.astype(np.float64).reshape(-1)
    first = found.statistics[0]
    assert first.mean == pytest.approx(errors.mean(), rel=1e-6)
    assert first.max == errors.max()
    assert np.mean(errors <= first.p95) >= 0.95
    assert np.mean(errors < first.p95) <= 0.95
    assert (first.texels, first.total) == (4096, 4096)
    assert 0 < first.mean < first.p95 < first.p999 <= first.max <= 2.0**-11


def test_blocks_do_not_change_the_result(monkeypatch):
    whole = errors_of(ward(), "diffusecolor")
    monkeypatch.setattr("axffit.targets.encoding.BLOCK_TEXELS", 37)
    parts = errors_of(ward(), "diffusecolor")
    assert [s.to_json() for s in whole.statistics] == [s.to_json() for s in parts.statistics]
    np.testing.assert_array_equal(whole.picture, parts.picture)


def test_a_costly_measure_of_a_large_map_still_meets_the_worst_texel(monkeypatch):
    pytest.importorskip("colour")
    monkeypatch.setattr(maps, "COSTLY_TEXELS", 8)
    monkeypatch.setattr(maps, "WORST_OF_BLOCK", 4)

    def spoil(levels):
        levels[0][3, 11, 1] = np.float16(0.9).view(np.uint16)

    colors = np.full((16, 16, 3), 0.5)
    found = errors_of(with_texture(ward(), "diffusecolor", colors), "diffusecolor", spoil)
    delta_e = found.statistics[2]
    assert delta_e.measure == "delta_e_2000"
    assert delta_e.texels < delta_e.total == 256
    assert delta_e.where == Place(0, None, 3, 11)
    assert delta_e.max > 20


def test_an_infinite_error_is_null_in_json():
    indices = np.full((4, 4, 1), 1.5)
    indices[1, 2] = np.inf
    indices[2, 2] = 3e5
    statistics = errors_of(with_texture(ward(), "clearcoatior", indices), "clearcoatior").statistics
    ior = next(s for s in statistics if s.measure == "ior")
    assert ior.max == np.inf
    assert ior.to_json()["max"] is None
    assert ior.where == Place(0, None, 2, 2)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_flat_normals_and_zero_angles_have_their_known_errors(tilt):
    normals = np.broadcast_to([tilt, 0.0, 1.0], (4, 4, 3)) / np.hypot(tilt, 1)
    material = with_texture(with_texture(ward(), "normal", normals), "anisrotation", np.zeros((4, 4, 1)))
    normal = errors_of(material, "normal").statistics[0]
    angle = errors_of(material, "anisrotation").statistics[0]
    if tilt == 0:
        assert normal.max == pytest.approx(0.00124, rel=5e-3)
    assert normal.max <= np.degrees(np.arcsin(3**0.5 / 65535))
    assert angle.max == pytest.approx(0.00275, rel=2e-3)
    assert texture(normals).channels == 3
