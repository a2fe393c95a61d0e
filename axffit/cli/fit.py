"""``axffit fit``: the parameters of a model that explain a sampled BRDF, and how sure they are."""

import math
import re
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from axffit import __version__
from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._progress import ProgressCallback, progress_on_stderr
from axffit.cli._tables import fit_parts, show, table
from axffit.errors import InputError

if TYPE_CHECKING:
    from axffit.axf import AxfMaterial
    from axffit.brdf import AbstractBRDF
    from axffit.fitting import AbstractFitModel, AbstractResidual, FitResult, Negatives, Selection
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
  axffit fit all.npz --material delrin --select
"""


POLAR_LIMIT_DEGREES = 80.0
"""Samples nearer to the horizon are left out: the metrics of a fit are defined so."""


class Fitted(NamedTuple):
    """A fit, the samples it was made to, and those samples as a BRDF that can be evaluated anywhere."""

    result: "FitResult"
    measurements: "Measurements"
    measured: "AbstractBRDF"


def choose(
    samples_file: Path,
    *,
    material: str | None = None,
    residual: str | None = None,
    polar_limit: float = POLAR_LIMIT_DEGREES,
    progress: ProgressCallback | None = None,
) -> "Selection":
    """Compares Lambert, Ward, Cook-Torrance and GGX with 1 to 4 lobes on samples; arguments as of :func:`run`.

    Raises:
        InputError: for a file, material or residual that cannot be used, or too few samples to hold some back.
    """
    from axffit import fitting, measured

    samples = measured.to_rgb(measured.read(samples_file, material))
    chosen = _residual(residual)
    return fitting.select(samples, residual=chosen, polar_limit=_radians(polar_limit), progress=progress)


def _residual(name: str | None) -> "AbstractResidual | None":
    from axffit import fitting

    if name is not None and name not in fitting.RESIDUALS:
        raise InputError(f"unknown residual {name!r}: choose one of {', '.join(fitting.RESIDUALS)}")
    return None if name is None else fitting.RESIDUALS[name]()


def _radians(polar_limit: float) -> float:
    if not 0 < polar_limit <= 90:
        raise InputError(f"polar limit of {polar_limit:g} degrees: give an angle above 0 and at most 90")
    return math.radians(polar_limit)


def run(
    samples_file: Path,
    *,
    model: "str | AbstractFitModel" = "carpaint",
    material: str | None = None,
    residual: str | None = None,
    lobes: int | None = None,
    f0: str | None = None,
    ior: float = 1.5,
    polar_limit: float = POLAR_LIMIT_DEGREES,
    negatives: "Negatives" = "clip",
    passive: bool = False,
    profiles: tuple[str, ...] = (),
    bootstrap: int = 0,
    progress: ProgressCallback | None = None,
) -> Fitted:
    """Fits a model to samples.

    Args:
        samples_file: a file of samples in any format that `axffit.measured.read` knows.
        model: a name of `axffit.fitting.MODEL_NAMES`, ``+coat`` for a clear coat; or a model of `axffit.fitting`.
        material: which of the samples; needed where the file holds several.
        residual: a name of `axffit.fitting.RESIDUALS`; None is noise where the samples state theirs, else log.
        lobes: number of lobes, 1 to 4; None is 3 for a car paint, else 1.
        f0: ``"shared"`` by all lobes (None is the same), ``"each"`` its own, or its known value as text.
        ior: index of refraction of the coat.
        polar_limit: samples with a larger polar angle (degrees) of either direction are left out.
        negatives: ``"clip"``: they count as 0; ``"leave out"``: samples with one are left out.
        passive: no albedo above 1; for models that are no car paint and whose coat, if any, does not refract.
        profiles: names of parameters to profile, or ``("all",)``.
        bootstrap: fits of a bootstrap; 0 for none.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: for a file, material, model or residual that cannot be used.
    """
    from axffit import fitting, measured

    limit, chosen = _radians(polar_limit), _residual(residual)
    known_f0 = None if f0 is None else fitting.parse_f0(f0)
    fit_model = fitting.parse_model(model, lobes=lobes, f0=known_f0, ior=ior) if isinstance(model, str) else model
    samples = measured.to_rgb(measured.read(samples_file, material))
    study = fitting.Study(tuple(profiles), bootstrap)
    result = fitting.fit(
        fit_model,
        samples,
        residual=chosen,
        polar_limit=limit,
        negatives=negatives,
        passive=passive,
        study=study,
        progress=progress,
    )
    return Fitted(result, samples, measured.interpolant(samples_file, material))


def as_material(fitted: Fitted) -> "AxfMaterial":
    """The fitted car paint as an AxF material.

    Raises:
        InputError: the model is no car paint.
    """
    from axffit import axf, brdf
    from axffit.axf.appearance import car_paint_content

    model = fitted.result.model
    # AxF's car paint has a coat; one of index 1 that does not refract changes nothing.
    coated = brdf.ClearCoat(model, 1.0, refracting=False) if isinstance(model, brdf.CarPaint) else model
    if not isinstance(coated, brdf.ClearCoat) or not isinstance(coated.base, brdf.CarPaint):
        raise InputError(f"{fitted.result.model_name} cannot be written as an AxF car paint: fit carpaint")
    textures, properties = car_paint_content(coated.base)
    name = fitted.measurements.name or "fitted"
    return axf.AxfMaterial(
        id=re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "fitted",
        name=name,
        kind=axf.MaterialKind.CAR_PAINT,
        specular_model="CookTorrance",
        fresnel_variant="Schlick1994",
        textures=textures,
        properties={**properties, "IOR": coated.ior, "cc_no_refraction": 0 if coated.refracting else 1},
        metadata={"fitted_by": f"axffit {__version__}", "fitted_model": fitted.result.model_name},
    )


def _study_parts(content: dict[str, Any]) -> list[object]:
    """Intervals of profiles and bootstrap; an open end of a profile is said to be open."""

    def end(value: float | None, otherwise: str) -> str:
        return otherwise if value is None else f"{value:.4g}"

    parts: list[object] = []
    if content["profiles"]:
        rows = [(one["name"], end(one["low"], "open"), end(one["high"], "open")) for one in content["profiles"]]
        parts.append(table(("95 % by profile", "from", "to"), rows))
        parts += [f"note: held elsewhere, {one['name']} gives a better fit: this is not the lowest minimum"
                  for one in content["profiles"] if one["lower_cost_found"]]  # fmt: skip
    if content["bootstrap"] is not None:
        found = content["bootstrap"]
        rows = [
            (one["name"], f"{one['standard_deviation']:.3g}", end(one["low"], "-"), end(one["high"], "-"))
            for one in found["parameters"]
        ]
        heading = f"95 % by bootstrap, {found['converged']} of {found['count']} fits"
        parts.append(table((heading, "standard deviation", "from", "to"), rows))
    return parts


def _selection_table(selection: "Selection") -> object:
    """A row a model: parameters, error, criteria, error of what was held back."""
    rows = [
        (
            one.model.name + (" *" if one is selection.chosen else ""),
            str(one.parameters),
            f"{one.error:.4g}",
            f"{one.aic:.1f}",
            f"{one.bic:.1f}",
            f"{one.validation:.4g} +- {one.validation_error:.1g}",
        )
        for one in selection.candidates
    ]
    return table(("model", "parameters", f"{selection.residual} error", "AIC", "BIC", "held back"), rows)


def command(
    samples_file: Annotated[
        Path, typer.Argument(metavar="SAMPLES", help="The sampled BRDF: any file that `axffit measured` reads.")
    ],
    *,
    model: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="lambert, ward (also ward:Ward1992, ward:Duer2006), cook-torrance, ggx or carpaint; "
            "+coat for a clear coat.",
        ),
    ] = "carpaint",
    material: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which of the samples; needed where the file holds several.")
    ] = None,
    residual: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="What is made small: log, cube-root, cosine, noise or robust (log with Huber's loss). Without it "
            "noise, where the samples state it, else log.",
        ),
    ] = None,
    lobes: Annotated[
        int | None, typer.Option(metavar="N", help="Number of lobes, 1 to 4; 3 for a car paint, else 1.")
    ] = None,
    f0: Annotated[
        str | None,
        typer.Option(metavar="F0", help="Of the lobes: shared (without it), each its own, or its known value, 0 to 1."),
    ] = None,
    ior: Annotated[float, typer.Option(metavar="N", help="Index of refraction of the coat.")] = 1.5,
    select: Annotated[
        bool,
        typer.Option(
            "--select",
            help="Compare Lambert, Ward, Cook-Torrance and GGX with 1 to 4 lobes first (AIC, BIC, cross-validation) "
            "and fit the one that cross-validation chooses, instead of --model.",
        ),
    ] = False,
    leave_out_negatives: Annotated[
        bool, typer.Option("--leave-out-negatives", help="Leave out negative samples; otherwise they count as 0.")
    ] = False,
    passive: Annotated[
        bool,
        typer.Option("--passive", help="Let no albedo exceed 1; for all models but a car paint, without a coat."),
    ] = False,
    polar_limit: Annotated[
        float,
        typer.Option(metavar="DEGREES", help="Leave out samples with a larger polar angle of light or viewer."),
    ] = POLAR_LIMIT_DEGREES,
    profile: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Profile likelihood of a parameter, as 'spread 1'; repeatable; or all."),
    ] = None,
    bootstrap: Annotated[
        int, typer.Option(metavar="N", help="Fit N times again to samples drawn with replacement; 200 is usual.")
    ] = 0,
    json: _options.Json = None,
    html: _options.Html = None,
    out: Annotated[Path | None, typer.Option(metavar="FITTED.axf", help="Write the fitted car paint as AxF.")] = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json, html, out], [samples_file])
    if out is not None and not model.startswith("carpaint"):
        raise InputError(f"--out writes car paints only, and the model is {model!r}: leave --out out, or fit carpaint")
    if select and (out is not None or model != "carpaint" or lobes is not None or f0 is not None):
        raise InputError("--select chooses the model: leave out --model, --lobes, --f0 and --out")
    with progress_on_stderr() as progress:
        selection = None
        if select:
            selection = choose(
                samples_file, material=material, residual=residual, polar_limit=polar_limit, progress=progress
            )
        fitted = run(
            samples_file,
            model=model if selection is None else selection.chosen.model,
            material=material,
            residual=residual,
            lobes=lobes,
            f0=f0,
            ior=ior,
            polar_limit=polar_limit,
            negatives="leave out" if leave_out_negatives else "clip",
            passive=passive,
            profiles=tuple(profile or ()),
            bootstrap=bootstrap,
            progress=progress,
        )
        if selection is not None:
            result = fitted.result
            fitted = fitted._replace(result=replace(result, notes=result.notes + selection.notes()))
        content = fitted.result.to_json()
        results: Results = {}
        if json is not None:
            results[json] = json_text(content)
        if html is not None and fitted.result.model is not None:
            from axffit import report

            progress("drawing the page", 0.0)
            options = {
                "model": None if select else model,
                "material": material,
                "residual": residual,
                "lobes": lobes,
                "f0": f0,
                "ior": ior,
            }
            options["polar-limit"] = polar_limit
            options["bootstrap"] = bootstrap or None
            flags = {"--select": select, "--leave-out-negatives": leave_out_negatives, "--passive": passive}
            words = [_options.command_line("fit", [samples_file], options), *(flag for flag in flags if flags[flag])]
            words += [shlex.join(["--profile", name]) for name in profile or ()]
            made_by = report.Run(" ".join(words))
            results[html] = report.fit_page([report.FittedSamples(*fitted)], made_by).html
        if out is not None and fitted.result.model is not None:
            from axffit import axf

            fitted_material = as_material(fitted)
            results[out] = lambda path: axf.write(path, fitted_material)
    write_all(results)
    left_out = [path.name for path in (html, out) if path is not None and path not in results]
    if left_out:
        typer.echo(f"axffit: there is no fitted model, not written: {', '.join(left_out)}", err=True)
    if selection is not None:
        show(_selection_table(selection))
    *parts, advice = fit_parts(content)
    show(*parts, *_study_parts(content), advice)
    raise typer.Exit(0 if fitted.result.outcome.ok else 1)
