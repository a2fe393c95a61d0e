"""Pictures of materials: a sphere or a car-body-like shape in a studio or under sun and sky, tone mapped for a page."""

from axffit.preview.body import body_scene
from axffit.preview.environment import AbstractEnvironment, Studio, SunSky, Uniform
from axffit.preview.picture import (
    difference_to_display,
    display_steps,
    encode_srgb,
    indexed_png_bytes,
    png_bytes,
    to_display,
    tone_curve,
)
from axffit.preview.render import render_body, render_scene, render_scenes, render_sphere
from axffit.preview.sampling import Samples
from axffit.preview.scene import sphere_scene
from axffit.preview.surface import Shown

__all__ = [
    "AbstractEnvironment",
    "Samples",
    "Shown",
    "Studio",
    "SunSky",
    "Uniform",
    "body_scene",
    "difference_to_display",
    "display_steps",
    "encode_srgb",
    "indexed_png_bytes",
    "png_bytes",
    "render_body",
    "render_scene",
    "render_scenes",
    "render_sphere",
    "sphere_scene",
    "to_display",
    "tone_curve",
]
