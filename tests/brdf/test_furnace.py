"""White furnace: what a model reflects of light that is the same everywhere, by draws and by quadrature.

The draws are random and weighted by f cos / pdf; the quadrature (``chi2.integrate``) knows neither draws nor densities
but for where to look. Two-sided z-tests of all models, viewers and channels; their false alarm is part of the 1e-4
that ``chi2.LEVEL`` divides. A coat's mirror is tested by its weight in ``test_sampling``.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.stats import norm

from axffit.testing.batches import in_batches
from tests.brdf import chi2
from tests.brdf.models import MODELS

pytestmark = pytest.mark.slow

BATCHES = 4
Z = norm.isf(chi2.LEVEL / 2)
ROUGH = 1e-5
"""Largest change of a rectangle's integral, of the model's albedo: color tables have kinks, and z-tests see 1e-4."""


@eqx.filter_jit
def weights(model, wo, u):
    """f cos / pdf of each draw, (n, 3); 0 for those that carry no light."""
    wi = model.sample(wo, u)
    density = model.pdf(wi, wo)
    lit = density > 0
    return model.evaluate(wi, wo) * jnp.where(lit, wi[:, 2] / jnp.where(lit, density, 1.0), 0.0)[:, None]


@eqx.filter_jit
def reflected(model, wi, wo):
    return model.evaluate(wi, wo) * wi[:, 2:]


@pytest.mark.parametrize("name", MODELS)
def test_draws_reflect_what_quadrature_says(name):
    model = MODELS[name]()
    rng = np.random.Generator(np.random.SFC64(31))
    for wo in chi2.VIEWERS:
        bins, wedge = chi2.lay(model, wo)

        def integrand(wi, wo=wo):
            return in_batches(reflected, model, wi, np.broadcast_to(wo, wi.shape), batch=4096)

        batches = [weights(model, jnp.asarray(wo), jnp.asarray(rng.random((chi2.BATCH, 3)))) for _ in range(BATCHES)]
        drawn = np.concatenate([np.asarray(batch) for batch in batches])
        rough = ROUGH * drawn.mean(axis=0).min()
        total, _, missed = chi2.integrate(bins, wedge, chi2.density_of(model, wo), integrand, rough)
        expected, missed = total.sum(axis=0), missed.sum(axis=0)
        error = drawn.std(axis=0) / np.sqrt(len(drawn))
        # A kink-ridden integrand is known to a thousandth of itself at worst, and nearly always far better.
        assert (missed <= 1e-3 * expected).all(), (missed, expected)
        # Draws too rare to have come up, such as the one in 10^8 that a narrow lobe loses below the horizon.
        unseen = drawn.max(axis=0) * -np.log(chi2.LEVEL) / len(drawn)
        distance = np.abs(drawn.mean(axis=0) - expected)
        assert (distance < Z * error + missed + unseen).all(), (expected, distance / error)
