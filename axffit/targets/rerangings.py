"""Re-rangings that only some engines use; those of the specification are in `textures.rerange`."""

from dataclasses import dataclass

import numpy as np

from ..axf.ranges import DEFAULT_IOR
from ..textures.rerange import Counts, Reranging, texels

_HALF_MAXIMUM = 65504.0


def _excess(beyond: np.ndarray) -> float:
    return float(np.nanmax(beyond, initial=0.0))


@dataclass(frozen=True)
class Gamma(Reranging):
    """x^(1/g): a linear color in [0, 1] to a plain power curve, g = 2.2; negative values count as 0."""

    exponent: float = 2.2

    @property
    def formula(self) -> str:
        """The power."""
        return f"x^(1/{self.exponent:g})"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """max(0, x)^(1/g); NaN stays NaN."""
        return np.maximum(np.asarray(values, np.float64), 0.0) ** (1.0 / self.exponent)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """x^g."""
        return np.maximum(np.asarray(values, np.float64), 0.0) ** self.exponent


@dataclass(frozen=True)
class PositiveAngle(Reranging):
    """x / 2 pi of an angle in radians, a negative one first increased by 2 pi: the whole turn on [0, 1]."""

    @property
    def formula(self) -> str:
        """The turn."""
        return "(x < 0: x + 2 pi) / (2 pi)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """The angle's part of a whole turn, in [0, 1); NaN and infinities give NaN."""
        with np.errstate(invalid="ignore"):
            return np.mod(np.asarray(values, np.float64), 2 * np.pi) / (2 * np.pi)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """The angle in [-pi, pi), as AxF has it."""
        angle = 2 * np.pi * np.asarray(values, np.float64)
        return np.where(angle >= np.pi, angle - 2 * np.pi, angle)

    def count(self, values: np.ndarray) -> Counts:
        """Angles outside [-pi, pi], which a whole turn brings back."""
        # float32's pi exceeds pi by 8.7e-8; such an angle is meant to be pi.
        return Counts(wrapped=texels(~(np.abs(np.asarray(values, np.float64)) <= np.pi * (1 + 2.0**-24))))


@dataclass(frozen=True)
class ThroughHalf(Reranging):
    """x rounded to half precision on the way: an importer that reads every texture as half first."""

    @property
    def formula(self) -> str:
        """The rounding."""
        return "half(x)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """The nearest half; beyond 65504 it is clamped."""
        held = np.clip(np.asarray(values, np.float64), -_HALF_MAXIMUM, _HALF_MAXIMUM)
        return held.astype(np.float16).astype(np.float64)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """x: what was rounded is lost."""
        return np.asarray(values, np.float64)

    def count(self, values: np.ndarray) -> Counts:
        """Texels beyond the range of a half."""
        beyond = np.abs(np.asarray(values, np.float64)) - _HALF_MAXIMUM
        return Counts(clamped=texels(beyond > 0), excess=_excess(np.maximum(beyond, 0.0)))


@dataclass(frozen=True)
class ChannelScale(Reranging):
    """x / s with one scale a channel.

    Attributes:
        scales: s, positive; a map of one channel uses the first.
    """

    scales: tuple[float, ...]

    @property
    def formula(self) -> str:
        """The division."""
        return f"x / ({', '.join(f'{scale:.9g}' for scale in self.scales)})"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """x / s."""
        values = np.asarray(values, np.float64)
        return values / self.scales[: values.shape[-1]]

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """s x."""
        values = np.asarray(values, np.float64)
        return values * self.scales[: values.shape[-1]]


@dataclass(frozen=True)
class TwoComponents(Reranging):
    """0.5 (n_xy + 1) of the unit vector along n, whose z the shader rebuilds: z = sqrt(1 - x² - y²).

    A normal that points below the surface comes back above it: folded.
    """

    @property
    def formula(self) -> str:
        """The offset of two components."""
        return "0.5 (n_xy + 1), z = sqrt(1 - x² - y²)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """Two of three components [..., 3] -> [..., 2]."""
        values = np.asarray(values, np.float64)
        length = np.linalg.norm(values, axis=-1, keepdims=True)
        return 0.5 * (values[..., :2] / np.where(length > 0, length, 1.0) + 1.0)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """The unit vector [..., 2] -> [..., 3]; where x² + y² > 1, z is 0."""
        xy = 2.0 * np.asarray(values, np.float64)[..., :2] - 1.0
        z = np.sqrt(np.maximum(1.0 - np.sum(xy * xy, axis=-1, keepdims=True), 0.0))
        return np.concatenate([xy, z], axis=-1)

    def count(self, values: np.ndarray) -> Counts:
        """Normals below the surface."""
        return Counts(folded=texels(np.asarray(values)[..., 2:] < 0))


@dataclass(frozen=True)
class AtLeast(Reranging):
    """max(x, lowest), when written and when read.

    Attributes:
        lowest: the smallest value the shader works with.
    """

    lowest: float

    @property
    def formula(self) -> str:
        """The floor."""
        return f"max({self.lowest:.6g}, x)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """max(x, lowest); NaN stays NaN."""
        return np.maximum(np.asarray(values, np.float64), self.lowest)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """max(x, lowest)."""
        return self.forward(values)

    def count(self, values: np.ndarray) -> Counts:
        """Texels below, and how far."""
        below = self.lowest - np.asarray(values, np.float64)
        return Counts(clamped=texels(below > 0), excess=_excess(np.maximum(below, 0.0)))


@dataclass(frozen=True)
class FlippedNormal(Reranging):
    """0.5 (n + 1) of the unit vector along n with y negated: normal maps whose green runs downward."""

    @property
    def formula(self) -> str:
        """Offset and flip."""
        return "0.5 ((x, -y, z) / |n| + 1)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """The unit vector, flipped, in [0, 1]."""
        values = np.asarray(values, np.float64)
        length = np.linalg.norm(values, axis=-1, keepdims=True)
        return 0.5 * (_flipped(values) / np.where(length > 0, length, 1.0) + 1.0)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """2 x - 1, flipped back."""
        return _flipped(2.0 * np.asarray(values, np.float64) - 1.0)


def _flipped(vectors: np.ndarray) -> np.ndarray:
    return vectors * np.array([1.0, -1.0, 1.0])


@dataclass(frozen=True)
class UsableIor(Reranging):
    """An index of refraction as it is; 1.5 where it is NaN or not positive."""

    @property
    def formula(self) -> str:
        """The replacement."""
        return "x > 0: x, otherwise 1.5"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """n, or 1.5."""
        values = np.asarray(values, np.float64)
        return np.where(values > 0, values, DEFAULT_IOR)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """n."""
        return np.asarray(values, np.float64)

    def count(self, values: np.ndarray) -> Counts:
        """Texels that became 1.5."""
        return Counts(replaced=texels(~(np.asarray(values) > 0)))


@dataclass(frozen=True)
class ThroughRgbe(Reranging):
    """x held as RGBE on the way: 8 bits a channel below one common exponent (Ward, Graphics Gems II, 1991).

    With 2^(e-1) <= max < 2^e, each channel is floor(256 x / 2^e) / 256 · 2^e: it loses less than 2^-7 of the largest.
    """

    @property
    def formula(self) -> str:
        """The rounding."""
        return "RGBE(x)"

    def forward(self, values: np.ndarray) -> np.ndarray:
        """The numbers RGBE holds, never above x; below 1e-32 it holds 0."""
        values = np.maximum(np.asarray(values, np.float64), 0.0)
        largest = values.max(axis=-1, keepdims=True)
        step = np.ldexp(1.0, np.frexp(largest)[1] - 8)
        return np.where(largest >= 1e-32, np.floor(values / step) * step, 0.0)

    def inverse(self, values: np.ndarray) -> np.ndarray:
        """x: what was rounded is lost."""
        return np.asarray(values, np.float64)
