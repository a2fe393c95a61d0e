"""Which checks there are, how they are called, and what they say."""

import re

import pytest

from axffit import axf
from axffit.brdf import Lambert
from axffit.errors import InputError
from axffit.targets import TARGETS
from axffit.testing import laws
from axffit.testing.checks import NotApplicable, _check_law, _check_passivity, checks_of
from axffit.testing.negatives import negative_colors
from axffit.testing.places import Place
from tests.testing.materials import METALLIC, constant, overexposed, plain, written


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """Two materials: one that obeys, one that does not."""
    tilted = plain(normal=constant(0.1, 0.0, 0.995), diffusecolor=constant(-0.25, 0.5, 0.5))
    broken = overexposed()
    renamed = [axf.AxfMaterial(**{**vars(m), "id": id}) for m, id in ((tilted, "good"), (broken, "bad"))]
    return written(tmp_path_factory.mktemp("checks") / "two.axf", *renamed)


def named(checks):
    return {check.id: check for check in checks}


def test_every_law_of_every_material_is_a_check_of_its_own(file):
    expected = [f"{material}-{law}" for material in ("good", "bad") for law in (*laws.LAWS, "negative-colors")]
    assert [check.id for check in checks_of([file])] == expected


def test_a_material_is_chosen_by_its_id(file):
    assert {check.material for check in checks_of([file], materials=["bad"])} == {"bad"}
    with pytest.raises(InputError, match="no material 'nobody'; there are: good, bad"):
        checks_of([file], materials=["good", "nobody"])


def test_ids_that_two_files_share_are_told_apart(file, tmp_path):
    other = written(tmp_path / "other.axf", *axf.read(file).materials[:1])
    assert list(dict.fromkeys(check.material for check in checks_of([file, other]))) == [
        "two:good",
        "bad",
        "other:good",
    ]


def test_targets_add_three_checks_each(file):
    found = checks_of([file], materials=["good"], engines=list(TARGETS))
    expected = [f"good-{name}-{what}" for name in TARGETS for what in ("obligations", "unpacks", "stable")]
    assert [check.id for check in found][-len(expected) :] == expected
    for check in found[-len(expected) :]:
        check.run()


REFUSED = {
    "no such file": ({"files": ["nothing.axf"]}, "nothing.axf: no such file"),
    "no such target": ({"engines": ["nobody"]}, "unknown target 'nobody'; allowed: unity_2018"),
    "fewer than no texels": ({"texels": -1}, "--axf-texels -1: give 0 or more"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused(name, file):
    arguments, message = REFUSED[name]
    with pytest.raises(InputError, match=message):
        checks_of(**{"files": [file]} | arguments)


def test_a_broken_law_is_named_and_the_others_hold(file):
    found = named(checks_of([file]))
    with pytest.raises(AssertionError, match=r"^passivity: albedo 1\.\d+ .* is above 1$"):
        found["bad-passivity"].run()
    for id in ("bad-non-negativity", "bad-horizon", "good-non-negativity"):
        assert found[id].run() is None
    assert str(found["good-passivity"].run()).startswith("albedo 0.")
    with pytest.raises(NotApplicable, match="the shading normal is tilted"):
        found["good-isotropy"].run()


def test_the_place_of_a_broken_law_is_named():
    where = (
        Place("uv (0, 0), at random", Lambert((0.5, 0.5, 0.5))),
        Place("uv (1, 2), here", Lambert((0.5, -1e-3, 0.5))),
    )
    with pytest.raises(AssertionError, match=r"^non-negativity: .*, at uv \(1, 2\), here$"):
        _check_law("non-negativity", where)


def test_a_glint_is_reported_and_the_mean_over_the_surface_judged():
    gray, bright = Place("gray", Lambert((0.5,) * 3)), Place("glint", Lambert((1.5,) * 3))
    extreme = Place("glint", bright.brdf, extreme=True)
    for where in ((gray, extreme), (gray, gray, bright)):
        assert re.fullmatch(r"albedo 1\.5\d* .*, at glint", _check_passivity(where))
    for where in ((gray, bright, bright), (bright, Place("gray", gray.brdf, extreme=True)), (extreme,)):
        with pytest.raises(
            AssertionError, match=r"^passivity: albedo 1\.\d+ .* is above 1(, at the mean of 3 places)?$"
        ):
            _check_passivity(where)


def test_negative_colors_are_counted_and_judged_on_request_only(file):
    text = "1 of 3 values of diffusecolor, down to -0.25"
    assert named(checks_of([file]))["good-negative-colors"].run() == f"negative colors, read as 0: {text}"
    with pytest.raises(AssertionError, match=f"^negative-colors: {text}$"):
        named(checks_of([file], strict=True))["good-negative-colors"].run()
    assert named(checks_of([file], strict=True))["bad-negative-colors"].run() is None


def test_negative_flakes_are_counted_over_all_levels():
    (material,) = axf.read(METALLIC).materials
    count = sum(int((level < 0).sum()) for level in material.textures["btfflakes"].levels)
    total = sum(level.size for level in material.textures["btfflakes"].levels)
    assert f"{count} of {total} values of btfflakes, down to -0.00" in str(negative_colors(material))
