"""More synthetic car paints: silver, a solid yellow, ruby, and one whose color travels."""

import numpy as np

from ..axf import AxfMaterial
from ..measured import REC709_LUMINANCE
from .carpaint import TABLE_SIZE, PaintRecipe, half_difference_grid, paint, within_measurement
from .fields import blend, smooth_step
from .flakes import FlakeRecipe
from .material import SEED

_COAT_INDEX, _FILM_INDEX = 1.5, 1.38
"""Of the binder around an interference pigment and of its magnesium fluoride spacer."""

_FILM_NM = 297.0
"""Thickness of the spacer: its second maximum is green face on, blue and violet where the film is crossed aslant."""

_BANDS_NM = ((600.0, 40.0), (545.0, 35.0), (455.0, 30.0))
"""Center and standard deviation of what red, green and blue see."""


def silver_metallic(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Silver metallic: neutral and bright face on, slate gray at the flop, many coarse flakes."""
    recipe = PaintRecipe(
        "silver_metallic",
        "Silver metallic paint",
        face_flop_table((1.10, 1.12, 1.14), (0.62, 0.65, 0.70), (0.22, 0.24, 0.28)),
        diffuse=0.04,
        coefficients=(0.016, 0.11, 0.16),
        f0s=(0.80, 0.70, 0.90),
        spreads=(0.12, 0.30, 3.5),
        flakes=FlakeRecipe(density=900.0, strength=0.16, hue_spread=0.10),
    )
    return paint(recipe, size, seed)


def ruby_metallic(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """A deep red with fine gold and red flakes; the green and blue of its depth are slightly negative."""
    recipe = PaintRecipe(
        "ruby_metallic",
        "Ruby metallic paint",
        face_flop_table((1.60, 0.16, 0.10), (0.80, -0.012, 0.012), (0.20, 0.004, 0.03)),
        diffuse=0.025,
        coefficients=(0.014, 0.13, 0.10),
        f0s=(0.50, 0.45, 0.90),
        spreads=(0.11, 0.26, 3.0),
        flakes=FlakeRecipe(density=700.0, color=(1.3, 0.55, 0.35), strength=0.10),
    )
    return paint(recipe, size, seed)


def solid_yellow(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """A solid fine paint: no flakes, nearly all of it diffuse, a weak broad lobe; its blue is slightly negative."""
    recipe = PaintRecipe(
        "solid_yellow",
        "Solid yellow paint",
        face_flop_table((1.42, 0.84, 0.03), (1.40, 0.80, -0.012), (1.20, 0.66, 0.02)),
        diffuse=0.50,
        coefficients=(0.004, 0.03),
        f0s=(0.05, 0.10),
        spreads=(0.20, 0.45),
        peel=0.005,
    )
    return paint(recipe, size, seed)


def pearlescent(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """An interference paint: green face on, blue to violet as light and viewer part (theta_d)."""
    recipe = PaintRecipe(
        "pearlescent",
        "Pearlescent green-blue paint",
        travel_table(),
        diffuse=0.02,
        coefficients=(0.016, 0.14, 0.12),
        f0s=(0.80, 0.65, 0.90),
        spreads=(0.13, 0.30, 3.0),
        flakes=FlakeRecipe(density=500.0, color=(0.6, 1.1, 0.9), strength=0.09, hue_spread=0.6),
    )
    return paint(recipe, size, seed)


def face_flop_table(
    face: tuple[float, float, float],
    body: tuple[float, float, float],
    flop: tuple[float, float, float],
    *,
    size: int = TABLE_SIZE,
) -> np.ndarray:
    """chi (size, size, 3) of a paint by three colors: where half vector and normal agree, off it, and past 38°."""
    theta_h, theta_d = half_difference_grid(size)
    near = np.exp(-((theta_h / np.deg2rad(13.0)) ** 2))
    far = smooth_step(np.deg2rad(24.0), np.deg2rad(54.0), theta_h)
    color = blend(body, flop, far)
    color = color + near[..., None] * (np.asarray(face) - color)
    pale = 0.06 * np.sin(theta_d)[..., None] ** 2
    return within_measurement(color * (1.0 - pale) + pale * np.mean(body))


def travel_table(*, size: int = TABLE_SIZE) -> np.ndarray:
    """chi (size, size, 3) of an interference pigment, of luminance 1 face on.

    The two sides of a film of thickness d and index n reflect in phase where sin² is 1,

        R(lambda) ~ sin²(delta / 2)³,   delta = 4 pi n d cos(theta_film) / lambda

    (the cube stands for the several films of a pigment, which sharpen the peak), and theta_film follows from theta_d in
    the binder by Snell's law: hue travels with theta_d. Off the pigment's own orientation (theta_h > 30°) the dark base
    coat shows, a deep violet.
    """
    theta_h, theta_d = half_difference_grid(size)
    # Past the film's critical angle nothing is left of the travel.
    aslant = np.minimum(_COAT_INDEX / _FILM_INDEX * np.sin(theta_d), 0.98)
    path = 4.0 * np.pi * _FILM_INDEX * _FILM_NM * np.sqrt(1.0 - aslant**2)
    hue = np.stack([_band_mean(path, *band) for band in _BANDS_NM], axis=-1)
    luminance = hue @ np.array(REC709_LUMINANCE)
    hue = hue / luminance[0, 0]
    # A display's primaries: what the eye's overlapping bands mix is taken apart, below 0 for saturated hues.
    gray = (luminance / luminance[0, 0])[..., None]
    hue = gray + 1.2 * (hue - gray)
    base = blend((0.20, 0.05, 0.42), (0.10, 0.04, 0.20), smooth_step(0.0, 1.2, theta_d))
    leafing = 1.0 - smooth_step(np.deg2rad(14.0), np.deg2rad(46.0), theta_h)
    return within_measurement(base + leafing[..., None] * (hue - base))


def _band_mean(path: np.ndarray, center: float, deviation: float) -> np.ndarray:
    """The film's reflectance for an optical path (nm, times 2 pi) averaged over a Gaussian band."""
    steps = np.linspace(-2.0, 2.0, 9)
    weights = np.exp(-0.5 * steps**2)
    total = np.zeros_like(path)
    for step, weight in zip(steps, weights, strict=True):
        wave = np.sin(0.5 * path / (center + step * deviation)) ** 2
        total = total + weight * wave**3
    return total / weights.sum()
