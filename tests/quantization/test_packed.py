"""Planted faults of packers: each is named, on several targets; what is packed well, or differs by noise, never is."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.quantization import verify_packed
from axffit.quantization.diagnosis import FACTOR, NAMES, faults, table_fault
from axffit.quantization.hypotheses import ranks, wrong_bits
from axffit.targets import TARGETS, hdrp_10, png16, unity_2018
from axffit.targets.rerangings import PositiveAngle
from axffit.textures import FORMATS, Counts
from axffit.textures.rerange import Identity, SignedAngle
from axffit.textures.unorm import linear_to_srgb, srgb_to_linear
from tests.quantization.test_verify import changed
from tests.targets.materials import MATERIALS, paint, ward, with_texture

pytestmark = pytest.mark.usefixtures("found_only")

LUT = "_CarPaint_thetaFI_sliceLUTMap"


def readable(material, packed):
    """Textures that hold every level of an AxF map."""
    return {
        name
        for name, held in packed.textures.items()
        if held.axf_name in material.textures and len(held.levels) == len(material.textures[held.axf_name].levels)
    }


def named(material, packed, *outside):
    """(fault, subject) of textures that are declared to be outside."""
    return [(fault.fault, fault.subject) for fault in faults(material, packed, readable(material, packed), outside)]


def renumbered(packed, name, change):
    """A texture whose decoded numbers went through a function before they were encoded again."""
    form = packed.textures[name].number_format

    def codes(levels):
        return tuple(form.encode(np.clip(change(form.decode(level)), 0.0, form.codecs[0].highest)) for level in levels)

    return changed(packed, name, codes)


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", MATERIALS)
def test_what_a_target_packs_has_no_fault_even_where_it_is_outside(target, name):
    material = MATERIALS[name]()
    packed = TARGETS[target].pack(material)
    assert named(material, packed, *readable(material, packed)) == []


def test_the_last_bit_of_another_program_is_no_fault():
    packed = unity_2018.pack(ward())
    rng = np.random.default_rng(5)
    for name in ("_SVBRDF_NormalMap", "_SVBRDF_SpecularLobeMap"):
        noisy = changed(
            packed, name, lambda levels: tuple(x + rng.choice(2, x.shape, p=[0.9, 0.1]).astype(x.dtype) for x in levels)
        )
        assert named(ward(), noisy, name) == []


def tenth_floored(levels):
    """A tenth of the codes one lower, as no rounding mode makes them."""
    rng = np.random.default_rng(6)
    return tuple(x - rng.choice(2, x.shape, p=[0.9, 0.1]).astype(x.dtype) for x in levels)


def test_a_fault_needs_the_factor():
    packed = unity_2018.pack(ward())
    name = "_SVBRDF_FresnelMap_sRGB"
    floored = unity_2018.pack(ward(), rounding="floor")
    assert named(ward(), floored, name) == [("floor_rounding", name)]
    mixed = changed(floored, name, tenth_floored)
    (fault,) = faults(ward(), mixed, {name}, {name})
    assert fault.residual is not None
    assert fault.advised is not None
    assert fault.advised >= FACTOR * fault.residual
    assert named(ward(), changed(packed, name, tenth_floored), name) == []


def bgr(levels):
    return tuple(level[..., [2, 1, 0, 3]] for level in levels)


def upside_down(levels):
    return tuple(level[..., ::-1, :, :].copy() for level in levels)


def quarter_of_a_level(levels):
    """Mip levels made by dropping three texels of four."""
    made = [levels[0]]
    for _ in levels[1:]:
        made.append(made[-1][..., ::2, ::2, :])
    return tuple(made)


def test_more_ways_to_the_same_fault():
    svbrdf, car = unity_2018.pack(ward()), unity_2018.pack(paint())
    specular, flakes = "_SVBRDF_SpecularColorMap_sRGB", "_CarPaint_BTFFlakesMap_sRGB"
    assert named(ward(), changed(svbrdf, specular, bgr), specular) == [("channels_swapped", specular)]
    assert named(ward(), changed(svbrdf, specular, upside_down), specular) == [("rows_flipped", specular)]
    assert named(paint(), changed(car, flakes, quarter_of_a_level), flakes) == [("mips_rebuilt", flakes)]
    dark = renumbered(svbrdf, specular, srgb_to_linear)
    assert named(ward(), dark, specular) == [("srgb_curve", specular)]
    bright = renumbered(unity_2018.pack(ward(), rounding="floor"), specular, linear_to_srgb)
    assert named(ward(), bright, specular) == [("srgb_curve", specular)]


def test_the_range_of_each_other_target_is_named_with_it():
    material, name = ward(), "_SVBRDF_AnisoRotationMap"
    packed = hdrp_10.pack(material)
    form, angles = packed.textures[name].number_format, material.textures["anisrotation"].data
    others = {"unity_2018 and png16": SignedAngle(), "mdl": PositiveAngle(), "unity_2018": Identity()}
    for words, reranging in others.items():
        codes = form.encode(reranging.forward(angles))
        (fault,) = faults(material, changed(packed, name, lambda _, codes=codes: (codes,)), {name}, {name})
        assert fault.fault == "range_of_another_target"
        assert f"it is packed as {reranging.formula}, as for {words};" in fault.message
        assert "hdrp_10 reads the inverse of 0.5 (1 + x / (pi/2))" in fault.message


def test_scales():
    car, colors, scale = paint(), "_CarPaint_BRDFColorMap_sRGB", "_CarPaint_BRDFColorMap_Scale"
    eight = unity_2018.pack(car, formats={"brdfcolors": "RGBA8_UNORM_SRGB"})
    largest = float(car.textures["brdfcolors"].data.max())

    def with_scale(packed, value):
        return replace(packed, values={**packed.values, scale: value})

    assert named(car, eight, colors) == []
    assert named(car, with_scale(eight, 1.0), colors) == [("scale_left_at_one", scale)]
    assert named(car, with_scale(eight, 2 * largest), colors) == [("wrong_scale", scale)]
    assert named(car, with_scale(unity_2018.pack(car), 2.0), colors) == [("wrong_scale", scale)]
    # Neither divided nor scaled: what is brighter than 1 is cut off.
    form = FORMATS["RGBA8_UNORM_SRGB"]
    cut = form.encode(np.concatenate([car.textures["brdfcolors"].data.clip(0, 1), np.ones((8, 12, 1))], axis=-1))
    plain = with_scale(changed(eight, colors, lambda _: (cut,)), 1.0)
    (fault,) = faults(car, plain, {colors}, {colors})
    assert (fault.fault, fault.subject) == ("scale_left_at_one", scale)
    assert f"reaches {largest:.6g} and is cut off at 1" in fault.message


def test_a_scale_for_each_channel():
    car = paint()
    packed = TARGETS["unreal"].pack(car)
    left = replace(packed, values={**packed.values, "BRDFcolors_Scale": (1.0, 1.0, 1.0)})
    assert ("scale_left_at_one", "BRDFcolors_Scale") in named(car, left, "BRDFcolors")


def test_negatives_are_counted_in_every_level_and_target():
    material, name = ward(), "DiffuseColor"
    packed = png16.pack(material)
    assert named(material, packed) == []
    silent = changed(packed, name, counts=Counts())
    (fault,) = faults(material, silent, {name}, ())
    assert (fault.fault, fault.residual) == ("negatives_uncounted", None)
    assert "1 texels are negative in AxF and clamped here, but counts.clamped is 0" in fault.message


LUT_FAULTS = {
    "one too large": lambda entries: entries + 1,
    "one too small": lambda entries: entries - 1,
    "one bin too late": lambda entries: np.roll(entries, 1),
    "one bin too early": lambda entries: np.concatenate([entries[1:], entries[:1]]),
}


@pytest.mark.parametrize("words", LUT_FAULTS)
def test_a_slice_table_off_by_one(words):
    entries = np.array([1, 5, 8, 10, 14, 19, 23, 30])

    def fault(stored):
        held = replace(unity_2018.pack(paint()).textures[LUT], format="R8_UINT")
        held = replace(held, levels=(np.asarray(stored, np.uint8).reshape(1, -1, 1),))
        return table_fault(entries, held, Identity())

    assert fault(entries) is None
    assert fault(np.random.default_rng(0).permutation(entries)) is None
    found = fault(LUT_FAULTS[words](entries))
    assert found is not None
    assert found.fault == "lut_off_by_one"
    assert words in found.message


def test_what_cannot_be_told_apart_is_listed():
    """One color everywhere: an sRGB curve and swapped channels of a gray normal look alike or are no fault at all."""
    flat = with_texture(ward(), "normal", np.broadcast_to([0.0, 0.0, 1.0], (4, 4, 3)))
    packed, name = unity_2018.pack(flat), "_SVBRDF_NormalMap"
    assert named(flat, changed(packed, name, lambda x: (x[0][..., [1, 0, 2, 3]],)), name) == []
    (fault,) = faults(flat, changed(packed, name, lambda x: (x[0][..., [2, 1, 0, 3]],)), {name}, {name})
    assert fault.fault == "channels_swapped"


def test_every_code_has_its_place_and_every_name_is_known():
    half = FORMATS["R16F"]
    numbers = np.array([-2.0, -1.0, -6e-8, -0.0, 0.0, 6e-8, 1.0, 65504.0])[:, None]
    order = ranks(half.encode(numbers), half)[:, 0]
    assert np.all(np.diff(order) >= 0)
    assert order[3] == order[4] == 0
    assert wrong_bits(np.array([0, 0]), np.array([1, 3])) == 1.5
    assert len(set(NAMES)) == len(NAMES)


def test_a_texture_axf_has_not_and_a_wrong_name_are_problems():
    material = ward()
    packed = unity_2018.pack(material)
    less = replace(material, textures={k: t for k, t in material.textures.items() if k != "height"})
    problems = {(p.obligation, p.subject) for p in verify_packed(less, packed).problems}
    assert ("texture.extra", "_SVBRDF_HeightMap") in problems
    swapped = changed(packed, "_SVBRDF_SpecularColorMap_sRGB", axf_name="diffusecolor")
    problems = {(p.obligation, p.subject) for p in verify_packed(material, swapped).problems}
    assert ("texture.name", "_SVBRDF_SpecularColorMap_sRGB") in problems
    with pytest.raises(InputError, match="packed as a SVBRDF, but paint is a CarPaint2"):
        verify_packed(paint(), packed)
