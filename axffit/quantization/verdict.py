"""The verdict: every number beside its limit, as objects and as JSON (``schemas/verdict.schema.json``)."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

import numpy as np

from .. import __version__
from ..targets import PackedTexture, Problem
from .brdf_verdict import BrdfVerdict
from .checks import Check as Check
from .diagnosis import Fault
from .maps import MapErrors
from .statistics import Statistics
from .tolerances import Tolerances

SCHEMA_VERSION = 1


@dataclass(frozen=True, eq=False)
class TextureVerdict:
    """One texture: how it was packed, what could not be kept, and its errors.

    Attributes:
        packed: the packed texture.
        measures: statistics and limit of each measure, the one of the picture first.
        reading: what the shader reads it as the inverse of, as a formula.
        non_finite: texels of which the shader sees a NaN or an infinity.
    """

    packed: PackedTexture
    measures: tuple[tuple[Statistics, Check], ...]
    reading: str
    non_finite: int

    @classmethod
    def judged(cls, packed: PackedTexture, reading: str, errors: MapErrors, tolerances: Tolerances) -> "TextureVerdict":
        """The verdict of measured errors, each against the limit of its texture, measure and level."""
        measures = []
        for statistics in errors.statistics:
            level = "" if statistics.level is None else f".level.{statistics.level}"
            name = f"textures.{packed.axf_name}.{statistics.measure}{level}"
            tolerance = tolerances.get(name)
            value = statistics.value(tolerance.statistic if tolerance is not None else "max")
            measures.append((statistics, Check(name, value, tolerance)))
        return cls(packed, tuple(measures), reading, errors.non_finite)

    @property
    def within(self) -> bool:
        """Whether every measure is within its limit."""
        return all(check.within for _, check in self.measures)

    def to_json(self) -> dict[str, Any]:
        """The row: the first measure's numbers on top, all of them under ``measures``."""
        packed = self.packed
        measures = [{**statistics.to_json(), **check.to_json()} for statistics, check in self.measures]
        return {
            "name": packed.name,
            "axf_name": packed.axf_name,
            "format": packed.format,
            "rounding": packed.rounding,
            "transform": packed.transform,
            "reading": self.reading,
            "shape": [int(size) for size in packed.levels[0].shape[:-1]],
            "levels": len(packed.levels),
            "bytes": packed.size_bytes,
            "source": packed.source,
            "defaulted": packed.defaulted,
            **asdict(packed.counts),
            "non_finite": self.non_finite,
            **measures[0],
            "within": self.within,
            "measures": measures,
        }


@dataclass(frozen=True)
class LutVerdict:
    """The slice table: which entries a shader gets back.

    Attributes:
        content: the readings (`slice_lut.lut_json`).
        checks: slices lost by truncating in float32, and by rounding, however the texel is held.
    """

    content: Mapping[str, Any]
    checks: tuple[Check, ...]

    @property
    def within(self) -> bool:
        """Whether both counts are within their limits."""
        return all(check.within for check in self.checks)

    def to_json(self) -> dict[str, Any]:
        """Readings and checks."""
        checks = [{"found": check.value, **check.to_json()} for check in self.checks]
        return {**self.content, "checks": checks, "within": self.within}


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a target's textures lose of a material, against the tolerances.

    Attributes:
        id: the material's id.
        name: the material's name.
        kind: "SVBRDF" or "CarPaint2".
        target: name of the target whose shader reads.
        packed_for: name of the target whose importer packed; the same one as a rule.
        textures: one entry a texture.
        lut: the slice table of a car paint with flakes, or None.
        brdf: the BRDF level.
        problems: broken obligations of the packed material.
        faults: what the packer did wrong, where it has a name.
        values: the packed values by the target's names.
        notes: what a person should know.
        tolerances: where the limits come from.
        error_maps: target name to the error map of the texture's first measure, [H, W] float32.
    """

    id: str
    name: str
    kind: str
    target: str
    packed_for: str
    textures: tuple[TextureVerdict, ...]
    lut: LutVerdict | None
    brdf: BrdfVerdict
    problems: tuple[Problem, ...]
    faults: tuple[Fault, ...]
    values: Mapping[str, Any]
    notes: tuple[str, ...]
    tolerances: str
    error_maps: Mapping[str, np.ndarray]

    @property
    def within(self) -> bool:
        """Whether every check is within its limit, no obligation is broken and no fault named."""
        return not self.problems and not self.faults and all(check.within for check in self.checks())

    def checks(self) -> Iterator[Check]:
        """Every number that was compared with a limit."""
        for texture in self.textures:
            yield from (check for _, check in texture.measures)
        yield from self.lut.checks if self.lut is not None else ()
        yield from self.brdf.checks

    def failures(self) -> tuple[str, ...]:
        """What is outside, one line each, named faults first; empty when within."""
        outside = [f"{check}{self.brdf.basis(check)}" for check in self.checks() if not check.within]
        return (*map(str, self.faults), *outside, *map(str, self.problems))

    def engines(self) -> str:
        """For which engine it was packed, and which one reads it where that is another."""
        if self.target == self.packed_for:
            return f"for {self.target}"
        return f"packed for {self.packed_for}, read by {self.target}"

    def summary(self) -> str:
        """One line for people."""
        failures = self.failures()
        outcome = "within tolerance" if not failures else f"outside tolerance ({len(failures)}): {failures[0]}"
        return f"{self.id} {self.engines()}: {len(self.textures)} textures, {outcome}"

    def to_json(self) -> dict[str, Any]:
        """The whole verdict without the pictures; validates against `schema`."""
        return {
            "schema": "axffit.verdict",
            "schema_version": SCHEMA_VERSION,
            "axffit_version": __version__,
            "material": {"id": self.id, "name": self.name, "kind": self.kind},
            "target": self.target,
            "packed_for": self.packed_for,
            "within": self.within,
            "summary": self.summary(),
            "failures": list(self.failures()),
            "tolerances": self.tolerances,
            "textures": [texture.to_json() for texture in self.textures],
            "lut": None if self.lut is None else self.lut.to_json(),
            "brdf": self.brdf.to_json(),
            "faults": [fault.to_json() for fault in self.faults],
            "flags": [asdict(problem) for problem in self.problems],
            "values": {name: list(v) if isinstance(v, tuple) else v for name, v in self.values.items()},
            "notes": list(self.notes),
        }


def schema() -> dict[str, Any]:
    """The JSON schema of `Verdict.to_json`."""
    text = resources.files("axffit.quantization").joinpath("schemas/verdict.schema.json").read_text(encoding="utf-8")
    return json.loads(text)
