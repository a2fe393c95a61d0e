"""Synthetic car paints: a metallic one as an AxF material, and a colorless one whose parameters a fit must recover."""

from dataclasses import dataclass

import numpy as np

from .. import brdf
from ..axf import AxfMaterial, AxfTexture, MaterialKind
from .flakes import BINS, FlakeRecipe, flake_stack
from .material import SEED, labels
from .noise import fractal_noise, normal_noise, unit_grid, unit_vectors

TABLE_SIZE = 64
"""Texels along each side of the color table, as in the known real ones."""

IOR = 1.5

DIFFUSE = 0.032
COEFFICIENTS = (0.0135, 0.085, 0.31)
F0S = (0.37, 0.22, 0.93)
SPREADS = (0.105, 0.265, 4.6)
"""Lobes in the ranges of measured paints: narrow ones of spread 0.05 to 0.3 and a broad one, weights over decades."""


FLAKE_TEXEL_MM = 0.03
"""Side of a texel of the flakes: about the diameter of one."""


@dataclass(frozen=True)
class PaintRecipe:
    """What a paint is made of; lobes as in `brdf.CarPaint`.

    Attributes:
        id: of the material; also the name of the function that makes it.
        name: to show to people, without the note that it is synthetic.
        table: chi (H, W, 3) over (theta_d, theta_h).
        diffuse: diffuse weight.
        coefficients: weight of each lobe.
        f0s: F0 of each lobe.
        spreads: Beckmann roughness of each lobe.
        flakes: what the flakes are like, or None for a solid paint.
        flakes_part: texels of the coat's normal map a texel of the flakes, along each side.
        peel: largest slope of the coarsest orange peel.
    """

    id: str
    name: str
    table: np.ndarray
    diffuse: float = DIFFUSE
    coefficients: tuple[float, ...] = COEFFICIENTS
    f0s: tuple[float, ...] = F0S
    spreads: tuple[float, ...] = SPREADS
    flakes: FlakeRecipe | None = None
    flakes_part: int = 4
    peel: float = 0.008


def paint(recipe: PaintRecipe, size: int, seed: int) -> AxfMaterial:
    """A paint under a refracting coat as an AxF material: lobes, color table, flakes with mip levels, coat maps.

    Args:
        recipe: what it is made of.
        size: texels along each side of the coat's normal map.
        seed: of the noise.
    """
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    peel = [recipe.peel * fractal_noise(rng, u, v, (5, 5), octaves=3, size=size) for _ in range(2)]
    textures = {"brdfcolors": AxfTexture((recipe.table.astype(np.float32),))}
    properties: dict[str, object] = {
        "CT_diffuse": recipe.diffuse,
        "CT_coeffs": recipe.coefficients,
        "CT_F0s": recipe.f0s,
        "CT_spreads": recipe.spreads,
    }
    if recipe.flakes is not None:
        side = size // recipe.flakes_part
        extent = FLAKE_TEXEL_MM * side
        flakes = flake_stack(rng, side, extent, recipe.flakes)
        textures["btfflakes"] = AxfTexture(flakes.levels, extent, extent)
        properties |= {"num_thetaF": BINS, "num_thetaI": BINS, "max_thetaI": BINS, "thetaFI_sliceLUT": flakes.lut}
    textures |= {
        "clearcoatnormal": AxfTexture((unit_vectors(*peel).astype(np.float32),), 20.0, 20.0),
        "clearcoatior": AxfTexture((np.full((1, 1, 1), IOR, np.float32),)),
        "clearcoatcolor": AxfTexture((np.ones((1, 1, 3), np.float32),)),
    }
    return AxfMaterial(
        id=recipe.id,
        name=f"{recipe.name} (synthetic)",
        kind=MaterialKind.CAR_PAINT,
        specular_model="CookTorrance",
        fresnel_variant="Schlick1994",
        textures=textures,
        properties=properties | {"IOR": IOR, "cc_no_refraction": 0},
        metadata=labels(recipe.id, size, seed),
    )


def metallic_paint(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """A blue metallic paint as an AxF material: three lobes, color table, flakes with mip levels, coat maps.

    Args:
        size: texels along each side of the coat's normal map; the flakes take half of it.
        seed: of the noise.
    """
    flakes = FlakeRecipe(color=(0.75, 0.9, 1.15), strength=0.12)
    recipe = PaintRecipe("metallic_paint", "Blue metallic paint", flop_table(), flakes=flakes, flakes_part=2)
    return paint(recipe, size, seed)


def half_difference_grid(size: int) -> tuple[np.ndarray, np.ndarray]:
    """theta_h and theta_d (size, size) of a color table's texels: column and row k at (k + 1/2) 90° / size."""
    theta = (np.arange(size) + 0.5) * 0.5 * np.pi / size
    theta_d, theta_h = np.meshgrid(theta, theta, indexing="ij")
    return theta_h, theta_d


def within_measurement(color: np.ndarray) -> np.ndarray:
    """A color table with 0 where theta_h + theta_d > pi/2: one of the directions would be below the horizon."""
    size = len(color)
    theta_h, theta_d = half_difference_grid(size)
    measurable = theta_h + theta_d <= 0.5 * np.pi + 0.5 * np.pi / size
    return np.where(measurable[..., None], color, 0.0)


def flop_table(size: int = TABLE_SIZE) -> np.ndarray:
    """chi (size, size, 3) of a metallic paint: bright and pale face on, deep blue below, violet at the flop.

    Column: theta_h, row: theta_d, texel k at (k + 1/2) 90° / size. Values exceed 1 face on, the red of the deep blue
    is slightly negative (outside the RGB gamut), and where theta_h + theta_d > pi/2 nothing can be measured: 0.
    """
    theta_h, theta_d = half_difference_grid(size)
    face = np.exp(-((theta_h / np.deg2rad(11.0)) ** 2))
    flop = 1.0 / (1.0 + np.exp(-(theta_h - np.deg2rad(38.0)) / np.deg2rad(6.0)))
    pale, deep, violet = np.array([0.62, 1.02, 1.75]), np.array([-0.03, 0.30, 1.18]), np.array([0.20, 0.12, 0.52])
    body = (1.0 - flop)[..., None] * deep + flop[..., None] * violet
    color = body + face[..., None] * (pale - body)
    # Toward grazing the pigment's interference shifts to shorter waves and everything pales a little.
    graze = np.sin(theta_d) ** 2
    color = color * (1.0 + graze[..., None] * np.array([0.10, -0.12, 0.06])) + 0.05 * graze[..., None] ** 2
    return within_measurement(color)


def paint_model(material: AxfMaterial) -> brdf.ClearCoat:
    """The paint of a car-paint material without its flakes, in float64: the truth behind synthetic samples."""
    values, colors = material.properties, material.textures["brdfcolors"].data
    base = brdf.CarPaint(
        diffuse=np.float64(values["CT_diffuse"]),
        coefficients=np.asarray(values["CT_coeffs"], np.float64),
        f0=np.asarray(values["CT_F0s"], np.float64),
        spreads=np.asarray(values["CT_spreads"], np.float64),
        color_table=brdf.ColorTable(colors.astype(np.float64)),
    )
    return brdf.ClearCoat(base, np.float64(values["IOR"]))


def unit_luminance_paint(seed: int = 0, *, size: int = 16, coated: bool = True) -> brdf.AbstractBRDF:
    """A paint whose color table has luminance 1 (Rec. 709) in every cell, so that its lobes have no gauge freedom.

    Args:
        seed: of the table's hues.
        size: texels along each side of the table.
        coated: under a refracting clear coat of index 1.5, or the bare base.

    Returns:
        `ClearCoat(CarPaint(...))` or `CarPaint(...)`, in float64 where JAX has it enabled.
    """
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    hue = np.stack([fractal_noise(rng, u, v, (3, 3), octaves=2, size=size) for _ in range(3)], axis=-1)
    color = np.array([0.5, 0.8, 1.6]) * np.exp(0.35 * hue)
    luminance = color @ np.array([0.2126, 0.7152, 0.0722])
    table = brdf.ColorTable(color / luminance[..., None])
    base = brdf.CarPaint(
        np.float64(0.12),
        np.array([0.05, 0.09]),
        np.array([0.35, 0.22]),
        np.array([0.10, 0.28]),
        table,
    )
    return brdf.ClearCoat(base, np.float64(IOR)) if coated else base


def relative_noise(values: np.ndarray, level: float, seed: int) -> np.ndarray:
    """Values (..., C) with independent Gaussian noise of standard deviation `level` times the value."""
    rng = np.random.Generator(np.random.PCG64(seed))
    return values * (1.0 + level * normal_noise(rng, values.shape))
