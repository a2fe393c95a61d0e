"""A class of texels: what quantization does to an isotropic lobe, as a box in parameter space."""

from dataclasses import dataclass

import numpy as np

from ..directions import LOWEST

Range = tuple[float, float]
"""Smallest and largest value."""

LARGEST_TILT = 0.9 * float(np.arcsin(LOWEST))
"""The normal's error stays below the 1° that views and lights keep from the horizon (radians)."""

LARGEST_ROUGHNESS = 1.01
"""Of alpha', which rounding may move above 1."""

HALF = 2.0**-11
"""Relative error of half precision, to nearest."""

UNORM16_NORMAL = float(np.arcsin(3**0.5 / 65535))
"""Largest error of a normal in RGBA16_UNORM, to nearest (radians)."""


@dataclass(frozen=True)
class TexelClass:
    """Texels whose parameters and errors lie in a box; a bound holds for every one of them.

    Attributes:
        tilt: largest angle between the normals before and after (radians); every angle up to it belongs to the class.
        roughness: alpha, in [1e-4, 1].
        roughness_ratio: alpha' / alpha, in [0.5, 2].
        f0: reflectance at normal incidence, in (0, 1]; (1, 1) without Fresnel.
        f0_change: F0' - F0, with F0' > 0.

    Raises:
        ValueError: a range that is empty or outside what is allowed.
    """

    tilt: float
    roughness: Range
    roughness_ratio: Range = (1.0, 1.0)
    f0: Range = (1.0, 1.0)
    f0_change: Range = (0.0, 0.0)

    def __post_init__(self):
        allowed = {"roughness": (1e-4, 1.0), "roughness_ratio": (0.5, 2.0), "f0": (2.0**-24, 1.0), "f0_change": (-1, 1)}
        for name, (least, most) in allowed.items():
            low, high = getattr(self, name)
            if not least <= low <= high <= most:
                raise ValueError(
                    f"{name}=({low}, {high}): give a smallest and a largest value within [{least}, {most}]"
                )
        if not 0 <= self.tilt <= LARGEST_TILT:
            raise ValueError(f"tilt={self.tilt}: allowed are 0 to {LARGEST_TILT:.4f} radians; bound larger ones apart")
        if self.roughness[1] * self.roughness_ratio[1] > LARGEST_ROUGHNESS:
            raise ValueError(f"roughness={self.roughness}, roughness_ratio={self.roughness_ratio}: alpha' exceeds 1.01")
        if self.f0[0] + self.f0_change[0] <= 0:
            raise ValueError(f"f0={self.f0} and f0_change={self.f0_change}: F0 may not fall to 0 or below")


def advised(roughness: float, f0: float = 1.0) -> TexelClass:
    """The errors of the advised formats, RGBA16_UNORM normals and half precision, at one roughness and F0."""
    change = f0 * HALF if f0 < 1 else 0.0
    return TexelClass(UNORM16_NORMAL, (roughness, roughness), (1 - HALF, 1 + HALF), (f0, f0), (-change, change))
