"""The verdict: within for what is packed as advised, planted faults named, monotone in the tolerance, valid JSON."""

import json
import sys
from dataclasses import replace
from functools import cache

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axffit.errors import InputError
from axffit.quantization import Tolerance, Tolerances, default_tolerances, verify, verify_packed
from axffit.quantization.bounds import Bounds, TexelClass
from axffit.quantization.brdf_error import BrdfErrors, Found
from axffit.quantization.brdf_verdict import BrdfVerdict
from axffit.quantization.material_bounds import BoundedClass, MaterialBounds
from axffit.quantization.tolerances import KINDS, Kind
from axffit.quantization.verdict import schema
from axffit.targets import unity_2018
from axffit.textures.unorm import linear_to_srgb
from tests.targets.materials import MATERIALS, paint, texture, ward, with_texture, without

pytestmark = pytest.mark.usefixtures("found_only")

NORMAL, LUT, FLAKES = "_SVBRDF_NormalMap", "_CarPaint_thetaFI_sliceLUTMap", "_CarPaint_BTFFlakesMap_sRGB"


@cache
def verdict_of(name):
    return verify(MATERIALS[name]())


def changed(packed, name, change=None, **fields):
    """A packed material with one texture's codes or fields changed."""
    levels = tuple(level.copy() for level in packed.textures[name].levels)
    if change is not None:
        levels = change(levels)
    return replace(packed, textures={**packed.textures, name: replace(packed.textures[name], levels=levels, **fields)})


@pytest.mark.parametrize("name", MATERIALS)
def test_what_is_packed_as_advised_is_within(name):
    verdict = verdict_of(name)
    assert verdict.within
    assert verdict.failures() == ()
    assert "within tolerance" in verdict.summary()
    assert {t.packed.name for t in verdict.textures} == set(unity_2018.pack(MATERIALS[name]()).textures) - {LUT}
    assert set(verdict.error_maps) == {t.packed.name for t in verdict.textures}
    assert all(picture.ndim == 2 for picture in verdict.error_maps.values())
    assert all(check.tolerance is not None for check in verdict.brdf.checks)


@pytest.mark.parametrize("name", MATERIALS)
def test_json_validates_against_the_schema(name):
    jsonschema.Draft202012Validator.check_schema(schema())
    content = json.loads(json.dumps(verdict_of(name).to_json(), allow_nan=False))
    jsonschema.validate(content, schema())
    assert content["schema_version"] == 1
    row = content["textures"][0]
    assert row["max"] == row["measures"][0]["max"]
    assert row["tolerance"] == row["measures"][0]["tolerance"]


def test_an_infinite_error_and_a_limit_that_is_off_are_still_json():
    indices = np.full((4, 4, 1), 1.5)
    indices[0, 1] = 3e5
    verdict = verify(with_texture(ward(), "clearcoatior", indices))
    assert not verdict.within
    assert "textures.clearcoatior.ior: inf" in verdict.failures()[0]
    content = json.loads(json.dumps(verdict.to_json(), allow_nan=False))
    jsonschema.validate(content, schema())


def test_counts_are_in_the_rows():
    rows = {row["axf_name"]: row for row in verdict_of("ward").to_json()["textures"]}
    assert rows["diffusecolor"]["clamped"] == 1
    assert rows["diffusecolor"]["excess"] == pytest.approx(0.01)
    assert rows["clearcoatior"]["replaced"] == 1


def test_a_default_is_compared_with_what_it_stands_for():
    verdict = verify(without(ward(), "normal", "clearcoatior"))
    rows = {t.packed.axf_name: t for t in verdict.textures}
    assert rows["normal"].packed.defaulted
    assert rows["normal"].measures[0][0].max == pytest.approx(0.00124, rel=5e-3)
    assert rows["clearcoatior"].measures[0][0].max < 2e-5


def swap_red_green(levels):
    return (levels[0][..., [1, 0, 2, 3]],)


def add_one(levels):
    return (levels[0] + np.uint8(1),)


def without_last_level(levels):
    return levels[:-1]


def rebuilt(levels):
    """Mip levels averaged from level 0 instead of kept as given."""
    decoded = levels[0].view(np.float16).astype(np.float64)
    rebuilt_levels = [levels[0]]
    for _ in levels[1:]:
        d, h, w, c = decoded.shape
        decoded = decoded.reshape(d, h // 2, 2, w // 2, 2, c).mean(axis=(2, 4))
        rebuilt_levels.append(decoded.astype(np.float16).view(np.uint16))
    return tuple(rebuilt_levels)


def srgb_curve(levels):
    linear = levels[0].view(np.float16).astype(np.float64)
    return (linear_to_srgb(np.maximum(linear, 0.0)).astype(np.float16).view(np.uint16),)


def packed_over_half_a_turn(levels):
    """0.5 (1 + x / (pi / 2)), as another target wants it, instead of 0.5 (1 + x / pi)."""
    return (np.clip(2.0 * levels[0] - 32767.5, 0, 65535).astype(np.uint16),)


def let_negatives_through(levels):
    codes = levels[0].copy()
    codes[1, 2, 0] = np.float16(-0.01).view(np.uint16)
    return (codes,)


WARD, PAINT = unity_2018.pack(ward()), unity_2018.pack(paint())
DIFFUSE, TABLE = "_SVBRDF_DiffuseColorMap_sRGB", "_CarPaint_BRDFColorMap_sRGB"
FAULTS = {
    "red and green swapped": (ward, changed(WARD, NORMAL, swap_red_green), "textures.normal.angle"),
    "floor instead of round": (ward, unity_2018.pack(ward(), rounding="floor"), "textures.normal.angle"),
    "an sRGB curve on a linear map": (ward, changed(WARD, DIFFUSE, srgb_curve), "textures.diffusecolor.relative"),
    "negatives let through": (ward, changed(WARD, DIFFUSE, let_negatives_through), "textures.diffusecolor.relative"),
    "a table off by one": (paint, changed(PAINT, LUT, add_one), "lut.rounded"),
    "mips rebuilt": (paint, changed(PAINT, FLAKES, rebuilt), "textures.btfflakes.relative"),
    "a mip level dropped": (paint, changed(PAINT, FLAKES, without_last_level), "texture.shape: _CarPaint_BTFFlakesMap"),
    "a scale that does not belong": (
        paint,
        replace(PAINT, values={**PAINT.values, "_CarPaint_BRDFColorMap_Scale": 2.0}),
        "textures.brdfcolors.relative",
    ),
    "a scale left at 1": (
        paint,
        replace(
            unity_2018.pack(paint(), formats={"brdfcolors": "RGBA8_UNORM_SRGB"}),
            values={**unity_2018.pack(paint()).values},
        ),
        "textures.brdfcolors.relative",
    ),
    "an angle packed for another target": (
        ward,
        changed(
            WARD,
            "_SVBRDF_AnisotropicRotationAngleMap",
            packed_over_half_a_turn,
        ),
        "textures.anisrotation.axis_angle",
    ),
    "a texture lost": (
        ward,
        replace(WARD, textures={n: t for n, t in WARD.textures.items() if n != DIFFUSE}),
        f"texture.lost: {DIFFUSE}",
    ),
    "a coat without its flag": (ward, replace(WARD, values={**WARD.values, "_flags": 13}), "flags.bit1"),
    "another lobe": (
        paint,
        replace(PAINT, values={**PAINT.values, "_CarPaint_CT_coefs": (0.1, 0.06, 0.02, 0.0)}),
        "brdf.log_ratio",
    ),
    "an integer without a meaning": (ward, replace(WARD, values={**WARD.values, "_SVBRDF_BRDFType": 14}), "models"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_caught_and_named(name):
    make, packed, named = FAULTS[name]
    verdict = verify_packed(make(), packed)
    assert not verdict.within
    assert any(failure.startswith(named) for failure in verdict.failures()), verdict.failures()
    jsonschema.validate(json.loads(json.dumps(verdict.to_json(), allow_nan=False)), schema())


def test_the_slice_table_as_an_integer_texture():
    verdict = verify(paint(), formats={"thetaFI_sliceLUT": "R8_UINT"})
    assert verdict.lut is not None
    assert verdict.within
    assert [check.value for check in verdict.lut.checks] == [0, 0]


def test_a_model_that_is_not_evaluated_is_said_so():
    verdict = verify(replace(ward(), specular_model="GGX", specular_variant="Ward1992"))
    assert verdict.brdf.errors is None
    assert "GGX" in verdict.brdf.reason
    jsonschema.validate(json.loads(json.dumps(verdict.to_json(), allow_nan=False)), schema())


def test_a_lobe_map_of_exponents():
    material = replace(ward(), specular_model="Phong", specular_variant=None, anisotropic=False)
    verdict = verify(with_texture(material, "specularlobe", 5 + 4 * np.random.default_rng(0).random((16, 16, 1))))
    assert verdict.brdf.errors is not None
    # A half rounds the exponent's logarithm 9 by 2^-8 at most, the exponent 512 by a quarter of a percent.
    assert 1e-4 < verdict.brdf.errors.log_ratio.value < 0.03


@settings(max_examples=20)
@given(factor=st.floats(0, 4), more=st.floats(1, 10), name=st.sampled_from(["ward", "paint"]))
def test_a_wider_tolerance_never_turns_within_into_outside(factor, more, name):
    verdict = verdict_of(name)

    def judged(scale):
        """The same measurements against limits multiplied by a factor."""

        def scaled(check):
            limit = check.tolerance and replace(check.tolerance, limit=scale * check.tolerance.limit)
            return replace(check, tolerance=limit)

        textures = tuple(replace(t, measures=tuple((s, scaled(c)) for s, c in t.measures)) for t in verdict.textures)
        brdf = replace(verdict.brdf, checks=tuple(scaled(c) for c in verdict.brdf.checks))
        return replace(verdict, textures=textures, brdf=brdf)

    narrow, wide = judged(factor), judged(factor * more)
    assert narrow.within <= wide.within
    assert len(wide.failures()) <= len(narrow.failures())
    for a, b in zip(narrow.checks(), wide.checks(), strict=True):
        assert a.within <= b.within


def bounded(monkeypatch, bound):
    """Every material has this bound of both errors."""
    bounds: dict[Kind, Bounds] = {kind: Bounds(bound, 1) for kind in KINDS}
    group = BoundedClass(TexelClass(1e-5), 768, None, bounds)
    module = sys.modules["axffit.quantization.verify"]
    monkeypatch.setattr(module, "material_bounds", lambda *_: MaterialBounds((group,), 12))


def test_the_bound_is_judged_where_there_is_one(monkeypatch):
    bounded(monkeypatch, 0.012)
    verdict = verify(ward())
    assert [check.value for check in verdict.brdf.checks] == [0.012, 0.012]
    assert verdict.failures() == ("brdf.peak_relative: 0.012 > 0.01 (bound)",)
    content = json.loads(json.dumps(verdict.to_json(), allow_nan=False))
    jsonschema.validate(content, schema())
    peak, ratio = content["brdf"]["rows"]
    assert (peak["judged"], peak["bound"], peak["within"]) == ("bound", 0.012, False)
    assert (ratio["judged"], ratio["within"]) == ("bound", True)
    assert 0 < peak["found"] < 0.012
    (group,) = content["brdf"]["bounds"]["classes"]
    assert (group["items"], group["log_ratio"]) == (768, {"bound": 0.012, "boxes": 1})


def test_without_a_bound_what_was_found_is_judged_and_the_reason_is_given():
    verdict = verify(ward(), tolerance=Tolerances({"brdf.log_ratio": Tolerance(1e-9)}))
    (failure,) = verdict.failures()
    assert failure.startswith("brdf.log_ratio: 0.0")
    assert failure.endswith("> 1e-09 (found only)")
    content = verdict.to_json()["brdf"]
    assert content["rows"][0]["judged"] == "found"
    assert content["rows"][0]["bound"] is None
    assert content["bounds"]["reason"] == "left out by a test"
    assert verify(ward(), bounds=False).to_json()["brdf"]["bounds"]["reason"] == "left out on request"


def test_tolerances_decide(tmp_path):
    path = tmp_path / "strict.toml"
    path.write_text("[textures.normal.angle]\nlimit = 1e-6\n", encoding="utf-8")
    strict = verify(ward(), "unity_2018", path)
    assert not strict.within
    assert strict.failures()[0].startswith("textures.normal.angle: 0.001")
    everything_off = Tolerances({name: Tolerance(np.inf) for name in default_tolerances().entries})
    assert verify(with_texture(ward(), "clearcoatior", np.full((4, 4, 1), 0.5)), tolerance=everything_off).within


def test_without_the_color_extra_the_verdict_says_what_is_missing(monkeypatch):
    for module in ("measures", "verify"):
        monkeypatch.setattr(sys.modules[f"axffit.quantization.{module}"], "has_color_science", lambda: False)
    verdict = verify(paint())
    assert verdict.within
    assert any("dE2000 is not measured" in note for note in verdict.notes)
    assert not [check for check in verdict.checks() if "delta_e" in check.name]


def test_progress_runs_through_its_stages(monkeypatch):
    seen = []
    monkeypatch.setattr(sys.modules["axffit.quantization.verify"], "material_bounds", lambda *args: args[-1](1.0))
    monkeypatch.setattr(BrdfVerdict, "judged", lambda *_: BrdfVerdict(None, None, ()))
    verify(paint(), progress=lambda stage, fraction: seen.append((stage, fraction)))
    assert list(dict.fromkeys(stage for stage, _ in seen)) == [
        "packing textures", "measuring map errors", "measuring the reflectance", "bounding the reflectance",
    ]  # fmt: skip
    assert all(0 <= fraction <= 1 for _, fraction in seen)
    assert seen[-1][1] == 1.0


def test_bad_input_is_named():
    with pytest.raises(InputError, match="unknown target 'unity_6'; allowed: unity_2018"):
        verify(ward(), "unity_6")
    with pytest.raises(InputError, match="300"):
        verify(replace(paint(), properties={**paint().properties, "thetaFI_sliceLUT": [0, 300]}))
    assert texture(np.zeros((1, 1, 1))).channels == 1


@pytest.mark.parametrize(("bound", "judged"), [(0.02, "bound"), (0.2, "found"), (np.inf, "found")])
def test_a_bound_that_ended_early_is_shown_and_not_judged(bound, judged):
    place = Found(0.005, (0.5, 0.5), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    errors = BrdfErrors(place, place, place, (), (), texels=1, views=1, lights=1, ascents=1)
    proved: dict[Kind, Bounds] = {kind: Bounds(bound, 1) for kind in KINDS}
    bounds = MaterialBounds((BoundedClass(TexelClass(1e-5), 1, None, proved),), 1)
    verdict = BrdfVerdict.judged(errors, bounds, default_tolerances())
    for row in verdict.to_json()["rows"]:
        assert row["judged"] == judged
        assert row["bound"] == (None if np.isinf(bound) else bound)
        ended = "without one" if np.isinf(bound) else "at 0.2, more than 10 times what was found"
        assert row["unproved"] == ("" if judged == "bound" else f"the search for a bound ended {ended}")
    # Within 1 % by what was found, outside by the bound.
    assert verdict.checks[0].within == (judged == "found")
    assert verdict.basis(verdict.checks[0]) == (" (bound)" if judged == "bound" else " (found only)")
