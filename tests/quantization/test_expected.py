"""Expected errors: the lights of the rings cover the hemisphere, a scaled BRDF errs by its scale under any lighting."""

import jax.numpy as jnp
import numpy as np
import pytest

from axffit.quantization.brdf_error import brdf_errors
from axffit.quantization.definitions import lights_of
from axffit.quantization.directions import LobeFrames, even_lights, views
from axffit.quantization.expected import MOST_LIGHTS, Lighting, Tally, posed, uniform_irradiance
from axffit.quantization.samples import sample_texels
from tests.quantization.test_brdf_error import single_lobe
from tests.targets.materials import with_texture

UP = np.tile([0.0, 0.0, 1.0], (3, 1))
WINDOW = Lighting("window", np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]]), np.ones((2, 3)))


@pytest.mark.parametrize(("ior", "close"), [(1.0, 0.02), (1.5, 0.2)])
@pytest.mark.parametrize("roughness", [(0.05, 0.05), (0.3, 0.1), (1.0, 1.0)])
def test_the_lights_of_the_rings_cover_the_hemisphere(roughness, ior, close):
    """Their solid angles times the cosine add up to pi, the view does not matter."""
    frames = LobeFrames(UP, np.zeros(3), np.full((3, 1, 2), roughness), UP, np.full(3, ior))
    wo, texels = views(3), np.arange(3)
    wi = np.asarray(lights_of(frames, texels, wo, even_lights(7)))
    weights = uniform_irradiance(frames, texels, wi, wo)[..., 0]
    assert np.all(weights[..., 0] == 0)
    assert np.all(weights[..., -7:] == 0)
    np.testing.assert_allclose(np.sum(weights * np.maximum(wi[..., 2], 0.0), axis=-1), np.pi, rtol=close)


def test_a_scaled_color_errs_by_its_scale():
    before = single_lobe("GGX", None, 0.1, size=4)
    after = with_texture(before, "specularcolor", np.full((4, 4, 3), 1.01))
    expected = brdf_errors(before, after, sample_texels(before, {}, 16), lightings=[WINDOW]).expected
    assert [each.lighting for each in expected] == ["uniform", "window"]
    for each in expected:
        assert each.light == pytest.approx(0.01, rel=1e-5)
        assert each.picture == pytest.approx(0.01, rel=1e-5)


def test_errors_that_cancel():
    tally = Tally("two lights")
    f = np.ones((1, 1, 2, 3))
    tally.add(f, f + np.array([0.1, -0.1])[:, None], np.ones(3))
    expected = tally.expected()
    assert expected.light == pytest.approx(0.1)
    assert expected.picture == pytest.approx(0.0, abs=1e-15)
    assert expected.to_json()["lighting"] == "two lights"


def test_a_lighting_is_turned_with_the_viewer():
    wo = views(3)
    lights = posed(WINDOW, wo, 0)
    np.testing.assert_allclose(lights[:, :, 0], wo, atol=1e-12)
    np.testing.assert_allclose(np.sum(lights[:, :, 1] * wo, axis=-1), 0.8, rtol=1e-12)
    assert len(np.unique(np.round(lights[:, 0, 1], 6), axis=0)) == 3
    assert jnp.isfinite(jnp.asarray(lights)).all()


def test_too_many_lights_are_refused():
    with pytest.raises(ValueError, match=f"give {MOST_LIGHTS} at most"):
        Lighting("stars", np.zeros((1000, 3)), np.zeros((1000, 3)))
