"""What packers with a known fault would have written: predicted codes, for `diagnosis` to compare with those found."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np

from ..axf import AxfMaterial, AxfTexture
from ..targets import TARGETS, PackedTexture
from ..targets.encoding import spread
from ..targets.table import FormatChoice
from ..textures import NumberFormat
from ..textures.rerange import Chain, Reranging, SignedAngle
from ..textures.unorm import linear_to_srgb, srgb_to_linear

SAMPLE_TEXELS = 2**14
"""About so many texels of each level are compared, evenly spread."""

MIP_TEXELS = 256
"""Texels along each side of the corner of level 0 whose rebuilt mip levels are compared."""

MIP_SLICES = 8
"""At least so many slices of an array are compared, where it has so many."""

Codes = np.ndarray
"""Codes in the order of the numbers they stand for, [n, channels] int64 (`ranks`)."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One fault a packer may have.

    Attributes:
        fault: its name (`diagnosis.NAMES`).
        subject: the target's name of the texture or value concerned.
        message: what was done and how to mend it.
        found: the codes.
        predicted: the codes with the fault, one array for each way to have it.
        advised: the codes of a packer without it, one array for each way to round.
        clamps: whether the fault shows in AxF's values alone, and the codes are those a shader expects.
    """

    fault: str
    subject: str
    message: str
    found: Codes
    predicted: tuple[Codes, ...]
    advised: tuple[Codes, ...]
    clamps: bool = False


def ranks(codes: np.ndarray, form: NumberFormat) -> Codes:
    """Codes in the order of their numbers: those of negative floats negated."""
    codes = codes.astype(np.int64)
    if not (form.is_float and form.codecs[0].lowest < 0):
        return codes
    sign = np.int64(1) << (form.codecs[0].bits - 1)
    return np.where(codes >= sign, sign - codes, codes)


def wrong_bits(found: Codes, predicted: Codes) -> float:
    """Mean of log2(1 + |found - predicted|): how many low bits of a code are wrong."""
    return float(np.mean(np.log2(1.0 + np.abs(found - predicted))))


@dataclass(frozen=True, eq=False)
class Evidence:
    """A texture, AxF's map it was made from, and how the target reads it.

    Attributes:
        material: the material as the importer changes it before it packs.
        texture: the packed texture.
        module: the target.
        values: the packed values.
    """

    material: AxfMaterial
    texture: PackedTexture
    module: ModuleType
    values: Mapping[str, Any]

    @property
    def original(self) -> AxfTexture:
        """AxF's map."""
        return self.material.textures[self.texture.axf_name]

    @property
    def form(self) -> NumberFormat:
        """The number format."""
        return self.texture.number_format

    @property
    def roundings(self) -> tuple[str, ...]:
        """How a packer without fault may round: to the nearest, or as the importer does."""
        return tuple(dict.fromkeys((self.module.ENGINE.rounding, "nearest_even")))

    @property
    def scale(self) -> tuple[str, Any] | None:
        """Name and value of what the texture is divided by, or None."""
        return self.module.scale_of(self.texture, self.values)

    @property
    def bare(self) -> Reranging:
        """How the shader reads the texture where its scale is 1."""
        return (
            self.reading() if self.scale is None else self.reading(**{self.scale[0]: np.ones(np.shape(self.scale[1]))})
        )

    def reading(self, **values: Any) -> Reranging:
        """How the shader reads the texture, with some values changed."""
        return self.module.reading(self.texture, {**self.values, **values})

    @cached_property
    def found(self) -> Codes:
        """The codes at the sampled texels."""
        return ranks(self._sampled(self.texture.levels)[..., : self.texture.channels], self.form)

    @cached_property
    def wanted(self) -> np.ndarray:
        """AxF's values at the sampled texels, [n, channels]."""
        return self._sampled(self.original.levels).astype(np.float64)

    @cached_property
    def flipped(self) -> np.ndarray:
        """The same with the rows of every level upside down."""
        return self._sampled([level[..., ::-1, :, :] for level in self.original.levels]).astype(np.float64)

    @cached_property
    def advised(self) -> tuple[Codes, ...]:
        """The codes a packer without fault writes."""
        return tuple(self.encoded(self.reading().forward(self.wanted), rounding) for rounding in self.roundings)

    def encoded(self, stored: np.ndarray, rounding: str = "nearest_even") -> Codes:
        """Codes of numbers in the texture's range, clamped to the format's."""
        lowest = np.array([codec.lowest for codec in self.form.codecs])
        highest = np.array([codec.highest for codec in self.form.codecs])
        numbers = np.clip(spread(stored[..., : self.form.channels], self.form.channels), lowest, highest)
        return ranks(self.form.encode(numbers, rounding)[..., : self.texture.channels], self.form)

    def _sampled(self, levels: Any) -> np.ndarray:
        return np.concatenate([_spread_texels(level) for level in levels])


def _spread_texels(level: np.ndarray) -> np.ndarray:
    """About `SAMPLE_TEXELS` texels of a level, [n, channels]."""
    step = max(1, int(np.ceil(np.sqrt(level[..., 0].size / SAMPLE_TEXELS))))
    return level[..., ::step, ::step, :].reshape(-1, level.shape[-1])


def hypotheses(evidence: Evidence) -> Iterator[Hypothesis]:
    """Every fault a packer of this texture may have, the plainest first."""
    for makes in (_rounding, _channels, _rows, _curve, _scale, _mips, _ranges):
        yield from makes(evidence)


def _hypothesis(evidence: Evidence, fault: str, message: str, *predicted: Codes, **fields: Any) -> Hypothesis:
    given = {"subject": evidence.texture.name, "found": evidence.found, "advised": evidence.advised}
    return Hypothesis(**{**given, **fields}, fault=fault, message=message, predicted=predicted)


def _rounding(evidence: Evidence) -> Iterator[Hypothesis]:
    stored = evidence.reading().forward(evidence.wanted)
    codes = tuple(evidence.encoded(stored, rounding) for rounding in ("floor", "toward_zero"))
    yield _hypothesis(evidence, "floor_rounding", "its codes are rounded down; round to the nearest", *codes)


def _ranges(evidence: Evidence) -> Iterator[Hypothesis]:
    """Every other re-ranging any target has for the map; angles also by packers that clamp where others go round."""
    own, unscaled = evidence.reading().formula, evidence.bare.formula
    by_formula: dict[str, tuple[FormatChoice, dict[str, None]]] = {}
    for name, module in TARGETS.items():
        row = module.ENGINE.tables.row_of(evidence.texture.axf_name, evidence.material.kind)
        for choice in () if row is None else row.stored_choices(evidence.texture.channels):
            formula = Chain((choice.reranging, choice.curve)).formula
            if formula not in (own, unscaled):
                by_formula.setdefault(formula, (choice, {}))[1][name] = None
    for formula, (choice, names) in by_formula.items():
        made = [choice.curve.forward(choice.reranging.forward(evidence.wanted))]
        if isinstance(choice.reranging, SignedAngle):
            made.append(np.clip(0.5 * (1.0 + evidence.wanted / choice.reranging.half_range), 0.0, 1.0))
        message = (
            f"it is packed as {formula}, as for {' and '.join(names)}; {evidence.module.NAME} reads the inverse of "
            f"{own}"
        )
        yield _hypothesis(evidence, "range_of_another_target", message, *(evidence.encoded(each) for each in made))


_SWAPS = {"R and G": (1, 0, 2), "R and B": (2, 1, 0), "G and B": (0, 2, 1)}


def _channels(evidence: Evidence) -> Iterator[Hypothesis]:
    stored = evidence.reading().forward(evidence.wanted)
    if stored.shape[-1] < 2 or evidence.texture.channels < 2:
        return
    pairs = _SWAPS if stored.shape[-1] == 3 else {"R and G": (1, 0)}
    for pair, order in pairs.items():
        codes = evidence.encoded(stored[..., list(order)])
        yield _hypothesis(evidence, "channels_swapped", f"{pair} are swapped; swap them back", codes)


def _rows(evidence: Evidence) -> Iterator[Hypothesis]:
    codes = evidence.encoded(evidence.reading().forward(evidence.flipped))
    yield _hypothesis(evidence, "rows_flipped", "its rows stand upside down; row 0 is v = 0", codes)


_CURVES: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {
    "an sRGB curve is applied to its linear numbers; leave it out": linear_to_srgb,
    "its numbers went through the inverse of the sRGB curve; leave it out": srgb_to_linear,
}


def _curve(evidence: Evidence) -> Iterator[Hypothesis]:
    stored = evidence.reading().forward(evidence.wanted)
    for message, curve in _CURVES.items():
        yield _hypothesis(evidence, "srgb_curve", message, evidence.encoded(curve(stored)))


def _scale(evidence: Evidence) -> Iterator[Hypothesis]:
    """The texture is divided by something else than the value says, or not although it must be."""
    if evidence.scale is None:
        return
    name, value = evidence.scale
    largest = max(float(np.nanmax(level, initial=0.0)) for level in evidence.original.levels)
    left = bool(np.all(np.asarray(value) == 1.0))
    fault = "scale_left_at_one" if left else "wrong_scale"
    if np.ndim(value) == 0:
        divisors = [float(np.float32(largest)), _fitted(evidence), 1.0]
    else:
        tops = np.max([level.reshape(-1, level.shape[-1]).max(axis=0) for level in evidence.original.levels], axis=0)
        divisors = [
            np.ones(np.shape(value)),
            tuple(float(top) for top in np.maximum(np.resize(tops, np.shape(value)), 0.1)),
        ]
    for divisor in divisors:
        if not np.all(np.isfinite(divisor)) or np.any(np.asarray(divisor) <= 0) or np.all(divisor == value):
            continue
        codes = evidence.encoded(evidence.reading(**{name: divisor}).forward(evidence.wanted))
        shown = ", ".join(f"{number:.6g}" for number in np.atleast_1d(divisor))
        given = ", ".join(f"{number:.6g}" for number in np.atleast_1d(value))
        message = f"{evidence.texture.name} is divided by {shown}, but the value is {given}; give {shown}"
        yield _hypothesis(evidence, fault, message, codes, subject=name)
    if left and largest > 1.0 and not evidence.form.is_float:
        message = (
            f"{evidence.texture.name} reaches {largest:.6g} and is cut off at 1, as the value is 1; "
            f"divide it by {largest:.6g} and give that"
        )
        yield _hypothesis(evidence, fault, message, *evidence.advised, subject=name, clamps=True)


def _fitted(evidence: Evidence) -> float:
    """The divisor that explains the numbers found best, by least squares."""
    numbers = np.concatenate([_spread_texels(level) for level in evidence.texture.levels])
    stored = evidence.form.decode(numbers)[..., : evidence.texture.channels].astype(np.float64)
    meant = evidence.bare.forward(evidence.wanted)[..., : stored.shape[-1]]
    product = float(np.sum(meant * stored))
    return float(np.sum(meant * meant)) / product if product > 0 else np.nan


def _mips(evidence: Evidence) -> Iterator[Hypothesis]:
    """Levels averaged from the one before instead of AxF's own."""
    levels, originals = evidence.texture.levels, evidence.original.levels
    corner = [_corner(level, number) for number, level in enumerate(levels)]
    if len(levels) < 2 or not all(_halves(a, b) for a, b in zip(corner[:-1], corner[1:], strict=True)):
        return
    channels, form = evidence.texture.channels, evidence.form
    kept = [_corner(level, number) for number, level in enumerate(originals)][1:]
    found = np.concatenate([ranks(level.reshape(-1, level.shape[-1])[:, :channels], form) for level in corner[1:]])
    wanted = np.concatenate([level.reshape(-1, level.shape[-1]) for level in kept]).astype(np.float64)
    advised = tuple(evidence.encoded(evidence.reading().forward(wanted), each) for each in evidence.roundings)
    first = form.decode(corner[0])[..., :channels]
    coded = ranks(corner[0][..., :channels], form).astype(np.float64)
    averaged = evidence.encoded(_chain_of(first, len(kept), _average))
    in_codes = np.rint(_chain_of(coded, len(kept), _average)).astype(np.int64)
    picked = evidence.encoded(_chain_of(first, len(kept), lambda level: level[..., ::2, ::2, :]))
    message = "its mip levels are rebuilt from the finest one; keep those of AxF"
    yield _hypothesis(evidence, "mips_rebuilt", message, averaged, in_codes, picked, found=found, advised=advised)


def _corner(level: np.ndarray, number: int) -> np.ndarray:
    """The corner of a mip level, of an array of some slices."""
    side = max(1, MIP_TEXELS >> number)
    step = max(1, len(level) // MIP_SLICES) if level.ndim == 4 else 1
    return (level[::step] if level.ndim == 4 else level)[..., :side, :side, :]


def _halves(finer: np.ndarray, coarser: np.ndarray) -> bool:
    return all(a == 2 * b for a, b in zip(finer.shape[-3:-1], coarser.shape[-3:-1], strict=True))


def _average(level: np.ndarray) -> np.ndarray:
    """Means of 2 x 2 texels."""
    return (
        level[..., ::2, ::2, :] + level[..., 1::2, ::2, :] + level[..., ::2, 1::2, :] + level[..., 1::2, 1::2, :]
    ) / 4


def _chain_of(level: np.ndarray, count: int, coarser: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Texels [n, channels] of so many levels, each made from the one before."""
    made = []
    for _ in range(count):
        level = coarser(level)
        made.append(level.reshape(-1, level.shape[-1]))
    return np.concatenate(made)
