"""Leather: a pebbled grain with creases, with or without a lacquer, and perforated."""

from dataclasses import dataclass

import numpy as np

from ..axf import AxfMaterial
from .coat import clear_coat
from .fields import cells, halved, jittered, normals_of, smooth_step, staggered
from .material import SEED, labels, svbrdf_material, with_dark_noise
from .noise import Rng, fractal_noise, unit_grid, value_noise

EXTENT_MM = 12.0
"""Side of the patch."""

HOLE_ROWS = 6
"""Rows of holes over the patch, in a brick pattern: one every 2 mm."""


@dataclass(frozen=True)
class Grain:
    """The relief of leather, each (H, W).

    Attributes:
        height_mm: of the surface.
        pebble: 0 in the creases to 1 on the pebbles.
        shade: uneven dye, about -1 to 1.
    """

    height_mm: np.ndarray
    pebble: np.ndarray
    shade: np.ndarray


def leather_grain(rng: Rng, size: int, *, pebbles: int = 14, depth_mm: float = 0.075) -> Grain:
    """Pebbles of uneven size between creases, and pores: a repeating relief of ``size`` texels a side."""
    u, v = unit_grid(size)
    bent = [0.016 * fractal_noise(rng, u, v, (7, 7), octaves=3, size=4 * size) for _ in range(2)]
    points = jittered(rng, (pebbles, pebbles), 0.85)
    own = 2.0 * rng.random((pebbles, pebbles)) - 1.0
    found = cells(u + bent[0], v + bent[1], points)
    # Rounded like cushions: steep at the crease, flat on top, and some creases run out.
    closed = 0.75 + 0.25 * fractal_noise(rng, u, v, (6, 6), octaves=2, size=size)
    gap = np.clip((found.second - found.nearest) / 0.7, 0.0, 1.0)
    pebble = 1.0 - closed * (1.0 - gap) ** 3
    fine = fractal_noise(rng, u, v, (3 * pebbles, 3 * pebbles), octaves=2, size=4 * size)
    swell = value_noise(rng, u, v, (3, 3))
    height = depth_mm * (pebble * (1.0 + 0.2 * own[found.row, found.column]) + 0.10 * fine + 0.5 * swell)
    shade = 0.15 * own[found.row, found.column] * pebble + 0.6 * fractal_noise(rng, u, v, (4, 4), octaves=3, size=size)
    return Grain(height, pebble, shade)


def leather_maps(rng: Rng, grain: Grain, color: tuple[float, float, float]) -> dict[str, np.ndarray]:
    """Colors, roughness and normals of a dyed grain; the roughness at half the size, which is enough for it."""
    worn = np.clip(0.72 + 0.28 * grain.pebble + 0.12 * grain.shade, 0.0, 1.2)
    # Dye gathers in the creases: darker there, and of a deeper hue.
    diffuse = np.asarray(color) ** (1.0 + 0.25 * (1.0 - worn[..., None])) * worn[..., None]
    specular = (0.020 + 0.030 * grain.pebble)[..., None] * np.ones(3)
    roughness = 0.40 - 0.13 * grain.pebble - 0.02 * grain.shade
    return {
        "diffusecolor": with_dark_noise(rng, diffuse),
        "normal": normals_of(grain.height_mm, EXTENT_MM),
        "specularcolor": specular,
        "specularlobe": halved(roughness[..., None]),
    }


def leather(
    size: int = 64,
    seed: int = SEED,
    *,
    id: str = "leather",
    name: str = "Cognac leather",
    color: tuple[float, float, float] = (0.30, 0.105, 0.035),
    depth_mm: float = 0.075,
    fresnel: bool = False,
    with_height: bool = False,
) -> AxfMaterial:
    """Dyed leather without a coat: Lambert and isotropic Ward.

    Args:
        size: texels along each side.
        seed: of the noise.
        id: of the material.
        name: of the material.
        color: of the dye, linear RGB.
        depth_mm: of the creases.
        fresnel: whether the lobe has a Fresnel factor (AxF >= 1.1), F0 being the same everywhere.
        with_height: whether the height map is there (AxF >= 1.4).
    """
    rng = np.random.Generator(np.random.PCG64(seed))
    grain = leather_grain(rng, size, depth_mm=depth_mm)
    maps = leather_maps(rng, grain, color)
    if fresnel:
        # With a Fresnel factor the weight of the lobe is a matter of shadowing alone.
        maps["specularcolor"] = np.minimum(16.0 * maps["specularcolor"], 1.0)
        maps["fresnel"] = np.full(3, 0.04)
    if with_height:
        maps["height"] = grain.height_mm[..., None]
    return svbrdf_material(
        id,
        name,
        maps,
        extent_mm=EXTENT_MM,
        metadata=labels("leather", size, seed),
        fresnel_variant="Schlick1994" if fresnel else None,
    )


def patent_leather(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Red leather under a lacquer that does not refract: it follows the pebbles and fills the creases."""
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    grain = leather_grain(rng, size, pebbles=11, depth_mm=0.05)
    maps = leather_maps(rng, grain, (0.42, 0.012, 0.018))
    maps["specularcolor"] = np.full(3, 0.5)
    maps["fresnel"] = np.full(3, 0.05)
    coat = clear_coat(rng, u, v, size, ior=1.52)
    filled = 0.35 * halved(grain.height_mm)
    maps |= coat | {"clearcoatnormal": normals_of(filled, EXTENT_MM), "clearcoatcolor": np.ones(3)}
    return svbrdf_material(
        "patent_leather",
        "Red patent leather",
        maps,
        extent_mm=EXTENT_MM,
        metadata=labels("patent_leather", size, seed),
        fresnel_variant="Schlick1994",
        refracting=False,
    )


def perforated_leather(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Fine black leather with punched holes: opacity 0 in the holes, a height map with their rolled rims."""
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    grain = leather_grain(rng, size, pebbles=16, depth_mm=0.045)
    hole = cells(u, v, staggered((HOLE_ROWS, HOLE_ROWS))).nearest
    edge = 0.75 * HOLE_ROWS / size
    opacity = smooth_step(0.24 - edge, 0.24 + edge, hole)
    rim = 0.35 * (1.0 - smooth_step(0.20, 0.40, hole))
    height = grain.height_mm - rim
    maps = leather_maps(
        rng, Grain(height, grain.pebble * smooth_step(0.16, 0.30, hole), grain.shade), (0.05, 0.05, 0.05)
    )
    maps["specularcolor"] = np.minimum(16.0 * maps["specularcolor"], 1.0)
    maps |= {"fresnel": np.full(3, 0.04), "opacity": opacity[..., None], "height": height[..., None]}
    return svbrdf_material(
        "perforated_leather",
        "Perforated leather",
        maps,
        extent_mm=EXTENT_MM,
        metadata=labels("perforated_leather", size, seed),
        fresnel_variant="Schlick1994",
    )
