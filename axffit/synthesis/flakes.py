"""Metallic flakes in a car paint: the stack of textures over the angles that AxF calls BTFflakes.

Each flake is a small mirror, tilted a little out of the surface. It flashes while the half vector comes within a few
degrees of its own normal: 6 to 7 degrees of theta_h from on to off, and none is tilted so far that it would flash
past theta_h = 45 degrees below the coat (AxF SDK).
"""

from dataclasses import dataclass, replace

import numpy as np

from .noise import Rng, normal_noise

BINS = 12
"""Bins of theta_h and of theta_d over [0, pi/2] in known files: num_thetaF, num_thetaI and max_thetaI."""

LUT_ENTRIES = 64

LAST_TILT = np.deg2rad(42.0)
"""No flake is tilted further: with half its lifetime it is dark again at 45 degrees."""


@dataclass(frozen=True)
class FlakeRecipe:
    """What the flakes of a paint are like.

    Attributes:
        density: flakes of all tilts per mm².
        diameter_mm: smallest and largest diameter; 10 to 60 micrometers in metallic paints.
        orientation_spread: standard deviation (radians) of the tilt about each of the two axes of the surface.
        color: mean linear RGB of the flakes, (3,), relative to ``strength``.
        strength: value of a typical flake in full flash, 1/sr.
        brightness_spread: standard deviation of the log of a flake's brightness.
        hue_spread: largest share by which a flake's color leaves the mean, towards red or towards blue.
        lifetime: change of theta_h (radians) over which a flake is brighter than half its maximum.
    """

    density: float = 780.0
    diameter_mm: tuple[float, float] = (0.033, 0.06)
    orientation_spread: float = float(np.deg2rad(11.0))
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    strength: float = 0.1
    brightness_spread: float = 0.7
    hue_spread: float = 0.35
    lifetime: float = float(np.deg2rad(6.5))

    def __post_init__(self) -> None:
        low, high = self.diameter_mm
        positive = (self.density, low, self.orientation_spread, self.lifetime)
        if not (all(value > 0 for value in positive) and low <= high and self.strength >= 0):
            raise ValueError(f"{self}: density, diameters, spread and lifetime are positive, the strength at least 0")


@dataclass(frozen=True)
class FlakeStack:
    """Slices with all their mip levels.

    Attributes:
        levels: [D, H, W, 3] float16 each, the finest first, in 1/sr.
        lut: `thetaFI_sliceLUT`, the first slice of each bin of theta_d.
    """

    levels: tuple[np.ndarray, ...]
    lut: tuple[int, ...]


def slices_of_bins(bins: int = BINS) -> tuple[int, ...]:
    """Slices of theta_h, 0 to 45 degrees, in each bin of theta_d; fewer where theta_h + theta_d nears pi/2."""
    return tuple(min(bins // 2 + 1, bins - k) for k in range(bins - 1))


def slice_table(bins: int = BINS) -> tuple[int, ...]:
    """`thetaFI_sliceLUT`; of 12 bins 0 7 14 21 28 35 42 48 53 57 60 62, then zeros."""
    starts = (0, *np.cumsum(slices_of_bins(bins)).tolist())
    return (*starts, *[0] * (max(LUT_ENTRIES, bins + 1) - len(starts)))


@dataclass(frozen=True)
class Flakes:
    """Single flakes on a square that repeats.

    Attributes:
        position: in units of the square's side, (N, 2).
        radius_mm: (N,).
        tilt: about the two axes of the surface, radians, (N, 2).
        color: in full flash, linear RGB, 1/sr, (N, 3).
    """

    position: np.ndarray
    radius_mm: np.ndarray
    tilt: np.ndarray
    color: np.ndarray


def scatter_flakes(rng: Rng, recipe: FlakeRecipe, extent_mm: float) -> Flakes:
    """Flakes strewn independently over a square of side ``extent_mm``."""
    count = round(recipe.density * extent_mm**2)
    position = rng.random((count, 2))
    tilt = recipe.orientation_spread * normal_noise(rng, (count, 2))
    brightness = recipe.strength * np.exp(recipe.brightness_spread * normal_noise(rng, (count,)))
    hue = recipe.hue_spread * (2.0 * rng.random((count, 1)) - 1.0) * np.array([1.0, -0.2, -0.8])
    color = brightness[:, None] * np.maximum(np.asarray(recipe.color) * (1.0 + hue), 0.0)
    low, high = recipe.diameter_mm
    radius = 0.5 * (low + (high - low) * rng.random(count))
    flat = np.hypot(*tilt.T) < LAST_TILT
    return Flakes(position[flat], radius[flat], tilt[flat], color[flat])


def flake_stack(rng: Rng, size: int, extent_mm: float, recipe: FlakeRecipe, *, bins: int = BINS) -> FlakeStack:
    """A repeating field of flakes seen at every slice's pair of angles.

    Args:
        rng: source of chance.
        size: texels along each side of a slice; a power of two.
        extent_mm: side of the field.
        recipe: what the flakes are like.
        bins: bins of theta_h and of theta_d over [0, pi/2].
    """
    flakes = scatter_flakes(rng, recipe, extent_mm)
    slices = []
    for bin_d, bins_h in enumerate(slices_of_bins(bins)):
        # A flake is not quite flat: what flashes drifts a little as the light moves away from the viewer.
        drift = np.deg2rad(0.36) * bin_d * BINS / bins
        seen = flakes.tilt + drift * normal_noise(rng, flakes.tilt.shape)
        for bin_h in range(bins_h):
            # Bin k stands at k bins: the lookup adds half a bin before it takes the floor.
            theta_h, theta_d = 0.5 * np.pi * bin_h / bins, 0.5 * np.pi * bin_d / bins
            slices.append(flash(replace(flakes, tilt=seen), recipe, size, extent_mm, theta_h, theta_d))
    # The floor of a measurement, of either sign.
    floor = 0.002 * recipe.strength * normal_noise(rng, (len(slices), size, size, 3))
    return FlakeStack(_mip_levels(np.stack(slices) + floor), slice_table(bins))


def flash(
    flakes: Flakes, recipe: FlakeRecipe, size: int, extent_mm: float, theta_h: float, theta_d: float
) -> np.ndarray:
    """What flakes reflect at a pair of angles (radians), 1/sr, on a repeating map (size, size, 3)."""
    off = np.hypot(flakes.tilt[:, 0] - theta_h, flakes.tilt[:, 1])
    brightness = np.exp(-4.0 * np.log(2.0) * (off / recipe.lifetime) ** 2) * np.cos(theta_d)
    lit = brightness > 0.02
    radius = flakes.radius_mm[lit] * (size / extent_mm)
    return _splat(size, size * flakes.position[lit], radius, brightness[lit, None] * flakes.color[lit])


def _splat(size: int, position: np.ndarray, radius: np.ndarray, color: np.ndarray) -> np.ndarray:
    """Gaussian spots of the given radii (texels) at positions (column, row), added up on a repeating map."""
    image = np.zeros((size, size, 3))
    corner = np.floor(position).astype(np.int64)
    reach = 1 + int(np.ceil(radius.max(initial=0.0)))
    for row in range(-reach, reach + 1):
        for column in range(-reach, reach + 1):
            texel = corner + (column, row)
            distance = (texel + 0.5 - position) / radius[:, None]
            weight = np.exp(-np.sum(distance * distance, axis=1))
            np.add.at(image, (texel[:, 1] % size, texel[:, 0] % size), weight[:, None] * color)
    return image


def _mip_levels(stack: np.ndarray) -> tuple[np.ndarray, ...]:
    """The stack and its halvings down to one texel, each the mean of 2x2 texels of the one before."""
    levels = [stack.astype(np.float16)]
    while stack.shape[1] > 1:
        depth, height, width, channels = stack.shape
        stack = stack.reshape(depth, height // 2, 2, width // 2, 2, channels).mean(axis=(2, 4))
        levels.append(stack.astype(np.float16))
    return tuple(levels)
