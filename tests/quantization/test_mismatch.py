"""Textures packed for one target and read by another."""

import json
from functools import cache

import jsonschema
import numpy as np
import pytest

from axffit.errors import InputError
from axffit.quantization import verify
from axffit.quantization.mismatch import read_by, reader_problems
from axffit.quantization.verdict import schema
from axffit.targets import TARGETS
from tests.targets.materials import paint, ward, with_texture

pytestmark = pytest.mark.usefixtures("found_only")

ROTATION = "_SVBRDF_AnisoRotationMap"


def row(verdict, axf_name):
    return next(texture for texture in verdict.textures if texture.packed.axf_name == axf_name)


DEGREES = -80.0


@cache
def misread():
    """A material whose every axis is turned by `DEGREES`, packed by the specification of 2018 and read by HDRP."""
    material = with_texture(ward(), "anisrotation", np.full((4, 4, 1), np.radians(DEGREES)))
    return verify(material, packed_for="unity_2018", read_by="hdrp_10")


def test_an_angle_of_2018_is_read_at_half_by_hdrp():
    verdict = misread()
    statistics, check = row(verdict, "anisrotation").measures[0]
    assert statistics.unit == "degrees"
    assert statistics.max == pytest.approx(abs(DEGREES) / 2, abs=0.003)
    assert not check.within
    assert not verdict.within
    problem = next(p for p in verdict.problems if p.obligation == "mismatch")
    assert problem.subject == ROTATION
    for words in ("anisrotation", "0.5 (1 + x / pi)", "0.5 (1 + x / (pi/2))", "degrees", "unity_2018", "hdrp_10"):
        assert words in problem.message
    assert "unity_2018, read by hdrp_10" in verdict.summary()


def test_what_both_read_alike_is_not_reported():
    verdict = misread()
    assert [problem.subject for problem in verdict.problems] == [ROTATION]
    outside = [t.packed.axf_name for t in verdict.textures if not t.within]
    # Read alike, but packed in 8 bits where the reading engine's limits expect half floats.
    assert outside == ["opacity", "anisrotation"]


def test_the_json_names_both_targets_and_both_ranges():
    content = misread().to_json()
    jsonschema.validate(json.loads(json.dumps(content, allow_nan=False)), schema())
    assert (content["packed_for"], content["target"]) == ("unity_2018", "hdrp_10")
    angle = next(entry for entry in content["textures"] if entry["axf_name"] == "anisrotation")
    assert (angle["transform"], angle["reading"]) == ("0.5 (1 + x / pi)", "0.5 (1 + x / (pi/2))")
    assert angle["name"] == ROTATION


def test_a_target_that_reads_itself_has_no_mismatch():
    verdict = verify(ward())
    assert (verdict.packed_for, verdict.target) == ("unity_2018", "unity_2018")
    assert all(texture.reading == texture.packed.transform for texture in verdict.textures)


def test_a_scale_goes_with_its_texture():
    formats = {"brdfcolors": "RGBA8_UNORM_SRGB"}
    verdict = verify(paint(), packed_for="unity_2018", read_by="hdrp_10", formats=formats)
    table = paint().textures["brdfcolors"].data
    assert verdict.values["_CarPaint2_BRDFColorMapScale"] == table.max()
    assert row(verdict, "brdfcolors").measures[1][0].max < 0.02


@pytest.mark.parametrize("packer", TARGETS)
@pytest.mark.parametrize("reader", TARGETS)
def test_any_two_targets_give_a_verdict(packer, reader):
    for make in (ward, paint):
        material = make()
        packed = read_by(material, TARGETS[packer].pack(material), reader)
        assert packed.target == reader
        assert set(packed.values) == set(TARGETS[reader].pack(material).values)
        problems = list(reader_problems(TARGETS[reader].validate(packed), packed))
        unreadable = {problem.subject for problem in problems}
        for texture in packed.textures.values():
            assert TARGETS[reader].texture_name(texture.axf_name, material.kind) == texture.name
            if texture.name not in unreadable:
                TARGETS[reader].reading(texture, packed.values)


def test_two_components_are_no_normal_to_a_shader_that_wants_three():
    verdict = verify(ward(), packed_for="hdrp_10", read_by="unity_2018")
    assert ("texture.channels", "_SVBRDF_NormalMap") in {(p.obligation, p.subject) for p in verdict.problems}
    assert verdict.brdf.errors is None
    assert "the shader reads 3" in verdict.brdf.reason


@pytest.mark.slow
def test_an_engine_that_keeps_less_is_judged_by_what_it_keeps():
    verdict = verify(ward(), "unreal")
    assert not verdict.within
    assert not row(verdict, "specularlobe").within
    assert any("anisotropy is dropped" in note for note in verdict.notes)


def test_an_unknown_engine_is_refused():
    with pytest.raises(InputError, match="unknown target 'godot'; allowed: unity_2018"):
        verify(ward(), packed_for="godot")
    with pytest.raises(InputError, match="unknown target 'godot'; allowed: unity_2018"):
        verify(ward(), read_by="godot")
