"""What the pytest plugin checks on a material of the user's: the laws, and what a target makes of it."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import jax
import numpy as np

from axffit import axf
from axffit.errors import InputError
from axffit.targets import target_named
from axffit.testing import laws, packing
from axffit.testing.directions import Pairs, extreme_pairs, random_pairs
from axffit.testing.energy import demand_passive, gains, mean, passivity_report
from axffit.testing.negatives import negative_colors
from axffit.testing.places import Place, places

AWAY = 0.05
"""Smallest cosine of the pairs for laws that do not hold to the last digit near the horizon."""


class NotApplicable(Exception):
    """A check does not apply to a material; the message says why."""


@dataclass(frozen=True)
class Check:
    """One test of one material.

    Attributes:
        material: id of the material, made unique by the file's name where two files share it.
        name: name of the law, or of the target and what is checked there.
        run: does it: returns a line about what was measured (or None), raises ``AssertionError`` if it fails and
            ``NotApplicable`` if there is nothing to check.
    """

    material: str
    name: str
    run: Callable[[], str | None]

    @property
    def id(self) -> str:
        """What the test is called."""
        return f"{self.material}-{self.name}"


def checks_of(
    files: Sequence[str],
    *,
    materials: Sequence[str] = (),
    engines: Sequence[str] = (),
    texels: int = 8,
    strict: bool = False,
) -> tuple[Check, ...]:
    """All checks of the materials of some files.

    Args:
        files: paths of .axf files.
        materials: ids of the materials to check; empty for all.
        engines: names of targets to pack for.
        texels: places of a material drawn at random besides its extreme ones, >= 0.
        strict: whether a material with negative colors fails.

    Raises:
        InputError: a file cannot be read, a material or target is unknown, or a model is not evaluated.
    """
    if texels < 0:
        raise InputError(f"--axf-texels {texels}: give 0 or more")
    packers = [target_named(name) for name in engines]
    chosen = [(Path(file), material) for file in files for material in axf.read(file).materials]
    if materials:
        known = [material.id for _, material in chosen]
        for wanted in materials:
            if wanted not in known:
                raise InputError(f"{', '.join(files)}: no material {wanted!r}; there are: {', '.join(known)}")
        chosen = [(path, material) for path, material in chosen if material.id in materials]
    ids = [material.id for _, material in chosen]
    found: list[Check] = []
    for path, material in chosen:
        name = material.id if ids.count(material.id) == 1 else f"{path.stem}:{material.id}"
        found.extend(_law_checks(name, places(material, count=texels)))
        found.append(_negatives_check(name, material, strict=strict))
        for engine in packers:
            found.extend(_target_checks(name, material, engine))
    return tuple(found)


def _law_checks(material: str, where: tuple[Place, ...]) -> Iterator[Check]:
    for law in laws.LAWS:
        run = _check_passivity if law == "passivity" else lambda where, law=law: _check_law(law, where)
        yield Check(material, law, lambda run=run: run(where))


def _pairs(law: str) -> Iterator[Pairs]:
    """The directions on which a law is checked."""
    if law in ("finite", "horizon"):
        extreme = extreme_pairs()
        yield extreme
        if law == "finite":
            yield extreme[0].astype(np.float32), extreme[1].astype(np.float32)
    yield random_pairs(lowest=0.0 if law in ("non-negativity", "horizon", "finite") else AWAY)


@contextmanager
def _at(place: Place) -> Iterator[None]:
    """A law that is broken here says where."""
    try:
        yield
    except AssertionError as error:
        raise AssertionError(f"{error}, at {place.name}" if place.name else str(error)) from None


def _check_law(law: str, where: tuple[Place, ...]) -> None:
    """A law at every place of a material; double precision, whatever the process uses."""
    with jax.enable_x64(True):  # noqa: FBT003
        exempt = [laws.exemption(law, place.brdf) for place in where]
        if all(exempt):
            raise NotApplicable(exempt[0] if len(where) == 1 else f"nowhere: {exempt[0]}")
        for place, reason in zip(where, exempt, strict=True):
            if reason is None:
                with _at(place):
                    for wi, wo in _pairs(law):
                        laws.LAWS[law](place.brdf, wi, wo)


def _check_passivity(where: tuple[Place, ...]) -> str:
    """The law of the mean over the surface, and a line about the brightest place and viewer."""
    with jax.enable_x64(True):  # noqa: FBT003
        ((_, wo),) = _pairs("passivity")
        reports = [(passivity_report(place.brdf, wo), place) for place in where]
        lawful = next(filter(None, (gains(place.brdf) for place in where)), None)
    report, place = max(reports, key=lambda each: each[0].largest)
    if lawful is None:
        typical = [each for each, place in reports if not place.extreme] or [each for each, _ in reports]
        with _at(Place(f"the mean of {len(typical)} places" if len(typical) > 1 else "", place.brdf)):
            demand_passive(mean(typical))
    judged = f"; not enforced: {lawful}" if lawful else ""
    return f"{report}{f', at {place.name}' if place.name else ''}{judged}"


def _negatives_check(name: str, material: axf.AxfMaterial, *, strict: bool) -> Check:
    def run() -> str | None:
        found = negative_colors(material)
        assert not (strict and found), f"negative-colors: {found}"
        return f"negative colors, read as 0: {found}" if found else None

    return Check(name, "negative-colors", run)


def _target_checks(name: str, material: axf.AxfMaterial, target: ModuleType) -> Iterator[Check]:
    for what, run in packing.checks(material, target):
        yield Check(name, f"{target.NAME}-{what}", run)
