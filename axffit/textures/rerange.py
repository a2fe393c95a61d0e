"""Re-rangings: what a target does to AxF's values before a format quantizes them, and how its shader undoes that.

Each has ``forward`` (AxF -> target) and ``inverse`` (target -> AxF), both in float64 and on arrays of any shape, and
``count`` says how many texels (arrays [..., channels]) ``forward`` could not keep: nothing is clamped, wrapped or
replaced in silence.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields

import numpy as np

from ..axf.ranges import DEFAULT_IOR
from ..errors import InputError


@dataclass(frozen=True)
class Counts:
    """How many texels a re-ranging or a format could not keep as they were.

    Attributes:
        clamped: clamped to the legal range in any channel.
        wrapped: angles brought back by whole turns.
        replaced: texels that mean nothing (NaN or not positive, an index of refraction) and became a default.
        folded: texels that come back as others because the re-ranging is not one-to-one (n < 1 as 1/n, F0 = 1 as
            infinity).
        floored: roughness texels that decode below the floor (1e-4) of the models and are read as the floor.
        excess: how far the worst clamped value lay outside, in AxF's own unit.
    """

    clamped: int = 0
    wrapped: int = 0
    replaced: int = 0
    folded: int = 0
    floored: int = 0
    excess: float = 0.0

    def __add__(self, other: "Counts") -> "Counts":
        """Counts of both; the larger excess."""
        sums = {f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self) if f.name != "excess"}
        return Counts(**sums, excess=max(self.excess, other.excess))


def texels(where: np.ndarray) -> int:
    """How many texels have a marked channel; ``where`` is [..., channels] of booleans."""
    return int(np.count_nonzero(np.any(where, axis=-1)))


def _largest(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if finite.size else (np.inf if values.size else 0.0)


class Reranging(ABC):
    """A map from AxF's range to the target's and back."""

    @property
    @abstractmethod
    def formula(self) -> str:
        """The forward map in words of mathematics, for reports."""

    @abstractmethod
    def forward(self, values: np.ndarray) -> np.ndarray:
        """Target values of AxF values."""

    @abstractmethod
    def inverse(self, values: np.ndarray) -> np.ndarray:
        """AxF values of target values: what the shader computes."""

    def count(self, values: np.ndarray) -> Counts:
        """What ``forward`` cannot keep of these AxF values."""
        return Counts()


@dataclass(frozen=True)
class Identity(Reranging):
    """Values as they are."""

    @property
    def formula(self) -> str:
        """Nothing changes."""
        return "x"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """x."""
        return np.asarray(values, dtype=np.float64)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """x."""
        return np.asarray(values, dtype=np.float64)


@dataclass(frozen=True)
class ClampNegative(Reranging):
    """max(0, x): AxF colors do contain negative values, and the target wants none."""

    @property
    def formula(self) -> str:
        """The clamp."""
        return "max(0, x)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """max(0, x); NaN stays NaN."""
        return np.maximum(np.asarray(values, dtype=np.float64), 0.0)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """x: what was clamped is lost."""
        return np.asarray(values, dtype=np.float64)

    def count(self, values: np.ndarray) -> Counts:
        """Texels with a negative value, and how negative."""
        values = np.asarray(values)
        negative = values < 0
        return Counts(clamped=texels(negative), excess=_largest(-values[negative].astype(np.float64)))


@dataclass(frozen=True)
class UnitOffset(Reranging):
    """0.5 (x + 1): components of normals from [-1, 1] to [0, 1]."""

    @property
    def formula(self) -> str:
        """The offset."""
        return "0.5 (x + 1)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """0.5 (clamp(x, -1, 1) + 1); NaN stays NaN."""
        return 0.5 * (np.clip(np.asarray(values, dtype=np.float64), -1.0, 1.0) + 1.0)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """2 x - 1."""
        return 2.0 * np.asarray(values, dtype=np.float64) - 1.0

    def count(self, values: np.ndarray) -> Counts:
        """Texels with a component outside [-1, 1]; one float32 rounding of a unit component is none."""
        excess = np.abs(np.asarray(values, dtype=np.float64)) - 1.0
        outside = excess > 2.0**-23
        return Counts(clamped=texels(outside), excess=_largest(excess[outside]))


@dataclass(frozen=True)
class SignedAngle(Reranging):
    """0.5 (1 + x / r): angles from [-r, r] radians to [0, 1]; r = pi as the specification has it.

    Angles outside are brought back by whole periods 2 r (an anisotropy axis is the same after a half turn, so r = pi
    and r = pi/2 both keep the axis). Angle 0 becomes 0.5, which no UNORM format holds.
    """

    half_range: float = float(np.pi)

    @property
    def formula(self) -> str:
        """The offset and scale."""
        half = {np.pi: "pi", np.pi / 2: "(pi/2)"}.get(self.half_range, f"{self.half_range:.6g}")
        return f"0.5 (1 + x / {half})"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """0.5 (1 + x / r) of the angle brought back into [-r, r]; NaN and infinities give NaN."""
        values = np.asarray(values, dtype=np.float64)
        with np.errstate(invalid="ignore"):
            wrapped = np.mod(values + self.half_range, 2 * self.half_range) - self.half_range
        return 0.5 * (1.0 + np.where(self._outside(values), wrapped, values) / self.half_range).clip(0.0, 2.0)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """r (2 x - 1)."""
        return self.half_range * (2.0 * np.asarray(values, dtype=np.float64) - 1.0)

    def count(self, values: np.ndarray) -> Counts:
        """Angles outside [-r, r]."""
        return Counts(wrapped=texels(self._outside(np.asarray(values, dtype=np.float64))))

    def _outside(self, values: np.ndarray) -> np.ndarray:
        # float32's pi exceeds pi by 8.7e-8; such an angle is meant to be pi.
        return ~(np.abs(values) <= self.half_range * (1 + 2.0**-24))


@dataclass(frozen=True)
class IorToF0(Reranging):
    """F0 = ((n - 1) / (n + 1))²: an index of refraction in [0, inf[ to [0, 1].

    NaN and n <= 0 take 1.5. The map is not one-to-one: 1/n gives the F0 of n, so n < 1 comes back as 1/n, and F0 = 1
    comes back as infinity.
    """

    @property
    def formula(self) -> str:
        """The reflectance at normal incidence."""
        return "((x - 1) / (x + 1))²"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """F0 of n; 0.04 where n is NaN or not positive."""
        values = np.asarray(values, dtype=np.float64)
        usable = np.where(values > 0, values, DEFAULT_IOR)
        # 1 - 2 / (n + 1) has no inf - inf at n = infinity.
        return (1.0 - 2.0 / (usable + 1.0)) ** 2

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """n = (1 + sqrt F0) / (1 - sqrt F0), infinity from F0 = 1 on."""
        root = np.sqrt(np.maximum(np.asarray(values, dtype=np.float64), 0.0))
        below = root < 1.0
        return np.where(below, (1.0 + root) / np.where(below, 1.0 - root, 1.0), np.inf)

    def count(self, values: np.ndarray) -> Counts:
        """NaN and n <= 0 as replaced; n < 1 and F0 = 1 as folded."""
        values = np.asarray(values)
        usable = values > 0
        folded = usable & ((values < 1) | (self.forward(values) >= 1.0))
        return Counts(replaced=texels(~usable), folded=texels(folded))


@dataclass(frozen=True)
class Scale(Reranging):
    """x / s: values with a known maximum to [0, 1] for integer formats; s = 1 for float formats.

    Raises:
        InputError: s is not a positive finite number.
    """

    scale: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise InputError(f"scale {self.scale!r} is not positive and finite; give the map's maximum, or 1")

    @property
    def formula(self) -> str:
        """The division."""
        return f"x / {self.scale:.9g}"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """x / s."""
        return np.asarray(values, dtype=np.float64) / self.scale

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """s x."""
        return np.asarray(values, dtype=np.float64) * self.scale


@dataclass(frozen=True)
class Chain(Reranging):
    """Several re-rangings one after the other, the first on AxF's side."""

    steps: tuple[Reranging, ...]

    @property
    def formula(self) -> str:
        """Each formula, the next with x standing for the last."""
        return ", then ".join(step.formula for step in self.steps if not isinstance(step, Identity)) or "x"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """The steps in order."""
        for step in self.steps:
            values = step.forward(values)
        return values

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """The inverses in reverse order."""
        for step in reversed(self.steps):
            values = step.inverse(values)
        return values

    def count(self, values: np.ndarray) -> Counts:
        """What all steps together cannot keep."""
        counts = Counts()
        for step in self.steps:
            counts += step.count(values)
            values = step.forward(values)
        return counts


@dataclass(frozen=True)
class SliceIndex(Reranging):
    """k / 255: an integer index in an 8-bit UNORM texel; the shader rounds 255 x.

    Raises:
        InputError: from ``forward``, for an index that is no whole number in 0..255 (it would wrap or be clamped).
    """

    @property
    def formula(self) -> str:
        """The division."""
        return "x / 255"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """k / 255."""
        values = np.asarray(values, dtype=np.float64)
        bad = ~((values >= 0) & (values <= 255) & (np.trunc(values) == values))
        if np.any(bad):
            position = int(np.flatnonzero(bad)[0])
            raise InputError(
                f"slice index {values[bad][0]:g} at entry {position} does not fit 8 bits; "
                "give whole numbers from 0 to 255 (a table for at most 256 slices)"
            )
        return values / 255.0

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """round(255 x)."""
        return np.rint(255.0 * np.asarray(values, dtype=np.float64))
