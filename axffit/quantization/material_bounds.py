"""An upper bound of the BRDF errors of all texels of a material, from bounds of its merged classes.

A few merged classes hold all classes of the table (`classes`), and the largest of their bounds holds for every texel.
Merging makes boxes wide and bounds loose; so the group with the largest bound is taken apart, and the parts are bounded
anew, until the bound is near what was found, or no lower, or `MOST_GROUPS` were bounded. The number is fixed, not the
time: the same material gets the same bound everywhere.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..axf import AxfMaterial, MaterialKind
from ..targets import PackedMaterial, target_named
from .bounds import Bounds, Form, NoBound, TexelClass, form_of, upper_bounds
from .brdf_error import without_negative_colors
from .classes import ClassTable, class_table
from .statistics import finite_or_none
from .tiles import of_packed_texels, of_texels
from .tolerances import KINDS, Kind

MOST_GROUPS = 7
"""Groups that are bounded, shared among a material's forms: one for an SVBRDF, three (channels) for a car paint."""

NEAR = 2.0
"""Bounds up to this times what was found are not lowered by taking groups apart."""

WORTH = 0.95
"""Parts are worth more splitting where they lower the group's bound at least to this part of it."""


@dataclass(frozen=True, eq=False)
class BoundedClass:
    """A group of texel classes with its bounds.

    Attributes:
        texels: ranges of its parameters and errors.
        items: how many texels of the material it holds, a texel's channels counted apart where they differ.
        channel: color channel of a car paint; None where all three share the class.
        bounds: by definition.
    """

    texels: TexelClass
    items: int
    channel: int | None
    bounds: Mapping[Kind, Bounds]

    def to_json(self) -> dict[str, Any]:
        """Ranges and bounds; infinite numbers are null."""
        ranges = {
            name: [finite_or_none(x) for x in value] if isinstance(value, tuple) else value
            for name, value in asdict(self.texels).items()
        }
        bounds = {
            kind: {"bound": finite_or_none(each.value), "boxes": each.boxes} for kind, each in self.bounds.items()
        }
        return {"items": self.items, "channel": self.channel, "ranges": ranges, **bounds}


@dataclass(frozen=True, eq=False)
class MaterialBounds:
    """Bounds of a material, or why there are none.

    Attributes:
        classes: groups of classes that hold every texel, in every channel; empty where there is no bound.
        cells: classes of the table they are merged from.
        reason: why there is no bound, or "".
    """

    classes: tuple[BoundedClass, ...]
    cells: int
    reason: str = ""

    def bound(self, kind: Kind) -> float | None:
        """The upper bound of one definition over all texels, or None."""
        return max((each.bounds[kind].value for each in self.classes), default=None)

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {"reason": self.reason, "cells": self.cells, "classes": [each.to_json() for each in self.classes]}


def material_bounds(
    material: AxfMaterial,
    packed: PackedMaterial,
    found: Mapping[Kind, float],
    progress: Callable[[float], None] = lambda fraction: None,
) -> MaterialBounds:
    """Upper bounds over all texels, views and lights.

    Args:
        material: the original; its negative colors count as 0.
        packed: the packed material, with the names and values of the target that reads it.
        found: the largest errors found (`brdf_error`); it saves work to lower no bound further than near them.
        progress: called with the part that is done.

    Raises:
        InputError: a model that axffit does not evaluate.
    """
    cells = 0
    try:
        forms = _forms(material, packed)
        table = class_table(material, packed, lambda done: progress(0.3 * done))
        cells = len(table)
        classes: list[BoundedClass] = []
        for number, (channel, form) in enumerate(forms.items()):
            steps = lambda done, k=number: progress(0.3 + 0.7 * (k + done) / len(forms))  # noqa: E731
            classes += _bounded(form, table, channel, found, MOST_GROUPS // len(forms), steps)
    except NoBound as error:
        progress(1.0)
        return MaterialBounds((), cells, str(error))
    return MaterialBounds(tuple(classes), cells)


def _forms(material: AxfMaterial, packed: PackedMaterial) -> dict[int | None, Form]:
    """The form of each channel that has its own; None stands for all three.

    Raises:
        NoBound: the shader sees other models than the original's.
    """
    corner = np.array([[0.0, 0.0]])
    before = without_negative_colors(of_texels(material, corner))
    after = target_named(packed.target).unpack(of_packed_texels(packed, material, corner))
    if before.kind is MaterialKind.CAR_PAINT:
        if (before.has_clear_coat, before.coat_refracts) != (after.has_clear_coat, after.coat_refracts):
            raise NoBound("the shader sees another coat than the original's")
        return {channel: form_of(before, after, channel) for channel in range(3)}
    forms = [form_of(side, side, 0) for side in (before, after)]
    if vars(forms[0]) != vars(forms[1]) or before.anisotropic != after.anisotropic:
        raise NoBound(f"the shader sees other models ({_named(forms[1])}) than the original's ({_named(forms[0])})")
    return {None: forms[0]}


def _named(form: Form) -> str:
    """The models of a form, for people."""
    models = [model.__name__ for model in (form.diffuse, form.specular, form.fresnel) if model is not None]
    return " + ".join([*models, *([] if form.coat is None else [f"{form.coat} coat"])])


def _bounded(
    form: Form,
    table: ClassTable,
    channel: int | None,
    found: Mapping[Kind, float],
    most: int,
    progress: Callable[[float], None],
) -> list[BoundedClass]:
    """Groups that hold the whole table, their bounds lowered by splitting; at most so many are bounded.

    Raises:
        NoBound: where even a group that cannot be split any more has no bound, or no more may be bounded.
    """

    def bounded(chosen: np.ndarray) -> BoundedClass | NoBound:
        try:
            texels = table.merged(chosen)
            bounds = upper_bounds(form, texels, found)
            return BoundedClass(texels, int(table.items[chosen].sum()), channel, bounds)
        except NoBound as error:
            return error

    everything = np.arange(len(table))
    groups = [(everything, bounded(everything))]
    count = 1
    settled: set[int] = set()
    while count + 2 <= most and (chosen := _worst(groups, settled, found)) is not None:
        progress(count / most)
        indices, whole = groups[chosen]
        halves = table.halves(indices)
        if halves is None:
            settled.add(id(indices))
            continue
        parts = [(half, bounded(half)) for half in halves]
        count += 2
        groups[chosen : chosen + 1] = parts
        if not _lowered(whole, [part for _, part in parts]):
            settled |= {id(half) for half in halves}
    progress(1.0)
    refused = next((each for _, each in groups if isinstance(each, NoBound)), None)
    if refused is not None:
        raise refused
    return [each for _, each in groups if isinstance(each, BoundedClass)]


def _worst(
    groups: list[tuple[np.ndarray, BoundedClass | NoBound]], settled: set[int], found: Mapping[Kind, float]
) -> int | None:
    """The group to split next: one without a bound, else the one whose bound is the most times what was found."""
    open_ = [k for k, (indices, _) in enumerate(groups) if id(indices) not in settled]

    def excess(k: int) -> float:
        return max(_bound(groups[k][1], kind) / max(found[kind], 1e-12) for kind in KINDS)

    worst = max(open_, key=excess, default=None)
    return None if worst is None or excess(worst) <= NEAR else worst


def _bound(each: BoundedClass | NoBound, kind: Kind) -> float:
    return np.inf if isinstance(each, NoBound) else each.bounds[kind].value


def _lowered(whole: BoundedClass | NoBound, parts: list[BoundedClass | NoBound]) -> bool:
    """Whether splitting helped either definition."""
    if isinstance(whole, NoBound):
        return True
    return any(max(_bound(part, kind) for part in parts) <= WORTH * _bound(whole, kind) for kind in KINDS)
