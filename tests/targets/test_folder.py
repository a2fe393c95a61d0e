"""Folders of packed textures: what is written comes back bit for bit, and says where it came from."""

import json
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axffit.axf import AxfFile, MaterialKind
from axffit.errors import InputError
from axffit.targets import TARGETS, folder, unity_2018
from axffit.targets.folder_json import schema
from axffit.testing.strategies import axf_files, axf_materials
from axffit.textures import ROUNDINGS, format_named
from tests.targets.materials import MATERIALS, paint, ward, with_texture, without


def packed_alike(a, b):
    """Whether two packed materials agree in everything, every code included."""
    assert (a.target, a.id, a.name, a.kind) == (b.target, b.id, b.name, b.kind)
    assert (dict(a.values), dict(a.metadata), a.notes) == (dict(b.values), dict(b.metadata), b.notes)
    assert list(a.textures) == list(b.textures)
    for name, first in a.textures.items():
        second = b.textures[name]
        assert replace(first, levels=()).__dict__ == replace(second, levels=()).__dict__
        assert len(first.levels) == len(second.levels)
        for x, y in zip(first.levels, second.levels, strict=True):
            assert x.dtype == y.dtype
            assert np.array_equal(x, y), name
    return True


def as_imported(material, target="unity_2018", **options):
    return TARGETS[target].unpack(TARGETS[target].pack(material, **options), defaults=False)


def outcome(function, *arguments, **options):
    """What a call returns, and the message of its refusal; one of them is None."""
    try:
        return function(*arguments, **options), None
    except InputError as error:
        return None, str(error)


@given(
    material=axf_materials(), target=st.sampled_from(list(TARGETS)), container=st.sampled_from(["auto", "dds", "ktx2"])
)
def test_every_material_comes_back_as_its_target_sees_it(material, target, container, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    packed, refused = outcome(TARGETS[target].pack, material)
    exported, not_written = outcome(folder.write, material, out, target=target, container=container)
    if exported is None or packed is None:
        # DDS has no formats of three channels of 8 or 16 bits; what cannot be packed cannot be exported.
        assert not_written == refused or (container == "dds" and "cannot be stored as dds" in str(not_written))
        assert list(out.iterdir()) == []
        return
    content = json.loads((exported[0].folder / "material.json").read_text())
    assert content == exported[0].content
    jsonschema.validate(content, schema())
    assert packed_alike(folder.read_packed(exported[0].folder), packed)
    (back,) = folder.read(out).materials
    assert back.identical(as_imported(material, target))


@given(material=axf_materials(), rounding=st.sampled_from(ROUNDINGS))
def test_import_is_within_each_format_s_proven_bound(material, rounding, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    folder.write(material, out, rounding=rounding)
    (back,) = folder.read(out).materials
    packed = unity_2018.pack(material, rounding=rounding)
    compared = set()
    for packed_texture in packed.textures.values():
        key = packed_texture.axf_name
        if packed_texture.defaulted or key not in material.textures:
            continue
        form = format_named(packed_texture.format)
        reading = unity_2018.reading(packed_texture, packed.values)
        for before, after in zip(material.textures[key].levels, back.textures[key].levels, strict=True):
            channels = before.shape[-1]
            lowest, highest = (
                np.array([getattr(c, end) for c in form.codecs[:channels]]) for end in ("lowest", "highest")
            )
            wanted = np.clip(reading.forward(before), lowest, highest)
            full = np.zeros((*wanted.shape[:-1], form.channels))
            full[..., :channels] = wanted
            bound = form.error_bound(full, rounding)[..., :channels]
            # The decoded value is held in float32, as in a shader.
            single = 2.0**-22 * np.maximum(1.0, np.abs(wanted))
            assert np.all(np.abs(reading.forward(after) - wanted) <= bound + single), key
        compared.add(key)
    assert compared == {key for key in material.textures if unity_2018.texture_name(key, material.kind)}


EXACT = {
    "diffusecolor": "RGBA32F",
    "specularcolor": "RGBA32F",
    "normal": "RGBA32F",
    "specularlobe": "RG32F",
    "anisrotation": "R32F",
    "fresnel": "RGBA32F",
    "height": "R32F",
    "brdfcolors": "RGBA32F",
    "btfflakes": "RGBA32F",
    "clearcoatcolor": "RGBA32F",
    "clearcoatnormal": "RGBA32F",
}


@pytest.mark.parametrize("container", ["auto", "exr", "dds", "ktx2"])
@pytest.mark.parametrize("name", MATERIALS)
def test_import_is_exact_where_the_format_is(name, container, tmp_path):
    material = MATERIALS[name]()
    formats = {key: format for key, format in EXACT.items() if key in material.textures}
    folder.write(material, tmp_path, formats=formats, container=container)
    (back,) = folder.read(tmp_path).materials
    for key in formats:
        kept = tuple(
            np.maximum(level, 0) if "color" in key or key == "btfflakes" else level
            for level in material.textures[key].levels
        )
        assert replace(material.textures[key], levels=kept).identical(back.textures[key]), key
    for key, value in material.properties.items():
        if key != "cc_no_refraction":
            np.testing.assert_array_equal(back.properties[key], value)


@settings(max_examples=max(1, settings().max_examples // 3))
@given(file=axf_files())
def test_files_of_several_materials_keep_their_order_version_and_ids(file, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    exported = folder.write(file, out)
    assert {path.name for path in out.iterdir()} == {item.folder.name for item in exported}
    back = folder.read(out)
    assert back.version == file.version
    assert [material.id for material in back.materials] == [material.id for material in file.materials]
    for found, material in zip(back.materials, file.materials, strict=True):
        assert found.identical(as_imported(material))


def test_material_json_says_where_each_texture_came_from(tmp_path):
    file = AxfFile((ward(), paint()), version=(1, 4, 2), source="some/where/both.axf")
    ward_out, paint_out = folder.write(file, tmp_path, rounding="toward_zero")
    assert ward_out.content["axf"] == {"file": "both.axf", "version": [1, 4, 2], "index": 0}
    assert ward_out.content["rows"] == {"first": "v = 0", "flipped": False}
    assert ward_out.problems == paint_out.problems == ()
    rows = {row["axf_name"]: row for row in ward_out.content["textures"]}
    normal = rows["normal"]
    assert (normal["source"], normal["transform"], normal["format"]) == ("in memory", "0.5 (x + 1)", "RGBA16_UNORM")
    assert (normal["rounding"], normal["container"]) == ("toward_zero", "png")
    assert normal["files"] == [{"file": "_SVBRDF_NormalMap.png"}]
    assert rows["diffusecolor"]["counts"]["clamped"] == 1
    assert rows["diffusecolor"]["error"]["max"] == pytest.approx(0.01)
    assert rows["clearcoatior"]["counts"]["replaced"] == 1
    assert rows["clearcoatior"]["error"]["left_out"] == 1
    # Rounding toward zero errs by up to one step of 16 bits, twice over in [-1, 1].
    assert 1.9 / 65535 < normal["error"]["max"] <= 2.0001 / 65535
    assert normal["error"]["mean"] == pytest.approx(1 / 65535, rel=0.1)
    assert normal["error"]["unit"] == "tangent-space component"
    flakes = {row["axf_name"]: row for row in paint_out.content["textures"]}["btfflakes"]
    assert flakes["levels"] == [[10, 16 >> k, 16 >> k] for k in range(4)]
    assert flakes["container"] == "dds"
    table = {row["axf_name"]: row for row in paint_out.content["textures"]}["thetaFI_sliceLUT"]
    assert (table["error"]["max"], table["error"]["unit"]) == (0.0, "slice index")
    default = {row["axf_name"]: row for row in paint_out.content["textures"]}["clearcoatior"]
    assert default["error"] is None
    assert "default" in default["error_reason"]


def test_an_angle_s_error_is_that_of_its_axis(tmp_path):
    turned = with_texture(ward(), "anisrotation", np.full((4, 4, 1), 1.5 * np.pi))
    (exported,) = folder.write(turned, tmp_path)
    (angle,) = (row for row in exported.content["textures"] if row["axf_name"] == "anisrotation")
    assert angle["error"]["quantity"].endswith("modulo pi")
    assert angle["error"]["max"] < 1e-4
    assert angle["counts"]["wrapped"] == 16


def test_arrays_and_levels_take_a_png_file_each(tmp_path):
    material = without(paint(), "brdfcolors", "clearcoatnormal")
    formats = {"btfflakes": "RGBA8_UNORM_SRGB", "brdfcolors": "RGBA8_UNORM_SRGB"}
    (exported,) = folder.write(material, tmp_path, container="png", formats=formats)
    (flakes,) = (row for row in exported.content["textures"] if row["axf_name"] == "btfflakes")
    assert len(flakes["files"]) == 40
    assert flakes["files"][13] == {"file": "_CarPaint_BTFFlakesMap_sRGB.level1.slice3.png", "level": 1, "slice": 3}
    (back,) = folder.read(tmp_path).materials
    assert back.identical(as_imported(material, formats=formats))


def test_a_format_may_be_given_by_either_name(tmp_path):
    for number, name in enumerate(("normal", "Normal", "_SVBRDF_NormalMap")):
        (exported,) = folder.write(ward(), tmp_path / str(number), formats={name: "RGBA32F"})
        assert exported.packed.textures["_SVBRDF_NormalMap"].format == "RGBA32F"
    (exported,) = folder.write(paint(), tmp_path / "3", formats={"_CarPaint_thetaFI_sliceLUTMap": "R8_UINT"})
    assert exported.packed.textures["_CarPaint_thetaFI_sliceLUTMap"].format == "R8_UINT"


def test_one_material_of_several(tmp_path):
    file = AxfFile((ward(), paint()))
    (exported,) = folder.write(file, tmp_path, material="paint")
    assert exported.folder == tmp_path / "paint"
    assert exported.content["axf"]["index"] == 1
    assert [path.name for path in tmp_path.iterdir()] == ["paint"]
    assert folder.read(tmp_path / "paint").materials[0].kind is MaterialKind.CAR_PAINT


def test_progress_names_what_is_done(tmp_path):
    stages = []
    folder.write(ward(), tmp_path, progress=lambda stage, fraction: stages.append((stage, fraction)))
    folder.read(tmp_path, progress=lambda stage, fraction: stages.append((stage, fraction)))
    assert [stage for stage in dict(stages)] == [f"{verb} synthetic Ward" for verb in ("packing", "writing", "reading")]
    assert all(0.0 <= fraction < 1.0 for _, fraction in stages)


REFUSED = {
    "an unknown target": ({"target": "unity_1850"}, "unknown target 'unity_1850'"),
    "an unknown material": ({"material": "gold"}, "no material 'gold'"),
    "an unknown kind of file": ({"container": "bmp"}, "unknown image format 'bmp'"),
    "an unknown texture": ({"formats": {"bump": "R8_UNORM"}}, "a format is given for 'bump'"),
    "an unknown format": ({"formats": {"normal": "BC5"}}, "cannot be BC5"),
    "an unknown rounding": ({"rounding": "up"}, "unknown rounding 'up'"),
    "floats as PNG": ({"container": "png"}, "ward: _SVBRDF_DiffuseColorMap_sRGB: RGBA16F of 16x16 texels cannot"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_exported_is_refused_and_leaves_nothing(name, tmp_path):
    options, message = REFUSED[name]
    out = tmp_path / "deep" / "out"
    with pytest.raises(InputError, match=message):
        folder.write(ward(), out, **options)
    assert list(tmp_path.iterdir()) == []
