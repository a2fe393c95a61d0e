"""An upper bound of the BRDF errors of all texels of a material, from bounds of its merged classes.

One merged class holds all classes of the table (`classes`), and its bound holds for every texel; where the class is too
wide for a good one it is taken apart (`bounds.descent`). The work is fixed, not the time: the same material gets the
same bound everywhere.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..axf import AxfMaterial, MaterialKind
from ..targets import PackedMaterial, target_named
from .bounds import MOST_BOXES, Bounds, Form, Group, NoBound, TexelClass, form_of, upper_bounds
from .brdf_error import without_negative_colors
from .classes import ClassTable, class_table
from .statistics import finite_or_none
from .tiles import of_packed_texels, of_texels
from .tolerances import Kind

MOST_GROUPS = 8
"""Where all classes of a material have no bound together: groups that are bounded apart."""


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
            classes += _bounded(form, table, channel, found, MOST_BOXES // len(forms), steps)
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
    """Groups that hold the whole table; more than one where some classes have no bound together.

    Raises:
        NoBound: where even a group that cannot be split any more has no bound, or there are too many.
    """
    waiting, classes, whole = [np.arange(len(table))], [], int(table.items.sum())
    while waiting:
        chosen = waiting.pop()
        before, items = sum(each.items for each in classes), int(table.items[chosen].sum())
        steps = lambda done, before=before, items=items: progress((before + done * items) / whole)  # noqa: E731
        try:
            group = _group(table, chosen)
            bounds = upper_bounds(form, group, found, most, steps)
            classes.append(BoundedClass(group.texels, items, channel, bounds))
        except NoBound:
            halves = table.halves(chosen)
            if halves is None or len(classes) + len(waiting) + 2 > MOST_GROUPS:
                raise
            waiting += halves[::-1]
    return classes


def _group(table: ClassTable, chosen: np.ndarray) -> Group:
    """Some classes of the table, to be taken apart as the table is."""

    def halves() -> tuple[Group, Group] | None:
        parts = table.halves(chosen)
        return None if parts is None else (_group(table, parts[0]), _group(table, parts[1]))

    return Group(table.merged(chosen), halves)
