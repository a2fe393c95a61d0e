"""Pages: content as JSON first, then one HTML file that holds everything it shows."""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup

from axffit import __version__
from axffit.measured import Measurements
from axffit.preview.picture import LINEAR_LIMIT
from axffit.report.measured_view import DescribedSamples, measured_view
from axffit.report.numbers import number, significant
from axffit.report.pictures import color_scale_css
from axffit.report.sampled_view import compare_view, fit_view
from axffit.report.sections import SPHERE_SIZE, ComparedSamples, FittedSamples, Section, VerifiedMaterial
from axffit.report.summary import engines, summarize
from axffit.report.verify_view import verify_view

SCHEMA_VERSION = 1

Progress = Callable[[str, float], None]
"""Called with what is being done and how much of it is (0 to 1)."""

VIEWS = {"verify": verify_view, "fit": fit_view, "compare": compare_view, "measured": measured_view}


@dataclass(frozen=True)
class Run:
    """How the numbers of a page came about.

    Attributes:
        command: the command line that computes them again.
        seed: of everything random, or None where nothing is.
        date: as text, or None (the same input then gives the same bytes).
        seconds: how long it took, or None.
    """

    command: str
    seed: int | None = None
    date: str | None = None
    seconds: float | None = None


@dataclass(frozen=True)
class Page:
    """A report.

    Attributes:
        content: everything it says, JSON-ready; validates against `schema`.
        html: one file that needs no other.
    """

    content: Mapping[str, Any]
    html: str


def verify_page(
    items: Sequence[VerifiedMaterial], run: Run, *, title: str | None = None, progress: Progress | None = None
) -> Page:
    """The page of one or more verdicts."""
    return verdict_page(_drawn(items, SPHERE_SIZE, progress), run, title=title)


def verdict_page(sections: Sequence[Section], run: Run, *, title: str | None = None) -> Page:
    """The same of sections drawn one after the other, so that not all materials are held at once."""
    return _page(sections, run, title or _verification([section.content for section in sections]))


def fit_page(
    items: Sequence[FittedSamples], run: Run, *, title: str | None = None, progress: Progress | None = None
) -> Page:
    """The page of one or more fits."""
    return demo_page(fitted=items, run=run, title=title or f"Fit of {_names(items, 'sampled BRDF')}", progress=progress)


def compare_page(
    items: Sequence[ComparedSamples], run: Run, *, title: str | None = None, progress: Progress | None = None
) -> Page:
    """The page of one or more comparisons."""
    return demo_page(compared=items, run=run, title=title or _comparison(items), progress=progress)


def measured_page(samples: Measurements, run: Run) -> Page:
    """The page of a description of samples."""
    return _page([DescribedSamples(samples).section()], run, f"Samples of {samples.name or 'a BRDF'}")


def demo_page(
    *,
    verified: Sequence[VerifiedMaterial] = (),
    fitted: Sequence[FittedSamples] = (),
    compared: Sequence[ComparedSamples] = (),
    run: Run,
    title: str = "What axffit says of a material",
    sphere_size: int = SPHERE_SIZE,
    progress: Progress | None = None,
) -> Page:
    """A page of anything: verdicts, fits and comparisons, in this order.

    Args:
        verified: verdicts and their materials.
        fitted: fits and their samples.
        compared: comparisons and their samples.
        run: how the numbers came about.
        title: of the page.
        sphere_size: pixels along each side of the spheres.
        progress: called with what is being done and how much of it is (0 to 1).
    """
    return _page(_drawn((*verified, *fitted, *compared), sphere_size, progress), run, title)


def _drawn(items: Sequence[Any], sphere_size: int, progress: Progress | None) -> list[Section]:
    sections = []
    for done, item in enumerate(items):
        if progress is not None:
            progress("drawing the page", done / len(items))
        sections.append(item.section(sphere_size=sphere_size))
    return sections


def _verification(contents: Sequence[Mapping[str, Any]]) -> str:
    """What was verified; where one engine packs and another reads, which."""
    name = contents[0]["title"] if len(contents) == 1 else f"{len(contents)} materials"
    ways = {engines(content["result"]) for content in contents}
    foreign = any(content["result"]["target"] != content["result"]["packed_for"] for content in contents)
    return f"{name}, {ways.pop()}" if foreign and len(ways) == 1 else f"Verification of {name}"


def _comparison(items: Sequence[ComparedSamples]) -> str:
    return items[0].title if len(items) == 1 and items[0].title else f"Comparison with {_names(items, 'sampled BRDF')}"


def _names(items: Sequence[Any], many: str) -> str:
    if len(items) != 1:
        return f"{len(items)} {many}s"
    return items[0].measurements.name or f"a {many}"


def _page(sections: Sequence[Section], run: Run, title: str) -> Page:
    contents = [dict(section.content) for section in sections]
    taken: set[str] = set()
    for content in contents:
        content["id"] = _identifier(f"{content['kind']}-{content['title']}", taken)
    summary, within = summarize(contents)
    content = {
        "schema": "axffit.page",
        "schema_version": SCHEMA_VERSION,
        "axffit_version": __version__,
        "title": title,
        "summary": summary,
        "within": within,
        "run": asdict(run),
        "sections": contents,
    }
    # What is shown is what the JSON says: floats, lists and names have been through JSON once.
    content = json.loads(json.dumps(content, allow_nan=False))
    return Page(content, render(content, [section.pictures for section in sections]))


def _identifier(text: str, taken: set[str]) -> str:
    """An HTML id that no other section has."""
    base = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"
    chosen, counter = base, 2
    while chosen in taken:
        chosen, counter = f"{base}-{counter}", counter + 1
    taken.add(chosen)
    return chosen


def render(content: Mapping[str, Any], pictures: Sequence[Mapping[str, str]]) -> str:
    """The HTML of a page's content; ``pictures`` are those of its sections, in order."""
    environment = _environment()
    sections = [
        {
            "id": section["id"],
            "kind": section["kind"],
            "title": section["title"],
            "view": VIEWS[section["kind"]](section),
            "pictures": {name: _trusted(name, value) for name, value in shown.items()},
        }
        for section, shown in zip(content["sections"], pictures, strict=True)
    ]
    css = resources.files("axffit.report").joinpath("templates/page.css").read_text(encoding="utf-8")
    return environment.get_template("page.html").render(
        page=content,
        sections=sections,
        css=Markup(css.replace("SCALE", color_scale_css())),
        macros=environment.get_template("macros.html").module,
        linear_limit=number(LINEAR_LIMIT),
    )


def _trusted(name: str, value: str) -> str:
    """Plots are SVG elements made here, their texts escaped; everything else stays text for the template to escape."""
    return Markup(value) if name.startswith("plot") else value


def schema() -> dict[str, Any]:
    """The JSON schema of `Page.content`, those of its sections' results included."""
    from axffit.fitting.compare import schema as comparison
    from axffit.fitting.result import schema as fit
    from axffit.measured.description import schema as description
    from axffit.quantization.verdict import schema as verdict

    text = resources.files("axffit.report").joinpath("schemas/page.schema.json").read_text(encoding="utf-8")
    page = json.loads(text)
    parts = {"verdict": verdict(), "fit": fit(), "comparison": comparison(), "measured": description()}
    page["$defs"] |= {f"result_{name}": part | {"$id": f"urn:axffit:{name}"} for name, part in parts.items()}
    return page


@lru_cache(maxsize=1)
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("axffit.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["significant"] = significant
    environment.filters["number"] = number
    return environment
