"""What each engine does that the others do not."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.axf import MaterialKind
from axffit.targets import hdrp_10, mdl, png16, unity_2018, unreal
from axffit.targets.bitfields import Flags, HdrpFlags
from axffit.targets.hdrp_10 import is_black_beyond_diagonal
from axffit.targets.unreal import filled_rows
from axffit.targets.unreal_lobe import COEFFICIENT, reduce_paint
from axffit.textures import format_named
from axffit.textures.rerange import Counts
from tests.targets.materials import paint, ward, with_texture, without


def decoded(packed, name):
    return format_named(packed.textures[name].format).decode(packed.textures[name].levels[0])


def triangle(size=6):
    """A color table that is black beyond theta_h + theta_d = pi/2."""
    rows, columns = np.mgrid[:size, :size]
    return np.where((rows + columns < size)[..., None], 0.5, 0.0) * np.ones(3)


def test_every_texture_of_hdrp_is_a_half():
    for make in (ward, paint):
        assert {t.format for t in hdrp_10.pack(make()).textures.values()} <= {"R16F", "RG16F", "RGBA16F"}


def test_hdrp_reads_an_angle_of_2018_at_half():
    packed = unity_2018.pack(ward())
    texture = replace(packed.textures["_SVBRDF_AnisotropicRotationAngleMap"], name="_SVBRDF_AnisoRotationMap")
    shown = format_named(texture.format).decode(texture.levels[0])[..., :1]
    seen = hdrp_10.reading(texture, hdrp_10.values_of(ward())).inverse(shown)
    np.testing.assert_allclose(seen, ward().textures["anisrotation"].data / 2, atol=1e-4)


def test_hdrp_rebuilds_z_or_stores_it():
    packed = hdrp_10.pack(ward())
    assert (packed.textures["_SVBRDF_NormalMap"].format, packed.textures["_SVBRDF_NormalMap"].channels) == ("RG16F", 2)
    three = hdrp_10.pack(ward(), formats={"normal": "RGBA16F"})
    for each in (packed, three):
        np.testing.assert_allclose(
            hdrp_10.unpack(each).textures["normal"].data, ward().textures["normal"].data, atol=1e-3
        )
    below = with_texture(ward(), "normal", np.full((2, 2, 3), [0.6, 0.0, -0.8]))
    assert hdrp_10.pack(below).textures["_SVBRDF_NormalMap"].counts == Counts(folded=4)


def test_hdrp_clamps_a_color_table_that_is_black_beyond_the_diagonal():
    assert is_black_beyond_diagonal(triangle())
    assert not is_black_beyond_diagonal(np.zeros((6, 6, 3)))
    assert not is_black_beyond_diagonal(np.ones((6, 6, 3)))
    clamped, plain = hdrp_10.pack(with_texture(paint(), "brdfcolors", triangle())), hdrp_10.pack(paint())
    assert HdrpFlags(clamped.values["_Flags"]).clamps_color_table
    assert not HdrpFlags(plain.values["_Flags"]).clamps_color_table
    assert clamped.values["_CarPaint2_BRDFColorMapUVScale"] == (1, 1, 0, 0)
    assert any("bit 4" in note for note in clamped.notes)
    # The same bit has no meaning to the shader of 2018.
    assert Flags(clamped.values["_Flags"]).unknown == 16


def test_hdrp_raises_the_index_of_a_coat():
    glass = replace(paint(), properties={**paint().properties, "IOR": 1.0})
    packed = hdrp_10.pack(glass)
    assert packed.values["_CarPaint2_ClearcoatIOR"] == pytest.approx(1.001)
    assert any("raised to 1.001" in note for note in packed.notes)
    seen = hdrp_10.unpack(hdrp_10.pack(with_texture(ward(), "clearcoatior", np.full((2, 2, 1), 1.0))))
    np.testing.assert_allclose(seen.textures["clearcoatior"].data, 1.001, atol=1e-6)


def test_hdrp_bins_flakes_with_num_theta_f_for_both_angles():
    uneven = replace(paint(), properties={**paint().properties, "num_thetaI": 4})
    assert any("num_thetaF 6 for both angles; num_thetaI is 4" in note for note in hdrp_10.pack(uneven).notes)


def test_hdrp_finds_its_slices_in_a_half():
    packed = hdrp_10.pack(paint())
    np.testing.assert_array_equal(hdrp_10.unpack(packed).properties["thetaFI_sliceLUT"], [0, 5, 8, 10, 0, 0])


def test_png_colors_are_behind_a_power_of_2_2():
    packed = png16.pack(with_texture(ward(), "diffusecolor", np.full((2, 2, 3), [0.0, 0.25, 4.0])))
    np.testing.assert_allclose(decoded(packed, "DiffuseColor")[0, 0], [0, 0.25 ** (1 / 2.2), 1], atol=1 / 65535)
    assert packed.textures["DiffuseColor"].counts.clamped == 4


def test_png_divides_table_and_flakes_by_a_maximum_above_one():
    packed = png16.pack(paint())
    table = paint().textures["brdfcolors"].data
    assert packed.values["BRDFcolors_scale"] == table.max() > 1
    assert packed.values["BTFflakes_scale"] == 1.0
    shown = decoded(packed, "BRDFcolors")
    np.testing.assert_allclose(shown, (np.maximum(table, 0) / table.max()) ** (1 / 2.2), atol=1 / 65535)


def test_png_indices_are_behind_f0_and_the_power():
    packed = png16.pack(with_texture(ward(), "clearcoatior", np.full((2, 2, 1), 1.5)))
    np.testing.assert_allclose(decoded(packed, "ClearcoatIOR"), 0.04 ** (1 / 2.2), atol=1 / 65535)


def test_png_holds_eight_or_sixteen_bits():
    for make in (ward, paint):
        formats = {t.axf_name: t.format for t in png16.pack(make()).textures.values()}
        assert {f for name, f in formats.items() if name != "thetaFI_sliceLUT"} <= {
            "R16_UNORM", "RG16_UNORM", "RGB16_UNORM",
        }  # fmt: skip
    assert formats["thetaFI_sliceLUT"] == "R8_UINT"


def test_unreal_floors_colors_below_a_scale_of_each_channel():
    colors = np.array([[[0.5, 2.0, 0.01]], [[0.25, 1.0, -1.0]]])
    packed = unreal.pack(with_texture(ward(), "diffusecolor", colors))
    scale = packed.values["DiffuseColor_Scale"]
    assert scale == pytest.approx((0.5, 2.0, 0.1))
    halves = np.maximum(colors, 0).astype(np.float16).astype(np.float64)
    codes = np.floor(halves / np.float32(scale).astype(np.float64) * 65535)
    np.testing.assert_array_equal(packed.textures["DiffuseColor"].levels[0][..., :3], codes)
    assert packed.textures["DiffuseColor"].counts == Counts(clamped=1, excess=1.0)


def test_unreal_drops_anisotropy_and_says_so():
    packed = unreal.pack(ward())
    assert unreal.texture_name("anisrotation", MaterialKind.SVBRDF) is None
    assert any("anisotropy is dropped" in note for note in packed.notes)
    seen = unreal.unpack(packed)
    assert not seen.anisotropic
    mean = ward().textures["specularlobe"].data.mean(axis=-1, keepdims=True)
    np.testing.assert_allclose(seen.textures["specularlobe"].data, mean, rtol=2.0**-10)


def test_unreal_flips_green():
    shown = decoded(unreal.pack(ward()), "Normal")[..., :3]
    normals = ward().textures["normal"].data * [1, -1, 1]
    np.testing.assert_allclose(shown, 0.5 * (normals + 1), atol=2.0**-10)


def test_unreal_reduces_a_paint_to_one_lobe():
    packed = unreal.pack(paint())
    assert any("reduced to one GGX lobe of roughness" in note for note in packed.notes)
    back = unreal.unpack(packed).properties
    assert back["CT_coeffs"].tolist() == [COEFFICIENT]
    assert back["CT_spreads"][0] == pytest.approx(packed.values["Roughness"] ** 2)
    assert back["CT_F0s"][0] == np.float32(packed.values["Specularity"])


def missed(properties, roughness, specularity, count=40):
    """Sum |f' - f| cos over sum f cos, in the plane of incidence, written down from the formulas."""
    angles = np.linspace(-0.4 * np.pi, 0.4 * np.pi, count)
    light, view = np.meshgrid(angles, angles, indexing="ij")
    i, o, h, d = np.cos(light), np.cos(view), np.cos((light + view) / 2), np.cos((light - view) / 2)
    edge = (1 - d) ** 5
    groove = np.minimum(1, np.minimum(2 * h * i / d, 2 * h * o / d)) / (i * o)
    paint_value = np.full_like(i, properties["CT_diffuse"])
    for s, f0, m in zip(*(properties[name] for name in ("CT_coeffs", "CT_F0s", "CT_spreads")), strict=True):
        facets = np.exp((h * h - 1) / (h * h * m * m)) / (m * m * h**4)
        paint_value += s * (f0 + (1 - f0) * edge) * facets * groove
    alpha = roughness**2
    facets = alpha**2 / (h * h * (alpha**2 - 1) + 1) ** 2
    smith = [2 * c / (c + np.sqrt(alpha**2 + (1 - alpha**2) * c * c)) for c in (i, o)]
    fresnel = min(50 * specularity, 1.0) * edge + (1 - edge) * specularity
    engine_value = 0.25 * fresnel * facets * smith[0] * smith[1] / (i * o)
    return np.abs((engine_value - paint_value) * i).sum() / (paint_value * i).sum()


def test_no_other_lobe_is_much_nearer_to_the_paint():
    material = paint()
    lobe = reduce_paint(material)
    assert missed(material.properties, lobe.roughness, lobe.specularity) == pytest.approx(lobe.residual, rel=1e-3)
    tried = [
        missed(material.properties, roughness, specularity)
        for roughness in np.linspace(0.1, 1, 40)
        for specularity in np.linspace(0, 1, 41)
    ]
    assert lobe.residual <= min(tried) + 1e-4


def test_a_reduced_paint_is_reduced_to_itself():
    once = unreal.unpack(unreal.pack(paint()))
    lobe = reduce_paint(once)
    assert lobe.residual == 0
    assert unreal.pack(once).values == unreal.pack(unreal.unpack(unreal.pack(once))).values


def test_unreal_continues_colors_where_a_row_ends_in_black():
    table = np.zeros((3, 4, 3))
    table[0, :2] = [[1, 2, 3], [4, 5, 6]]
    filled = filled_rows(table)
    np.testing.assert_array_equal(filled[0, 2:], [[4, 5, 6]] * 2)
    np.testing.assert_array_equal(filled[1], [[1, 2, 3]] * 4)
    np.testing.assert_array_equal(filled_rows(triangle())[1, -1], triangle()[1, 4])


def test_unreal_keeps_the_finest_level_of_flakes():
    packed = unreal.pack(paint())
    assert len(packed.textures["BTFflakes"].levels) == 1
    assert any("of 4 levels of the flakes" in note for note in packed.notes)


def test_mdl_angles_are_a_positive_part_of_a_turn():
    angles = np.array([[[0.0], [np.pi / 2], [-np.pi / 2], [-0.001]]])
    packed = mdl.pack(with_texture(ward(), "anisrotation", angles))
    shown = decoded(packed, "specular_brdf_texture_rotation")
    np.testing.assert_allclose(shown.reshape(-1), [0, 0.25, 0.75, 1 - 0.001 / (2 * np.pi)], atol=1e-7)
    np.testing.assert_allclose(mdl.unpack(packed).textures["anisrotation"].data, angles, atol=1e-6)


def test_mdl_rescales_specular_colors_that_give_more_than_comes_in():
    material = with_texture(ward(), "diffusecolor", np.full((2, 2, 3), 0.5))
    material = with_texture(material, "specularcolor", np.full((2, 2, 3), [1.0, 0.5, 0.25]))
    material = with_texture(material, "fresnel", np.full((2, 2, 1), 0.3))
    packed = mdl.pack(material)
    seen = mdl.unpack(packed).textures
    np.testing.assert_allclose(seen["specularcolor"].data[0, 0], [0.5, 0.25, 0.125], rtol=2.0**-7)
    np.testing.assert_allclose(seen["fresnel"].data[0, 0], 0.6, rtol=1e-6)
    assert packed.textures["specular_texture"].counts.clamped == 4
    assert any("4 texels is rescaled" in note for note in packed.notes)
    # Without a Fresnel factor, or where diffuse and specular stay below 1, nothing is rescaled.
    plain = mdl.unpack(mdl.pack(replace(material, fresnel_variant=None))).textures
    np.testing.assert_allclose(plain["specularcolor"].data[0, 0], [1.0, 0.5, 0.25], rtol=2.0**-7)


def test_mdl_does_not_resample_maps_of_different_size():
    material = with_texture(ward(), "diffusecolor", np.full((2, 4, 3), 0.9))
    packed = mdl.pack(material)
    assert any("maps of different size" in note for note in packed.notes)


def test_mdl_bakes_the_paint_and_keeps_what_is_baked():
    four = {"CT_coeffs": [0.1, 0.2, 0.3, 0.4], "CT_F0s": [0.1] * 4, "CT_spreads": [0.2] * 4}
    packed = mdl.pack(replace(paint(), properties={**paint().properties, **four}))
    assert packed.values["ct_coeffs"] == pytest.approx((0.4, 0.8, 1.2))
    assert any("baked into a measured BRDF" in note for note in packed.notes)
    assert any("of 4 lobes the importer takes the first 3" in note for note in packed.notes)
    back = mdl.unpack(packed).properties["CT_coeffs"]
    np.testing.assert_array_equal(back, np.array([0.1, 0.2, 0.3], np.float32))


NOTES = {
    "a model it refuses": (
        replace(without(ward(), "anisrotation"), specular_model="Phong", specular_variant=None), "refuses Phong"
    ),
    "a variant it does not know": (replace(ward(), specular_variant="Duer2006"), "Duer2006 becomes Geisler"),
    "a coat that refracts": (ward(), "the coat refracts"),
    "the coat's color": (ward(), "no place for them in a SVBRDF: clearcoatcolor"),
    "flakes": (paint(), "statistics of a procedural pattern"),
}  # fmt: skip


@pytest.mark.parametrize("name", NOTES)
def test_mdl_says_what_it_cannot_express(name):
    material, sentence = NOTES[name]
    assert any(sentence in note for note in mdl.pack(material).notes)
