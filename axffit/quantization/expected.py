"""The error to expect: how much of the light that reaches a viewer changes under a lighting, not under the worst light.

    light       sum |f' - f| i_z E / sum f i_z E                    over lights, texels and views
    picture     mean over texels and views of |sum (f' - f) i_z E| / sum f i_z E, the sums over lights

The first is the expected error of a single light drawn from the lighting, weighted by what it contributes; in the
second the errors of many lights cancel as they do in a pixel. E is a light's irradiance; the three channels are added.
Under the uniform lighting lights stand in the rings of the lobes (`directions`), each with the solid angle it stands
for. Another lighting is a list of lights, in a frame whose z axis points to the viewer, as on a sphere in a picture;
each texel and view turns it about that axis by an angle of its own.
"""

from dataclasses import dataclass, field
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..frames import refract
from .definitions import RINGS, SPOKES, normals_of
from .directions import GOLDEN_ANGLE, LobeFrames, ring_solid_angles
from .statistics import finite_or_none

UNIFORM = "uniform"
MOST_LIGHTS = 1 + RINGS * SPOKES
"""Of a lighting: as many as the smallest set of lights that `definitions.lights_of` makes."""


@dataclass(frozen=True, eq=False)
class Lighting:
    """Lights at infinity.

    Attributes:
        name: for people, in a few words.
        directions: unit vectors to the lights (n, 3): x to the right, y up, z to the viewer.
        irradiance: what each gives a surface that faces it, linear RGB (n, 3).

    Raises:
        ValueError: more than `MOST_LIGHTS`.
    """

    name: str
    directions: np.ndarray
    irradiance: np.ndarray

    def __post_init__(self):
        if len(self.directions) > MOST_LIGHTS:
            raise ValueError(f"{self.name}: {len(self.directions)} lights; give {MOST_LIGHTS} at most")


@dataclass(frozen=True)
class Expected:
    """Expected errors under one lighting.

    Attributes:
        lighting: its name.
        light: of a single light, see above.
        picture: of all lights together.
    """

    lighting: str
    light: float
    picture: float

    def to_json(self) -> dict[str, Any]:
        """As a JSON object; an infinite error is null."""
        return {
            "lighting": self.lighting,
            "light": finite_or_none(self.light),
            "picture": finite_or_none(self.picture),
        }


@dataclass(eq=False)
class Tally:
    """Sums for one lighting over batches of texels."""

    lighting: str
    changed: float = 0.0
    reflected: float = 0.0
    pixels: list[np.ndarray] = field(default_factory=list)

    def add(self, f: np.ndarray, g: np.ndarray, irradiance: np.ndarray) -> None:
        """Adds f i_z and f' i_z (texels, views, lights, 3) under irradiances of the same shape."""
        weighted, other = f * irradiance, g * irradiance
        self.changed += float(np.sum(np.abs(other - weighted)))
        self.reflected += float(np.sum(weighted))
        pixel, seen = np.sum(weighted, axis=(2, 3)), np.sum(other, axis=(2, 3))
        lit = pixel > 0
        self.pixels.append(np.abs(seen - pixel)[lit] / pixel[lit])

    def expected(self) -> Expected:
        """The errors; 0 where nothing reflects."""
        pixels = np.concatenate(self.pixels)
        light = self.changed / self.reflected if self.reflected > 0 else 0.0
        return Expected(self.lighting, light, float(pixels.mean()) if pixels.size else 0.0)


def uniform_irradiance(frames: LobeFrames, texels: np.ndarray, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """Solid angles (n, views, lights, 1) of lights that `definitions.lights_of` made; 0 for those beside the rings.

    With h in the rings below the coat, d omega_i* = 4 <o*, h> d omega_h, and d omega_i = n² cos_i* / cos_i d omega_i*.
    """
    rings = ring_solid_angles(frames.roughness[texels], RINGS, SPOKES)
    base, coat, ior = (np.asarray(x) for x in normals_of(frames, texels))
    del base
    wo = np.broadcast_to(wo[:, :, None], wi.shape)
    coat, ior = np.broadcast_to(coat[:, None, None], wi.shape), np.broadcast_to(ior[:, None, None], wi.shape[:-1])
    inside = [np.asarray(refract(*(jnp.asarray(x) for x in (v, coat, ior)))) for v in (wi, wo)]
    cosine = np.sum(inside[0] * coat, axis=-1)
    along = 0.5 * np.linalg.norm(inside[0] + inside[1], axis=-1)
    jacobian = 4.0 * along * ior**2 * cosine / np.maximum(wi[..., 2], 1e-9)
    weights = np.zeros(wi.shape[:-1])
    weights[..., : rings.shape[1]] = rings[:, None]
    return (weights * np.where(wi[..., 2] > 0, jacobian, 0.0))[..., None]


def posed(lighting: Lighting, wo: np.ndarray, first: int) -> np.ndarray:
    """The lights (n, views, lights, 3) of a lighting in the texels' frames, for viewers (n, views, 3).

    ``first``: number of the first texel, from which the turns about the axis follow.
    """
    number = first * wo.shape[1] + np.arange(wo.shape[0] * wo.shape[1]).reshape(wo.shape[:2])
    turn = number * GOLDEN_ANGLE
    helper = np.where(np.abs(wo[..., 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    x = np.cross(helper, wo)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    y = np.cross(wo, x)
    cosine, sine = np.cos(turn)[..., None], np.sin(turn)[..., None]
    axes = np.stack([cosine * x + sine * y, cosine * y - sine * x, wo], axis=-2)
    return np.einsum("lk,nvki->nvli", lighting.directions, axes)
