"""What inspect says of a material."""

import jsonschema
import numpy as np
import pytest
from hypothesis import given

from axffit.axf import AxfFile, AxfMaterial, AxfTexture, MaterialKind
from axffit.axf.description import describe, describe_material, describe_texture, schema
from axffit.synthesis import brushed_carbon, metallic_paint
from axffit.testing.strategies import axf_files


def texture(values, **sizes):
    return AxfTexture((np.asarray(values, np.float32),), **sizes)


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(schema())


@pytest.mark.parametrize("make", [brushed_carbon, metallic_paint])
def test_a_material_is_described_by_the_schema(make):
    content = describe(AxfFile((make(64),)))
    jsonschema.validate(content, schema(), cls=jsonschema.Draft202012Validator)
    assert content["materials"][0]["problems"] == []


@given(axf_files())
def test_any_file_is_described_by_the_schema(file):
    content = describe(file)
    jsonschema.validate(content, schema(), cls=jsonschema.Draft202012Validator)
    assert [material["id"] for material in content["materials"]] == [material.id for material in file.materials]


def test_values_are_counted_and_ranged():
    found = describe_texture(
        "clearcoatior", texture([[[1.5], [np.nan]], [[-2.0], [np.inf]]], width_mm=20, height_mm=10)
    )
    assert found["size"] == [2, 2]
    assert (found["negative"], found["nan"], found["infinite"]) == (1, 1, 1)
    assert (found["minimum"], found["maximum"], found["mean"]) == ([-2.0], [1.5], [-0.25])
    assert (found["outside"], found["outside_means"]) == (2, "counted")  # NaN and the negative one
    assert not found["constant"]


def test_channels_are_ranged_apart():
    found = describe_texture("diffusecolor", texture([[[0, 1, 2], [3, -4, 5]]]))
    assert found["minimum"] == [0, -4, 2]
    assert found["maximum"] == [3, 1, 5]
    assert found["negative"] == found["outside"] == 1


def test_a_texture_without_a_finite_value_has_no_range():
    found = describe_texture("clearcoatior", texture([[[np.nan]]]))
    assert found["minimum"] == found["maximum"] == found["mean"] == [None]


def test_a_height_and_a_width_are_told_apart():
    assert describe_texture("height", texture(np.zeros((3, 5, 1))))["size"] == [5, 3]


def test_flakes_have_slices_and_levels():
    found = describe_material(metallic_paint(64))["textures"]["btfflakes"]
    assert found["slices"] == 62
    assert found["levels"] == 6


def test_broken_rules_are_listed_and_not_raised():
    broken = AxfMaterial("m", "m", MaterialKind.SVBRDF, textures={"specularlobe": texture([[[2.0]]])})
    (problem,) = describe_material(broken)["problems"]
    assert "specularlobe" in problem
    assert describe_material(broken)["textures"]["specularlobe"]["outside_means"] == "refused"
