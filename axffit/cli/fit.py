"""``axffit fit``: the parameters of a model that explain a sampled BRDF, and how sure they are."""

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from axffit import __version__
from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import fit_parts, show
from axffit.errors import InputError

if TYPE_CHECKING:
    from axffit.axf import AxfMaterial
    from axffit.brdf import AbstractBRDF
    from axffit.fitting import FitResult
    from axffit.measured import Measurements

HELP = """Find the model parameters that explain a sampled BRDF.

Needs no start and no seed. Each parameter comes with its standard error,
or with the reason why it has none: at a bound, or not determined by these
samples.

\b
Exit codes
  0  converged
  1  not converged; the best parameters found are shown all the same
  2  unusable input

\b
Examples
  axffit fit red.mbsdf --model carpaint+coat --html fit.html --out red.axf
  axffit fit all.npz --material cc_ibiza_sunset_rgb --model ggx+coat
"""


POLAR_LIMIT_DEGREES = 80.0
"""Samples nearer to the horizon are left out: the metrics of a fit are defined so."""


class Fitted(NamedTuple):
    """A fit, the samples it was made to, and those samples as a BRDF that can be evaluated anywhere."""

    result: "FitResult"
    measurements: "Measurements"
    measured: "AbstractBRDF"


def run(
    samples_file: Path,
    *,
    model: str = "carpaint",
    material: str | None = None,
    residual: str | None = None,
    lobes: int = 3,
    polar_limit: float = POLAR_LIMIT_DEGREES,
    progress: ProgressCallback | None = None,
) -> Fitted:
    """Fits a model to samples.

    Args:
        samples_file: a file of samples in any format that `axffit.measured.read` knows.
        model: a name of `axffit.fitting.MODEL_NAMES`, ``+coat`` for a clear coat.
        material: which of the samples; needed where the file holds several.
        residual: a name of `axffit.fitting.RESIDUALS`; None is noise where the samples state theirs, else log.
        lobes: number of lobes of a car paint, 1 to 4.
        polar_limit: samples with a larger polar angle (degrees) of either direction are left out.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, material, model or residual that cannot be used.
    """
    from axffit import fitting, measured

    if not 0 < polar_limit <= 90:
        raise InputError(f"polar limit of {polar_limit:g} degrees: give an angle above 0 and at most 90")
    fit_model = fitting.parse_model(model, lobes=lobes)
    if residual is not None and residual not in fitting.RESIDUALS:
        raise InputError(f"unknown residual {residual!r}: choose one of {', '.join(fitting.RESIDUALS)}")
    chosen = None if residual is None else fitting.RESIDUALS[residual]()
    samples = measured.read(samples_file, material)
    result = fitting.fit(fit_model, samples, residual=chosen, polar_limit=math.radians(polar_limit), progress=progress)
    return Fitted(result, samples, measured.interpolant(samples_file, material))


def as_material(fitted: Fitted) -> "AxfMaterial":
    """The fitted car paint as an AxF material.

    Raises:
        InputError: the model is no car paint.
    """
    import numpy as np

    from axffit import axf, brdf

    model = fitted.result.model
    # AxF's car paint has a coat; one of index 1 that does not refract changes nothing.
    coated = brdf.ClearCoat(model, 1.0, refracting=False) if isinstance(model, brdf.CarPaint) else model
    if not isinstance(coated, brdf.ClearCoat) or not isinstance(coated.base, brdf.CarPaint):
        raise InputError(f"{fitted.result.model_name} cannot be written as an AxF car paint: fit carpaint")
    paint = coated.base
    name = fitted.measurements.name or "fitted"
    return axf.AxfMaterial(
        id=re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "fitted",
        name=name,
        kind=axf.MaterialKind.CAR_PAINT,
        specular_model="CookTorrance",
        fresnel_variant="Schlick1994",
        textures={"brdfcolors": axf.AxfTexture((np.asarray(paint.color_table.values, np.float32),))},
        properties={
            "CT_diffuse": paint.diffuse,
            "CT_coeffs": paint.coefficients,
            "CT_F0s": paint.f0,
            "CT_spreads": paint.spreads,
            "IOR": coated.ior,
            "cc_no_refraction": 0 if coated.refracting else 1,
        },
        metadata={"fitted_by": f"axffit {__version__}", "fitted_model": fitted.result.model_name},
    )


def command(
    samples_file: Annotated[
        Path, typer.Argument(metavar="SAMPLES", help="The sampled BRDF: .mbsdf, or .npz of neural encodings.")
    ],
    *,
    model: Annotated[
        str,
        typer.Option(metavar="NAME", help="lambert, ward, cook-torrance, ggx or carpaint; +coat for a clear coat."),
    ] = "carpaint",
    material: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which of the samples; needed where the file holds several.")
    ] = None,
    residual: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="What is made small: log, cube-root, cosine or noise. Without it noise, where the samples state it, "
            "else log.",
        ),
    ] = None,
    lobes: Annotated[int, typer.Option(metavar="N", help="Lobes of a car paint, 1 to 4.")] = 3,
    polar_limit: Annotated[
        float,
        typer.Option(metavar="DEGREES", help="Leave out samples with a larger polar angle of light or viewer."),
    ] = POLAR_LIMIT_DEGREES,
    json: _options.Json = None,
    html: _options.Html = None,
    out: Annotated[Path | None, typer.Option(metavar="FITTED.axf", help="Write the fitted car paint as AxF.")] = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json, html, out], [samples_file])
    if out is not None and not model.startswith("carpaint"):
        raise InputError(f"--out writes car paints only, and the model is {model!r}: leave --out out, or fit carpaint")
    with progress_on_stderr() as progress:
        fitted = run(
            samples_file,
            model=model,
            material=material,
            residual=residual,
            lobes=lobes,
            polar_limit=polar_limit,
            progress=progress,
        )
        content = fitted.result.to_json()
        results: Results = {}
        if json is not None:
            results[json] = json_text(content)
        if html is not None and fitted.result.model is not None:
            from axffit import report

            progress("drawing the page", 0.0)
            options = {"model": model, "material": material, "residual": residual, "lobes": lobes}
            options["polar-limit"] = polar_limit
            made_by = report.Run(_options.command_line("fit", [samples_file], options))
            results[html] = report.fit_page([report.FittedSamples(*fitted)], made_by).html
        if out is not None and fitted.result.model is not None:
            from axffit import axf

            fitted_material = as_material(fitted)
            results[out] = lambda path: axf.write(path, fitted_material)
    write_all(results)
    left_out = [path.name for path in (html, out) if path is not None and path not in results]
    if left_out:
        typer.echo(f"axffit: there is no fitted model, not written: {', '.join(left_out)}", err=True)
    show(*fit_parts(content))
    raise typer.Exit(0 if fitted.result.outcome.ok else 1)
