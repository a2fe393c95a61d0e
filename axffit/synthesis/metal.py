"""Metals: brushed along lines, engine-turned in overlapping circles, hammered."""

import numpy as np

from ..axf import AxfMaterial
from .coat import clear_coat
from .fields import blend, cells, halved, jittered, normals_of, overlapping_discs, smooth_step
from .material import SEED, labels, svbrdf_material, with_dark_noise, with_highlights
from .noise import Rng, fractal_noise, normal_noise, unit_grid, unit_vectors, value_noise

DISCS = 4
"""Circles of the engine turning along each side."""

_GGX_WEIGHT = 0.25
"""AxF's GGX lobe lacks the microfacet factor 1/4; this weight is a white mirror's."""


def _hairlines(rng: Rng, size: int, lines: int) -> np.ndarray:
    """Scratches along v, about -1.5 to 1.5, (size, size): long, of uneven depth, some much shorter."""
    u, v = unit_grid(size)
    long = fractal_noise(rng, u, v, (lines, 2), octaves=3, size=8 * size)
    short = fractal_noise(rng, u, v, (2 * lines, 7), octaves=2, size=8 * size)
    return long + 0.6 * short


def brushed_metal(
    size: int = 64,
    seed: int = SEED,
    *,
    id: str = "brushed_aluminum",
    name: str = "Brushed aluminum",
    color: tuple[float, float, float] = (0.86, 0.87, 0.88),
    roughness: tuple[float, float] = (0.075, 0.27),
    specular_model: str = "Ward",
    fresnel: bool = False,
) -> AxfMaterial:
    """Metal brushed along v: an anisotropic lobe whose rotation map stays about pi/2, on either side of it.

    Args:
        size: texels along each side.
        seed: of the noise.
        id: of the material.
        name: of the material.
        color: reflectance at normal incidence, linear RGB.
        roughness: along and across the scratches.
        specular_model: "Ward" or "GGX".
        fresnel: whether the color is that of the Fresnel factor (AxF >= 1.1) or of the lobe.
    """
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    scratch = _hairlines(rng, size, 40)
    stain = fractal_noise(rng, u, v, (3, 2), octaves=3, size=size)
    shade = 0.90 + 0.05 * scratch + 0.03 * stain
    weight = _GGX_WEIGHT if specular_model == "GGX" else 1.0
    hue = np.ones(3) if fresnel else np.asarray(color)
    along = roughness[0] * (1.0 + 0.12 * scratch + 0.10 * stain)
    across = roughness[1] * (1.0 + 0.10 * scratch - 0.05 * stain)
    maps = {
        "diffusecolor": with_dark_noise(rng, 0.012 * (1.0 - 0.3 * scratch)[..., None] * np.asarray(color)),
        "normal": unit_vectors(0.022 * scratch, 0.004 * stain),
        "specularcolor": with_highlights(weight * shade[..., None] * hue, ceiling=weight),
        "specularlobe": np.stack([along, across], axis=-1),
        "anisrotation": (0.5 * np.pi + 0.025 * normal_noise(rng, (size, size)) + 0.02 * stain)[..., None],
    }
    if fresnel:
        maps["fresnel"] = np.asarray(color)
    return svbrdf_material(
        id,
        name,
        maps,
        extent_mm=10.0,
        metadata=labels("brushed_metal", size, seed),
        specular_model=specular_model,
        fresnel_variant="Schlick1994" if fresnel else None,
    )


def turned_brass(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Engine-turned brass under a lacquer that does not refract: circles whose scratches take every angle."""
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    disc = overlapping_discs(u, v, (DISCS, DISCS), 0.74)
    own = rng.random((DISCS, DISCS))[disc.row, disc.column]
    x, y = disc.offset[..., 0], disc.offset[..., 1]
    azimuth = np.arctan2(y, x)
    scratch = fractal_noise(rng, azimuth / (2.0 * np.pi) + own, disc.nearest + own, (5, 26), octaves=3, size=8 * size)
    edge = 1.0 - smooth_step(0.0, 0.05, disc.second)
    tarnish = fractal_noise(rng, u, v, (3, 3), octaves=3, size=size)
    outward = disc.offset / np.maximum(disc.nearest, 1e-3)[..., None]
    # Each circle is ground a little hollow, and the next one leaves a step at its edge.
    slope = -0.07 * disc.offset + (0.025 * scratch + 0.16 * edge)[..., None] * outward
    shade = (0.93 + 0.05 * scratch + 0.03 * tarnish) * (1.0 - 0.35 * edge)
    brass = np.array([0.86, 0.64, 0.27]) * (1.0 - 0.05 * tarnish[..., None] * np.array([0.3, 0.7, 1.5]))
    roughness = np.stack([0.06 * (1.0 + 0.15 * scratch), 0.24 * (1.0 + 0.12 * scratch)], axis=-1)
    turned = np.mod(azimuth + 1.5 * np.pi, 2.0 * np.pi) - np.pi
    coat = clear_coat(rng, u, v, size, peel=0.006, ior=1.47)
    maps = {
        "diffusecolor": with_dark_noise(rng, 0.010 * shade[..., None] * brass),
        "normal": unit_vectors(slope[..., 0], slope[..., 1]),
        "specularcolor": with_highlights(shade[..., None] * np.ones(3)),
        "specularlobe": roughness,
        "anisrotation": turned[..., None],
        "fresnel": halved(np.clip(brass, 0.0, 1.0)),
        **coat,
    }
    return svbrdf_material(
        "turned_brass",
        "Engine-turned brass, lacquered",
        maps,
        extent_mm=24.0,
        metadata=labels("turned_brass", size, seed),
        fresnel_variant="Schlick1994",
        refracting=False,
    )


def hammered_copper(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Hand-hammered copper: GGX, dimples that meet in ridges (normals and height), dark patina in the hollows."""
    rng = np.random.Generator(np.random.PCG64(seed))
    extent_mm, blows = 40.0, 6
    u, v = unit_grid(size)
    bent = [0.012 * fractal_noise(rng, u, v, (4, 4), octaves=2, size=size) for _ in range(2)]
    found = cells(u + bent[0], v + bent[1], jittered(rng, (blows, blows), 0.75))
    force = rng.random((blows, blows))[found.row, found.column] - 0.5
    ridge = 1.0 - smooth_step(0.0, 0.25, found.second - found.nearest)
    fine = fractal_noise(rng, u, v, (24, 24), octaves=3, size=size)
    # The smaller of the two nearest bowls, rounded where they meet.
    bowls = found.nearest**2, np.minimum(found.second, 1.5) ** 2
    sharpness = 7.0
    dent = -np.log(np.exp(-sharpness * bowls[0]) + np.exp(-sharpness * bowls[1])) / sharpness
    height = 1.2 * dent + 0.03 * fine + 0.1 * value_noise(rng, u, v, (2, 2))
    patina = smooth_step(0.1, 0.9, 0.5 + 0.55 * fractal_noise(rng, u, v, (4, 4), octaves=4, size=size) - 0.5 * ridge)
    shade = (1.0 - 0.60 * patina) * (0.92 + 0.06 * ridge)
    maps = {
        "diffusecolor": with_dark_noise(rng, blend((0.006, 0.003, 0.002), (0.055, 0.020, 0.010), patina)),
        "normal": normals_of(height, extent_mm),
        "specularcolor": with_highlights(_GGX_WEIGHT * shade[..., None] * np.ones(3), ceiling=_GGX_WEIGHT),
        "specularlobe": (0.16 + 0.14 * patina + 0.02 * fine + 0.02 * force)[..., None],
        "fresnel": blend((0.94, 0.54, 0.38), (0.66, 0.30, 0.18), patina),
        "height": halved(height[..., None]),
    }
    return svbrdf_material(
        "hammered_copper",
        "Hammered copper",
        maps,
        extent_mm=extent_mm,
        metadata=labels("hammered_copper", size, seed),
        specular_model="GGX",
        fresnel_variant="Schlick1994",
    )
