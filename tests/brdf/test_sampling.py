"""Draws against densities: every model's samples integrate to what quadrature integrates to."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import ClearCoat, Lambert
from axffit.brdf.sampling import DOWN
from axffit.hemisphere import gauss_legendre_hemisphere
from tests.brdf.models import MODELS, S

TOO_NARROW = {
    name: "its lobe is narrower than the quadrature's steps; the same code is tested at larger roughness"
    for name in MODELS
    if name.endswith("smooth") or name == "coated, narrow mirror"
}
WO = jnp.asarray([0.48, 0.36, 0.8])


@eqx.filter_jit
def moments(model, u, nodes, weights):
    """Share of draws that carry light and the albedo, each by draws (with standard errors) and by quadrature."""
    wi = model.sample(WO, u)
    density, value = model.pdf(wi, WO), model.evaluate(wi, WO)
    lit = density > 0
    estimate = jnp.where(lit, value[:, 0] * wi[:, 2] / jnp.where(lit, density, 1.0), 0.0)
    drawn = jnp.stack([(wi[:, 2] > 0).astype(float), estimate])
    expected = jnp.stack(
        [jnp.sum(model.pdf(nodes, WO) * weights), jnp.sum(model.evaluate(nodes, WO)[:, 0] * nodes[:, 2] * weights)]
    )
    return drawn.mean(axis=1), drawn.std(axis=1) / jnp.sqrt(len(u)), expected


@pytest.mark.parametrize("name", sorted(MODELS.keys() - TOO_NARROW.keys()))
def test_draws_integrate_like_quadrature(name):
    """False alarm below 1e-4 for the whole table: two-sided 5.2 standard errors, 2e-7 each."""
    u = jax.random.uniform(jax.random.key(1), (20_000, 3))
    mean, error, expected = moments(MODELS[name](), u, *gauss_legendre_hemisphere(250, 250))
    quadrature = 2e-3 * np.maximum(expected, 1e-3)
    assert (np.abs(mean - expected) < 5.2 * error + quadrature).all(), (mean, error, expected)


@pytest.mark.parametrize("name", MODELS)
def test_draws_are_unit_vectors_with_a_density_or_carry_no_light(name):
    model = MODELS[name]()
    rng = np.random.default_rng(2)
    u = jnp.asarray(np.concatenate([rng.random((300, 3)), [[0, 0, 0], [1 - 1e-16, 1 - 1e-16, 0.5]]]))
    for cosine in (1.0, 0.3, 1e-3, -0.2):
        wo = jnp.asarray([np.sqrt(1 - cosine**2), 0.0, cosine])
        wi = model.sample(wo, u)
        density = model.pdf(wi, wo)
        np.testing.assert_allclose(jnp.linalg.norm(wi, axis=-1), 1.0, rtol=1e-9)
        assert jnp.isfinite(density).all()
        lit = wi[:, 2] > 0
        assert (density[lit] > 0).all()
        np.testing.assert_array_equal(wi[~lit], np.broadcast_to(DOWN, wi[~lit].shape))
        assert (density[~lit] == 0).all()
        assert cosine > 0 or not lit.any()


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
