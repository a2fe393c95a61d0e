"""A class of texels: what quantization does to one channel of a material's parameters, as a box."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from ..directions import LOWEST

Range = tuple[float, float]
"""Smallest and largest value."""

LARGEST_TILT = 0.9 * float(np.arcsin(LOWEST))
"""The normal's error stays below the 1° that views and lights keep from the horizon (radians)."""

HALF = 2.0**-11
"""Relative error of half precision, to nearest."""

UNORM16_NORMAL = float(np.arcsin(3**0.5 / 65535))
"""Largest error of a normal in RGBA16_UNORM, to nearest (radians)."""

_ALLOWED: dict[str, Range] = {
    "roughness": (1e-4, 2.0**16),
    "roughness_ratio": (0.5, 2.0),
    "roughness_y": (1e-4, 2.0**16),
    "roughness_y_ratio": (0.5, 2.0),
    "f0": (0.0, 1.0),
    "f0_change": (-1.0, 1.0),
    "specular": (0.0, np.inf),
    "specular_ratio": (0.0, 2.0),
    "diffuse": (0.0, np.inf),
    "diffuse_ratio": (0.0, 2.0),
    "gap": (0.0, np.pi / 2),
    "gap_azimuth": (-2 * np.pi, 2 * np.pi),
    "ior": (1.0, 4.0),
    "ior_change": (-1.0, 1.0),
}


@dataclass(frozen=True)
class TexelClass:
    """Texels whose parameters and errors, in one color channel, lie in a box; a bound holds for every one of them.

    Fields that a `Form` does not use are ignored. Ranges before are those of the original; a change or a ratio says
    what the shader sees instead. Angles in radians.

    Attributes:
        tilt: largest angle between the base's normals before and after; every angle up to it belongs to the class.
        roughness: alpha, along the lobe's x axis where there are two; the exponent for Blinn-Phong and Phong.
        roughness_ratio: roughness after over before, in [0.5, 2].
        f0: reflectance at normal incidence, in [0, 1]; (1, 1) without Fresnel.
        f0_change: F0' - F0, with F0' >= 0.
        roughness_y: along the lobe's y axis; None for an isotropic lobe.
        roughness_y_ratio: as `roughness_ratio`.
        twist: largest turn of the lobe's axes about the normal, what tilting the frame brings with it included.
        specular: specular color.
        specular_ratio: after over before.
        diffuse: diffuse color; (0, 0) where there is none.
        diffuse_ratio: after over before.
        coat_tilt: largest angle between the coat's normals before and after.
        gap: angle between the coat's and the base's normal.
        gap_azimuth: azimuth of the coat's normal in the lobe's own axes about the base's normal.
        ior: the coat's index of refraction.
        ior_change: n' - n.

    Raises:
        ValueError: a range that is empty or outside what is allowed.
    """

    tilt: float
    roughness: Range = (1.0, 1.0)
    roughness_ratio: Range = (1.0, 1.0)
    f0: Range = (1.0, 1.0)
    f0_change: Range = (0.0, 0.0)
    roughness_y: Range | None = None
    roughness_y_ratio: Range = (1.0, 1.0)
    twist: float = 0.0
    specular: Range = (1.0, 1.0)
    specular_ratio: Range = (1.0, 1.0)
    diffuse: Range = (0.0, 0.0)
    diffuse_ratio: Range = (1.0, 1.0)
    coat_tilt: float = 0.0
    gap: Range = (0.0, 0.0)
    gap_azimuth: Range = (0.0, 0.0)
    ior: Range = (1.5, 1.5)
    ior_change: Range = (0.0, 0.0)

    def __post_init__(self):
        for name, (least, most) in _ALLOWED.items():
            if getattr(self, name) is None:
                continue
            low, high = getattr(self, name)
            if not least <= low <= high <= most:
                raise ValueError(
                    f"{name}=({low}, {high}): give a smallest and a largest value within [{least}, {most}]"
                )
        for name in ("tilt", "twist", "coat_tilt"):
            angle = getattr(self, name)
            if not 0 <= angle <= LARGEST_TILT:
                raise ValueError(
                    f"{name}={angle}: allowed are 0 to {LARGEST_TILT:.4f} radians; bound larger ones apart"
                )
        if self.f0[0] + self.f0_change[0] < 0:
            raise ValueError(f"f0={self.f0} and f0_change={self.f0_change}: F0 may not fall below 0")
        if self.ior[0] + self.ior_change[0] < 1:
            raise ValueError(f"ior={self.ior} and ior_change={self.ior_change}: n may not fall below 1")


def hull(classes: Sequence[TexelClass]) -> TexelClass:
    """The smallest class that holds all of some, which are all isotropic or all not."""
    merged = {}
    for field in fields(TexelClass):
        values = [getattr(one, field.name) for one in classes]
        if values[0] is None:
            merged[field.name] = None
        elif isinstance(values[0], float | int):
            merged[field.name] = max(values)
        else:
            merged[field.name] = (min(low for low, _ in values), max(high for _, high in values))
    return TexelClass(**merged)


def advised(roughness: float, f0: float = 1.0) -> TexelClass:
    """The errors of the advised formats, RGBA16_UNORM normals and half precision, at one roughness and F0."""
    change = f0 * HALF if f0 < 1 else 0.0
    return TexelClass(UNORM16_NORMAL, (roughness, roughness), (1 - HALF, 1 + HALF), (f0, f0), (-change, change))
