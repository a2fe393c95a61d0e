"""``axffit verify``: what a target's textures lose of materials, and whether that is within tolerance."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from axffit.cli import _options
from axffit.cli._lightings import lightings
from axffit.cli._materials import Wanted, axf_files, wanted_materials
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._suggest import check_target_alone, suggested, suggestion_parts
from axffit.cli._tables import judged_parts, show
from axffit.errors import InputError

if TYPE_CHECKING:
    from axffit.axf import AxfMaterial
    from axffit.quantization import Tolerances, Verdict

TARGET = "unity_2018"
LARGE_BYTES = 2**26
"""Files together from which on reading takes long enough to be named."""


HELP = """Check what an engine's textures lose of AxF materials.

Packs every texture as the engine's importer does, unpacks it again, and
measures the error of every map in the quantity that matters (an angle for
a normal, a relative error for a color) and the error of the reflectance.
With --packed it judges what another program packed (a folder as axffit
export writes it) and names what that did wrong, where it can.

Judged is every material of every file, and of every .axf file below a
folder. A file that cannot be read ends the run before any work.

\b
Exit codes
  0  every error of every material is within its tolerance
  1  at least one is outside
  2  unusable input: nothing is written

\b
Examples
  axffit verify steel.axf --html report.html --json verdicts.json
  axffit verify paint.axf fabrics --junit verdicts.xml
  axffit verify steel.axf --packed exported --tolerance studio.toml
  axffit verify steel.axf --packed-for unity_2018 --read-by hdrp_10
  axffit verify steel.axf --suggest
"""


class Verified(NamedTuple):
    """A verdict and the material it is about.

    Attributes:
        verdict: the verdict.
        material: the original.
        file: the file it is from.
        packed: the folder of textures another program packed, or None.
    """

    verdict: "Verdict"
    material: "AxfMaterial"
    file: Path
    packed: Path | None = None


def run(
    files: Sequence[Path],
    *,
    target: str | None = None,
    packed_for: str | None = None,
    read_by: str | None = None,
    packed: Path | None = None,
    tolerance: Path | None = None,
    material: str | None = None,
    bounds: bool = True,
    progress: ProgressCallback | None = None,
) -> Iterator[Verified]:
    """Verifies materials one after the other; everything that is named is checked before the first.

    Args:
        files: .axf files, and folders with some below them.
        target: the importer whose formats and re-rangings the textures go through; None takes `TARGET`.
        packed_for: the importer, where it is another engine's than the shader; None takes ``target``.
        read_by: the engine whose shader reads the textures; None takes ``target``, or what ``packed`` is packed for.
        packed: a folder of textures that another program packed, as `axffit export` lays them out.
        tolerance: a TOML file of tolerances; None takes those of the package.
        material: id of the only material of each file; None takes all.
        bounds: whether the errors of the reflectance are bounded; without, what was found is judged.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, folder, target, tolerance or material that cannot be used.
    """
    from axffit import axf, quantization
    from axffit.targets import target_named

    for name in (target, packed_for, read_by):
        if name is not None:
            target_named(name)
    if packed is not None and (target is not None or packed_for is not None):
        raise InputError(
            "--packed: its material.json says what it is packed for, so --target and --packed-for have no place; "
            "give --read-by to have another engine read it"
        )
    limits = quantization.default_tolerances() if tolerance is None else quantization.read_tolerances(tolerance)
    # The last file is kept, so that a single one is read once.
    read = lru_cache(maxsize=1)(axf.read)
    wanted = wanted_materials(axf_files(files), read, material, packed)
    reflectance: dict[str, Any] = {"bounds": bounds, "lightings": lightings()}
    say = progress or (lambda stage, fraction: None)

    def judged(each: Wanted) -> Verified:
        original = read(each.file).materials[each.index]
        prefix = "" if len(wanted) == 1 else f"{each.id}: "

        def stages(stage: str, fraction: float) -> None:
            say(f"{prefix}{stage}", fraction)

        try:
            if each.packed is not None:
                verdict = _of_packed(original, each.packed, limits, read_by, stages, **reflectance)
            else:
                verdict = quantization.verify(
                    original,
                    target or TARGET,
                    limits,
                    packed_for=packed_for,
                    read_by=read_by,
                    progress=stages,
                    **reflectance,
                )
        except InputError as error:
            raise InputError(f"{each.file}: {error}") from error
        return Verified(verdict, original, each.file, each.packed)

    return map(judged, wanted)


def _of_packed(
    original: "AxfMaterial",
    folder: Path,
    limits: "Tolerances",
    read_by: str | None,
    progress: ProgressCallback,
    **options: Any,
) -> "Verdict":
    from axffit.quantization import verify_packed
    from axffit.targets.folder import read_packed
    from axffit.targets.folder_json import FILE

    packed = read_packed(folder)
    try:
        return verify_packed(original, packed, limits, read_by=read_by, progress=progress, **options)
    except (TypeError, KeyError, IndexError, ValueError, OverflowError, ArithmeticError) as error:
        # Values of types and numbers no packing makes; `InputError` is a `ValueError` and says which.
        raise InputError(f"{folder / FILE}: cannot be read as {packed.target} ({error})") from error


def command(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="MATERIAL.axf|FOLDER...", help="What to verify: every material of each file."),
    ],
    *,
    target: Annotated[
        str | None, typer.Option(metavar="NAME", help=f"Importer to verify for; without it {TARGET}.")
    ] = None,
    packed_for: Annotated[
        str | None, typer.Option(metavar="NAME", help="Importer that packs, if not that of --target.")
    ] = None,
    read_by: Annotated[
        str | None, typer.Option(metavar="NAME", help="Engine whose shader reads, if not that of --target or --packed.")
    ] = None,
    packed: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Judge the textures and material.json of this folder.")
    ] = None,
    tolerance: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Tolerances; without it those of axffit.")
    ] = None,
    material: Annotated[
        str | None, typer.Option(metavar="ID", help="Only this material of each file; without it all.")
    ] = None,
    no_bounds: Annotated[
        bool, typer.Option("--no-bounds", help="Judge the reflectance by what is found, and prove nothing: faster.")
    ] = False,
    json: _options.Json = None,
    junit: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the checks as JUnit XML to this file.")
    ] = None,
    html: _options.Html = None,
    suggest: Annotated[
        bool, typer.Option("--suggest", help="Show each texture's cheapest format that keeps the tolerance.")
    ] = False,
    pictures: Annotated[
        bool,
        typer.Option("--pictures/--no-pictures", help="Whether the page shows spheres and a body: they take time."),
    ] = True,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json, junit, html], axf_files(files))
    if suggest:
        check_target_alone(packed, packed_for, read_by)
    options = {"target": target, "packed_for": packed_for, "read_by": read_by, "packed": packed}
    options |= {"tolerance": tolerance, "material": material}
    with progress_on_stderr() as progress:
        if sum(path.stat().st_size for path in axf_files(files) if path.is_file()) >= LARGE_BYTES:
            progress("reading files", 0.0)
        verified = run(files, **options, bounds=not no_bounds, progress=progress)
        from axffit import report
        from axffit.quantization.document import Judged, document

        judged, sections = [], []
        for item in verified:
            suggestion = None
            if suggest:
                suggestion = suggested(item.material, item.verdict, tolerance, progress, bounds=not no_bounds)
            judged.append(Judged.of(item.verdict, item.file, item.packed, suggestion))
            if html is not None:
                progress("drawing the page", 0.0)
                shown = item.material if pictures else None
                sections.append(report.VerifiedMaterial(item.verdict, shown).section())
        content = document(judged)
        results: Results = {}
        if json is not None:
            results[json] = json_text(content)
        if junit is not None:
            results[junit] = report.junit_xml(content)
        if html is not None:
            named = {name.replace("_", "-"): value for name, value in options.items()}
            made_by = report.Run(
                _options.command_line("verify", files, named)
                + " --no-bounds" * no_bounds
                + " --suggest" * suggest
                + " --no-pictures" * (not pictures)
            )
            results[html] = report.verdict_page(sections, made_by).html
    write_all(results)
    show(*suggestion_parts(content), *judged_parts(content))
    raise typer.Exit(0 if content["within"] else 1)
