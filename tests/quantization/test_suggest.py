"""The cheapest formats: each texture's, verified together, and honest where there are none."""

import itertools
import sys
from dataclasses import replace
from functools import cache

import jsonschema
import pytest

from axffit.quantization import Tolerance, Tolerances, default_tolerances, verify
from axffit.quantization.document import Judged, document, schema
from axffit.quantization.suggest import suggest
from axffit.targets import TARGETS, Problem
from tests.targets.materials import MATERIALS, paint, ward

pytestmark = pytest.mark.usefixtures("found_only")

MODULE = sys.modules["axffit.quantization.suggest"]
SRGB = "RGBA8_UNORM_SRGB"


def limits(**changes):
    """The default tolerances with limits of textures changed; `diffusecolor_relative=0.1`."""
    entries = dict(default_tolerances().entries)
    for name, limit in changes.items():
        entries[f"textures.{name.replace('_', '.', 1)}"] = Tolerance(limit)
    return Tolerances(entries)


LOOSE = limits(diffusecolor_relative=1.0, diffusecolor_delta_e_2000=10.0, diffusecolor_filtered_relative=1.0)


@cache
def loose():
    return suggest(ward(), tolerances=LOOSE)


PLANTED = (Problem("planted", "nothing", "planted by a test"),)


def within(*_, **options):
    """Stands for `verify` where only the choice is looked at."""
    return replace(loose().verdict, problems=())


def by_axf(suggestion):
    return {each.axf_name: each for each in suggestion.textures}


def test_a_looser_limit_gives_a_cheaper_format_and_the_whole_is_verified():
    suggestion = loose()
    diffuse = by_axf(suggestion)["diffusecolor"]
    assert (diffuse.advised, diffuse.chosen) == ("RGBA16F", SRGB)
    assert 2 * diffuse.size_of(SRGB) == diffuse.size_of(None) == 16 * 16 * 8
    assert suggestion.bytes_before - suggestion.bytes_after == 16 * 16 * 4
    packed = {t.packed.axf_name: t.packed.format for t in suggestion.verdict.textures}
    assert packed == {each.axf_name: each.chosen for each in suggestion.textures}
    assert suggestion.steps == 0


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", MATERIALS)
def test_no_eligible_format_is_cheaper_and_no_chosen_one_outside(name, target, monkeypatch):
    loose()
    monkeypatch.setattr(MODULE, "verify", within)
    for each in suggest(MATERIALS[name](), target).textures:
        sizes = {c.format: c.size_bytes for c in each.candidates if not c.failures and not c.announced}
        assert sizes.get(each.chosen or "none") == min(sizes.values(), default=None)
        assert each.candidates[0].format == each.advised


def test_the_suggested_set_is_verified_again_by_hand():
    suggestion = loose()
    formats = {each.axf_name: str(each.chosen) for each in suggestion.textures}
    again = verify(ward(), tolerance=LOOSE, formats=formats)
    assert again.within == suggestion.verdict.within
    assert again.failures() == suggestion.verdict.failures()
    assert sum(t.packed.size_bytes for t in again.textures) == suggestion.bytes_after


def test_announced_formats_are_tried_and_never_chosen():
    suggestion = suggest(ward(), tolerances=limits(normal_angle=1e-5, normal_filtered_angle=1e-4))
    normal = by_axf(suggestion)["normal"]
    single = next(each for each in normal.candidates if each.format == "RGBA32F")
    assert (single.announced, single.failures) == (True, ())
    assert normal.chosen is None
    assert normal.candidates[0].failures[0].startswith("textures.normal.angle: ")
    assert not suggestion.verdict.within
    assert "no format keeps the tolerance of normal" in suggestion.summary()
    assert normal.size_of(normal.chosen) == normal.size_of("RGBA16_UNORM")


def test_a_texture_with_one_format_is_judged_too():
    suggestion = suggest(ward(), tolerances=limits(opacity_absolute=1e-9))
    assert [each.axf_name for each in suggestion.without] == ["opacity"]


def test_dearer_formats_are_taken_while_the_whole_is_outside(monkeypatch):
    tried = []

    def outside_at_first(material, target, *_, formats, **options):
        tried.append(formats)
        return replace(verdict, problems=() if formats["diffusecolor"] == "RGBA32F" else PLANTED)

    verdict = loose().verdict
    monkeypatch.setattr(MODULE, "verify", outside_at_first)
    suggestion = suggest(ward(), tolerances=LOOSE)
    assert [formats["diffusecolor"] for formats in tried] == [SRGB, "RGBA16F", "RGBA32F"]
    assert (suggestion.steps, by_axf(suggestion)["diffusecolor"].chosen) == (2, "RGBA32F")
    sizes = [sum(each.size_of(formats[each.axf_name]) for each in suggestion.textures) for formats in tried]
    assert all(a < b for a, b in itertools.pairwise(sizes))


def test_where_no_set_is_within_the_cheapest_stays_and_says_so(monkeypatch):
    verdict = replace(loose().verdict, problems=PLANTED)
    monkeypatch.setattr(MODULE, "verify", lambda *_, **options: verdict)
    suggestion = suggest(ward(), tolerances=LOOSE)
    assert by_axf(suggestion)["diffusecolor"].chosen == SRGB
    assert suggestion.summary().endswith("but the whole is outside tolerance")
    assert suggestion.to_json()["failures"] == [str(PLANTED[0])]
    assert not suggestion.to_json()["within"]


def test_levels_that_an_importer_drops_are_no_texture_within(monkeypatch):
    loose()
    monkeypatch.setattr(MODULE, "verify", within)
    flakes = by_axf(suggest(paint(), "unreal"))["btfflakes"]
    assert flakes.chosen is None
    assert flakes.candidates[0].failures[0].startswith("texture.shape: ")


def test_a_known_verdict_of_the_advised_formats_is_not_measured_again(monkeypatch):
    verdict = loose().verdict
    monkeypatch.setattr(MODULE, "verify", None)
    assert suggest(ward(), advised=verdict).verdict is verdict


def test_a_wider_limit_never_costs_bytes(monkeypatch):
    loose()
    monkeypatch.setattr(MODULE, "verify", within)
    wide = [
        suggest(ward(), tolerances=limits(diffusecolor_relative=x, diffusecolor_delta_e_2000=x)).bytes_after
        for x in (1e-6, 1e-3, 0.1, 10.0)
    ]
    assert wide == sorted(wide, reverse=True)


def test_json_validates_against_the_schema():
    suggestion = loose()
    content = document([Judged.of(suggestion.verdict, "ward.axf", None, suggestion)])
    jsonschema.validate(content, schema())
    rows = content["materials"][0]["suggestion"]
    assert rows["megabytes_before"] * 1e6 == pytest.approx(suggestion.bytes_before)
    assert len(rows["textures"]) == len(suggestion.textures)
    assert "suggestion" not in document([Judged.of(suggestion.verdict, "ward.axf")])["materials"][0]
