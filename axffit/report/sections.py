"""What a page says of one verdict, fit or comparison: JSON content, and the pictures that go with it.

The content is complete without the pictures: everything that a plot shows is in it as numbers.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from axffit.axf import AxfMaterial
from axffit.brdf import AbstractBRDF, ClearCoat
from axffit.measured import Measurements
from axffit.report import curves, pictures, plots
from axffit.targets import PackedMaterial, PackedTexture, target_named
from axffit.targets.encoding import encode_level
from axffit.targets.table import SLICE_TABLE

if TYPE_CHECKING:
    from axffit.fitting import Comparison, FitResult
    from axffit.quantization import Verdict

SPHERE_SIZE = 256


@dataclass(frozen=True)
class Section:
    """A part of a page.

    Attributes:
        content: JSON-ready: ``kind``, ``title``, ``result`` and the numbers behind the plots.
        pictures: name to a data URI, or to an SVG element for names that begin with ``plot``.
    """

    content: Mapping[str, Any]
    pictures: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class VerifiedMaterial:
    """A verdict and the material it is about.

    Attributes:
        verdict: of `axffit.quantization.verify`.
        material: the original, for the pictures; None leaves them out.
    """

    verdict: "Verdict"
    material: AxfMaterial | None = None

    def section(self, *, sphere_size: int = SPHERE_SIZE) -> Section:
        """Content and pictures of the verdict."""
        verdict = self.verdict
        shown: dict[str, str] = {}
        maps = {}
        for name, errors in verdict.error_maps.items():
            picture = pictures.error_map_picture(errors)
            shown[f"error {name}"] = picture.uri
            maps[name] = {"largest": picture.largest, "texels_per_pixel": picture.block}
        pairs = []
        if self.material is not None and verdict.brdf.errors is not None:
            pairs = pictures.material_pictures(
                self.material, _as_packed(verdict, self.material), size=max(2, 5 * sphere_size // 8)
            )
        for number, pair in enumerate(pairs):
            shown |= {f"{name} {number}": uri for name, uri in pair.uris.items()}
        content = {
            "kind": "verify",
            "title": verdict.name or verdict.id,
            "result": verdict.to_json(),
            "error_maps": maps,
            "pictures": [pair.facts for pair in pairs],
        }
        return Section(content, shown)


def _as_packed(verdict: "Verdict", material: AxfMaterial) -> PackedMaterial:
    """The material as the target's shader has it."""
    textures = {t.packed.name: t.packed for t in verdict.textures}
    if verdict.lut is not None:
        textures[verdict.lut.content["name"]] = _slice_table(verdict)
    return PackedMaterial(verdict.target, verdict.id, verdict.name, material.kind, textures, verdict.values)


def _slice_table(verdict: "Verdict") -> PackedTexture:
    """The table as it is meant: pictures show what the textures lose, the verdict which entries are misread."""
    assert verdict.lut is not None
    content = verdict.lut.content
    entries = np.asarray(content["entries"], np.float64).reshape(1, -1, 1)
    table = PackedTexture(content["name"], SLICE_TABLE, content["format"], "nearest_even", (entries,), 1)
    reading = target_named(verdict.target).reading(table, verdict.values)
    codes, _ = encode_level(entries, reading, table.number_format, table.rounding)
    return replace(table, levels=(codes,))


@dataclass(frozen=True, eq=False)
class FittedSamples:
    """A fit and what it was made to.

    Attributes:
        result: of `axffit.fitting.fit`.
        measurements: the samples.
        measured: the samples as a BRDF that can be evaluated anywhere (`axffit.measured.interpolant`), for the plots
            and the spheres; None leaves them out.
    """

    result: "FitResult"
    measurements: Measurements
    measured: AbstractBRDF | None = None

    def section(self, *, sphere_size: int = SPHERE_SIZE) -> Section:
        """Content and pictures of the fit."""
        result = self.result.to_json()
        limit = result["samples"].get("polar_limit_degrees", 90.0)
        return _sampled("fit", result, self.result.model, self.measurements, self.measured, sphere_size, limit)


@dataclass(frozen=True, eq=False)
class ComparedSamples:
    """A comparison of a model with samples.

    Attributes:
        comparison: of `axffit.fitting.compare`.
        model: the BRDF that was compared.
        measurements: the samples.
        measured: the samples as a BRDF, as in `FittedSamples`.
        title: what was compared, for people.
    """

    comparison: "Comparison"
    model: AbstractBRDF
    measurements: Measurements
    measured: AbstractBRDF | None = None
    title: str = ""

    def section(self, *, sphere_size: int = SPHERE_SIZE) -> Section:
        """Content and pictures of the comparison."""
        result = self.comparison.to_json()
        limit = result["polar_limit_degrees"]
        section = _sampled("compare", result, self.model, self.measurements, self.measured, sphere_size, limit)
        return replace(section, content={**section.content, "title": self.title or section.content["title"]})


def _sampled(
    kind: str,
    result: Mapping[str, Any],
    model: AbstractBRDF | None,
    measurements: Measurements,
    measured: AbstractBRDF | None,
    sphere_size: int,
    polar_limit_degrees: float,
) -> Section:
    """What fits and comparisons share: lobes, where the model fails, spheres. Without a model only words remain."""
    title = measurements.name or "samples"
    failure = lobes = None
    spheres = False
    shown: dict[str, str] = {}
    if model is not None:
        failure = curves.failure_map(measurements, model, polar_limit=math.radians(polar_limit_degrees))
        shown["plot failure"] = plots.failure_heat_map(failure, label=f"{title}: model over measurement, by angle")
    if model is not None and measured is not None:
        lobes = curves.incidence_plane(measured, model)
        shown["plot log"] = plots.lobes_log(lobes, label=f"{title}: lobes in the plane of incidence, logarithmic")
        shown["plot polar"] = plots.lobes_polar(lobes, label=f"{title}: lobes in the plane of incidence, polar")
        spheres = pictures.affordable(model)
        if spheres:
            shown["sphere measured"], _ = pictures.spheres(measured, size=sphere_size)
            shown["sphere model"], coated = pictures.spheres(model, size=sphere_size)
            if isinstance(model, ClearCoat):
                shown["sphere coated"] = coated
    content = {
        "kind": kind,
        "title": title,
        "result": result,
        "samples": _describe(measurements) | {"polar_limit_degrees": polar_limit_degrees},
        "incidence_plane": lobes,
        "spheres": spheres,
        "failure_map": failure,
        "coated": isinstance(model, ClearCoat),
    }
    return Section(content, shown)


def _describe(measurements: Measurements) -> dict[str, Any]:
    """Number of samples and where they came from."""
    return {
        "count": len(measurements.wi),
        "valid": int(np.count_nonzero(measurements.valid)),
        "noise_known": measurements.sigma is not None,
        "provenance": dict(measurements.provenance),
    }
