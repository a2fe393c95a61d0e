"""Lights at infinity that can be sampled: soft boxes and a sun.

A light states its radiance in a direction and how to draw directions towards it, so that a renderer can place its
samples where the light is. Directions are in the scene's frame: x to the right, y up, z towards the camera.
Radiance is linear RGB in the units of :mod:`axffit.preview.environment` (a white diffuser in full light is about 1).
"""

import abc
import math

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Angles, Direction, Directions, Scalar
from axffit.frames import tangent_frame, to_world
from axffit.numerics import normalize

Uniforms = Float[Array, "count 2"]


def inner(v: Directions, axis: Direction) -> Angles:
    """<v, axis> for many v; by components, which vectorizes where a product with a 3-vector does not."""
    return v[..., 0] * axis[0] + v[..., 1] * axis[1] + v[..., 2] * axis[2]


def smoothstep(low, high, x: Angles) -> Angles:
    """0 below ``low``, 1 above ``high``, and the cubic 3 t² - 2 t³ between."""
    t = jnp.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


class AbstractLight(eqx.Module):
    """A light at infinity of one color: its radiance is ``shape(direction)`` × ``color``."""

    color: eqx.AbstractVar[RGB]

    @abc.abstractmethod
    def shape(self, direction: Directions) -> Angles:
        """Relative radiance arriving from unit ``direction``."""

    @abc.abstractmethod
    def sample(self, uniforms: Uniforms) -> Float[Array, "count 3"]:
        """Directions towards the light for points of the unit square."""

    @abc.abstractmethod
    def density(self, direction: Directions) -> Angles:
        """Probability per solid angle (1/sr) with which :meth:`sample` draws ``direction``."""


class SoftBox(AbstractLight):
    """A rectangular area light with rounded, soft edges, as a photographer's soft box looks in a reflection.

    A direction d meets the box at x = <d, a>/<d, c>, y = <d, b>/<d, c>, where c points to the middle of the box and
    a, b are its axes; it is lit where |x| < half_width, |y| < half_height. The light falls off towards the edges by
    ``falloff`` (a fraction), and vanishes over ``edge`` (a fraction of the smaller half size).
    """

    center: Direction
    across: Direction
    along: Direction
    half_width: Scalar
    half_height: Scalar
    color: RGB
    edge: float = eqx.field(static=True)
    falloff: float = eqx.field(static=True)

    def __init__(
        self, *, center, up, half_width: float, half_height: float, color, edge: float = 0.25, falloff: float = 0.25
    ):
        """``center`` and ``up`` need not be unit or perpendicular; sizes are tangents of half the angles subtended."""
        c = normalize(jnp.asarray(center, jnp.float32))
        a = normalize(jnp.cross(jnp.asarray(up, jnp.float32), c))
        self.center, self.across, self.along = c, a, jnp.cross(c, a)
        self.half_width, self.half_height = jnp.float32(half_width), jnp.float32(half_height)
        self.color = jnp.asarray(color, jnp.float32)
        self.edge, self.falloff = edge, falloff

    def _project(self, direction: Directions) -> tuple[Angles, Angles, Angles]:
        """(x, y) on the plane of the box, and the cosine with its middle."""
        cosine = inner(direction, self.center)
        scale = 1.0 / jnp.maximum(cosine, 1e-4)
        return inner(direction, self.across) * scale, inner(direction, self.along) * scale, cosine

    def shape(self, direction: Directions) -> Angles:
        """The soft rounded rectangle, zero behind."""
        x, y, cosine = self._project(direction)
        edge = self.edge * jnp.minimum(self.half_width, self.half_height)
        # Signed distance to a rectangle whose corners are rounded by `edge`, the softness of its rim.
        dx = jnp.abs(x) - (self.half_width - edge)
        dy = jnp.abs(y) - (self.half_height - edge)
        corner = jnp.sqrt(jnp.maximum(dx, 0.0) ** 2 + jnp.maximum(dy, 0.0) ** 2)
        distance = corner + jnp.minimum(jnp.maximum(dx, dy), 0.0)
        inside = 1.0 - smoothstep(0.0, edge, distance)
        radius2 = 0.5 * ((x / self.half_width) ** 2 + (y / self.half_height) ** 2)
        return jnp.where(cosine > 1e-4, inside * (1.0 - self.falloff * jnp.minimum(radius2, 1.0)), 0.0)

    def sample(self, uniforms: Uniforms) -> Float[Array, "count 3"]:
        """Uniform over the rectangle."""
        x = (2.0 * uniforms[:, :1] - 1.0) * self.half_width
        y = (2.0 * uniforms[:, 1:] - 1.0) * self.half_height
        return normalize(self.center[None, :] + x * self.across[None, :] + y * self.along[None, :])

    def density(self, direction: Directions) -> Angles:
        """(1 + x² + y²)^(3/2) / (4 half_width half_height) on the rectangle, 0 elsewhere."""
        x, y, cosine = self._project(direction)
        radius2 = 1.0 + x * x + y * y
        inside = (cosine > 1e-4) & (jnp.abs(x) <= self.half_width) & (jnp.abs(y) <= self.half_height)
        return jnp.where(inside, radius2 * jnp.sqrt(radius2) / (4.0 * self.half_width * self.half_height), 0.0)


class Sun(AbstractLight):
    """A disc of angular radius ``radius`` (radians) about ``center``, its rim soft over the outer part.

    ``color`` is its radiance: irradiance on a plane facing it / the solid angle it fills, 3/4 of the disc's because of
    the rim, so that a mirror shows the disc without jagged edges.
    """

    center: Direction
    color: RGB
    radius: float = eqx.field(static=True)

    def __init__(self, *, center, irradiance, radius: float):
        """``center`` need not be a unit vector; ``irradiance``: linear RGB (3,)."""
        self.center = normalize(jnp.asarray(center, jnp.float32))
        self.radius = radius
        self.color = jnp.asarray(irradiance, jnp.float32) / (0.75 * self._solid_angle())

    def _solid_angle(self) -> float:
        return 2.0 * math.pi * (1.0 - math.cos(self.radius))

    def shape(self, direction: Directions) -> Angles:
        """1 inside, falling to 0 between half and all of the disc's area."""
        # The chord keeps the digits that an arc cosine of nearly 1 loses.
        dx, dy, dz = (direction[..., k] - self.center[k] for k in range(3))
        return 1.0 - smoothstep(0.5, 1.0, (dx * dx + dy * dy + dz * dz) / self.radius**2)

    def sample(self, uniforms: Uniforms) -> Float[Array, "count 3"]:
        """Uniform over the disc's solid angle."""
        cosine = 1.0 - uniforms[:, 0] * (1.0 - math.cos(self.radius))
        sine = jnp.sqrt(jnp.maximum(1.0 - cosine * cosine, 0.0))
        phi = 2.0 * jnp.pi * uniforms[:, 1]
        local = jnp.stack([sine * jnp.cos(phi), sine * jnp.sin(phi), cosine], axis=-1)
        return to_world(tangent_frame(self.center)[None], local)

    def density(self, direction: Directions) -> Angles:
        """1 / solid angle inside the disc."""
        inside = inner(direction, self.center) >= math.cos(self.radius)
        return jnp.where(inside, 1.0 / self._solid_angle(), 0.0)
