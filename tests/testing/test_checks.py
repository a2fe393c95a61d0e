"""Which checks there are, how they are called, and what they say."""

import numpy as np
import pytest

from axffit import axf
from axffit.errors import InputError
from axffit.targets import TARGETS
from axffit.testing import laws
from axffit.testing.checks import NotApplicable, checks_of
from axffit.testing.negatives import negative_colors
from tests.testing.materials import CARBON, METALLIC, constant, mapped, overexposed, plain, written


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


def test_the_place_of_a_broken_law_is_named(tmp_path):
    colors = np.full((4, 4, 3), 0.5)
    colors[1, 2, 1] = 1.5
    found = named(checks_of([written(tmp_path / "x.axf", plain(diffusecolor=mapped(colors)))], texels=1))
    with pytest.raises(AssertionError, match=r"at uv \(0\.625, 0\.375\), largest channel 1 of diffusecolor$"):
        found["plain-passivity"].run()


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


@pytest.mark.slow
def test_the_bundled_carbon_passes_every_check():
    for check in checks_of([str(CARBON)], texels=1, engines=list(TARGETS)):
        try:
            check.run()
        except NotApplicable:
            assert check.name == "isotropy"
