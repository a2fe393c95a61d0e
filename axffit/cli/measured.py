"""``axffit measured``: what a file of samples holds, before anything is fitted to it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._tables import show, table

if TYPE_CHECKING:
    from axffit.measured import Measurements

HELP = """Describe a file of measured samples of a BRDF.

Reads NVIDIA .mbsdf, MERL .binary, RGL .bsdf, UTIA, Zemax, ASTM, ALTA, NIST
and multi-angle files, neural encodings and plain CSV, told apart by their
content. Says which angles and wavelengths there are, how many values are
negative, how far reciprocity is violated, how much of the light comes back,
and every conversion that was made on reading.

\b
Exit codes
  0  done
  2  unusable input

\b
Example
  axffit measured red_paint.mbsdf --html samples.html
"""


def run(samples_file: Path, *, material: str | None = None) -> "Measurements":
    """The samples of a file, spectra as they are.

    Raises:
        InputError: the file cannot be read, or the material is not in it.
    """
    from axffit import measured

    return measured.read(samples_file, material)


def command(
    samples_file: Annotated[Path, typer.Argument(metavar="FILE", help="The file of samples.")],
    *,
    material: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which of the samples; needed where the file holds several.")
    ] = None,
    json: _options.Json = None,
    html: _options.Html = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    from axffit.measured.description import describe

    check_outputs([json, html], [samples_file])
    samples = run(samples_file, material=material)
    content = describe(samples)
    results: Results = {}
    if json is not None:
        results[json] = json_text(content)
    if html is not None:
        from axffit.report.page import Run, measured_page

        made_by = Run(_options.command_line("measured", [samples_file], {"material": material}))
        results[html] = measured_page(samples, made_by).html
    write_all(results)
    show(*parts(content))
    raise typer.Exit(0)


def parts(content: dict[str, Any]) -> list[object]:
    """The description for a terminal."""
    from axffit.report.measured_view import facts, sentence
    from axffit.report.numbers import number, significant

    shown: list[object] = [f"{content['provenance']['file']}: {content['provenance']['format']}"]
    shown += [f"{topic}: {text}" for topic, text in facts(content)]
    if content["furnace"]:
        rows = [
            (
                " to ".join(dict.fromkeys(number(x) for x in row["incidence_degrees"])),
                str(row["samples"]),
                significant(sum(row["albedo"]) / len(row["albedo"])),
            )
            for row in content["furnace"]
        ]
        shown.append(table(("incidence (degrees)", "samples", "albedo, mean of channels"), rows))
    shown += [f"{topic}: {text}" for topic, text in content["provenance"].items() if topic not in ("file", "format")]
    return [*shown, sentence(content)]
