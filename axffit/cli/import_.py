"""``axffit import``: an .axf file from folders that ``axffit export`` wrote."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from axffit.cli._output import check_outputs
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import show

if TYPE_CHECKING:
    from axffit.axf import AxfFile

HELP = """Write an .axf file from folders that axffit export wrote.

Decodes every texture as the engine's shader does and turns it back into
AxF's own ranges: exact where the texture's format is, else within the error
that material.json states. What the engine has no place for stays lost.

\b
Exit codes
  0  the file is written; its path is the last line
  2  unusable input: a damaged or missing file, or names the target has not

\b
Example
  axffit import paint_unity --out paint.axf
"""


def run(folder: Path, path: Path, *, progress: ProgressCallback | None = None) -> "AxfFile":
    """Reads exported folders and writes them as one .axf file; see `axffit.targets.folder.read`.

    Args:
        folder: what was given to ``axffit export`` as --out, or one material's folder in it.
        path: the .axf file; an existing one is replaced.
        progress: called with what is being done and how much of it is (0 to 1).

    Returns:
        What was written.

    Raises:
        InputError: for folders that cannot be used, or a file that cannot be written.
    """
    from axffit import axf
    from axffit.targets import folder as folders

    file = folders.read(folder, progress=progress)
    if progress is not None:
        progress(f"writing {path.name}", 0.0)
    axf.write(path, file)
    return file


def command(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="What axffit export wrote.")],
    *,
    out: Annotated[Path, typer.Option(metavar="FILE.axf", help="The file to write.")],
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([out])
    with progress_on_stderr() as progress:
        file = run(folder, out, progress=progress)
    for material in file.materials:
        named = f"{material.name} ({material.id})" if material.name else material.id
        show(f"{named}: {material.kind.value}, {', '.join(material.textures) or 'no textures'}")
    show(str(out))
