"""``axffit export``: the textures and values of an engine, as files that it can load."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import show, table
from axffit.errors import InputError

if TYPE_CHECKING:
    from axffit.targets.folder import Exported

HELP = """Write an AxF material as an engine's textures and values.

Makes a folder for each material: image files that hold exactly the codes
the engine's textures hold, and material.json with every name and value and,
for each texture, where it came from, its format, what was clamped, and its
error. The folder of an earlier export is replaced as a whole, and only when
everything new is on the disk.

\b
Image files: OpenEXR (half, float), PNG (8 and 16 bits), DDS, KTX2 (anything,
arrays and mip levels). auto takes EXR for floats, PNG for other formats, and
DDS for arrays and mip levels (PNG files or KTX2 where DDS has no code).

\b
Exit codes
  0  everything is written; the folders are the last lines
  2  unusable input, or a folder that cannot be written

\b
Example
  axffit export paint.axf --target unity_2018 --out paint_unity
"""


def run(
    material_file: Path,
    folder: Path,
    *,
    target: str = "unity_2018",
    material: str | None = None,
    format: str = "auto",
    texture_formats: dict[str, str] | None = None,
    rounding: str | None = None,
    progress: ProgressCallback | None = None,
) -> "tuple[Exported, ...]":
    """Exports the materials of a file; see `axffit.targets.folder.write`.

    Args:
        material_file: an .axf file.
        folder: where the materials' sub-folders go.
        target: the engine.
        material: id of the only material to export; None exports all.
        format: kind of image files.
        texture_formats: AxF's or the target's texture name to a number format.
        rounding: rounding mode of every encoder; None takes the target's own.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, name or folder that cannot be used.
        OSError: the disk.
    """
    from axffit import axf
    from axffit.targets import folder as folders

    return folders.write(
        axf.read(material_file),
        folder,
        target=target,
        material=material,
        container=format,
        formats=texture_formats,
        rounding=rounding,
        progress=progress,
    )


def command(
    material_file: Annotated[Path, typer.Argument(metavar="MATERIAL.axf", help="The materials to export.")],
    *,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Where the folders of the materials go.")],
    target: Annotated[str, typer.Option(metavar="NAME", help="Engine to export for.")] = "unity_2018",
    material: Annotated[str | None, typer.Option(metavar="ID", help="Only this material; without it all.")] = None,
    format: Annotated[str, typer.Option(metavar="KIND", help="Image files: exr, png, dds, ktx2, or auto.")] = "auto",
    texture_format: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=FORMAT", help="Number format of one texture, as normal=RGBA32F; repeatable."),
    ] = None,
    rounding: Annotated[
        str | None,
        typer.Option(metavar="MODE", help="nearest_even, toward_zero, floor or device; without it the target's own."),
    ] = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    formats = _pairs(texture_format or [])
    with progress_on_stderr() as progress:
        exported = run(
            material_file,
            out,
            target=target,
            material=material,
            format=format,
            texture_formats=formats,
            rounding=rounding,
            progress=progress,
        )
    for item in exported:
        show(*_parts(item), "")
    show(*(str(item.folder) for item in exported))


def _pairs(given: list[str]) -> dict[str, str]:
    pairs = {}
    for text in given:
        name, equals, format = text.partition("=")
        if not (name and equals and format):
            raise InputError(f"--texture-format {text!r}: give NAME=FORMAT, for instance normal=RGBA32F")
        if name in pairs:
            raise InputError(f"--texture-format names {name!r} twice; give each texture one format")
        pairs[name] = format
    return pairs


def _parts(exported: "Exported") -> list[object]:
    """A material: one row a texture, then what a person should know."""
    content = exported.content
    rows = [_row(entry) for entry in content["textures"]]
    columns = ("texture", "format", "files", "unit", "mean error", "max error", "clamped")
    parts: list[object] = [
        f"{content['material']['name'] or content['material']['id']}, for {content['target']}",
        table(columns, rows, text_columns=4),
    ]
    parts += [f"note: {note}" for note in content["notes"]]
    return parts + [f"PROBLEM: {problem}" for problem in exported.problems]


def _row(entry: dict[str, Any]) -> tuple[str, ...]:
    from axffit.report.numbers import significant

    files = [file["file"] for file in entry["files"]]
    error = entry["error"]
    figures = ("", "", "") if error is None else (error["unit"], significant(error["mean"]), significant(error["max"]))
    return (
        entry["name"] + (" (default)" if entry["defaulted"] else ""),
        entry["format"],
        files[0] if len(files) == 1 else f"{files[0]} and {len(files) - 1} more",
        *figures,
        str(entry["counts"]["clamped"]),
    )
