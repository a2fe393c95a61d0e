"""What went wrong where a texture is outside its tolerance: known faults of packers, compared by residual.

Each hypothesis predicts the codes a packer with that fault writes for AxF's texels. Its residual is the mean number of
wrong low bits a code, log2(1 + |code - predicted code|) with the codes of floats in the order of their numbers; so a
residual means the same in every format, and no single texel rules it. A fault is named only where

    residual as the target reads it  >=  FACTOR (residual of the fault + NOISE).

Of several that pass the smallest residual counts; others within NOISE of it cannot be told apart on this texture and
are listed beside it. One fault a texture is assumed: two at once stay unnamed unless one of them explains nearly all.
Negative colors need no hypothesis: what the target clamps is counted in AxF and in the codes.
"""

from collections.abc import Collection, Iterator
from dataclasses import asdict, dataclass
from types import ModuleType
from typing import Any

import numpy as np

from ..axf import AxfMaterial
from ..targets import PackedMaterial, PackedTexture, target_named
from ..targets.encoding import blocks, decode_rows
from ..textures import NumberFormat
from ..textures.rerange import Reranging
from .hypotheses import Evidence, Hypothesis, hypotheses, wrong_bits
from .measures import COLORS

FACTOR = 4.0
"""How many times better than the advised packing a fault must explain the codes to be named."""

NOISE = 0.01
"""Bits a code that count as nothing: what two programs' arithmetic may differ by."""


@dataclass(frozen=True)
class Fault:
    """A named fault of a texture.

    Attributes:
        fault: its name, one of `NAMES`.
        subject: the target's name of the texture or value concerned.
        message: what was done, what is right, how to mend it.
        residual: wrong bits a code that are left if the fault is assumed; None where texels were counted instead.
        advised: wrong bits a code if the texture was packed as the target reads it; None as above.
    """

    fault: str
    subject: str
    message: str
    residual: float | None = None
    advised: float | None = None

    def __str__(self) -> str:
        """Name, subject and message on one line."""
        return f"fault.{self.fault}: {self.subject}: {self.message}"

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return asdict(self)


NAMES = (
    "floor_rounding",
    "range_of_another_target",
    "channels_swapped",
    "rows_flipped",
    "srgb_curve",
    "scale_left_at_one",
    "wrong_scale",
    "mips_rebuilt",
    "lut_off_by_one",
    "negatives_let_through",
    "negatives_uncounted",
)
"""Every fault that has a name."""


def faults(
    material: AxfMaterial, packed: PackedMaterial, readable: Collection[str], outside: Collection[str]
) -> Iterator[Fault]:
    """The faults of a packed material that can be named.

    Args:
        material: the original.
        packed: what was packed, read by the target it was packed for.
        readable: the target's names of the textures whose shape and format fit.
        outside: those of them that are outside a tolerance.
    """
    module = target_named(packed.target)
    given = [packed.textures[name] for name in readable if not packed.textures[name].defaulted]
    for texture in given:
        if texture.axf_name in COLORS:
            yield from _negatives(material, texture, module, packed)
    suspects = [texture for texture in given if texture.name in outside]
    if not suspects:
        return
    # What the importer itself changes first is no fault of the packer.
    prepared = module.ENGINE.prepare(material).material
    for texture in suspects:
        yield from _named(Evidence(prepared, texture, module, packed.values))


def table_fault(wanted: np.ndarray, texture: PackedTexture, reading: Reranging) -> Fault | None:
    """The fault of a slice table whose entries are not those of AxF, if it has a name.

    Args:
        wanted: AxF's entries.
        texture: the table as packed.
        reading: how the target's shader reads it.
    """
    found = decode_rows(texture.levels[0], reading, texture.number_format, 1).reshape(-1)
    found, wanted = np.rint(found[: len(wanted)]).astype(np.int64), np.asarray(wanted, np.int64)
    if len(found) < len(wanted) or np.array_equal(found, wanted):
        return None
    advised = wrong_bits(found, wanted)
    shifted = {
        "every entry is one too large; subtract 1": [np.minimum(wanted + 1, 255), (wanted + 1) % 256],
        "every entry is one too small; add 1": [np.maximum(wanted - 1, 0), (wanted - 1) % 256],
        "every entry stands one bin too late; the first belongs to bin 0": [np.roll(wanted, 1), _moved(wanted, 1)],
        "every entry stands one bin too early; the first belongs to bin 0": [np.roll(wanted, -1), _moved(wanted, -1)],
    }
    residuals = {message: min(wrong_bits(found, each) for each in made) for message, made in shifted.items()}
    message, residual = min(residuals.items(), key=lambda pair: pair[1])
    if not _explains(residual, advised):
        return None
    return Fault("lut_off_by_one", texture.name, f"{message}{_bits(residual, advised)}", residual, advised)


def _moved(entries: np.ndarray, places: int) -> np.ndarray:
    """The entries some places later or earlier, 0 where none comes in."""
    moved = np.roll(entries, places)
    moved[:places] = 0 if places > 0 else moved[:places]
    moved[places:] = 0 if places < 0 else moved[places:]
    return moved


def _explains(residual: float, advised: float) -> bool:
    return advised >= FACTOR * (residual + NOISE)


def _bits(residual: float, advised: float) -> str:
    return f" (explains the codes to {residual:.2g} bits each; packed as advised they would be {advised:.2g} off)"


def _named(evidence: Evidence) -> Iterator[Fault]:
    """The hypothesis that explains a texture best, if any does so by `FACTOR`."""
    tried: list[tuple[float, float, Hypothesis]] = []
    for hypothesis in hypotheses(evidence):
        residual = min(wrong_bits(hypothesis.found, codes) for codes in hypothesis.predicted)
        advised = min(wrong_bits(hypothesis.found, codes) for codes in hypothesis.advised)
        if hypothesis.clamps or _explains(residual, advised):
            tried.append((residual, advised, hypothesis))
    if not tried:
        return
    residual, advised, best = min(tried, key=lambda entry: entry[0])
    others = {entry.fault for left, _, entry in tried if left <= residual + NOISE} - {best.fault}
    like = f"; on this texture the same as {' or '.join(sorted(others))}" if others else ""
    explained = "" if best.clamps else _bits(residual, advised)
    yield Fault(best.fault, best.subject, f"{best.message}{explained}{like}", residual, advised)


def _negatives(
    material: AxfMaterial, texture: PackedTexture, module: ModuleType, packed: PackedMaterial
) -> Iterator[Fault]:
    """Negative colors that reached the texture, or were clamped and are missing from its counts."""
    original = material.textures[texture.axf_name]
    form, channels = texture.number_format, min(texture.channels, original.channels)
    negative = through = 0
    for level, codes in zip(original.levels, texture.levels, strict=True):
        for (_, wanted), (_, rows) in zip(blocks(level), blocks(codes), strict=True):
            below = wanted[:, :channels] < 0
            negative += int(np.count_nonzero(np.any(wanted < 0, axis=-1)))
            through += int(np.count_nonzero(np.any(below & _is_negative(rows[:, :channels], form), axis=-1)))
    if through:
        yield Fault(
            "negatives_let_through",
            texture.name,
            f"{through} of {negative} texels that are negative in AxF are negative here, too; {module.NAME} wants "
            f"{module.reading(texture, packed.values).formula}: clamp them at 0 and count them",
        )
    elif texture.counts.clamped < negative:
        yield Fault(
            "negatives_uncounted",
            texture.name,
            f"{negative} texels are negative in AxF and clamped here, but counts.clamped is {texture.counts.clamped}; "
            "count every texel that is clamped",
        )


def _is_negative(codes: np.ndarray, form: NumberFormat) -> np.ndarray:
    if not (form.is_float and form.codecs[0].lowest < 0):
        return np.zeros(codes.shape, bool)
    highest = codes.dtype.type(1 << (form.codecs[0].bits - 1))
    return codes > highest
