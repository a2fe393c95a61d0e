"""Pictures of a material on a shape, in a studio or under sun and sky."""

from collections.abc import Sequence
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit.preview.body import body_scene
from axffit.preview.environment import AbstractEnvironment, Studio
from axffit.preview.integrate import mirrored_radiance, reflected_radiance
from axffit.preview.normals import facing, lobe_normal
from axffit.preview.picture import inverse_tone_curve, tone_curve
from axffit.preview.sampling import Samples
from axffit.preview.scene import Points, Scene, sphere_scene
from axffit.preview.surface import Looked, Shown, look_up

CHUNK = 64
"""Points shaded together: their samples stay within a core's cache."""


@eqx.filter_jit
def _shade(varying, fixed, environment, samples, frames, wo):
    def shade(point):
        leaves, frame, view = point
        brdf = facing(eqx.combine(leaves, fixed), view)
        base = reflected_radiance(brdf, environment, frame, view, lobe_normal(brdf, view), samples)
        return base, mirrored_radiance(brdf, environment, frame, view)

    return jax.lax.map(shade, (varying, frames, wo), batch_size=CHUNK)


def _padded(array: np.ndarray) -> np.ndarray:
    """``array`` with its last row repeated up to a whole number of chunks, so that one compilation serves."""
    missing = -len(array) % CHUNK
    return np.concatenate([array, np.repeat(array[-1:], missing, axis=0)])


def _single(tree):
    """``tree`` with its floating leaves in float32."""
    return jax.tree.map(lambda x: jnp.asarray(x, jnp.float32) if eqx.is_inexact_array(x) else x, tree)


class Shading(NamedTuple):
    """Light from the points of a scene towards the camera, linear RGB (P, 3), and their opacity (P,)."""

    base: np.ndarray
    mirror: np.ndarray
    opacity: np.ndarray


def shade_points(
    shown: Shown,
    points: Points,
    environment: AbstractEnvironment,
    *,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> Shading:
    """Radiance from ``points`` towards the camera: of the BRDF, and of its coat's mirror (0 without a coat).

    Args:
        shown: one BRDF, an AxF material, or one packed for a target.
        points: the visible points.
        environment: what they see; nothing shadows them.
        repeats: how often textures repeat over pi units of length, half the circumference of the sphere.
        samples: how many samples, and where; the default serves roughness from about 0.005 up.
    """
    count = len(points.wo)
    # Pictures need no more than float32, whatever the caller computes in.
    with jax.enable_x64(new_val=False):
        samples = Samples() if samples is None else samples
        looked: Looked = look_up(shown, points.uv * repeats, points.footprint * repeats)
        varying = jax.tree.map(lambda x: jnp.asarray(_padded(np.asarray(x))), _single(looked.varying))
        frames, wo = (jnp.asarray(_padded(x)) for x in (points.frames, points.wo))
        base, mirror = _shade(varying, _single(looked.fixed), _single(environment), samples, frames, wo)
        return Shading(np.asarray(base)[:count], np.asarray(mirror)[:count], looked.opacity)


class Pictures(NamedTuple):
    """A picture without and with the reflection of the surroundings in a coat, linear radiance (H, W, 3) float32."""

    base: np.ndarray
    coated: np.ndarray


def render_scenes(
    shown: Shown,
    scenes: Sequence[Scene],
    environment: AbstractEnvironment | None = None,
    *,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> list[Pictures]:
    """``shown`` on the shape of each scene, on the floor of ``environment`` (default: the studio).

    What is not opaque shows the backdrop through, not the far side. The other arguments are those of
    :func:`shade_points`. Show the pictures with :func:`axffit.preview.to_display`.
    """
    environment = Studio() if environment is None else environment
    # All points at once: the shader is compiled for their number.
    points = Points(*(np.concatenate(parts) for parts in zip(*(scene.points for scene in scenes), strict=True)))
    shading = shade_points(shown, points, environment, repeats=repeats, samples=samples)
    ends = np.cumsum([len(scene.points.wo) for scene in scenes])
    pictures = []
    for scene, end in zip(scenes, ends, strict=True):
        own = slice(end - len(scene.points.wo), end)
        behind, opacity = backdrop(scene, environment), shading.opacity[own]
        lights = shading.base[own], shading.base[own] + shading.mirror[own]
        pictures.append(Pictures(*(_over(behind, scene, light, opacity) for light in lights)))
    return pictures


def render_scene(
    shown: Shown,
    scene: Scene,
    environment: AbstractEnvironment | None = None,
    *,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> Pictures:
    """The same of one scene."""
    return render_scenes(shown, [scene], environment, repeats=repeats, samples=samples)[0]


def render_sphere(
    shown: Shown,
    environment: AbstractEnvironment | None = None,
    *,
    size: int = 256,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> np.ndarray:
    """A sphere, as linear radiance (size, size, 3) float32; see :func:`render_scenes`."""
    return render_scene(shown, sphere_scene(size), environment, repeats=repeats, samples=samples).coated


def render_body(
    shown: Shown,
    environment: AbstractEnvironment | None = None,
    *,
    width: int = 448,
    repeats: float = 1.0,
    samples: Samples | None = None,
) -> np.ndarray:
    """A car-body-like shape, as linear radiance (width / 2, width, 3) float32; see :func:`render_scenes`."""
    return render_scene(shown, body_scene(width), environment, repeats=repeats, samples=samples).coated


def _over(backdrop: np.ndarray, scene: Scene, radiance: np.ndarray, opacity: np.ndarray) -> np.ndarray:
    """The shape's points (P, 3) over the backdrop (H, W, 3)."""
    picture = backdrop.copy()
    rows, columns = scene.points.rows, scene.points.columns
    coverage = (scene.coverage[rows, columns] * opacity)[:, None]
    # Highlights are far brighter than white: mixing what is shown, not radiance, keeps the outline smooth.
    shown = coverage * tone_curve(radiance) + (1.0 - coverage) * tone_curve(picture[rows, columns])
    picture[rows, columns] = np.where(coverage < 1.0, inverse_tone_curve(shown), radiance)
    return picture.astype(np.float32)


def backdrop(scene: Scene, environment: AbstractEnvironment) -> np.ndarray:
    """The floor with the shape's soft shadow, fading into the wall behind, (H, W, 3)."""
    floor = np.asarray(environment.floor, np.float64)
    fade = 1.0 - 0.55 * np.clip((scene.height - 0.18) / 0.82, 0.0, 1.0) ** 1.2
    return floor * (fade * (1.0 - 0.9 * scene.shadow))[..., None]
