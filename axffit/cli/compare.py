"""``axffit compare``: how well a material's analytic model explains a sampled BRDF, without fitting."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import comparison_parts, show

if TYPE_CHECKING:
    from axffit.brdf import AbstractBRDF
    from axffit.fitting import Comparison
    from axffit.measured import Measurements

HELP = """Say how well a material's own model explains a sampled BRDF.

Nothing is fitted: the model of the .axf file is evaluated in the samples'
directions. Shown are the metrics that fits are judged by, and where the
model fails. A textured material counts with the mean over its texels, as
for an instrument that sees many of them.

\b
Exit codes
  0  done
  2  unusable input

\b
Example
  axffit compare red_paint.axf red_paint.mbsdf --html comparison.html
"""


class Compared(NamedTuple):
    """A comparison, the model, the samples, and those samples as a BRDF that can be evaluated anywhere."""

    comparison: "Comparison"
    model: "AbstractBRDF"
    measurements: "Measurements"
    measured: "AbstractBRDF"
    title: str


def run(
    material_file: Path,
    samples_file: Path,
    *,
    material: str | None = None,
    sample_name: str | None = None,
    progress: ProgressCallback | None = None,
) -> Compared:
    """Compares one material of a file with samples.

    Args:
        material_file: an .axf file.
        samples_file: a file of samples in any format that `axffit.measured.read` knows.
        material: the material's id; needed where the file holds several.
        sample_name: which of the samples; needed where the file holds several.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, material or sample that cannot be used.
    """
    from axffit import axf, fitting, measured
    from axffit.cli._texel_mean import brdf_of

    report = progress or (lambda stage, fraction: None)
    report("reading", 0.0)
    chosen = axf.read(material_file).material(material)
    samples = measured.to_rgb(measured.read(samples_file, sample_name))
    model = brdf_of(chosen)
    report("evaluating the model", 0.0)
    comparison = fitting.compare(model, samples)
    title = f"{chosen.name or chosen.id} against {samples.name or samples_file.name}"
    return Compared(comparison, model, samples, measured.interpolant(samples_file, sample_name), title)


def command(
    material_file: Annotated[Path, typer.Argument(metavar="MATERIAL.axf", help="The material to judge.")],
    samples_file: Annotated[Path, typer.Argument(metavar="SAMPLES", help="The sampled BRDF to judge it by.")],
    *,
    material: _options.Material = None,
    sample_name: _options.SampleName = None,
    json: _options.Json = None,
    html: _options.Html = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json, html], [material_file, samples_file])
    with progress_on_stderr() as progress:
        compared = run(material_file, samples_file, material=material, sample_name=sample_name, progress=progress)
        content = compared.comparison.to_json()
        results: Results = {}
        if json is not None:
            results[json] = json_text(content)
        if html is not None:
            from axffit import report

            progress("drawing the page", 0.0)
            options = {"material": material, "sample-name": sample_name}
            made_by = report.Run(_options.command_line("compare", [material_file, samples_file], options))
            results[html] = report.compare_page([report.ComparedSamples(*compared)], made_by).html
    write_all(results)
    show(*comparison_parts(content, compared.title))
    raise typer.Exit(0)
