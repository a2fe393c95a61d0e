"""Texels with known parameters under known light, for tests, benchmarks and experiments."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from axffit.fitting.texels.problem import Samples, TexelModel, model_values
from axffit.fitting.texels.shading import common_light


class SyntheticTexels(NamedTuple):
    """Made samples and the truth behind them; lanes last."""

    wi: Float[np.ndarray, "n 3"]
    wo: Float[np.ndarray, "n 3"]
    samples: Samples
    theta: Float[np.ndarray, "p lanes"]
    weights: Float[np.ndarray, "channels k lanes"]


def directions(images: int, seed: int = 0, steepest: float = 75.0) -> tuple[np.ndarray, np.ndarray]:
    """Lights and viewers (images, 3), uniform in projected solid angle within ``steepest`` degrees of the normal."""
    rng = np.random.default_rng(seed)
    sine = np.sin(np.radians(steepest)) * np.sqrt(rng.random((2, images)))
    azimuth = 2.0 * np.pi * rng.random((2, images))
    wi, wo = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.sqrt(1.0 - sine * sine)], axis=-1)
    return wi, wo


def truth(
    model: TexelModel, texels: int, channels: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "p lanes"], Float[np.ndarray, "channels k lanes"]]:
    """Parameters of a varied material: roughness .08 to .5, normals tilted by 5 degrees, F0 .1 to .9."""
    theta = [rng.uniform(np.log(0.08), np.log(0.5), texels)]
    if model.anisotropic:
        stretch, rotation = rng.uniform(0.1, 0.5, texels), rng.uniform(-np.pi / 2, np.pi / 2, texels)
        theta += [stretch * np.cos(2.0 * rotation), stretch * np.sin(2.0 * rotation)]
    if model.normal:
        theta += list(rng.normal(0.0, np.tan(np.radians(5.0)), (2, texels)))
    diffuse, specular = rng.uniform(0.05, 0.8, (channels, texels)), rng.uniform(0.02, 0.3, (channels, texels))
    f0 = rng.uniform(0.1, 0.9, (channels, texels))
    parts = [diffuse, specular * f0, specular * (1.0 - f0)] if model.fresnel else [diffuse, specular]
    return np.stack(theta), np.stack(parts, axis=1)


@jax.enable_x64(new_val=True)
def made(
    model: TexelModel,
    texels: int,
    *,
    channels: int = 3,
    images: int = 64,
    noise: float = 0.01,
    floor: float = 1e-3,
    seed: int = 0,
) -> SyntheticTexels:
    """Noisy samples: sigma² = (noise · value)² + (noise · floor)², Gaussian; stated as such."""
    rng = np.random.default_rng([seed, 1])
    wi, wo = directions(images, seed)
    theta, weights = truth(model, texels, channels, rng)
    light = common_light(wi, wo)
    clean = np.asarray(model_values(model, light, jnp.asarray(theta), jnp.asarray(weights)))
    variance = (noise * clean) ** 2 + (noise * floor) ** 2
    values = clean + np.sqrt(variance) * rng.standard_normal(clean.shape)
    return SyntheticTexels(wi, wo, Samples(light, jnp.asarray(values), jnp.asarray(1.0 / variance)), theta, weights)


def true_maps(model: TexelModel, texels: SyntheticTexels) -> dict[str, Float[np.ndarray, "channels lanes"]]:
    """The truth as AxF's maps hold it."""
    weights = np.moveaxis(texels.weights, 1, 0)
    maps = {"diffusecolor": weights[0], "specularcolor": weights[1:].sum(axis=0)}
    if model.fresnel:
        maps["fresnel"] = weights[1] / maps["specularcolor"]
    if model.anisotropic:
        mean, e1, e2 = texels.theta[:3]
        stretch = np.hypot(e1, e2)
        maps["specularlobe"] = np.exp(np.stack([mean + stretch, mean - stretch]))
        maps["anisrotation"] = 0.5 * np.arctan2(e2, e1)[None]
    else:
        maps["specularlobe"] = np.exp(texels.theta[:1])
    if model.normal:
        slopes = np.concatenate([texels.theta[-2:], np.ones((1, texels.theta.shape[1]))])
        maps["normal"] = slopes / np.linalg.norm(slopes, axis=0)
    return maps
