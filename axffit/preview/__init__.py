"""Pictures of materials: spheres in a studio or under sun and sky, tone mapped for a page."""

from axffit.preview.environment import AbstractEnvironment, Studio, SunSky, Uniform
from axffit.preview.picture import (
    difference_to_display,
    display_steps,
    indexed_png_bytes,
    png_bytes,
    to_display,
    tone_curve,
)
from axffit.preview.sampling import Samples
from axffit.preview.sphere import render_layers, render_sphere

__all__ = [
    "AbstractEnvironment",
    "Samples",
    "Studio",
    "SunSky",
    "Uniform",
    "difference_to_display",
    "display_steps",
    "indexed_png_bytes",
    "png_bytes",
    "render_layers",
    "render_sphere",
    "to_display",
    "tone_curve",
]
