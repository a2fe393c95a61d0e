"""The representations of a material that a file of others holds over one pool of resources, and which is chosen.

AxF numbers resources (`Color`, `Color_1`, …) where several representations of a material share a pool. What each
representation consists of is not evidenced, so this is the rule, and what follows from it is listed as inferred:

1. Every number among the names of the textures, and no number, is a representation.
2. It has the textures of its number, and for the rest those of no number, else of the lowest number.
3. A car paint's properties or textures together with an SVBRDF's (`SpecularModel`, `DiffuseModel`) are two
   representations; the clear coat belongs to both.
4. A known string (type key, variant) belongs to the representation whose number it bears; without one to all.

Chosen is (`choose`) the one that is usable (every texture of legal channels), RGB rather than spectral, a car paint
rather than an SVBRDF, with the most textures, of the lowest number, in this order of weight.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from ..errors import InputError
from .gather import Candidate, Gathered
from .hdf5 import Leaf
from .material import MaterialKind
from .names import suffix

MAXIMUM_REPRESENTATIONS = 64
"""Representations of one material above which a file is refused."""

CAR_PAINT_MARKS = ("CT_diffuse", "CT_coeffs", "CT_F0s", "CT_spreads", "thetaFI_sliceLUT")
"""Properties that only a car paint has."""

_SVBRDF_MARKS = ("diffusecolor", "specularcolor", "specularlobe", "anisrotation")
_PAINT_KEYS = ("brdfcolors", "btfflakes")


@dataclass(frozen=True)
class Plan:
    """What one representation consists of.

    Attributes:
        number: its number as text, "" for none.
        kind: SVBRDF or car paint.
        candidates: its textures by canonical name.
        split: whether the other kind bears the same number.
    """

    number: str
    kind: MaterialKind
    candidates: dict[str, Candidate]
    split: bool = False

    @property
    def name(self) -> str:
        """How it is called: its number, with its kind where that is needed to tell two apart."""
        return " ".join(filter(None, (self.kind.value if self.split else "", self.number)))

    @property
    def order(self) -> tuple[int, int, int, int, int]:
        """Sorting key; the lowest is chosen."""
        each = self.candidates.values()
        return (
            sum(not candidate.is_legal for candidate in each),
            sum(candidate.is_spectrum for candidate in each),
            0 if self.kind is MaterialKind.CAR_PAINT else 1,
            -len(self.candidates),
            _place(self.number),
        )


def choose(gathered: Gathered) -> list[Plan]:
    """The representations of a material, the chosen one first.

    Raises:
        InputError: there are more than `MAXIMUM_REPRESENTATIONS`.
    """
    best: dict[str, dict[str, Candidate]] = {}
    for key, candidates in gathered.textures.items():
        of_key = best.setdefault(key, {})
        for candidate in sorted(candidates, key=lambda c: (not c.is_legal, c.node)):
            of_key.setdefault(candidate.suffix, candidate)
    numbers = sorted({number for of_key in best.values() for number in of_key} or {""}, key=_place)
    if len(numbers) > MAXIMUM_REPRESENTATIONS:
        raise InputError(
            f"material {gathered.group!r} has {len(numbers)} representations; "
            f"at most {MAXIMUM_REPRESENTATIONS} are read: split it"
        )
    plans = []
    for number in numbers:
        pool = {key: of_key.get(number) or of_key[min(of_key, key=_place)] for key, of_key in best.items()}
        plans += _by_kind(number, pool, paint_properties=any(mark in gathered.properties for mark in CAR_PAINT_MARKS))
    plans.sort(key=lambda plan: plan.order)
    return plans


def strings_of(gathered: Gathered, kind: str, number: str) -> list[tuple[str, Leaf]]:
    """The known strings of a kind that belong to a representation, those of its number first."""
    found = gathered.strings.get(kind, [])
    named = [(value, leaf) for value, leaf in found if suffix(leaf.parts[2:]) == number]
    return named + [(value, leaf) for value, leaf in found if number and not suffix(leaf.parts[2:])]


def unused(gathered: Gathered, plans: Iterable[Plan]) -> list[Candidate]:
    """The candidates that no representation has."""
    used = {id(candidate) for plan in plans for candidate in plan.candidates.values()}
    return [c for candidates in gathered.textures.values() for c in candidates if id(c) not in used]


def _place(number: str) -> int:
    return int(number or -1)


def _by_kind(number: str, pool: dict[str, Candidate], *, paint_properties: bool) -> list[Plan]:
    paint = paint_properties or any(key in pool for key in _PAINT_KEYS)
    svbrdf = any(key in pool for key in _SVBRDF_MARKS)
    if not (paint and svbrdf):
        return [Plan(number, MaterialKind.CAR_PAINT if paint else MaterialKind.SVBRDF, pool)]

    def coat(key: str) -> bool:
        return key.startswith("clearcoat")

    painted = {key: candidate for key, candidate in pool.items() if coat(key) or key in _PAINT_KEYS}
    rest = {key: candidate for key, candidate in pool.items() if key not in _PAINT_KEYS}
    return [
        Plan(number, MaterialKind.CAR_PAINT, painted, split=True),
        Plan(number, MaterialKind.SVBRDF, rest, split=True),
    ]
