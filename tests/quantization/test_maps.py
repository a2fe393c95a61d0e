"""Map errors: statistics with their place, over levels and slices, in blocks."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.quantization import maps
from axffit.quantization.maps import map_errors
from axffit.quantization.statistics import Place
from axffit.targets import unity_2018
from tests.targets.materials import paint, texture, ward, with_texture


def errors_of(material, axf_name, change=None, apart=None, **options):
    packed = unity_2018.pack(material, **options)
    packed_texture = next(t for t in packed.textures.values() if t.axf_name == axf_name)
    if change is not None:
        levels = tuple(level.copy() for level in packed_texture.levels)
        change(levels)
        packed_texture = replace(packed_texture, levels=levels)
    reading = unity_2018.reading(packed_texture, packed.values)
    return map_errors(material.textures[axf_name], packed_texture, reading, apart)


def test_a_planted_error_is_found_where_it_is():
    def spoil(levels):
        levels[0][5, 9, 0] += 655

    found = errors_of(ward(), "normal", spoil).statistics[0]
    assert found.where == Place(0, None, 5, 9, 9.5 / 16, 5.5 / 16)
    assert 0.5 < found.max < 1.5
    assert found.p95 < 0.002
    assert found.mean < found.max / 50


def test_a_planted_error_in_a_mip_level_of_a_slice_is_found():
    def spoil(levels):
        levels[2][7, 1, 3, 1] = np.float16(9.0).view(np.uint16)

    found = errors_of(paint(), "btfflakes", spoil)
    assert found.statistics[0].where == Place(2, 7, 1, 3, 3.5 / 4, 1.5 / 4)
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


@pytest.mark.parametrize(("material", "key"), [(ward, "diffusecolor"), (ward, "anisrotation"), (paint, "btfflakes")])
def test_neither_blocks_nor_files_change_the_result(material, key, monkeypatch):
    whole = errors_of(material(), key)
    monkeypatch.setattr("axffit.targets.encoding.BLOCK_TEXELS", 37)
    monkeypatch.setattr("axffit.quantization.filtered.BLOCK_TEXELS", 37)
    monkeypatch.setattr("axffit.quantization.statistics._RUN", 41)
    monkeypatch.setattr("axffit.axf.scratch.LARGE", 100)
    parts = errors_of(material(), key)
    for one, other in zip(whole.statistics, parts.statistics, strict=True):
        assert one.mean == pytest.approx(other.mean, rel=1e-6)
        same = ("measure", "p95", "p999", "max", "where", "texels", "total", "level")
        assert [getattr(one, name) for name in same] == [getattr(other, name) for name in same]
    np.testing.assert_array_equal(whole.picture, parts.picture)


def test_each_mip_level_has_its_numbers_and_may_stand_apart():
    def spoil(levels):
        levels[1][3, 2, 5, 0] = np.float16(9.0).view(np.uint16)

    whole = errors_of(paint(), "btfflakes", spoil).statistics[0]
    assert [each.level for each in whole.levels] == [0, 1, 2, 3]
    assert whole.level is None
    assert max(each.max for each in whole.levels) == whole.max == whole.levels[1].max
    assert whole.levels[0].max <= 2.0**-11
    assert whole.levels[1].where == Place(1, 3, 2, 5, 5.5 / 8, 2.5 / 8) == whole.where
    assert sum(each.total for each in whole.levels) == whole.total
    rest, apart = errors_of(paint(), "btfflakes", spoil, apart={"relative": {1}}).statistics[:2]
    assert (rest.level, [each.level for each in rest.levels]) == (None, [0, 2, 3])
    assert rest.max <= 2.0**-11
    assert (apart.level, apart.max, apart.where, apart.levels) == (1, whole.max, whole.where, ())


def test_every_level_may_stand_apart():
    found = errors_of(ward(), "normal", apart={"angle": {0}}).statistics
    assert [(each.measure, each.level) for each in found] == [
        ("angle", 0),
        ("filtered_angle", None),
        ("filtered_length", None),
    ]


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("key", ["diffusecolor", "fresnel", "height", "specularlobe"])
def test_a_texel_that_is_no_number_any_more_is_wrong_without_limit(key, value):
    def spoil(levels):
        levels[0][2, 3, 0] = np.float16(value).view(np.uint16)

    found = errors_of(ward(), key, spoil)
    assert found.non_finite == 1
    assert all((each.where.row, each.where.column) == (2, 3) for each in found.statistics)
    assert next(each for each in found.statistics if each.measure == "absolute").max == np.inf
    if np.isnan(value):
        assert all(each.max == np.inf for each in found.statistics)
    assert errors_of(ward(), key).non_finite == 0


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
    assert delta_e.where == Place(0, None, 3, 11, 11.5 / 16, 3.5 / 16)
    assert delta_e.max > 20


def test_an_infinite_error_is_null_in_json():
    indices = np.full((4, 4, 1), 1.5)
    indices[1, 2] = np.inf
    indices[2, 2] = 3e5
    statistics = errors_of(with_texture(ward(), "clearcoatior", indices), "clearcoatior").statistics
    ior = next(s for s in statistics if s.measure == "ior")
    assert ior.max == np.inf
    assert ior.to_json()["max"] is None
    assert ior.where == Place(0, None, 2, 2, 2.5 / 4, 2.5 / 4)


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
