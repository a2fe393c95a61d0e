"""Verdicts as JUnit XML, which CI systems show: one suite a material, one case for each number that has a limit."""

import re
from collections.abc import Iterator, Mapping
from typing import Any
from xml.etree import ElementTree

Content = Mapping[str, Any]

# XML 1.0 has no way to write these, not even escaped.
_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit_xml(document: Content) -> str:
    """The XML of a document of verdicts (`axffit.quantization.document`).

    A suite is named after its file and material. Its cases are, in this order: ``faults`` and ``obligations`` (each one
    case, so that it stays the same one from run to run), then each texture's checks, the slice table's, and the
    reflectance's, by the names tolerance files use. What was found and proved of the reflectance, or why nothing is
    proved, is each case's output. A level that was not evaluated is skipped with its reason.
    """
    root = ElementTree.Element("testsuites", name="axffit verify")
    for entry in document["materials"]:
        _add_suite(root, entry)
    _count(root, list(root.iter("testcase")))
    ElementTree.indent(root, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _add_suite(root: ElementTree.Element, entry: Content) -> None:
    verdict = entry["verdict"]
    id = verdict["material"]["id"]
    suite = ElementTree.SubElement(root, "testsuite", name=_text(f"{entry['file']}: {id}"))
    classname = _text(f"{id}.{verdict['target']}")
    proofs = _proofs(verdict["brdf"])
    for name, failures in _messages(verdict):
        case = ElementTree.SubElement(suite, "testcase", classname=classname, name=_text(name))
        if name in proofs:
            ElementTree.SubElement(case, "system-out").text = _text(proofs[name])
        if failures:
            failure = ElementTree.SubElement(case, "failure", message=_text(failures[0]))
            failure.text = _text("\n".join(failures))
    if not verdict["brdf"]["evaluated"]:
        case = ElementTree.SubElement(suite, "testcase", classname=classname, name="brdf")
        ElementTree.SubElement(case, "skipped", message=_text(verdict["brdf"]["reason"]))
    _count(suite, list(suite))


def _count(element: ElementTree.Element, cases: list[ElementTree.Element]) -> None:
    element.set("tests", str(len(cases)))
    for name, attribute in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
        element.set(attribute, str(sum(case.find(name) is not None for case in cases)))


def _messages(verdict: Content) -> Iterator[tuple[str, list[str]]]:
    """Name of each case and why it fails, nothing where it passes."""
    yield "faults", [f"{fault['fault']}: {fault['subject']}: {fault['message']}" for fault in verdict["faults"]]
    yield "obligations", [f"{flag['obligation']}: {flag['subject']}: {flag['message']}" for flag in verdict["flags"]]
    for row in verdict["textures"]:
        for measure in row["measures"]:
            if measure["tolerance"] is not None:
                found = measure[measure["statistic"]]
                yield measure["check"], _failure(measure, found, f"{measure['unit']} in {row['name']}")
    for check in (verdict["lut"] or {"checks": []})["checks"]:
        if check["tolerance"] is not None:
            yield check["check"], _failure(check, check["found"], "entries")
    for row in verdict["brdf"]["rows"]:
        if row["tolerance"] is not None:
            yield row["check"], _failure(row, row[row["judged"]], f"{row['title']} ({row['judged']})")


def _proofs(brdf: Content) -> dict[str, str]:
    """What was found and what is proved, or why nothing is, by the names of the checks."""
    proofs = {}
    for row in brdf["rows"]:
        found, bound = ("infinite" if row[end] is None else f"{row[end]:.4g}" for end in ("found", "bound"))
        only = f"found {found}, no bound: {row['unproved']}"
        proofs[row["check"]] = only if row["judged"] == "found" else f"[found, bound] = [{found}, {bound}]"
    return proofs


def _failure(check: Content, found: float | None, what: str) -> list[str]:
    if check["within"]:
        return []
    shown = "infinite" if found is None else f"{found:.4g}"
    return [f"{shown} > {check['tolerance']:.4g} {what.strip()}", *filter(None, [check["reason"]])]


def _text(value: str) -> str:
    return _FORBIDDEN.sub("\ufffd", value)
