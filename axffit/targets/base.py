"""What every target shares: packed textures and materials, and the problems a validation names."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from ..axf import MaterialKind
from ..textures import Counts, NumberFormat, format_named


@dataclass(frozen=True, eq=False)
class PackedTexture:
    """One texture as a GPU would hold it.

    Attributes:
        name: the target's name of the texture.
        axf_name: the canonical AxF name of what it was made from (a property's name for the slice table).
        format: name of the number format.
        rounding: how the encoder rounded.
        levels: codes of the mip levels, the finest first, [H, W, C] (arrays of slices: [D, H, W, C]).
        channels: how many of the format's channels carry data; the rest is padding.
        transform: the forward re-ranging as a formula, for people.
        counts: what could not be kept, in texels over all levels.
        defaulted: whether AxF had no such texture and this is the target's default color.
        width_mm: extent along u in millimeters, as in AxF.
        height_mm: extent along v in millimeters.
        source: the node of the file it came from.
    """

    name: str
    axf_name: str
    format: str
    rounding: str
    levels: tuple[np.ndarray, ...]
    channels: int
    transform: str = "x"
    counts: Counts = field(default_factory=Counts)
    defaulted: bool = False
    width_mm: float = 0.0
    height_mm: float = 0.0
    source: str = ""

    @property
    def number_format(self) -> NumberFormat:
        """The number format itself."""
        return format_named(self.format)

    @property
    def clamped(self) -> int:
        """Texels clamped to the target's range."""
        return self.counts.clamped

    @property
    def size_bytes(self) -> int:
        """Bytes of all levels on the GPU, uncompressed."""
        texels = sum(int(np.prod(level.shape[:-1])) for level in self.levels)
        return texels * self.number_format.bytes_per_texel


@dataclass(frozen=True, eq=False)
class PackedMaterial:
    """A material as a target receives it: textures and values under the target's own names.

    Attributes:
        target: name of the target.
        id: the AxF material's id.
        name: the AxF material's name.
        kind: SVBRDF or car paint (an engine has one shader for each).
        textures: target names to textures.
        values: target names to numbers: float, int, or a tuple of four floats.
        metadata: free text carried along.
        notes: what a person should know: what the target cannot express, what was assumed.
    """

    target: str
    id: str
    name: str
    kind: MaterialKind
    textures: Mapping[str, PackedTexture]
    values: Mapping[str, Any]
    metadata: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("textures", "values", "metadata"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))


@dataclass(frozen=True)
class Problem:
    """One broken obligation of a packed material.

    Attributes:
        obligation: short name of the rule, e.g. ``flags.bit1``.
        subject: the texture or value concerned.
        message: one line: what is wrong, what is required, how to mend it.
    """

    obligation: str
    subject: str
    message: str

    def __str__(self) -> str:
        """Rule, subject and message on one line."""
        return f"{self.obligation}: {self.subject}: {self.message}"
