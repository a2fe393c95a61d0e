"""Every rule at the border, kept and broken; a message names the node, the value and the mend."""

import numpy as np
import pytest

from axffit import axf
from axffit.axf.validation import check, problems
from axffit.errors import InputError

SHAPES = {
    "diffusecolor": (2, 3, 3),
    "normal": (2, 3, 3),
    "specularcolor": (2, 3, 3),
    "specularlobe": (2, 3, 1),
    "anisrotation": (2, 3, 1),
    "fresnel": (2, 3, 3),
    "opacity": (2, 3, 1),
    "height": (2, 3, 1),
    "clearcoatcolor": (2, 3, 3),
    "clearcoatnormal": (2, 3, 3),
    "clearcoatior": (2, 3, 1),
    "brdfcolors": (4, 4, 3),
    "btfflakes": (5, 4, 4, 3),
}


def with_texture(key, values, **changes):
    levels = values if isinstance(values, tuple) else (values,)
    texture = axf.AxfTexture(levels, source=f"/node/of/{key}")
    return axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF, textures={key: texture}, **changes)


def with_properties(**properties):
    return axf.AxfMaterial("m", "m", axf.MaterialKind.CAR_PAINT, properties=properties)


def legal(key, dtype=np.float32):
    return np.full(SHAPES[key], 0.5, dtype)


def changed(key, index, value):
    values = legal(key)
    values[index] = value
    return values


def first_problem(material):
    return next(problems(material), None)


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("key", SHAPES)
def test_legal_textures_pass(key, dtype):
    assert first_problem(with_texture(key, legal(key, dtype))) is None


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("key", [key for key in SHAPES if key != "clearcoatior"])
def test_values_that_are_not_finite_are_refused_and_placed(key, value):
    values = legal(key)
    values[..., 1, 2, 0] = value
    places = values.reshape(-1, *values.shape[-3:]).shape[0]
    problem = first_problem(with_texture(key, values))
    noun = "value" if places == 1 else "values"
    where = "[1, 2, 0]" if values.ndim == 3 else "[0, 1, 2, 0]"
    assert problem is not None
    assert problem.startswith(f"/node/of/{key}: {places} {noun} (first at {where}: {value})")


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.0, -1.0])
def test_a_clear_coat_ior_may_be_anything(value):
    assert first_problem(with_texture("clearcoatior", changed("clearcoatior", (1, 1, 0), value))) is None


@pytest.mark.parametrize(
    ("key", "value"),
    [("diffusecolor", -0.1), ("specularcolor", -0.1), ("fresnel", -0.1), ("clearcoatcolor", -1.0)]
    + [("brdfcolors", -0.1), ("btfflakes", -0.1), ("brdfcolors", 2.97), ("anisrotation", 4.0), ("height", -3.0)],
)
def test_values_that_a_target_replaces_pass(key, value):
    assert first_problem(with_texture(key, changed(key, 0, value))) is None


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("normal", 1.5, "(tangent-space component) outside [-1, 1]"),
        ("clearcoatnormal", -1.5, "(tangent-space component) outside [-1, 1]"),
        ("specularlobe", 1.5, "(roughness) outside [0, 1]"),
        ("specularlobe", -0.5, "(roughness) outside [0, 1]"),
        ("opacity", 1.5, "(opacity) outside [0, 1]"),
        ("fresnel", 1.5, "(F0) outside (-inf, 1]"),
    ],
)
def test_values_outside_their_range_are_refused(key, value, said):
    problem = first_problem(with_texture(key, changed(key, (1, 0, 0), value)))
    assert problem == f"/node/of/{key}: 1 value (first at [1, 0, 0]: {value}) in {key} {said}; correct them"


def test_phong_lobes_hold_exponents():
    values = changed("specularlobe", (0, 0, 0), 12.0)
    assert first_problem(with_texture("specularlobe", values)) is not None
    assert first_problem(with_texture("specularlobe", values, specular_model="BlinnPhong")) is None


def test_a_normal_needs_a_direction():
    problem = first_problem(with_texture("normal", changed("normal", (1, 1), 0.0)))
    assert problem is not None
    assert "1 value (first at [1, 1]: [0.0, 0.0, 0.0]) in normal of length 0" in problem


@pytest.mark.parametrize(
    ("key", "values", "said"),
    [
        ("brdfcolors", np.ones((4, 3), np.float32), "brdfcolors of rank 2 (shape (4, 3)); it must have rank 3"),
        ("btfflakes", np.ones((4, 4, 3), np.float32), "btfflakes of rank 3 (shape (4, 4, 3)); it must have rank 4"),
        ("diffusecolor", np.ones((2, 2, 1), np.float32), "diffusecolor has 1 channels; it must have 3"),
        ("diffusecolor", np.ones((1, 1, 31), np.float32), "diffusecolor has 31 channels (a spectrum?); it must"),
        ("specularlobe", np.ones((2, 2, 3), np.float32), "specularlobe has 3 channels; it must have 1 or 2"),
        ("fresnel", np.ones((2, 2, 2), np.float32), "fresnel has 2 channels; it must have 1 or 3"),
        ("normal", np.ones((0, 2, 3), np.float32), "normal has no texel (shape (0, 2, 3))"),
        ("diffusecolor", np.ones((2, 2, 3), np.uint8), "diffusecolor holds uint8; store float32 or float16"),
        ("diffusecolor", np.ones((2, 2, 3), np.float64), "diffusecolor holds float64; store float32 or float16"),
    ],
)
def test_shapes_and_types_are_checked(key, values, said):
    problem = first_problem(with_texture(key, values))
    assert problem is not None
    assert problem.startswith(f"/node/of/{key}: {said}")


def test_levels_must_continue_each_other():
    first, second = np.ones((3, 4, 4, 3), np.float32), np.ones((2, 2, 2, 3), np.float32)
    problem = first_problem(with_texture("btfflakes", (first, second)))
    assert problem is not None
    assert "(level 1): shape (2, 2, 2, 3) does not continue level 0 of shape (3, 4, 4, 3)" in problem
    assert first_problem(with_texture("btfflakes", (first, second[[0, 0, 1]]))) is None


LOBES = {"CT_coeffs": [0.1, 0.2], "CT_F0s": [0.1, 0.2], "CT_spreads": [0.1, 0.2]}


@pytest.mark.parametrize(
    ("properties", "said"),
    [
        ({"CT_diffuse": -0.1}, "m: property CT_diffuse is -0.1"),
        ({"CT_diffuse": np.nan}, "m: property CT_diffuse is nan"),
        ({**LOBES, "CT_F0s": [0.1, 1.5]}, "m: property CT_F0s[1] is 1.5; allowed: a finite F0 in [0, 1]"),
        ({**LOBES, "CT_spreads": [0.0, 1.0]}, "m: property CT_spreads[0] is 0.0"),
        ({**LOBES, "CT_coeffs": [0.1, np.inf]}, "m: property CT_coeffs[1] is inf"),
        ({"IOR": 0.0}, "m: property IOR is 0.0; allowed: a finite index of refraction in (0, inf)"),
        ({"num_thetaF": 0}, "m: property num_thetaF is 0"),
        ({"max_thetaI": 65}, "m: property max_thetaI is 65"),
        ({"thetaFI_sliceLUT": [0, 300]}, "m: property thetaFI_sliceLUT[1] is 300; allowed: a finite slice index"),
        ({"thetaFI_sliceLUT": [-1, 3]}, "m: property thetaFI_sliceLUT[0] is -1"),
        ({**LOBES, "CT_F0s": [0.1]}, "m: lobe properties of unequal length (CT_coeffs 2, CT_F0s 1, CT_spreads 2)"),
        ({"CT_F0s": [0.1]}, "m: lobe properties of unequal length (CT_coeffs 0, CT_F0s 1, CT_spreads 0)"),
        ({name: [0.1] * 5 for name in LOBES}, "m: 5 lobes; AxF has at most 4"),
        ({"thetaFI_sliceLUT": [0, 7, 5, 9]}, "m: property thetaFI_sliceLUT falls from 7 to 5 at entry 2"),
        ({"thetaFI_sliceLUT": [0, 7, 0, 9]}, "m: property thetaFI_sliceLUT falls from 7 to 0 at entry 2"),
        ({"thetaFI_sliceLUT": [0] * 65}, "m: property thetaFI_sliceLUT has 65 entries; AxF has at most 64"),
        ({"thetaFI_sliceLUT": [0, 7], "max_thetaI": 3}, "m: property thetaFI_sliceLUT has 2 entries for max_thetaI 3"),
    ],
    ids=str,
)
def test_properties_outside_their_range_are_refused(properties, said):
    problem = first_problem(with_properties(**properties))
    assert problem is not None
    assert problem.startswith(said)


@pytest.mark.parametrize(
    "properties",
    [
        {},
        LOBES,
        {name: [0.1] * 4 for name in LOBES},
        {"thetaFI_sliceLUT": [0, 7, 14, 14, 21, 0, 0], "max_thetaI": 5},
        {"thetaFI_sliceLUT": [0] * 64},
        {"cc_no_refraction": -7},
    ],
    ids=str,
)
def test_legal_properties_pass(properties):
    assert first_problem(with_properties(**properties)) is None


@pytest.mark.parametrize(("slices", "legal_table"), [(5, True), (4, False)])
def test_the_slice_table_stays_within_the_flakes(slices, legal_table):
    material = axf.AxfMaterial(
        "m",
        "m",
        axf.MaterialKind.CAR_PAINT,
        textures={"btfflakes": axf.AxfTexture((np.ones((slices, 1, 1, 3), np.float32),))},
        properties={"thetaFI_sliceLUT": [0, 3, 5, 0]},
    )
    problem = first_problem(material)
    if legal_table:
        assert problem is None
    else:
        assert problem is not None
        assert "points at slice 5 but the flakes have 4 slices" in problem


def test_check_raises_one_line_that_names_the_file():
    material = with_texture("normal", changed("normal", 0, np.nan))
    with pytest.raises(InputError) as caught:
        check(material, "paint.axf")
    assert str(caught.value).startswith("paint.axf: /node/of/normal: 9 values (first at [0, 0, 0]: nan)")
    assert "\n" not in str(caught.value)
    check(with_texture("normal", legal("normal")))
