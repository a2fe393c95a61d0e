"""GGX and Beckmann's D against Mitsuba 3, an implementation by others.

Mitsuba computes in float32. Both sides get the same directions, of float32 numbers that are not normalized again, so
what is compared is the formulas: normalizing one side's directions alone moves h by 6e-8, and D by 1e-5 at a
roughness of 0.05. Mitsuba's ``wi`` is the light here, its ``wo`` our viewer; its value holds the viewer's cosine.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import GGX
from axffit.brdf.cook_torrance import beckmann
from axffit.brdf.geometry import half_geometry

pytestmark = pytest.mark.slow

ROUGHNESSES = [(0.05, 0.05), (0.1, 0.1), (0.3, 0.3), (1.0, 1.0), (0.05, 0.3), (1.0, 0.05), (0.5, 0.2)]
COUNT = 3000
STEEPEST = np.cos(np.radians(85.0))
TOLERANCE = 1e-5


@pytest.fixture(scope="module")
def mitsuba():
    module = pytest.importorskip("mitsuba", reason="needs the extra `mitsuba`")
    module.set_variant("scalar_rgb")
    return module


def up_to_85_degrees(rng, count):
    cosine, phi = np.cos(np.radians(85.0) * rng.random(count)), 2 * np.pi * rng.random(count)
    sine = np.sqrt(1 - cosine**2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1).astype(np.float32)


def pairs(roughness):
    """Pairs of directions up to 85 degrees, half of them about the mirror direction, where a narrow lobe is."""
    rng = np.random.default_rng(6)
    light, viewer = up_to_85_degrees(rng, COUNT), up_to_85_degrees(rng, COUNT)
    spread = min(roughness) * rng.standard_normal((COUNT // 2, 3))
    near = light[::2] * [-1, -1, 1] + spread
    viewer[::2] = near / np.linalg.norm(near, axis=1, keepdims=True)
    kept = (viewer[:, 2] >= STEEPEST) & (light[:, 2] >= STEEPEST)
    assert np.count_nonzero(kept) > 2000
    return light[kept], viewer[kept]


@pytest.mark.parametrize("roughness", ROUGHNESSES)
def test_ggx_is_mitsubas_rough_conductor(mitsuba, roughness):
    light, viewer = pairs(roughness)
    conductor = {"type": "roughconductor", "material": "none", "distribution": "ggx"}
    theirs = mitsuba.load_dict(conductor | {"alpha_u": roughness[0], "alpha_v": roughness[1]})
    context, surface, found = mitsuba.BSDFContext(), mitsuba.SurfaceInteraction3f(), []
    for wi, wo in zip(light, viewer, strict=True):
        surface.wi = mitsuba.Vector3f(*map(float, wi))
        found.append(theirs.eval(context, surface, mitsuba.Vector3f(*map(float, wo)))[0])
    ours = GGX(jnp.ones(3), jnp.asarray(roughness), normalization="microfacet")
    value = ours.evaluate(jnp.asarray(light, float), jnp.asarray(viewer, float))[:, 0]
    np.testing.assert_allclose(found, value * viewer[:, 2].astype(float), rtol=TOLERANCE)


@pytest.mark.parametrize("roughness", ROUGHNESSES)
def test_beckmanns_d_is_mitsubas(mitsuba, roughness):
    """Mitsuba's D has its 1 / pi; it is 0 below 1e-20 / h_z, where ours goes on.

    Its exponent reaches -46 there, and float32's rounding of it is all the difference: 8.7e-6 at most.
    """
    light, viewer = (v.astype(float) for v in pairs(roughness))
    half = (light + viewer) / np.linalg.norm(light + viewer, axis=1, keepdims=True)
    half = half.astype(np.float32)
    kind = mitsuba.MicrofacetType.Beckmann
    theirs = mitsuba.MicrofacetDistribution(kind, *roughness, sample_visible=False)
    found = np.array([theirs.eval(mitsuba.Vector3f(*map(float, h))) for h in half])
    # The half vector of h and h is h.
    alpha, beta = (jnp.asarray(a) for a in roughness)
    value = jax.vmap(lambda h: beckmann(half_geometry(h, h), alpha, beta, jnp.asarray(1.0)))(jnp.asarray(half, float))
    value = np.asarray(value) / np.pi
    shown = value * half[:, 2] > 1e-20
    assert (found[~shown] < 2e-20 / half[~shown, 2]).all()
    assert np.count_nonzero(shown) > 1000
    np.testing.assert_allclose(found[shown], value[shown], rtol=TOLERANCE)
