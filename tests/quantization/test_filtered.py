"""Samples between texels: what a filter makes of angles, normals, indices and gamma, and where it adds nothing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axffit.quantization.filtered import FILTERED_MEASURES, filtered_errors, is_affine, measures_between
from axffit.quantization.maps import map_errors
from axffit.quantization.measures import MEASURES
from axffit.targets import TARGETS, target_named
from axffit.targets.rerangings import Gamma, PositiveAngle, TwoComponents
from axffit.textures.rerange import Chain, ClampNegative, Identity, IorToF0, Scale, SignedAngle, UnitOffset
from tests.targets.materials import paint, unit_normals, ward, with_texture


def between(key, values, target="unity_2018", **options):
    """Errors between the texels of a map as a target packs it, by measure, [H, W]."""
    material = with_texture(paint() if key in ("brdfcolors", "btfflakes") else ward(), key, values)
    module = target_named(target)
    packed = module.pack(material, **options)
    texture = next(t for t in packed.textures.values() if t.axf_name == key)
    level = material.textures[key].levels[0]
    errors = filtered_errors(level, texture.levels[0], texture, module.reading(texture, packed.values))
    return {name: found.reshape(level.shape[:-1]) for name, found in errors.items()}


def columns(*values):
    """A map of equal rows [4, len(values), C]."""
    return np.broadcast_to(np.reshape(values, (1, len(values), -1)), (4, len(values), np.reshape(values[0], -1).size))


def test_a_filter_across_the_wrap_around_turns_through_every_axis():
    # 0.99 pi and -0.99 pi are 3.6° apart as axes; a quarter of the way the shader sees 0.5 pi.
    errors = between("anisrotation", columns(0.99 * np.pi, -0.99 * np.pi, -0.97 * np.pi, -0.97 * np.pi))
    jump, smooth = errors["filtered_axis_angle"][0, 0], errors["filtered_axis_angle"][0, 1]
    assert jump == pytest.approx(90.0, abs=1.5)
    assert smooth < 0.01


def test_hdrp_wraps_at_a_quarter_turn():
    quarter = np.pi / 2
    errors = between("anisrotation", columns(0.98 * quarter, -0.98 * quarter, 0.0, 0.0), "hdrp_10")
    # Halfway the shader sees 0, and the axis is at a right angle to it.
    assert errors["filtered_axis_angle"][0, 0] == pytest.approx(90.0, abs=0.1)
    assert errors["filtered_axis_angle"][0, 2] < 0.1


def test_axes_without_a_mean_count_as_right():
    errors = between("anisrotation", columns(0.0, np.pi / 2, 0.0, np.pi / 2))["filtered_axis_angle"]
    # The halfway sample has no axis; those at a quarter of the way have: 0 for the mean, pi / 8 for the shader.
    assert errors[0, 0] == pytest.approx(22.5, abs=0.01)


def test_a_filtered_normal_is_short_and_a_rebuilt_z_is_steep():
    left, right = ([np.sin(t), 0.0, np.cos(t)] for t in (-0.5, 0.5))
    normals = columns(left, right, right, right)
    three = between("normal", normals)
    assert three["filtered_length"][0, 0] == pytest.approx(1 - np.cos(0.5), abs=1e-4)
    assert three["filtered_length"][0, 1] < 5e-5
    assert three["filtered_angle"].max() < 0.002
    tilted = [np.sin(1.2), 0.0, np.cos(1.2)]
    flat = [0.0, 0.0, 1.0]
    two = between("normal", columns(flat, tilted, tilted, tilted), "hdrp_10")
    # The mean points to 0.6; rebuilt from x = sin(1.2) / 2 it points to asin(x).
    assert two["filtered_angle"][0, 0] == pytest.approx(np.degrees(0.6 - np.arcsin(np.sin(1.2) / 2)), abs=0.05)
    assert two["filtered_length"].max() < 1e-12


def test_f0_is_filtered_in_place_of_the_index():
    errors = between("clearcoatior", columns(1.3, 1.8, 1.8, 1.8))
    low, middle, high = IorToF0().forward(np.array([1.3, 1.55, 1.8]))
    assert errors["filtered_f0"][0, 0] == pytest.approx((low + high) / 2 - middle, rel=0.02)
    assert errors["filtered_f0"][0, 1] < 5e-5
    # What the target keeps as an index is filtered as one.
    assert between("clearcoatior", columns(1.3, 1.8, 1.8, 1.8), "mdl")["filtered_ior"].max() < 1e-6


def test_an_index_without_meaning_counts_as_its_default():
    errors = between("clearcoatior", columns(np.nan, 1.5, 1.5, 1.5))
    assert errors["filtered_f0"].max() < 5e-5


def test_colors_stored_as_a_power_are_filtered_as_one():
    errors = between("diffusecolor", columns([0.1] * 3, [0.9] * 3, [0.9] * 3, [0.9] * 3), "png16")
    seen = ((0.1 ** (1 / 2.2) + 0.9 ** (1 / 2.2)) / 2) ** 2.2
    assert errors["filtered_absolute"][0, 0] == pytest.approx(0.5 - seen, abs=1e-4)
    assert errors["filtered_relative"][0, 1] < 1e-4


def test_hardware_that_knows_srgb_filters_what_it_decodes():
    colors = columns([0.1] * 3, [0.9] * 3, [0.9] * 3, [0.9] * 3)
    assert between("diffusecolor", colors, formats={"diffusecolor": "RGBA8_UNORM_SRGB"}) == {}


def test_maps_repeat_and_the_color_table_ends():
    normals = columns([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8])
    assert between("normal", normals)["filtered_length"][0, 3] > 0.04
    table = columns([0.1] * 3, [0.1] * 3, [0.1] * 3, [0.9] * 3)
    errors = between("brdfcolors", table, "png16")["filtered_absolute"]
    assert errors[0, 2] > 0.1
    assert errors[0, 3] < 1e-4


def test_slices_are_filtered_each_by_itself():
    flakes = np.full((10, 4, 4, 3), 0.25)
    flakes[1] = 0.75
    assert between("btfflakes", flakes, "png16")["filtered_absolute"].max() < 1e-4
    flakes[1, 2, 3] = 0.05
    errors = between("btfflakes", flakes, "png16")["filtered_absolute"]
    assert np.delete(errors, 1, axis=0).max() < 1e-4
    assert set(zip(*np.nonzero(errors[1] > 0.01), strict=True)) == {(1, 2), (1, 3), (2, 2), (2, 3)}


def test_the_place_is_the_corner_of_four_texels():
    angles = np.zeros((16, 16, 1))
    angles[5:, 9:] = 0.99 * np.pi
    material = with_texture(ward(), "anisrotation", angles)
    module = target_named("unity_2018")
    packed = module.pack(material)
    texture = next(t for t in packed.textures.values() if t.axf_name == "anisrotation")
    found = map_errors(material.textures["anisrotation"], texture, module.reading(texture, packed.values)).statistics[1]
    assert found.measure == "filtered_axis_angle"
    assert found.total == 256
    assert found.where.u == (found.where.column + 1) / 16
    assert (found.where.row in (4, 15)) or (found.where.column in (8, 15))


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("make", [ward, paint])
def test_what_is_measured_has_a_name(make, target):
    module = target_named(target)
    packed = module.pack(make())
    for texture in packed.textures.values():
        if texture.axf_name in MEASURES:
            names = [m.name for m in measures_between(texture, module.reading(texture, packed.values))]
            assert names in ([], list(FILTERED_MEASURES.get(texture.axf_name, ())))
            assert names or texture.axf_name not in ("normal", "anisrotation", "clearcoatior", "clearcoatnormal")


AFFINE = {
    "identity": (Identity(), True),
    "clamp": (ClampNegative(), True),
    "offset": (UnitOffset(), True),
    "angle": (SignedAngle(), True),
    "scaled": (Chain((ClampNegative(), Scale(3.7))), True),
    "power": (Gamma(), False),
    "scaled power": (Chain((Scale(3.7), Gamma())), False),
    "index": (IorToF0(), False),
    "turn": (PositiveAngle(), False),
    "rebuilt": (TwoComponents(), False),
}


@pytest.mark.parametrize("name", AFFINE)
def test_affine_readings_are_told_from_others(name):
    reading, affine = AFFINE[name]
    with np.errstate(invalid="ignore"):
        assert is_affine(reading, 2) is affine


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), target=st.sampled_from(["unity_2018", "png16", "mdl"]))
def test_normals_of_three_components_err_no_more_between_texels_than_half_a_code_allows(seed, target):
    normals = unit_normals(np.random.default_rng(seed), (8, 8), 0.3)
    errors = between("normal", normals, target)
    shortest = 1 - errors["filtered_length"].max()
    assert errors["filtered_angle"].max() <= np.degrees(np.arcsin(3**0.5 / 65535)) / (shortest - 1e-4)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_an_affine_reading_errs_no_more_between_texels_than_at_them(seed):
    rng = np.random.default_rng(seed)
    module = target_named("unity_2018")
    material = with_texture(ward(), "specularlobe", 0.01 + 0.9 * rng.random((6, 7, 2)))
    packed = module.pack(material)
    texture = next(t for t in packed.textures.values() if t.axf_name == "specularlobe")
    reading, wanted = module.reading(texture, packed.values), material.textures["specularlobe"].data.astype(np.float64)
    assert measures_between(texture, reading) == ()
    stored = texture.number_format.decode(texture.levels[0])
    largest = np.abs(reading.inverse(stored) - wanted).max()
    weights = rng.dirichlet(np.ones(4), size=20)
    corners = [(0, 0), (0, 1), (1, 0), (1, 1)]
    for weight in weights:
        means = [
            sum(w * np.roll(values, corner, (0, 1)) for w, corner in zip(weight, corners, strict=True))
            for values in (wanted, stored)
        ]
        assert np.abs(reading.inverse(means[1]) - means[0]).max() <= largest * (1 + 1e-9)


def test_a_code_that_is_no_number_spreads_to_its_neighbors():
    material = ward()
    module = target_named("hdrp_10")
    packed = module.pack(material)
    texture = next(t for t in packed.textures.values() if t.axf_name == "anisrotation")
    codes = texture.levels[0].copy()
    codes[5, 9, 0] = np.float16(np.nan).view(np.uint16)
    errors = filtered_errors(
        material.textures["anisrotation"].data,
        codes,
        replace(texture, levels=(codes,)),
        module.reading(texture, packed.values),
    )["filtered_axis_angle"].reshape(16, 16)
    assert set(zip(*np.nonzero(np.isinf(errors)), strict=True)) == {(4, 8), (4, 9), (5, 8), (5, 9)}
