import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.errors import InputError
from axffit.fitting import RESIDUALS, CosineWeighted, CubeRoot, LogCosine, NoiseWeighted, metrics_of
from axffit.fitting.residuals import AbstractResidual

from .paints import paint, sampled


@pytest.mark.parametrize("name", RESIDUALS)
def test_slope_and_curvature_are_the_derivatives_of_the_transform(name):
    residual = RESIDUALS[name]()
    x = jnp.geomspace(1e-8, 1e4, 40)
    np.testing.assert_allclose(residual.slope(x), jax.vmap(jax.grad(residual.transform))(x), rtol=1e-10)
    second = jax.vmap(jax.grad(jax.grad(residual.transform)))(x)
    np.testing.assert_allclose(residual.curvature(x), second, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize("name", RESIDUALS)
def test_the_transform_is_finite_with_finite_slope_at_zero(name):
    residual = RESIDUALS[name]()
    zero = jnp.zeros(())
    assert residual.transform(zero) == 0
    assert np.isfinite(residual.slope(zero))
    assert residual.slope(zero) > 0


def test_the_cube_root_is_one_where_it_matters():
    x = jnp.geomspace(1e-5, 1e4, 20)
    np.testing.assert_allclose(CubeRoot().transform(x), np.cbrt(x), rtol=1e-4)


@pytest.mark.parametrize(
    ("residual", "metric"), [(CosineWeighted(), "relative_cosine_rms"), (LogCosine(), "log"), (CubeRoot(), "cube_root")]
)
def test_the_root_of_the_cost_is_the_metric(residual: AbstractResidual, metric):
    measurements = sampled(paint())
    measurements = dataclasses.replace(measurements, values=measurements.values - 0.003)
    other = 1.1 * measurements.values + 0.02
    data = residual.prepare(measurements)
    gc = jnp.asarray(np.maximum(other, 0.0) * data.factor[:, None])
    r = data.root_weight * (residual.transform(gc) - residual.transform(jnp.asarray(data.target)))
    expected = getattr(metrics_of(measurements, other, polar_limit=np.pi / 2), metric)
    np.testing.assert_allclose(np.sqrt(np.sum(r**2)), expected, rtol=1e-5)


def test_noise_weighting_needs_noise_and_keeps_negative_values():
    measurements = sampled(paint(), noise=0.5)
    assert measurements.negative_count > 0
    data = NoiseWeighted().prepare(measurements)
    np.testing.assert_array_equal(data.target, measurements.values)
    with pytest.raises(InputError, match="standard deviation"):
        NoiseWeighted().prepare(sampled(paint()))
