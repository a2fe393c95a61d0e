"""A sphere of a material in a studio, or under sun and sky."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit.brdf import AbstractBRDF
from axffit.preview.environment import AbstractEnvironment, Studio
from axffit.preview.integrate import mirrored_radiance, reflected_radiance
from axffit.preview.picture import inverse_tone_curve, tone_curve
from axffit.preview.sampling import Samples
from axffit.preview.scene import SPHERE_FILL, Points, Scene, sphere_scene
from axffit.preview.texels import lobe_normals, look_up, map_shape, minified

CHUNK = 64
"""Points shaded together: their samples stay within a core's cache."""


@eqx.filter_jit
def _shade_uniform(brdf, environment, samples, frames, wo, normals):
    def shade(point):
        frame, view, normal = point
        return reflected_radiance(brdf, environment, frame, view, normal, samples)

    return jax.lax.map(shade, (frames, wo, normals), batch_size=CHUNK)


@eqx.filter_jit
def _shade_texels(brdf, environment, samples, frames, wo, normals):
    varying, fixed = eqx.partition(brdf, eqx.is_inexact_array)

    def shade(point):
        leaves, frame, view, normal = point
        return reflected_radiance(eqx.combine(leaves, fixed), environment, frame, view, normal, samples)

    return jax.lax.map(shade, (varying, frames, wo, normals), batch_size=CHUNK)


@eqx.filter_jit
def _mirror(brdf, environment, frames, wo, *, textured: bool):
    varying, fixed = eqx.partition(brdf, eqx.is_inexact_array)

    def shade(leaves, frame, view):
        return mirrored_radiance(eqx.combine(leaves, fixed), environment, frame, view)

    return jax.vmap(shade, in_axes=(0 if textured else None, 0, 0))(varying, frames, wo)


def _padded(array: np.ndarray) -> np.ndarray:
    """``array`` with its last row repeated up to a whole number of chunks, so that one compilation serves."""
    missing = -len(array) % CHUNK
    return np.concatenate([array, np.repeat(array[-1:], missing, axis=0)])


def shade_points(
    brdf: AbstractBRDF,
    points: Points,
    environment: AbstractEnvironment,
    *,
    textured: bool = False,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Radiance from ``points`` towards the camera, (P, 3): of the BRDF, and of its coat's mirror (0 without a coat).

    Args:
        brdf: one BRDF, or, if ``textured``, a map of BRDFs (array leaves with leading axes height, width).
        points: the visible points.
        environment: what they see.
        textured: whether ``brdf`` is a map.
        repeats: how often a map repeats over half the circumference.
        samples: how many samples, and where; the default serves roughness from about 0.005 up.
    """
    count = len(points.wo)
    # Pictures need no more than float32, whatever the caller computes in.
    with jax.enable_x64(new_val=False):
        samples = Samples() if samples is None else samples
        if textured:
            brdf = look_up(brdf, points.uv * repeats)
        normals = lobe_normals(brdf, count)
        brdf, environment = _single(brdf), _single(environment)
        frames, wo, normals = (jnp.asarray(_padded(x)) for x in (points.frames, points.wo, normals))
        if textured:
            brdf = jax.tree.map(lambda x: jnp.asarray(_padded(np.asarray(x))) if eqx.is_inexact_array(x) else x, brdf)
        shade = _shade_texels if textured else _shade_uniform
        base = shade(brdf, environment, samples, frames, wo, normals)
        mirror = _mirror(brdf, environment, frames, wo, textured=textured)
        return np.asarray(base)[:count], np.asarray(mirror)[:count]


def _single(tree):
    """``tree`` with its floating leaves in float32."""
    return jax.tree.map(lambda x: jnp.asarray(x, jnp.float32) if eqx.is_inexact_array(x) else x, tree)


class SpherePictures(NamedTuple):
    """A sphere without and with the reflection of the surroundings in its coat, linear radiance (H, W, 3) float32."""

    base: np.ndarray
    coated: np.ndarray


def render_sphere(
    brdf: AbstractBRDF,
    environment: AbstractEnvironment | None = None,
    *,
    size: int = 256,
    textured: bool = False,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> np.ndarray:
    """A sphere on the floor of ``environment`` (default: the studio), as linear radiance (size, size, 3) float32.

    The other arguments are those of :func:`shade_points`. Show it with :func:`axffit.preview.to_display`.
    """
    return render_layers(brdf, environment, size=size, textured=textured, repeats=repeats, samples=samples).coated


def render_layers(
    brdf: AbstractBRDF,
    environment: AbstractEnvironment | None = None,
    *,
    size: int = 256,
    textured: bool = False,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> SpherePictures:
    """As :func:`render_sphere`, also without the coat's mirror, which samples of a BRDF do not hold."""
    environment = Studio() if environment is None else environment
    scene = sphere_scene(size)
    if textured:
        # A pixel in the middle of the sphere sees so many texels a side; a GPU would take the mip level of that.
        texels_per_pixel = max(map_shape(brdf)) * repeats / (0.5 * SPHERE_FILL * np.pi * size)
        brdf = minified(brdf, 2 ** max(0, round(np.log2(max(texels_per_pixel, 1.0)))))
    base, mirror = shade_points(brdf, scene.points, environment, textured=textured, repeats=repeats, samples=samples)
    behind = backdrop(scene, environment)
    return SpherePictures(_over(behind, scene, base), _over(behind, scene, base + mirror))


def _over(backdrop: np.ndarray, scene: Scene, radiance: np.ndarray) -> np.ndarray:
    """The sphere's points (P, 3) over the backdrop (H, W, 3)."""
    picture = backdrop.copy()
    rows, columns = scene.points.rows, scene.points.columns
    coverage = scene.coverage[rows, columns][:, None]
    # Highlights are far brighter than white: mixing what is shown, not radiance, keeps the outline smooth.
    shown = coverage * tone_curve(radiance) + (1.0 - coverage) * tone_curve(picture[rows, columns])
    picture[rows, columns] = np.where(coverage < 1.0, inverse_tone_curve(shown), radiance)
    return picture.astype(np.float32)


def backdrop(scene: Scene, environment: AbstractEnvironment) -> np.ndarray:
    """The floor with the sphere's soft shadow, fading into the wall behind, (H, W, 3)."""
    floor = np.asarray(environment.floor, np.float64)
    fade = 1.0 - 0.55 * np.clip((scene.height - 0.18) / 0.82, 0.0, 1.0) ** 1.2
    return floor * (fade * (1.0 - 0.9 * scene.shadow))[..., None]
