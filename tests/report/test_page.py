"""Pages: valid JSON, one file, nothing from outside, nothing unescaped, nothing left out."""

import json
import re
from html.parser import HTMLParser

import jsonschema
import pytest

from axffit import report
from axffit.report.plots import SERIES
from tests.report.examples import HOSTILE, RUN, material


class Elements(HTMLParser):
    """Every start tag with its attributes, and the text of the document."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.open.append(tag)

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data):
        if not {"style", "script"} & set(self.open):
            self.text += data


@pytest.fixture(scope="module")
def elements(page) -> Elements:
    return Elements(page.html)


def test_content_validates_and_is_what_json_gives_back(page):
    validator = jsonschema.Draft202012Validator(report.schema())
    validator.check_schema(report.schema())
    errors = [error.message[:200] for error in validator.iter_errors(page.content)]
    assert errors == []
    assert json.loads(json.dumps(page.content, allow_nan=False)) == page.content


def test_schema_refuses_a_page_that_lacks_a_section_part(page):
    broken = json.loads(json.dumps(page.content))
    del broken["sections"][1]["failure_map"]
    assert not jsonschema.Draft202012Validator(report.schema()).is_valid(broken)


def test_nothing_comes_from_outside(page, elements):
    for tag, attributes in elements.tags:
        assert tag not in ("script", "iframe", "object", "embed", "base", "form")
        for name, value in attributes.items():
            if name in ("src", "href", "xlink:href", "data", "action", "srcset", "poster"):
                assert value is not None
                assert value.startswith(("data:", "#")), (tag, name, value[:60])
    for target in re.findall(r"url\(([^)]*)\)", page.html):
        assert target.strip("'\"").startswith(("#", "data:"))
    assert "@import" not in page.html


def test_fragments_point_to_something(elements):
    identifiers = {attributes["id"] for _, attributes in elements.tags if "id" in attributes}
    for _, attributes in elements.tags:
        for name in ("href", "xlink:href"):
            value = attributes.get(name) or ""
            if value.startswith("#"):
                assert value[1:] in identifiers


def test_hostile_names_are_text(page, elements):
    assert not any(tag == "script" for tag, _ in elements.tags)
    assert HOSTILE in elements.text
    assert "<script>" not in page.html
    assert "made <here>" in elements.text
    assert RUN.command in elements.text


def test_every_texture_has_its_row(page, elements):
    verdict = page.content["sections"][0]["result"]
    for row in verdict["textures"]:
        assert row["name"] in elements.text
        assert row["format"] in elements.text
    pictures = [a["alt"] or "" for tag, a in elements.tags if tag == "img"]
    shown = [alt for alt in pictures if alt.startswith("Error map")]
    with_errors = [row for row in verdict["textures"] if row["max"] > 0]
    assert len(shown) == len(with_errors) >= 3
    assert "1 texel clamped" in elements.text


def test_every_parameter_has_its_row_and_status(page, elements):
    result = page.content["sections"][1]["result"]
    assert "roughness α" in elements.text
    for parameter in result["parameters"]:
        assert parameter["status"] in elements.text
    for label in ("Relative cosine RMS", "Log", "Cube root", "Peak"):
        assert label in elements.text


def test_plots_hold_the_curves(page):
    """The log plot of the fit has a line and dots for each angle of incidence."""
    curves = page.content["sections"][1]["incidence_plane"]
    assert len(curves) == 5
    svgs = re.findall(r'<svg class="plot".*?</svg>', page.html, flags=re.DOTALL)
    assert len(svgs) == 6
    logarithmic = next(svg for svg in svgs if "logarithmic" in svg)
    for color in SERIES:
        assert logarithmic.count(color) >= 2
    # Dots of 5 curves: every 5 degrees and every degree around the mirror direction.
    assert logarithmic.count("<use ") > 5 * 30


def test_summary_states_the_verdict(page, elements):
    assert page.content["within"] is True
    assert "One material verified for unity_2018" in elements.text
    assert page.content["summary"] in elements.text


def test_same_input_same_bytes(page, verified, fitted, compared):
    again = report.demo_page(verified=[verified], fitted=[fitted], compared=[compared], run=RUN, sphere_size=24)
    assert again.html == page.html
    assert again.content == page.content


def test_sections_of_one_name_have_ids_of_their_own(verified):
    without_spheres = report.VerifiedMaterial(verified.verdict)
    page = report.verify_page([without_spheres, without_spheres], RUN)
    first, second = (section["id"] for section in page.content["sections"])
    assert first != second
    assert f'id="{first}"' in page.html
    assert f'id="{second}"' in page.html


def test_outside_tolerance_is_said_first_and_in_full():
    from axffit.quantization import Tolerance, Tolerances, verify

    tight = Tolerances({"textures.normal.angle": Tolerance(1e-9)}, "a test")
    page = report.verify_page([report.VerifiedMaterial(verify(material(), tolerance=tight, bounds=False))], RUN)
    text = Elements(page.html).text
    assert page.content["within"] is False
    assert "outside tolerance: Steel (1)" in page.content["summary"]
    assert "textures.normal.angle" in text
    assert text.index("outside tolerance") < text.index("Textures")


def test_a_fit_without_a_model_says_why(fitted):
    from dataclasses import replace

    from axffit.fitting import Outcome

    nothing = replace(fitted.result, model=None, metrics=None, parameters=(), limits=(), outcome=Outcome.ALL_BLACK)
    page = report.fit_page([report.FittedSamples(nothing, fitted.measurements, fitted.measured)], RUN)
    text = Elements(page.html).text
    assert "not converged" in text
    assert "a black material has no parameters to find" in text
    assert jsonschema.Draft202012Validator(report.schema()).is_valid(page.content)
