"""Surroundings that light a preview: a photographer's studio, a sun and sky, a uniform white.

An environment is a smooth background plus lights that can be sampled, all at infinity: a sum of shapes, each with its
color. Frame of the scene: x to the right, y up, z towards the camera. Radiance is linear RGB scaled so that, at
exposure 1, a white diffuser in the best lit place is about 1: AxF's own scale, where the perfect diffuser is (1, 1, 1)
under any white light.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Angles, Channels, Directions
from axffit.preview.lights import AbstractLight, SoftBox, Sun, inner, smoothstep

_SUN = (-0.45, 0.64, 0.62285)
"""Unit direction to the sun: 40° up."""


class AbstractEnvironment(eqx.Module):
    """What a surface sees in every direction."""

    lights: eqx.AbstractVar[tuple[AbstractLight, ...]]
    colors: eqx.AbstractVar[Float[Array, "parts 3"]]
    """Linear RGB of each part of the background."""
    floor: eqx.AbstractVar[RGB]
    """Radiance of the unshadowed floor the object stands on."""

    @abc.abstractmethod
    def background(self, direction: Directions) -> list[Angles]:
        """Weight of each of ``colors`` in unit directions (..., 3)."""

    def radiance(self, direction: Directions) -> Channels:
        """Radiance arriving from ``direction`` (..., 3), linear RGB: background and lights."""
        weights = self.background(direction) + [light.shape(direction) for light in self.lights]
        # One small matrix product: a sum of shape × color would compute every shape three times, once a channel.
        colors = jnp.concatenate([self.colors, *[light.color[None] for light in self.lights]])
        return jnp.stack(weights, axis=-1) @ colors


def _colors(*rows: tuple[float, float, float]) -> Array:
    return jnp.asarray(rows, jnp.float32)


class Uniform(AbstractEnvironment):
    """The same radiance from everywhere (a white furnace)."""

    colors: Float[Array, "parts 3"]
    floor: RGB
    lights: tuple[AbstractLight, ...] = ()

    def __init__(self, color: tuple[float, float, float] = (1.0, 1.0, 1.0)):
        """``color``: radiance, linear RGB."""
        self.colors = _colors(color)
        self.floor = self.colors[0]
        self.lights = ()

    def background(self, direction: Directions) -> list[Angles]:
        """1 everywhere."""
        return [jnp.ones_like(direction[..., 1])]


class Studio(AbstractEnvironment):
    """A car photographer's studio: a large soft box overhead, a strip on either side, a cyclorama."""

    colors: Float[Array, "parts 3"]
    floor: RGB
    lights: tuple[AbstractLight, ...]

    def __init__(self):
        """The lights are fixed, so that pictures compare."""
        self.lights = (
            SoftBox(
                center=(-0.12, 0.86, 0.52), up=(0.0, 0.0, 1.0), half_width=0.66, half_height=0.30,
                color=(5.6, 5.6, 5.6), edge=0.25,
            ),
            SoftBox(
                center=(-0.98, 0.10, 0.20), up=(0.0, 1.0, 0.0), half_width=0.17, half_height=0.62,
                color=(5.0, 5.05, 5.2), edge=0.6,
            ),
            SoftBox(
                center=(0.96, 0.02, 0.02), up=(0.0, 1.0, 0.0), half_width=0.12, half_height=0.70,
                color=(5.4, 5.3, 5.15), edge=0.6,
            ),
        )  # fmt: skip
        self.colors = _colors((0.20, 0.20, 0.204), (0.028, 0.028, 0.031), (0.24, 0.24, 0.24), (0.06, 0.06, 0.06))
        self.floor = _colors((0.33, 0.33, 0.335))[0]

    def background(self, direction: Directions) -> list[Angles]:
        """Walls that darken towards the ceiling, a floor that darkens under the object."""
        y = direction[..., 1]
        above = smoothstep(-0.12, 0.08, y)
        ceiling, nadir = smoothstep(0.0, 0.7, y), smoothstep(0.1, 1.0, -y)
        return [above * (1.0 - ceiling), above * ceiling, (1.0 - above) * (1.0 - nadir), (1.0 - above) * nadir]


class SunSky(AbstractEnvironment):
    """A clear sky with the sun 40° up, over gray ground.

    The sky's luminance is the CIE standard clear sky (CIE S 011 / ISO 15469:2004, type 12), phi(Z) f(chi) with
    phi(Z) = 1 + a exp(b / cos Z), f(chi) = 1 + c (exp(d chi) - exp(d pi/2)) + e cos² chi and
    (a, b, c, d, e) = (-1, -0.32, 10, -3, 0.45); its tint runs from pale at the horizon to blue overhead. The sun's
    disc is widened to a radius of 1.2° at its own irradiance, so that a small picture can show its reflection.
    """

    colors: Float[Array, "parts 3"]
    floor: RGB
    lights: tuple[AbstractLight, ...]

    def __init__(self):
        """The sun stands high on the left, before the object."""
        self.lights = (Sun(center=_SUN, irradiance=(2.35, 2.20, 1.95), radius=0.021),)
        self.colors = _colors((0.60, 0.59, 0.57), (0.36, 0.54, 0.95), (0.26, 0.255, 0.24), (0.09, 0.09, 0.09))
        self.floor = _colors((0.38, 0.37, 0.35))[0]

    def background(self, direction: Directions) -> list[Angles]:
        """The sky's pale and blue parts above, sunlit ground below."""
        y = direction[..., 1]
        cosine = jnp.clip(inner(direction, jnp.asarray(_SUN, direction.dtype)), -1.0, 1.0)
        circumsolar = 10.0 * (jnp.exp(-3.0 * jnp.arccos(cosine)) - jnp.exp(-1.5 * jnp.pi)) + 0.45 * cosine * cosine
        luminance = (1.0 + circumsolar) * (1.0 - jnp.exp(-0.32 / jnp.maximum(y, 0.03)))
        above = smoothstep(-0.02, 0.02, y)
        blue, nadir = smoothstep(0.02, 0.55, y), smoothstep(0.2, 1.0, -y)
        sky, ground = above * luminance, 1.0 - above
        return [sky * (1.0 - blue), sky * blue, ground * (1.0 - nadir), ground * nadir]
