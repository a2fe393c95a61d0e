"""``axffit demo``: generate, verify, fit, and one page that shows all of it."""

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

import axffit
from axffit.cli import fit, verify
from axffit.cli._output import json_text, make_folder, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import fit_parts, show

if TYPE_CHECKING:
    from axffit.report import FittedSamples, Page, VerifiedMaterial

HELP = """Show what axffit is for, on materials that it makes itself.

Generates two synthetic materials and a noisy sampled car paint, verifies
the materials for Unity 2018, fits the paint, and writes one page and its
JSON. Where reference data lie in the folder AXFFIT_REFERENCE_DATA (or in
../shared/data beside a clone), three real car paints are fitted as well.

\b
Exit codes
  0  the page is written; its path is the last line
  2  unusable input, or a folder that cannot be written

\b
Example
  axffit demo --out demo
"""

PAGE = "index.html"
MATERIALS = ("brushed_carbon", "metallic_paint")


class Samples(NamedTuple):
    """Samples to fit: where they are, which of the file, the model, and the largest polar angle (degrees)."""

    file: Path
    material: str | None
    model: str
    polar_limit: float = fit.POLAR_LIMIT_DEGREES


PAINT = Samples(Path("noisy_car_paint") / "noisy_car_paint.mbsdf", None, "carpaint+coat")
# Further out these tables' peaks leave the mirror direction: a limit of the instrument's range.
_RELIABLE_DEGREES = 64.9
REFERENCES = (
    # The table is the base under a coat that does not refract and is not part of it (the publisher's own account).
    Samples(Path("mbsdf_carpaint_nvidia") / "carpaint_red.mbsdf", None, "carpaint", _RELIABLE_DEGREES),
    Samples(Path("mbsdf_carpaint_nvidia") / "carpaint_blue.mbsdf", None, "carpaint", _RELIABLE_DEGREES),
    Samples(Path("nbrdf_measured") / "rgl_isotropic_nbrdf_weights.npz", "cc_ibiza_sunset_rgb", "carpaint+coat"),
)
"""Real car paints, below the folder of reference data."""


class Shown(NamedTuple):
    """What a demonstration computed."""

    verified: "list[VerifiedMaterial]"
    fitted: "list[FittedSamples]"
    page: "Page"


def clone() -> Path | None:
    """The folder of the clone that axffit runs from, or None for an installed package."""
    folder = Path(axffit.__file__).parents[1]
    return folder if (folder / "data_synthetic" / "generate.py").is_file() else None


def reference_samples() -> list[Samples]:
    """Those of `REFERENCES` that are there, below AXFFIT_REFERENCE_DATA or beside a clone."""
    named, home = os.environ.get("AXFFIT_REFERENCE_DATA"), clone()
    if named:
        folder = Path(named)
    elif home is not None:
        folder = home.parent / "shared" / "data"
    else:
        return []
    found = [samples._replace(file=folder / samples.file) for samples in REFERENCES]
    return [samples for samples in found if samples.file.is_file()]


def run(folder: Path, *, size: int = 512, quick: bool = False, progress: ProgressCallback | None = None) -> Shown:
    """Generates the materials into a folder, verifies them, fits the paints, and draws the page.

    Args:
        folder: where the generated files go, below ``materials``.
        size: texels along each side of the maps, 64 or 512.
        quick: the maps that come with a clone's size (64), and no real paints.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: the size is not one that is made, or a file cannot be used.
    """
    from axffit import report, synthesis

    say = progress or (lambda stage, fraction: None)
    size = 64 if quick else size
    materials = folder / "materials"
    say("generating materials", 0.0)
    synthesis.generate(materials, size=size, packages=(*MATERIALS, PAINT.file.parent.name))

    verified = []
    for name in MATERIALS:
        path = materials / name / f"{name}.axf"
        (judged,) = verify.run([path], progress=_prefixed(say, name))
        verified.append(report.VerifiedMaterial(judged.verdict, judged.material))
    fitted = []
    references = [] if quick else reference_samples()
    for samples in [PAINT._replace(file=materials / PAINT.file), *references]:
        stages = _prefixed(say, samples.material or samples.file.stem)
        found = fit.run(
            samples.file,
            model=samples.model,
            material=samples.material,
            polar_limit=samples.polar_limit,
            progress=stages,
        )
        fitted.append(report.FittedSamples(*found))
    say("drawing the page", 0.0)
    made_by = report.Run(f"axffit demo --size {size}" + (" --quick" if quick else ""), seed=None)
    return Shown(verified, fitted, report.demo_page(verified=verified, fitted=fitted, run=made_by))


def _prefixed(progress: ProgressCallback, name: str) -> ProgressCallback:
    return lambda stage, fraction: progress(f"{name}: {stage}", fraction)


def default_folder() -> Path:
    """Where the page goes when no folder is named: reports/latest in a clone, else a new temporary folder."""
    home = clone()
    return home / "reports" / "latest" if home is not None else Path(tempfile.mkdtemp(prefix="axffit-demo-"))


def command(
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of the page; without it reports/latest in a clone, else a new temporary folder."
        ),
    ] = None,
    size: Annotated[int, typer.Option(metavar="TEXELS", help="Texels along each side of the maps: 64 or 512.")] = 512,
    quick: Annotated[bool, typer.Option("--quick", help="Maps of 64 texels and no real paints.")] = False,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    folder = make_folder(out if out is not None else default_folder())
    with progress_on_stderr() as progress:
        shown = run(folder, size=size, quick=quick, progress=progress)
    write_all({folder / "report.json": json_text(shown.page.content), folder / PAGE: shown.page.html})
    show(*(item.verdict.summary() for item in shown.verified))
    for item in shown.fitted:
        show("", *fit_parts(item.result.to_json()))
    show("", str(folder / PAGE))
