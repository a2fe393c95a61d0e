"""Pictures of a page as data URIs: error maps on a color scale, spheres."""

import base64
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import matplotlib
import numpy as np

from axffit import axf
from axffit.brdf import AbstractBRDF
from axffit.preview import (
    difference_to_display,
    display_steps,
    indexed_png_bytes,
    png_bytes,
    render_layers,
    render_sphere,
    to_display,
)

LARGEST_SIDE = 128
"""Error maps are shown with at most this many pixels a side."""

SMALLEST_GAIN, LARGEST_GAIN = 8.0, 4096.0
"""The difference of two spheres is amplified by the largest power of two between these that keeps most on scale."""

LARGEST_COST = 20_000
"""Operations a pair of directions: a coated car paint takes about 700, a neural encoding 2000."""

MOST = 0.995
"""Part of the pixels that the amplified difference keeps on scale."""

TEXTURE_REPEATS = 2.0
"""How often a texture repeats over half the sphere's circumference."""

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


class Spheres(NamedTuple):
    """Spheres of a material before and after, and what became of the light."""

    uris: dict[str, str]
    """"before", "after" and "difference"."""
    gain: float
    """Amplification of the difference."""
    largest: float
    """Largest difference in 8-bit steps of the display, before rounding to them."""
    most: float
    """What 99.5 % of the picture's pixels do not exceed, in the same steps."""


def material_spheres(before: axf.AxfMaterial, after: axf.AxfMaterial, *, size: int) -> Spheres:
    """Spheres of a material before and after packing and their amplified difference."""
    textured = before.kind is axf.MaterialKind.SVBRDF
    repeats = TEXTURE_REPEATS if textured else 1.0
    radiance = [render_sphere(axf.to_brdf(m), size=size, textured=textured, repeats=repeats) for m in (before, after)]
    steps = display_steps(*radiance)
    most = float(np.quantile(steps, MOST))
    gain = SMALLEST_GAIN
    while gain < LARGEST_GAIN and 2 * gain * most <= 255:
        gain *= 2
    shown = [*(to_display(x) for x in radiance), difference_to_display(*radiance, gain=gain)]
    names = ("before", "after", "difference")
    uris = {name: data_uri(png_bytes(picture)) for name, picture in zip(names, shown, strict=True)}
    return Spheres(uris, gain, float(steps.max()), most)


def spheres(brdf: AbstractBRDF, *, size: int) -> tuple[str, str]:
    """Spheres of one BRDF, without and with the reflection in its coat."""
    base, coated = render_layers(brdf, size=size)
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
