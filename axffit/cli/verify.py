"""``axffit verify``: what a target's textures lose of a material, and whether that is within tolerance."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import show, verdict_parts

if TYPE_CHECKING:
    from axffit.axf import AxfMaterial
    from axffit.quantization import Verdict

HELP = """Check what an engine's textures lose of an AxF material.

Packs every texture as the engine's importer does, unpacks it again, and
measures the error of every map in the quantity that matters (an angle for
a normal, a relative error for a color) and the error of the reflectance.

\b
Exit codes
  0  every error is within its tolerance
  1  at least one is outside
  2  unusable input

\b
Examples
  axffit verify steel.axf --html report.html --json verdict.json
  axffit verify steel.axf --packed-for unity_2018 --read-by hdrp_10
"""


class Verified(NamedTuple):
    """A verdict and the material it is about."""

    verdict: "Verdict"
    material: "AxfMaterial"


def run(
    material_file: Path,
    *,
    target: str = "unity_2018",
    packed_for: str | None = None,
    read_by: str | None = None,
    tolerance: Path | None = None,
    material: str | None = None,
    progress: ProgressCallback | None = None,
) -> Verified:
    """Verifies one material of a file.

    Args:
        material_file: an .axf file.
        target: the importer whose formats and re-rangings the textures go through.
        packed_for: the importer, where it is another engine's than the shader; None takes ``target``.
        read_by: the engine whose shader reads the textures; None takes ``target``.
        tolerance: a TOML file of tolerances; None takes those of the package.
        material: the material's id; needed where the file holds several.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, target, tolerance or material that cannot be used.
    """
    from axffit import axf, quantization

    chosen = axf.read(material_file).material(material)
    verdict = quantization.verify(chosen, target, tolerance, packed_for=packed_for, read_by=read_by, progress=progress)
    return Verified(verdict, chosen)


def command(
    material_file: Annotated[Path, typer.Argument(metavar="MATERIAL.axf", help="The material to verify.")],
    *,
    target: Annotated[str, typer.Option(metavar="NAME", help="Importer to verify for.")] = "unity_2018",
    packed_for: Annotated[
        str | None, typer.Option(metavar="NAME", help="Importer that packs, if not that of --target.")
    ] = None,
    read_by: Annotated[
        str | None, typer.Option(metavar="NAME", help="Engine whose shader reads, if not that of --target.")
    ] = None,
    tolerance: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Tolerances; without it those of axffit.")
    ] = None,
    material: _options.Material = None,
    json: _options.Json = None,
    html: _options.Html = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json, html], [material_file])
    with progress_on_stderr() as progress:
        engines = {"packed_for": packed_for, "read_by": read_by}
        chosen = {"target": target, "tolerance": tolerance, "material": material}
        verified = run(material_file, **engines, **chosen, progress=progress)
        content = verified.verdict.to_json()
        results: Results = {}
        if json is not None:
            results[json] = json_text(content)
        if html is not None:
            from axffit import report

            progress("drawing the page", 0.0)
            options = {**{name.replace("_", "-"): name_of for name, name_of in engines.items()}, **chosen}
            made_by = report.Run(_options.command_line("verify", [material_file], options))
            results[html] = report.verify_page([report.VerifiedMaterial(*verified)], made_by).html
    write_all(results)
    show(*verdict_parts(content))
    raise typer.Exit(0 if verified.verdict.within else 1)
