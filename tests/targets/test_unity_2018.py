"""Pack and unpack: within each format's proven bound, counts, flags, scales, mip levels, and the known odd values."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.axf import MaterialKind
from axffit.errors import InputError
from axffit.targets import unity_2018
from axffit.targets.bitfields import Flags
from axffit.textures import ROUNDINGS, format_named
from axffit.textures.rerange import Counts
from tests.targets.materials import MATERIALS, paint, texture, ward, with_texture, without

every_material = pytest.mark.parametrize("name", MATERIALS)
MAPS = [(kind, axf_name) for kind, make in MATERIALS.items() for axf_name in make().textures]


def test_the_packed_material_says_whose_it_is():
    packed = unity_2018.pack(ward())
    assert (packed.target, packed.id, packed.kind) == ("unity_2018", "ward", MaterialKind.SVBRDF)
    assert packed.textures["_SVBRDF_NormalMap"].size_bytes == 16 * 16 * 8
    assert packed.textures["_SVBRDF_NormalMap"].transform == "0.5 (x + 1)"
    assert packed.textures["_SVBRDF_NormalMap"].source == "in memory"


@pytest.mark.parametrize(("kind", "axf_name"), MAPS)
@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_each_texture_comes_back_within_its_proven_bound(kind, axf_name, rounding):
    material = MATERIALS[kind]()
    packed = unity_2018.pack(material, rounding=rounding)
    packed_texture = next(t for t in packed.textures.values() if t.axf_name == axf_name)
    back = unity_2018.unpack(packed).textures[axf_name]
    assert packed_texture.rounding == rounding
    assert len(back.levels) == len(material.textures[axf_name].levels)
    form = packed_texture.number_format
    transform = unity_2018.reading(packed_texture, packed.values)
    for before, after in zip(material.textures[axf_name].levels, back.levels, strict=True):
        assert after.dtype == np.float32
        target = transform.forward(before)
        padded = np.zeros((*target.shape[:-1], form.channels))
        padded[..., : target.shape[-1]] = target
        bound = form.error_bound(padded, rounding)[..., : target.shape[-1]]
        # The decoded value is held in float32, as in a shader.
        rounding_of_single = 2.0**-22
        assert np.all(np.abs(transform.forward(after) - target) <= bound + rounding_of_single)


@every_material
def test_properties_and_models_come_back(name):
    material = MATERIALS[name]()
    back = unity_2018.unpack(unity_2018.pack(material))
    for field in ("id", "name", "kind", "diffuse_model", "specular_model", "anisotropic", "fresnel_variant"):
        assert getattr(back, field) == getattr(material, field)
    assert back.coat_refracts == material.coat_refracts
    for key, value in material.properties.items():
        if key != "cc_no_refraction":
            np.testing.assert_array_equal(back.properties[key], value)


@every_material
def test_defaults_are_left_out_on_request(name):
    material = without(MATERIALS[name](), "diffusecolor", "brdfcolors")
    back = unity_2018.unpack(unity_2018.pack(material), defaults=False)
    assert set(back.textures) == set(material.textures)


@every_material
def test_packing_twice_changes_nothing_more(name):
    once = unity_2018.unpack(unity_2018.pack(MATERIALS[name]()))
    first, second = unity_2018.pack(once), unity_2018.pack(unity_2018.unpack(unity_2018.pack(once)))
    for key, packed in first.textures.items():
        for a, b in zip(packed.levels, second.textures[key].levels, strict=True):
            np.testing.assert_array_equal(a, b)


def test_counts_of_what_could_not_be_kept():
    packed = unity_2018.pack(ward())
    assert packed.textures["_SVBRDF_DiffuseColorMap_sRGB"].counts == Counts(clamped=1, excess=float(np.float32(0.01)))
    assert packed.textures["_SVBRDF_ClearCoatIORMap_sRGB"].counts == Counts(replaced=1)
    assert packed.textures["_SVBRDF_SpecularColorMap_sRGB"].clamped == 0
    assert unity_2018.pack(paint()).textures["_CarPaint_BTFFlakesMap_sRGB"].clamped == 1


def test_values_beyond_a_half_are_clamped_and_counted():
    bright = np.full((4, 4, 3), 0.5)
    bright[0, 1] = 1e6
    packed = unity_2018.pack(with_texture(ward(), "specularcolor", bright))
    got = packed.textures["_SVBRDF_SpecularColorMap_sRGB"]
    assert got.counts == Counts(clamped=1, excess=1e6 - 65504)
    assert unity_2018.unpack(packed).textures["specularcolor"].data.max() == 65504


def test_a_roughness_that_decodes_below_the_floor_is_counted():
    lobe = np.full((4, 4, 2), 0.1)
    lobe[2, 3] = [1e-9, 0.1]
    packed = unity_2018.pack(with_texture(ward(), "specularlobe", lobe))
    assert packed.textures["_SVBRDF_SpecularLobeMap"].counts == Counts(floored=1)


def test_angles_outside_are_wrapped_and_counted():
    packed = unity_2018.pack(with_texture(ward(), "anisrotation", np.full((4, 4, 1), 1.5 * np.pi)))
    assert packed.textures["_SVBRDF_AnisotropicRotationAngleMap"].counts == Counts(wrapped=16)
    np.testing.assert_allclose(unity_2018.unpack(packed).textures["anisrotation"].data, -np.pi / 2, atol=1e-4)


def test_the_flat_normal_and_angle_zero_have_their_known_errors():
    flat = np.zeros((4, 4, 3))
    flat[..., 2] = 1
    material = with_texture(with_texture(ward(), "normal", flat), "anisrotation", np.zeros((4, 4, 1)))
    back = unity_2018.unpack(unity_2018.pack(material))
    normal = back.textures["normal"].data[0, 0].astype(np.float64)
    tilt = np.degrees(np.arctan2(np.hypot(normal[0], normal[1]), normal[2]))
    assert tilt == pytest.approx(0.00124, rel=5e-3)
    angle = np.degrees(float(back.textures["anisrotation"].data[0, 0, 0]))
    assert abs(angle) == pytest.approx(0.0027, rel=0.02)


FLAG_CASES = {
    "everything": (ward(), Flags(15)),
    "isotropic": (without(ward(), "height"), Flags(7)),
    "no coat": (without(ward(), "clearcoatcolor", "clearcoatnormal", "clearcoatior"), Flags(13)),
    "any coat texture sets bit 1": (without(ward(), "clearcoatnormal", "clearcoatior"), Flags(15)),
    "cc_no_refraction absent": (without(ward(), "cc_no_refraction"), Flags(15)),
    "paint": (paint(), Flags(6)),
    "paint without coat textures": (without(paint(), "clearcoatnormal"), Flags(4)),
}


@pytest.mark.parametrize("name", FLAG_CASES)
def test_flags(name):
    material, expected = FLAG_CASES[name]
    assert unity_2018.pack(material).values["_flags"] == int(expected)


def test_a_coat_that_does_not_refract_clears_bit_two():

    material = replace(ward(), properties={"cc_no_refraction": 1})
    packed = unity_2018.pack(material)
    assert packed.values["_flags"] == 11
    assert not unity_2018.unpack(packed).coat_refracts


def test_a_paint_without_coat_textures_loses_its_coat_and_says_so():
    packed = unity_2018.pack(without(paint(), "clearcoatnormal"))
    assert any("draws no coat" in note for note in packed.notes)
    assert unity_2018.unpack(packed).properties["IOR"] == 1.0


def test_an_ior_map_that_disagrees_with_the_property_is_reported():
    notes = unity_2018.pack(with_texture(paint(), "clearcoatior", np.full((2, 2, 1), 1.6))).notes
    assert any("differs from the property IOR 1.52 by up to 0.08" in note for note in notes)


def test_all_mip_levels_of_the_flakes_are_kept_as_given():
    packed = unity_2018.pack(paint()).textures["_CarPaint_BTFFlakesMap_sRGB"]
    assert [level.shape for level in packed.levels] == [(10, 16 >> k, 16 >> k, 4) for k in range(4)]


def test_the_slice_table():
    packed = unity_2018.pack(paint())
    table = packed.textures["_CarPaint_thetaFI_sliceLUTMap"]
    assert table.levels[0].shape == (1, 6, 1)
    np.testing.assert_array_equal(table.levels[0].reshape(-1), [0, 5, 8, 10, 0, 0])
    exact = unity_2018.pack(paint(), formats={"thetaFI_sliceLUT": "R8_UINT"})
    np.testing.assert_array_equal(unity_2018.unpack(exact).properties["thetaFI_sliceLUT"], [0, 5, 8, 10, 0, 0])


def test_a_slice_beyond_eight_bits_is_refused():

    material = replace(paint(), properties={**paint().properties, "thetaFI_sliceLUT": [0, 300]})
    with pytest.raises(InputError, match="300"):
        unity_2018.pack(material)


def test_integer_formats_get_a_scale_and_float_formats_none():
    assert unity_2018.pack(paint()).values["_CarPaint_BRDFColorMap_Scale"] == 1.0
    packed = unity_2018.pack(paint(), formats={"brdfcolors": "RGBA8_UNORM_SRGB"})
    scale = packed.values["_CarPaint_BRDFColorMap_Scale"]
    assert scale == pytest.approx(paint().textures["brdfcolors"].data.max())
    assert packed.textures["_CarPaint_BRDFColorMap_sRGB"].clamped == 0
    back = unity_2018.unpack(packed).textures["brdfcolors"].data
    np.testing.assert_allclose(back, paint().textures["brdfcolors"].data, atol=0.006 * scale)
    height = unity_2018.pack(ward(), formats={"height": "R16_UNORM"})
    assert height.values["_SVBRDF_heightMapMax_mm"] == ward().textures["height"].data.max()
    np.testing.assert_allclose(
        unity_2018.unpack(height).textures["height"].data, ward().textures["height"].data, atol=3e-5
    )


def test_a_gray_fresnel_map_is_gray_in_the_target():
    packed = unity_2018.pack(with_texture(ward(), "fresnel", np.full((4, 4, 1), 0.04)))
    decoded = format_named("RGBA16F").decode(packed.textures["_SVBRDF_FresnelMap_sRGB"].levels[0])
    np.testing.assert_allclose(decoded[0, 0], [0.04, 0.04, 0.04, 1], rtol=1e-3)
    assert unity_2018.unpack(packed).textures["fresnel"].channels == 1


def test_a_direct_float_normal_is_not_offset():
    packed = unity_2018.pack(ward(), formats={"normal": "RGBA32F"})
    np.testing.assert_array_equal(unity_2018.unpack(packed).textures["normal"].data, ward().textures["normal"].data)


def test_the_material_size_is_that_of_its_maps():
    values = unity_2018.pack(ward()).values
    assert (values["_materialSizeU_mm"], values["_materialSizeV_mm"]) == (30, 30)
    constant = without(ward(), *(key for key in ward().textures if key != "diffusecolor"))
    constant = with_texture(constant, "diffusecolor", np.full((1, 1, 3), 0.5))
    packed = unity_2018.pack(constant)
    assert packed.values["_materialSizeU_mm"] == 1
    assert any("spatial constant" in note for note in packed.notes)


def test_a_model_the_shader_does_not_support_is_noted():

    packed = unity_2018.pack(replace(ward(), specular_model="GGX", specular_variant=None))
    assert packed.values["_SVBRDF_BRDFType"] == 6
    assert any("GGX" in note for note in packed.notes)


def test_a_map_the_target_has_no_place_for_is_noted():
    packed = unity_2018.pack(with_texture(paint(), "height", np.zeros((4, 4, 1))))
    assert "_SVBRDF_HeightMap" not in packed.textures
    assert any("no place for them in a CarPaint2: height" in note for note in packed.notes)


def test_flakes_of_another_size_come_with_the_tiling_that_keeps_it():
    flakes = replace(paint().textures["btfflakes"], width_mm=1.5, height_mm=1.5)
    packed = unity_2018.pack(replace(paint(), textures={**paint().textures, "btfflakes": flakes}))
    assert packed.values["_materialSizeU_mm"] == 30
    assert any("_CarPaint_FlakesTiling 20" in note for note in packed.notes)


WRONG = {
    "an unknown texture": ({"bump": "RGBA16F"}, "a format is given for 'bump'"),
    "a format of the wrong row": ({"normal": "R8_UNORM"}, "_SVBRDF_NormalMap of 3 channels cannot be R8_UNORM"),
    "an unknown format": ({"diffusecolor": "BC6H"}, "cannot be BC6H; allowed: RGBA16F, RGBA32F, RGBA8_UNORM_SRGB"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_format_is_refused(name):
    formats, message = WRONG[name]
    with pytest.raises(InputError, match=message):
        unity_2018.pack(ward(), formats=formats)


WRONG_TEXTURES = {
    "rank": ("diffusecolor", np.zeros((4, 3)), "rank"),
    "channels": ("normal", np.zeros((4, 4, 2)), "channels"),
    "range": ("specularlobe", np.full((4, 4, 1), 1.5), "outside"),
    "NaN": ("diffusecolor", np.full((4, 4, 3), np.nan), "finite"),
}


@pytest.mark.parametrize("name", WRONG_TEXTURES)
def test_a_wrong_texture_is_refused(name):
    axf_name, level, message = WRONG_TEXTURES[name]
    with pytest.raises(InputError, match=message):
        unity_2018.pack(with_texture(ward(), axf_name, level))


def test_an_unknown_texture_is_refused_when_read():
    packed = unity_2018.pack(ward()).textures["_SVBRDF_NormalMap"]

    with pytest.raises(InputError, match="has no texture '_BumpMap'"):
        unity_2018.reading(replace(packed, name="_BumpMap"), {})
    assert texture(np.zeros((1, 1, 1))).is_constant
