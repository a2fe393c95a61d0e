"""Draws are unit vectors with a density, or carry no light; the mirror is tested by its weight.

Where draws fall is tested in ``test_chi2``, what they reflect in ``test_furnace``.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import ClearCoat, Lambert
from axffit.brdf.sampling import DOWN
from axffit.testing.batches import pdf, sample
from tests.brdf.models import MODELS, S

WO = jnp.asarray([0.48, 0.36, 0.8])


@pytest.mark.parametrize("name", MODELS)
def test_draws_are_unit_vectors_with_a_density_or_carry_no_light(name):
    model = MODELS[name]()
    rng = np.random.default_rng(2)
    u = np.concatenate([rng.random((300, 3)), [[0, 0, 0], [1 - 1e-16, 1 - 1e-16, 0.5]]])
    cosines = np.repeat([1.0, 0.3, 1e-3, -0.2], len(u))
    wo = np.stack([np.sqrt(1 - cosines**2), 0 * cosines, cosines], axis=1)
    wi = sample(model, wo, np.tile(u, (4, 1)))
    density = pdf(model, wi, wo)
    np.testing.assert_allclose(np.linalg.norm(wi, axis=-1), 1.0, rtol=1e-9)
    assert np.isfinite(density).all()
    lit = wi[:, 2] > 0
    assert (density[lit] > 0).all()
    np.testing.assert_array_equal(wi[~lit], np.broadcast_to(DOWN, wi[~lit].shape))
    assert (density[~lit] == 0).all()
    assert not lit[cosines < 0].any()


def test_the_mirror_is_fresnels_share_in_the_mirror_direction():
    coat = ClearCoat(Lambert(S), 1.5, (0.1, 0.0, 1.0), (1.0, 0.5, 0.25))
    wi, weight = coat.mirror(WO)
    normal = np.asarray([0.1, 0.0, 1.0]) / np.sqrt(1.01)
    np.testing.assert_allclose(wi @ normal, WO @ normal, rtol=1e-14)
    np.testing.assert_allclose(weight, coat.reflectance(jnp.asarray(WO @ normal)) * coat.color, rtol=1e-14)


def test_a_narrow_mirror_lobe_holds_the_mirrors_energy():
    """What the delta reflects, a lobe of roughness 0.02 reflects too, to its own loss."""
    ior, black = 1.5, Lambert((0.0, 0.0, 0.0))
    wo = jnp.asarray([0.6, 0.0, 0.8])
    lobe = ClearCoat(black, ior, mirror_roughness=0.02)
    u = jax.random.uniform(jax.random.key(4), (50_000, 3))
    wi = lobe.sample(wo, u)
    density = lobe.pdf(wi, wo)
    weight = jnp.where(density > 0, lobe.evaluate(wi, wo)[:, 0] * wi[:, 2] / jnp.where(density > 0, density, 1.0), 0.0)
    _, mirror = ClearCoat(black, ior).mirror(wo)
    assert float(weight.mean()) == pytest.approx(float(mirror[0]), rel=0.01)
