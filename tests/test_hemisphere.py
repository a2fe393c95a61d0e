"""Quadrature and sampling of the hemisphere."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit import hemisphere
from axffit.brdf import Lambert


@pytest.mark.parametrize("power", [0, 1, 2, 7])
def test_gauss_legendre_integrates_powers_of_the_cosine_exactly(power):
    directions, weights = hemisphere.gauss_legendre_hemisphere(6, 4)
    integral = jnp.sum(weights * directions[:, 2] ** power)
    assert float(integral) == pytest.approx(2 * np.pi / (power + 1), rel=1e-14)


@pytest.mark.parametrize(
    ("sample", "density"),
    [
        (hemisphere.sample_uniform, lambda z: jnp.full_like(z, 1 / (2 * np.pi))),
        (hemisphere.sample_cosine, lambda z: z / np.pi),
    ],
)
def test_samples_follow_their_density(sample, density):
    """False alarm 6e-5 a moment: five standard errors, two moments of two samplers."""
    directions = sample(jax.random.uniform(jax.random.key(3), (200_000, 2)))
    np.testing.assert_allclose(jnp.linalg.norm(directions, axis=-1), 1.0, rtol=1e-12)
    nodes, weights = hemisphere.gauss_legendre_hemisphere(32, 16)
    for moment in (lambda v: v[..., 2], lambda v: v[..., 0] ** 2 * v[..., 2]):
        expected = jnp.sum(weights * density(nodes[:, 2]) * moment(nodes))
        values = moment(directions)
        error = jnp.std(values) / np.sqrt(len(values))
        assert abs(float(jnp.mean(values) - expected)) < 5 * float(error)


def test_albedo_of_lambert_is_its_color():
    color = jnp.asarray([0.2, 0.5, 0.9])
    albedo = hemisphere.directional_albedo(Lambert(color), jnp.asarray([0.6, 0.0, 0.8]), polar_count=8, azimuth_count=8)
    np.testing.assert_allclose(albedo, color, rtol=1e-13)
