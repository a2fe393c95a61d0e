"""The previews' lightings as lights: they give a surface what the environment gives it."""

import jax.numpy as jnp
import numpy as np
import pytest

from axffit.cli._lightings import lightings
from axffit.preview import Studio, SunSky

ENVIRONMENTS = {"sun and sky": SunSky, "studio": Studio}


@pytest.mark.parametrize("lighting", lightings(), ids=lambda lighting: lighting.name)
@pytest.mark.parametrize("normal", [(0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (-0.6, 0.0, 0.8)], ids=str)
def test_a_surface_gets_the_irradiance_of_the_environment(lighting, normal):
    rng = np.random.default_rng(3)
    directions = rng.standard_normal((400_000, 3)).astype(np.float32)
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    radiance = np.asarray(ENVIRONMENTS[lighting.name]().radiance(jnp.asarray(directions)))
    wanted = 4 * np.pi * np.mean(radiance * np.maximum(directions @ np.float32(normal), 0)[:, None], axis=0)
    given = np.sum(lighting.irradiance * np.maximum(lighting.directions @ np.array(normal), 0)[:, None], axis=0)
    np.testing.assert_allclose(given, wanted, rtol=0.08)
