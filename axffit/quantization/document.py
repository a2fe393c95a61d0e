"""Verdicts of several materials as one JSON document (``schemas/verdicts.schema.json``)."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

from .. import __version__
from . import verdict as verdicts
from .suggest import Suggestion
from .verdict import Verdict

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class Judged:
    """The verdict of one material, and what was read for it.

    Attributes:
        verdict: its JSON.
        file: the .axf file, as it was named.
        packed: the folder of packed textures another program wrote, or None where axffit packed.
        suggestion: the JSON of the cheapest formats, or None where they were not asked for.
    """

    verdict: Mapping[str, Any]
    file: str
    packed: str | None = None
    suggestion: Mapping[str, Any] | None = None

    @classmethod
    def of(
        cls, verdict: Verdict, file: object, packed: object | None = None, suggestion: Suggestion | None = None
    ) -> "Judged":
        """The same of objects and of paths."""
        suggested = None if suggestion is None else suggestion.to_json()
        return cls(verdict.to_json(), str(file), None if packed is None else str(packed), suggested)

    def to_json(self) -> dict[str, Any]:
        """An entry of the document."""
        content: dict[str, Any] = {"file": self.file, "packed": self.packed, "verdict": dict(self.verdict)}
        return content if self.suggestion is None else {**content, "suggestion": dict(self.suggestion)}


def document(judged: Sequence[Judged]) -> dict[str, Any]:
    """The document of one or more verdicts; validates against `schema`."""
    return {
        "schema": "axffit.verdicts",
        "schema_version": SCHEMA_VERSION,
        "axffit_version": __version__,
        "within": all(entry.verdict["within"] for entry in judged),
        "summary": summary(judged),
        "materials": [entry.to_json() for entry in judged],
    }


def summary(judged: Sequence[Judged]) -> str:
    """One line for people: the verdict's own where there is one, else how many are outside and which."""
    if len(judged) == 1:
        return judged[0].verdict["summary"]
    textures = sum(len(entry.verdict["textures"]) for entry in judged)
    outside = [entry.verdict["material"]["id"] for entry in judged if not entry.verdict["within"]]
    if not outside:
        return f"{len(judged)} materials, {textures} textures: all within tolerance"
    return f"{len(outside)} of {len(judged)} materials outside tolerance: {', '.join(outside)}"


def schema() -> dict[str, Any]:
    """The JSON schema of `document`, that of a verdict included."""
    text = resources.files("axffit.quantization").joinpath("schemas/verdicts.schema.json").read_text(encoding="utf-8")
    whole = json.loads(text)
    whole["$defs"] = {"verdict": verdicts.schema() | {"$id": "urn:axffit:verdict"}}
    return whole
