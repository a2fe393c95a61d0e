"""JUnit XML: every number with a limit is a case, failures say what and why, hostile names stay text."""

from xml.etree import ElementTree

import pytest

from axffit import report
from axffit.quantization import Tolerance, Tolerances, verify, verify_packed
from axffit.quantization.document import Judged, document
from axffit.targets import unity_2018
from tests.report.examples import HOSTILE, material
from tests.targets.materials import paint, ward


def cases(judged):
    root = ElementTree.fromstring(report.junit_xml(document(judged)).encode())
    assert root.tag == "testsuites"
    for element in (root, *root.findall("testsuite")):
        below = list(element.iter("testcase"))
        counts = {"tests": len(below), "errors": 0}
        counts["failures"] = sum(case.find("failure") is not None for case in below)
        counts["skipped"] = sum(case.find("skipped") is not None for case in below)
        assert {name: int(element.get(name) or -1) for name in counts} == counts
    return [{case.get("name"): case for case in suite} for suite in root.findall("testsuite")]


@pytest.mark.parametrize("make", [ward, paint])
def test_each_number_that_has_a_limit_is_a_case(make):
    verdict = verify(make(size=8), bounds=False)
    (found,) = cases([Judged.of(verdict, "a.axf")])
    judged = {check.name for check in verdict.checks() if check.tolerance and check.tolerance.limit < float("inf")}
    assert set(found) == judged | {"faults", "obligations"}
    assert not [name for name, case in found.items() if len(case) > str(name).startswith("brdf.")]
    assert found["brdf.log_ratio"].findtext("system-out", "").endswith("no bound: left out on request")
    assert {case.get("classname") for case in found.values()} == {f"{verdict.id}.unity_2018"}


def test_a_failure_says_what_limit_and_reason():
    tight = Tolerances({"textures.normal.angle": Tolerance(1e-9, reason="for fun")}, "a test")
    first, second = cases(
        [
            Judged.of(verify(material(), tolerance=tight, bounds=False), "a.axf"),
            Judged.of(verify(material(), bounds=False), "b"),
        ]
    )
    failure = first["textures.normal.angle"].find("failure")
    assert failure is not None
    assert (failure.get("message") or "").endswith(" > 1e-09 degrees in _SVBRDF_NormalMap")
    assert (failure.text or "").endswith("for fun")
    assert not len(second["textures.normal.angle"])


def test_faults_and_obligations_fail_by_name():
    packed = unity_2018.pack(ward(size=8), rounding="floor")
    values = {**packed.values, "_flags": 13}
    packed = type(packed)("unity_2018", packed.id, packed.name, packed.kind, packed.textures, values)
    (found,) = cases([Judged.of(verify_packed(ward(size=8), packed, bounds=False), "a.axf", "out/ward")])
    faults, obligations = (found[name].find("failure") for name in ("faults", "obligations"))
    assert faults is not None
    assert obligations is not None
    assert "floor_rounding: _SVBRDF_NormalMap: " in (faults.text or "")
    assert "flags.bit1" in (obligations.get("message") or "")


def test_a_level_that_is_not_evaluated_is_skipped():
    base = ward(size=8)
    model = type(base)(**{**vars(base), "specular_model": "GGX", "specular_variant": "Ward1992"})
    (found,) = cases([Judged.of(verify(model), "a.axf")])
    skipped = found["brdf"].find("skipped")
    assert skipped is not None
    assert "GGX" in (skipped.get("message") or "")


def test_names_are_text_whatever_they_hold():
    hostile = f"{HOSTILE}\x00\x1b\ud800"
    text = report.junit_xml(document([Judged.of(verify(material(id=hostile), bounds=False), "a.axf")]))
    (suite,) = ElementTree.fromstring(text.encode()).findall("testsuite")
    assert suite.get("name") == f"a.axf: {HOSTILE}\ufffd\ufffd\ufffd"
