"""Pictures of a page as data URIs: error maps on a color scale, materials before and after."""

import base64
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import matplotlib
import numpy as np

from axffit import axf
from axffit.brdf import AbstractBRDF
from axffit.preview import (
    AbstractEnvironment,
    Studio,
    SunSky,
    body_scene,
    difference_to_display,
    display_steps,
    encode_srgb,
    indexed_png_bytes,
    png_bytes,
    render_scene,
    render_scenes,
    sphere_scene,
    to_display,
    tone_curve,
)
from axffit.quantization.images import image_errors
from axffit.targets import PackedMaterial

LARGEST_SIDE = 128
"""Error maps are shown with at most this many pixels a side."""

SMALLEST_GAIN, LARGEST_GAIN = 8.0, 4096.0
"""Differences are shown at the first, and at the largest power of two up to the second that keeps most on scale."""

LARGEST_COST = 20_000
"""Operations a pair of directions: a coated car paint takes about 700, a neural encoding 2000."""

MOST = 0.995
"""Part of the pixels that the amplified difference keeps on scale."""

TEXTURE_REPEATS, FLAKE_REPEATS = 2.0, 4.0
"""How often textures of an SVBRDF, and a car paint's flakes, repeat over half the sphere's circumference."""

BODY_WIDTH = 1.75
"""Width of the body's picture over that of the sphere's."""

SHAPES = {"sphere": "Sphere", "body": "Car-body-like shape"}
LIGHTS: dict[str, tuple[str, Callable[[], AbstractEnvironment]]] = {
    "studio": ("in a studio", Studio),
    "sun_sky": ("under sun and sky", SunSky),
}

PALETTE = np.round(255 * matplotlib.colormaps["viridis"](np.linspace(0.0, 1.0, 256))[:, :3]).astype(np.uint8)


def data_uri(png: bytes) -> str:
    """A PNG as the value of an ``src`` attribute."""
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")


class ErrorMapPicture(NamedTuple):
    """An error map as a picture."""

    uri: str
    largest: float
    """The error at the top of the color scale (largest finite error); 0 is at its bottom."""
    block: int
    """Each pixel shows the largest error of so many texels a side."""


def error_map_picture(errors: np.ndarray) -> ErrorMapPicture:
    """The picture of an error map (H, W): linear from 0 to the largest finite error; infinite errors at the top."""
    block = max(1, -(-max(errors.shape) // LARGEST_SIDE))
    shown = _block_maximum(np.where(np.isnan(errors), np.inf, errors).astype(np.float64), block)
    finite = shown[np.isfinite(shown)]
    largest = float(finite.max()) if finite.size else 0.0
    relative = np.minimum(shown / largest, 1.0) if largest > 0 else np.isinf(shown).astype(float)
    indices = np.round(255 * relative).astype(np.uint8)
    # Row 0 is v = 0, the bottom of the texture.
    return ErrorMapPicture(data_uri(indexed_png_bytes(indices[::-1], PALETTE)), largest, block)


def _block_maximum(values: np.ndarray, block: int) -> np.ndarray:
    height, width = values.shape
    padded = np.pad(values, ((0, -height % block), (0, -width % block)), mode="edge")
    return padded.reshape(padded.shape[0] // block, block, padded.shape[1] // block, block).max(axis=(1, 3))


def color_scale_css() -> str:
    """The palette as a CSS gradient, bottom of the scale at the left."""
    stops = ", ".join("#" + PALETTE[k].tobytes().hex() for k in range(0, 256, 51))
    return f"linear-gradient(90deg, {stops})"


class Pair(NamedTuple):
    """A picture of a material before and after packing."""

    facts: dict[str, Any]
    """JSON: shape, light, size, gain of the amplified difference, its largest value and what 99.5 % of the pixels do
    not exceed (8-bit steps of the display), FLIP, dE2000 and PSNR."""
    uris: dict[str, str]
    """"before", "after", "difference" (8 times) and "amplified" (``facts["gain"]`` times)."""


def material_pictures(before: axf.AxfMaterial, after: PackedMaterial, *, size: int) -> list[Pair]:
    """A sphere of ``size`` pixels and a body, each in a studio and under sun and sky, before and after packing.

    The errors are those of the pixels that the shape covers, as the display shows them before rounding to 8 bits.
    """
    repeats = TEXTURE_REPEATS if before.kind is axf.MaterialKind.SVBRDF else FLAKE_REPEATS
    scenes = {"sphere": sphere_scene(size), "body": body_scene(2 * round(0.5 * BODY_WIDTH * size))}
    pairs = []
    for light, (_, environment) in LIGHTS.items():
        drawn, seen = (
            render_scenes(shown, list(scenes.values()), environment(), repeats=repeats) for shown in (before, after)
        )
        for (shape, scene), *both in zip(scenes.items(), drawn, seen, strict=True):
            one, other = (each.coated for each in both)
            given, packed = (encode_srgb(tone_curve(x)) for x in (one, other))
            errors = image_errors(given, packed, scene.coverage > 0.0)
            steps = display_steps(one, other)
            most = float(np.quantile(steps, MOST))
            gain = SMALLEST_GAIN
            while gain < LARGEST_GAIN and 2 * gain * most <= 255:
                gain *= 2
            height, width = one.shape[:2]
            facts = {
                "shape": shape,
                "light": light,
                "width": width,
                "height": height,
                "difference_gain": gain,
                "largest_steps": float(steps.max()),
                "most_steps": most,
                **errors.to_json(),
            }
            shown = {
                "before": to_display(one),
                "after": to_display(other),
                "difference": difference_to_display(one, other, gain=SMALLEST_GAIN),
                "amplified": difference_to_display(one, other, gain=gain),
            }
            pairs.append(Pair(facts, {name: data_uri(png_bytes(picture)) for name, picture in shown.items()}))
    return pairs


def spheres(brdf: AbstractBRDF, *, size: int) -> tuple[str, str]:
    """Spheres of one BRDF, without and with the reflection in its coat."""
    base, coated = render_scene(brdf, sphere_scene(size))
    return data_uri(png_bytes(to_display(base))), data_uri(png_bytes(to_display(coated)))


def affordable(brdf: AbstractBRDF) -> bool:
    """Whether a sphere of ``brdf`` takes seconds, not minutes: a mean over hundreds of texels does not."""
    with jax.enable_x64(new_val=True):
        up = jnp.array([0.0, 0.0, 1.0])
        return _operations(jax.make_jaxpr(brdf.evaluate)(up, up).jaxpr) <= LARGEST_COST


def _operations(program: Any) -> int:
    """Scalar operations of a traced function, loops counted as often as they run."""
    total = 0
    for equation in program.eqns:
        inner = [x for x in jax.tree.leaves(list(equation.params.values()), is_leaf=_is_program) if _is_program(x)]
        if inner:
            length = equation.params.get("length", 1)
            total += length * sum(_operations(getattr(x, "jaxpr", x)) for x in inner)
        else:
            total += sum(int(np.prod(out.aval.shape)) for out in equation.outvars)
    return total


def _is_program(value: Any) -> bool:
    return hasattr(value, "eqns") or hasattr(value, "jaxpr")
