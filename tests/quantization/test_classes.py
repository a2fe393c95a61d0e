"""Texel classes: every texel lies in its class's box, whatever the number of classes; few classes, bounded memory."""

import numpy as np
import pytest

from axffit.axf.maps import grid_shape, texel_centers
from axffit.quantization import classes
from axffit.quantization.bounds import NoBound, classes_of
from axffit.quantization.brdf_error import without_negative_colors
from axffit.quantization.classes import ANGLES, COLUMNS, RANGES, class_table, items_of
from axffit.quantization.tiles import centers, of_packed_texels, of_texels
from axffit.targets import hdrp_10, unity_2018
from tests.targets.materials import MATERIALS, paint, texture, ward, with_texture


def everywhere(material):
    height, width = grid_shape(material)
    return texel_centers(material, *np.divmod(np.arange(height * width), width))


@pytest.mark.parametrize("engine", [unity_2018, hdrp_10], ids=lambda engine: engine.NAME)
@pytest.mark.parametrize("most", [2000, 40])
@pytest.mark.parametrize("name", MATERIALS)
def test_every_texel_lies_in_its_classs_box(name, most, engine, monkeypatch):
    monkeypatch.setattr(classes, "MOST", most)
    monkeypatch.setattr(classes, "RUN", 100)
    material = MATERIALS[name]()
    packed = engine.pack(material)
    table = class_table(material, packed)
    items = items_of(material, packed, everywhere(material))
    at = table.index_of(items)
    assert len(table) <= most
    assert at.min() >= 0
    assert np.all((items.low >= table.low[at]) & (items.high <= table.high[at]))
    np.testing.assert_array_equal(np.bincount(at, minlength=len(table)), table.items)


@pytest.mark.parametrize("name", MATERIALS)
def test_boxes_hold_the_classes_of_single_texels(name):
    material = MATERIALS[name]()
    packed = unity_2018.pack(material)
    uv = everywhere(material)[:40]
    before = without_negative_colors(of_texels(material, uv))
    after = unity_2018.unpack(of_packed_texels(packed, material, uv))
    items = items_of(material, packed, uv)
    single = classes_of(before, after, centers(len(uv)), 0)
    for k, texel in enumerate(single):
        side = {column: (items.low[k, j], items.high[k, j]) for j, column in enumerate(COLUMNS)}
        for angle in ANGLES:
            assert side[angle][1] == pytest.approx(getattr(texel, angle), rel=1e-6, abs=1e-12), angle
        for column in set(RANGES) - {"specular", "diffuse", "gap_azimuth"}:
            wanted = getattr(texel, column) or (1.0, 1.0)
            if material.kind.value == "SVBRDF" or column.startswith(("gap", "ior")):
                np.testing.assert_allclose(side[column], wanted, rtol=1e-12, atol=1e-15, err_msg=column)


def test_half_of_the_classes_and_all_of_them():
    material = ward()
    table = class_table(material, unity_2018.pack(material))
    everything = np.arange(len(table))
    halves = table.halves(everything)
    assert halves is not None
    assert sorted(np.concatenate(halves)) == list(everything)
    whole, part = table.merged(everything), table.merged(halves[0])
    assert whole.tilt >= part.tilt
    assert whole.roughness[0] <= part.roughness[0] <= part.roughness[1] <= whole.roughness[1]
    assert table.halves(everything[:1]) is None


def test_one_class_where_all_texels_are_alike():
    material = paint()
    material = with_texture(material, "clearcoatnormal", np.broadcast_to([0.0, 0.0, 1.0], (16, 16, 3)))
    table = class_table(material, unity_2018.pack(material))
    assert len(table) == 1
    assert table.merged(np.arange(1)).coat_tilt == pytest.approx(np.radians(0.00124), rel=5e-3)


def test_a_color_that_appears_from_nowhere_has_no_class():
    material = with_texture(ward(), "diffusecolor", np.zeros((16, 16, 3)))
    packed = unity_2018.pack(with_texture(material, "diffusecolor", np.full((16, 16, 3), 0.1)))
    table = class_table(material, packed)
    with pytest.raises(NoBound, match="diffuse_ratio"):
        table.merged(np.arange(len(table)))


def test_what_a_bound_does_not_cover_is_named():
    material = ward()
    normals = np.broadcast_to([0.3, 0.0, 0.95], (16, 16, 3))
    table = class_table(material, unity_2018.pack(with_texture(material, "normal", normals)))
    with pytest.raises(NoBound, match="tilt"):
        table.merged(np.arange(len(table)))
    assert texture(np.zeros((1, 1, 1))).channels == 1
