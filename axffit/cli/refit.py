"""``axffit refit``: the closest material of another model, and what is lost on the way."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import show, table
from axffit.errors import InputError

if TYPE_CHECKING:
    import numpy as np

    from axffit.fitting.refit import Refit

HELP = """Refit a material as another model: Ward as GGX, a car paint as fewer lobes.

An SVBRDF's lobes are converted texel by texel; a car paint is evaluated on
the reference grid and fitted. What is lost is stated in the metrics of fits
and in the reflectance errors of verify, at texels spread over the material.

\b
Exit codes
  0  written
  2  unusable input

\b
Examples
  axffit refit leather.axf --to ggx --out leather_ggx.axf
  axffit refit paint.axf --to carpaint+coat --lobes 2 --out two_lobes.axf
  axffit refit paint.axf --to ggx+coat --textures paint_unity --target unity_2018
"""

TEXELS = 16


class Refitted(NamedTuple):
    """A refit and its loss.

    ``metrics``: name to (mean, largest) over the texels; ``brdf``: definition of `verify` to the largest error found.
    """

    refit: "Refit"
    texels: int
    metrics: dict[str, tuple[float, float]]
    brdf: dict[str, float]

    def to_json(self) -> dict[str, Any]:
        """Everything but the material."""
        from axffit import __version__

        refit = self.refit
        tabled = refit.conversion is not None
        return {
            "schema": "axffit.refit",
            "schema_version": 1,
            "axffit_version": __version__,
            "material": refit.material.id,
            "target": refit.target,
            "loss": {
                "texels": self.texels,
                "metrics": {name: {"mean": mean, "max": most} for name, (mean, most) in self.metrics.items()},
                "brdf_found": self.brdf,
            },
            "interpolation": refit.interpolation,
            "conversion": {name: values.tolist() for name, values in _columns(refit).items()} if tabled else None,
            "fit": None if refit.fit is None else refit.fit.to_json(),
            "notes": list(refit.notes),
        }


def _columns(refit: "Refit") -> "dict[str, np.ndarray]":
    made = refit.conversion
    if made is None:
        return {}
    return {name: getattr(made, name) for name in ("lobes", "f0", "roughness", "p", "q", "misfit")}


def run(
    material_file: Path,
    *,
    to: str,
    material: str | None = None,
    lobes: int = 3,
    residual: str = "log",
    texels: int = TEXELS,
    progress: ProgressCallback | None = None,
) -> Refitted:
    """Refits one material of a file and measures the loss.

    Args:
        material_file: an .axf file.
        to: the model; see `axffit.fitting.refit.refit`.
        material: the material's id; needed where the file holds several.
        lobes: of a car paint.
        residual: a name of `axffit.fitting.RESIDUALS`, noise excepted.
        texels: how many texels the loss is taken at.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, material or option that cannot be used.
    """
    import jax
    import numpy as np

    from axffit import axf, fitting
    from axffit.axf.maps import grid_shape, texel_centers
    from axffit.fitting import refit as refits
    from axffit.quantization.brdf_error import brdf_errors

    report = progress or (lambda stage, fraction: None)
    if residual not in fitting.RESIDUALS:
        raise InputError(f"unknown residual {residual!r}: choose one of {', '.join(fitting.RESIDUALS)}")
    report("reading", 0.0)
    before = axf.read(material_file).material(material)
    chosen = fitting.RESIDUALS[residual]()
    found = refits.refit(before, to, lobes=lobes, residual=chosen, progress=report)
    height, width = grid_shape(before)
    count = min(texels, height * width)
    numbers = (np.arange(count) * (height * width) / count).astype(int)
    uv = texel_centers(before, *np.divmod(numbers, width))
    report("loss", 0.0)
    each = refits.loss(before, found.material, uv)
    names = ("relative_cosine_rms", "log", "cube_root", "peak")
    values = {name: np.array([getattr(metrics, name) for metrics in each]) for name in names}
    metrics = {name: (float(column.mean()), float(column.max())) for name, column in values.items()}
    with jax.enable_x64(new_val=True):
        errors = brdf_errors(before, found.material, uv, lambda fraction: report("reflectance", fraction))
    brdf = {name: getattr(errors, name).value for name in ("peak_relative", "log_ratio", "strip")}
    return Refitted(found, count, metrics, brdf)


def command(
    material_file: Annotated[Path, typer.Argument(metavar="MATERIAL.axf", help="The material to refit.")],
    *,
    to: Annotated[
        str,
        typer.Option(metavar="MODEL", help="ward, cook-torrance, ggx or carpaint; +coat keeps the clear coat."),
    ],
    material: _options.Material = None,
    lobes: Annotated[int, typer.Option(metavar="N", help="Lobes of a car paint, 1 to 4.")] = 3,
    residual: Annotated[
        str, typer.Option(metavar="NAME", help="What is made small: log, cube-root or cosine.")
    ] = "log",
    out: Annotated[Path | None, typer.Option(metavar="REFIT.axf", help="Write the refitted material as AxF.")] = None,
    textures: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write it as an engine's textures, as export does.")
    ] = None,
    target: Annotated[str, typer.Option(metavar="NAME", help="The engine of --textures.")] = "unity_2018",
    normalization: Annotated[
        str,
        typer.Option(metavar="NAME", help="Of --textures: sdk as in AxF, or microfacet for lobes with the factor 1/4."),
    ] = "sdk",
    texels: Annotated[int, typer.Option(metavar="N", help="Texels that the loss is taken at.")] = TEXELS,
    json: _options.Json = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json, out], [material_file])
    if normalization not in ("sdk", "microfacet"):
        raise InputError(f"unknown normalization {normalization!r}: choose sdk or microfacet")
    if normalization == "microfacet" and (textures is None or out is not None):
        raise InputError("--normalization microfacet is for --textures alone: AxF files hold colors of the sdk's lobes")
    if texels < 1:
        raise InputError(f"--texels {texels}: give at least 1")
    with progress_on_stderr() as progress:
        found = run(
            material_file,
            to=to,
            material=material,
            lobes=lobes,
            residual=residual,
            texels=texels,
            progress=progress,
        )
        from axffit import axf
        from axffit.fitting import refit as refits
        from axffit.targets import folder

        made = found.refit.material
        results: Results = {}
        if json is not None:
            results[json] = json_text(found.to_json())
        if out is not None:
            results[out] = lambda path: axf.write(path, made)
        write_all(results)
        if textures is not None:
            colored = made if normalization == "sdk" else refits.microfacet(made)
            folder.write(axf.AxfFile((colored,)), textures, target=target, progress=progress)
    show(*_parts(found))


def _parts(found: Refitted) -> list[object]:
    from axffit.report.numbers import significant

    made = found.refit
    names = {"relative_cosine_rms": "relative cosine RMS", "log": "log", "cube_root": "cube root", "peak": "peak"}
    rows = [(names[name], significant(mean), significant(most)) for name, (mean, most) in found.metrics.items()]
    b, c = (significant(found.brdf[name]) for name in ("peak_relative", "log_ratio"))
    return [
        f"{made.material.name or made.material.id} as {made.target}, loss at {found.texels} texels",
        table(("metric", "mean", "largest"), rows),
        f"reflectance, largest found: {b} of the view's peak; log ratio {c}",
        *(f"note: {note}" for note in made.notes),
    ]
