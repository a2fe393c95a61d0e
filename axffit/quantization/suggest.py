"""The cheapest format of each texture that keeps the tolerance, and the verdict of all together (docs/suggest.md).

Each texture is judged alone at map level, in every format the target allows for it; then the material packed in the
chosen formats is verified as a whole. Where that is outside although every map is within, the textures that have a
dearer format within tolerance take the next one, until the whole is within or nothing is left to try; in that case the
cheapest formats stay, and their verdict says what is outside.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..axf import AxfMaterial
from ..targets import PackedTexture, target_named
from ..targets.table import SLICE_TABLE, FormatChoice, TextureRow
from ..textures.rerange import Reranging
from .maps import map_errors
from .tolerances import Tolerances, default_tolerances
from .verdict import TextureVerdict, Verdict
from .verify import Progress, verify

_MEGABYTE = 1e6


@dataclass(frozen=True)
class Candidate:
    """A format a texture may have, judged at map level.

    Attributes:
        format: its name.
        size_bytes: of the texture in it, all levels and slices.
        announced: whether the target's source only announces it: no engine of its time reads it, so it is not chosen.
        failures: what is outside tolerance, one line each.
    """

    format: str
    size_bytes: int
    announced: bool
    failures: tuple[str, ...]

    @property
    def eligible(self) -> bool:
        """Whether it may be chosen: every measure within, and more than announced."""
        return not self.announced and not self.failures

    def to_json(self) -> dict[str, Any]:
        """All of it."""
        fields = {"format": self.format, "bytes": self.size_bytes, "announced": self.announced}
        return {**fields, "within": not self.failures, "failures": list(self.failures)}


@dataclass(frozen=True)
class TextureSuggestion:
    """One texture.

    Attributes:
        name: the target's name of the texture.
        axf_name: AxF's name.
        advised: the format the target advises.
        candidates: every format allowed, the advised one first; one alone where the texture is not judged here (a
            default color, the slice table).
        chosen: the format suggested, or None where none keeps the tolerance: the advised one then stays.
    """

    name: str
    axf_name: str
    advised: str
    candidates: tuple[Candidate, ...]
    chosen: str | None

    def size_of(self, format: str | None) -> int:
        """Bytes in a format; of the advised one for None."""
        return next(each.size_bytes for each in self.candidates if each.format == (format or self.advised))

    def dearer(self) -> "TextureSuggestion":
        """The same with the next dearer format within tolerance, or unchanged where there is none."""
        if self.chosen is None:
            return self
        now = self.size_of(self.chosen)
        above = [each for each in self.candidates if each.eligible and each.size_bytes > now]
        return replace(self, chosen=_cheapest(above) or self.chosen)

    def to_json(self) -> dict[str, Any]:
        """All of it."""
        return {
            "name": self.name,
            "axf_name": self.axf_name,
            "advised": self.advised,
            "chosen": self.chosen,
            "bytes_before": self.size_of(None),
            "bytes_after": self.size_of(self.chosen),
            "candidates": [each.to_json() for each in self.candidates],
        }


@dataclass(frozen=True, eq=False)
class Suggestion:
    """The cheapest formats of a material.

    Attributes:
        textures: one entry a texture.
        verdict: of the material packed in the chosen formats, every level of it.
        steps: how often the textures had to take dearer formats because the whole was outside.
    """

    textures: tuple[TextureSuggestion, ...]
    verdict: Verdict
    steps: int

    @property
    def bytes_before(self) -> int:
        """Bytes of all textures in the advised formats."""
        return sum(each.size_of(None) for each in self.textures)

    @property
    def bytes_after(self) -> int:
        """Bytes of all textures in the chosen formats."""
        return sum(each.size_of(each.chosen) for each in self.textures)

    @property
    def without(self) -> tuple[TextureSuggestion, ...]:
        """Textures of which no format keeps the tolerance."""
        return tuple(each for each in self.textures if each.chosen is None)

    def summary(self) -> str:
        """One line for people."""
        saved = f"{self.bytes_before / _MEGABYTE:.3g} MB as advised, {self.bytes_after / _MEGABYTE:.3g} MB as suggested"
        if self.without:
            names = ", ".join(each.axf_name for each in self.without)
            return f"{self.verdict.id}: {saved}; no format keeps the tolerance of {names}"
        outcome = "within tolerance, verified" if self.verdict.within else "but the whole is outside tolerance"
        return f"{self.verdict.id}: {saved}, {outcome}"

    def to_json(self) -> dict[str, Any]:
        """All of it but the pictures; the whole's verdict in short."""
        return {
            "textures": [each.to_json() for each in self.textures],
            "megabytes_before": self.bytes_before / _MEGABYTE,
            "megabytes_after": self.bytes_after / _MEGABYTE,
            "steps": self.steps,
            "within": self.verdict.within,
            "failures": list(self.verdict.failures()),
            "summary": self.summary(),
        }


def suggest(
    material: AxfMaterial,
    target: str = "unity_2018",
    tolerances: Tolerances | None = None,
    *,
    advised: Verdict | None = None,
    bounds: bool = True,
    progress: Progress | None = None,
) -> Suggestion:
    """The cheapest format of each texture, by bytes a texel, that keeps the tolerance.

    Args:
        material: the material, in AxF's ranges.
        target: name of the target that packs and reads.
        tolerances: limits; None takes those of the package.
        advised: the verdict of the advised formats for that target and those limits, where it is known: saves time.
        bounds: as in `verify`, for the verdict of the whole.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: an unknown target, or an unusable material.
    """
    limits = tolerances or default_tolerances()
    report = progress or (lambda stage, fraction: None)

    def whole(textures: tuple[TextureSuggestion, ...]) -> Verdict:
        if advised is not None and all(each.chosen in (None, each.advised) for each in textures):
            return advised
        formats = {each.axf_name: each.chosen for each in textures if each.chosen is not None}
        return verify(material, target, limits, formats=formats, bounds=bounds, progress=progress)

    cheapest = textures = tuple(_judged_alone(material, target, limits, report))
    first = verdict = whole(textures)
    for steps in itertools.count():
        dearer = tuple(each.dearer() for each in textures)
        if verdict.within:
            return Suggestion(textures, verdict, steps)
        if dearer == textures or any(each.chosen is None for each in textures):
            break
        textures, verdict = dearer, whole(dearer)
    return Suggestion(cheapest, first, 0)


def _judged_alone(
    material: AxfMaterial, target: str, limits: Tolerances, report: Progress
) -> Iterator[TextureSuggestion]:
    """Every texture in every format: the k-th choices of all textures are packed at once."""
    module, limits = target_named(target), limits.for_target(target)
    packed = module.pack(material)
    advised = packed.textures
    choices = {name: _choices(module.ENGINE.tables.row(name), texture, material) for name, texture in advised.items()}
    candidates: dict[str, list[Candidate]] = {name: [] for name in advised}
    most = max(map(len, choices.values()), default=0)
    for number in range(most):
        report("trying formats", number / most)
        tried = {name: each[number] for name, each in choices.items() if number < len(each)}
        if number > 0:
            packed = module.pack(material, formats={advised[name].axf_name: c.format for name, c in tried.items()})
        for name, choice in tried.items():
            texture = packed.textures[name]
            failures: tuple[str, ...] = ()
            if not _left_alone(texture):
                failures = tuple(_failures(material, texture, module.reading(texture, packed.values), limits))
            candidates[name].append(Candidate(choice.format, texture.size_bytes, choice.announced, failures))
    for name, texture in advised.items():
        chosen = _cheapest([each for each in candidates[name] if each.eligible])
        yield TextureSuggestion(name, texture.axf_name, texture.format, tuple(candidates[name]), chosen)


def _failures(material: AxfMaterial, texture: PackedTexture, reading: Reranging, limits: Tolerances) -> Iterator[str]:
    """What is outside at map level, one line each."""
    original = material.textures[texture.axf_name]
    if [level.shape[:-1] for level in texture.levels] != [level.shape[:-1] for level in original.levels]:
        yield f"texture.shape: {texture.name}: not every level of AxF's {texture.axf_name}, or not in its size"
        return
    errors = map_errors(original, texture, reading, limits.levels_apart(texture.axf_name))
    verdict = TextureVerdict.judged(texture, reading.formula, errors, limits)
    yield from (str(check) for _, check in verdict.measures if not check.within)


def _choices(row: TextureRow, texture: PackedTexture, material: AxfMaterial) -> tuple[FormatChoice, ...]:
    """The formats allowed, the advised one first; that one alone for a default color and the slice table."""
    if _left_alone(texture):
        return tuple(choice for choice in row.stored_choices(texture.channels) if choice.format == texture.format)[:1]
    # An importer may keep fewer channels than AxF has.
    return row.choices.get(material.textures[texture.axf_name].channels) or row.stored_choices(texture.channels)


def _left_alone(texture: PackedTexture) -> bool:
    """Default colors are small, and the slice table is judged by what a shader gets back, with the whole."""
    return texture.defaulted or texture.axf_name == SLICE_TABLE


def _cheapest(candidates: Sequence[Candidate]) -> str | None:
    """The format of the fewest bytes, of several the first; None of none."""
    return min(candidates, key=lambda each: each.size_bytes).format if candidates else None
