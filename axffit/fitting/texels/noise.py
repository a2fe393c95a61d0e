"""How noisy a pixel is: sigma² = (relative · value)² + floor²."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from axffit.errors import InputError


@dataclass(frozen=True)
class Noise:
    """What is known of the pixels' noise.

    Attributes:
        relative: standard deviation of a pixel as a share of its value.
        floor: standard deviation of a black pixel, in units of radiance over irradiance.
        known: whether the two are the noise itself; otherwise only its shape, and each texel's residuals say how
            large it is.
        saturation: pixels of this value or more are left out; None keeps all.

    Raises:
        InputError: negative, both zero, or not finite.
    """

    relative: float = 0.01
    floor: float = 1e-4
    known: bool = False
    saturation: float | None = None

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name, value in (("noise", self.relative), ("floor", self.floor)):
            if not (np.isfinite(value) and value >= 0):
                raise InputError(f"{name} of {value}: give a finite number of 0 or more")
        if self.floor == 0:
            raise InputError("floor of 0: a black pixel would count without end; give the noise of a black pixel")
        if self.saturation is not None and not self.saturation > 0:
            raise InputError(f"saturation of {self.saturation}: give a pixel value above 0")

    def usable(self, values: Float[np.ndarray, "..."]) -> np.ndarray:
        """Which values count: finite ones below saturation. Negative ones do: leaving them out would be a bias."""
        usable = np.isfinite(values)
        return usable if self.saturation is None else usable & (values < self.saturation)

    def precisions(self, expected: Float[np.ndarray, "..."], usable: np.ndarray) -> Float[np.ndarray, "..."]:
        """1 / sigma² at the expected values, 0 where a value does not count."""
        level = np.maximum(np.where(usable, expected, 0.0), 0.0)
        return usable / ((self.relative * level) ** 2 + self.floor**2)
