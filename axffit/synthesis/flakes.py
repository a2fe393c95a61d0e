"""Metallic flakes in a car paint: the stack of textures over the angles that AxF calls BTFflakes.

Each flake is a small mirror, tilted a little out of the surface. It flashes while the half vector comes within a few
degrees of its own normal: 6 to 7 degrees of theta_h from on to off, and none is tilted so far that it would flash
past theta_h = 45 degrees below the coat (AxF SDK).
"""

from dataclasses import dataclass

import numpy as np

from .noise import Rng, normal_noise

BINS = 12
"""Bins of theta_h and of theta_d over [0, pi/2]: num_thetaF, num_thetaI and max_thetaI."""

SLICES_OF_BIN = (7, 7, 7, 7, 7, 7, 6, 5, 4, 3, 2)
"""Slices of theta_h (0 to 45 degrees, fewer where theta_h + theta_d nears pi/2) in each bin of theta_d."""

LUT_ENTRIES = 64

TEXEL_MM = 0.03
"""Side of a texel: the flakes of a metallic paint are 10 to 50 micrometers across."""

LIFETIME = np.deg2rad(6.5)
"""Change of theta_h over which a flake is brighter than half its maximum."""


@dataclass(frozen=True)
class FlakeStack:
    """Slices with all their mip levels.

    Attributes:
        levels: [D, H, W, 3] float16 each, the finest first, in 1/sr.
        lut: `thetaFI_sliceLUT`, the first slice of each bin of theta_d.
    """

    levels: tuple[np.ndarray, ...]
    lut: tuple[int, ...]


def slice_table() -> tuple[int, ...]:
    """`thetaFI_sliceLUT`: 0 7 14 21 28 35 42 48 53 57 60 62, then zeros."""
    starts = (0, *np.cumsum(SLICES_OF_BIN).tolist())
    return (*starts, *[0] * (LUT_ENTRIES - len(starts)))


def flake_stack(rng: Rng, size: int, *, tint: np.ndarray, strength: float, density: float = 0.7) -> FlakeStack:
    """A repeating field of flakes seen at every slice's pair of angles.

    Args:
        rng: source of chance.
        size: texels along each side of a slice; a power of two.
        tint: mean linear RGB of the flakes, (3,).
        strength: value of a typical flake in full flash, 1/sr.
        density: flakes a texel, of all tilts.
    """
    count = round(density * size * size)
    position = size * rng.random((count, 2))
    tilt = np.deg2rad(11.0) * normal_noise(rng, (count, 2))
    brightness = strength * np.exp(0.7 * normal_noise(rng, (count,)))
    hue = 0.35 * (2.0 * rng.random((count, 1)) - 1.0) * np.array([1.0, -0.2, -0.8])
    color = brightness[:, None] * np.maximum(tint * (1.0 + hue), 0.0)
    radius = 0.55 + 0.45 * rng.random(count)
    flat = np.hypot(*tilt.T) < np.deg2rad(42.0)
    slices = []
    for bin_d, bins_h in enumerate(SLICES_OF_BIN):
        # A flake is not quite flat: what flashes drifts a little as the light moves away from the viewer.
        seen = tilt + np.deg2rad(1.2) * bin_d * 0.3 * normal_noise(rng, (count, 2))
        for bin_h in range(bins_h):
            # Bin k stands at k bins: the lookup adds half a bin before it takes the floor.
            theta_h = 0.5 * np.pi * bin_h / BINS
            off = np.hypot(seen[:, 0] - theta_h, seen[:, 1])
            flash = np.exp(-4.0 * np.log(2.0) * (off / LIFETIME) ** 2) * np.cos(0.5 * np.pi * bin_d / BINS)
            lit = flat & (flash > 0.02)
            slices.append(_splat(size, position[lit], radius[lit], flash[lit, None] * color[lit]))
    # The floor of a measurement, of either sign.
    stack = np.stack(slices) + 0.002 * strength * normal_noise(rng, (len(slices), size, size, 3))
    return FlakeStack(_mip_levels(stack), slice_table())


def _splat(size: int, position: np.ndarray, radius: np.ndarray, color: np.ndarray) -> np.ndarray:
    """Gaussian spots of the given radii (texels) at positions (column, row), added up on a repeating map."""
    image = np.zeros((size, size, 3))
    corner = np.floor(position).astype(np.int64)
    for row in range(-2, 3):
        for column in range(-2, 3):
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
