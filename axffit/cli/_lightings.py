"""The previews' lightings as lists of lights, for the expected error of the reflectance."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from axffit.quantization.expected import Lighting

BACKGROUND, SIDE = 180, 6
"""Lights for the background, spread evenly, and along each side of a light's own square."""


def lightings() -> "list[Lighting]":
    """Sun and sky, and the studio."""
    import jax.numpy as jnp
    import numpy as np

    from axffit.preview import Studio, SunSky
    from axffit.quantization.directions import GOLDEN_ANGLE
    from axffit.quantization.expected import Lighting

    index = np.arange(BACKGROUND) + 0.5
    y, turn = 1.0 - 2.0 * index / BACKGROUND, index * GOLDEN_ANGLE
    sine = np.sqrt(1.0 - y * y)
    even = np.stack([sine * np.cos(turn), y, sine * np.sin(turn)], axis=-1).astype(np.float32)
    square = np.stack(np.meshgrid(*2 * [(np.arange(SIDE) + 0.5) / SIDE]), axis=-1).reshape(-1, 2).astype(np.float32)
    made = []
    for name, environment in (("sun and sky", SunSky()), ("studio", Studio())):
        weights = jnp.stack(environment.background(jnp.asarray(even)), axis=-1)
        directions = [even]
        irradiance = [np.asarray(weights @ environment.colors) * 4 * np.pi / BACKGROUND]
        for light in environment.lights:
            drawn = light.sample(jnp.asarray(square))
            per_light = light.shape(drawn) / jnp.maximum(light.density(drawn), np.float32(1e-6)) / len(square)
            directions.append(np.asarray(drawn))
            irradiance.append(np.asarray(per_light)[:, None] * np.asarray(light.color))
        lights = [np.concatenate(parts).astype(np.float64) for parts in (directions, irradiance)]
        lights[0] /= np.linalg.norm(lights[0], axis=-1, keepdims=True)
        made.append(Lighting(name, lights[0], lights[1]))
    return made
