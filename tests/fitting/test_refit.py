"""One lobe as another: identities, laws of scale, and what of a material changes and what stays."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.axf import AxfMaterial, AxfTexture, MaterialKind, to_brdf
from axffit.errors import InputError
from axffit.fitting import CubeRoot, LogCosine, NoiseWeighted
from axffit.fitting.conversion import convert, nodes
from axffit.fitting.refit import loss, microfacet, refit
from tests.targets.materials import paint


def lobes(model: str, *, variant: str | None = None, fresnel: str | None = "Schlick1994") -> AxfMaterial:
    """2 x 3 texels of different roughness and color."""
    rng = np.random.default_rng(5)

    def varying(low: float, high: float, channels: int) -> AxfTexture:
        return AxfTexture((rng.uniform(low, high, (2, 3, channels)).astype(np.float32),), 3.0, 2.0)

    textures = {
        "diffusecolor": varying(0.05, 0.3, 3),
        "specularcolor": varying(0.2, 0.5, 3),
        "specularlobe": varying(0.15, 0.2, 1),
        "fresnel": varying(0.3, 0.4, 1),
    }
    return AxfMaterial("lobes", "lobes", MaterialKind.SVBRDF, "Lambert", model, variant, fresnel, textures=textures)


def converted(material: AxfMaterial, target: str, residual=None, *, brightness=1.0, lobe=0.2, f0=0.3):
    with jax.enable_x64(new_val=True):
        return convert(
            material, target, residual or CubeRoot(), brightness=brightness, lobes=(lobe, lobe), f0=(f0, f0)
        )[0]


@pytest.mark.slow
@pytest.mark.parametrize(("model", "target"), [("GGX", "ggx"), ("Ward", "ward"), ("CookTorrance", "cook-torrance")])
def test_a_lobe_as_itself_is_itself(model, target):
    table = converted(lobes(model), target, lobe=0.2, f0=0.3)
    np.testing.assert_allclose(table.roughness, 0.2, rtol=1e-5)
    np.testing.assert_allclose((table.p, table.q), [[[0.3]], [[0.7]]], rtol=1e-4)
    assert table.misfit < 1e-6


@pytest.mark.slow
def test_the_cube_root_does_not_see_the_color_and_the_log_does():
    ward = lobes("Ward", fresnel=None)
    dark, bright = (converted(ward, "ggx", CubeRoot(floor=1e-15), brightness=c) for c in (0.01, 1.0))
    np.testing.assert_allclose(dark.roughness, bright.roughness, rtol=1e-3)
    np.testing.assert_allclose(dark.p, bright.p, rtol=1e-3)
    dark, bright = (converted(ward, "ggx", LogCosine(), brightness=c) for c in (0.01, 1.0))
    assert abs(dark.roughness - bright.roughness) > 0.01 * bright.roughness


@pytest.mark.slow
def test_an_exponent_becomes_the_roughness_of_the_same_width():
    # Near the highlight cos^n is exp(-n theta² / 2), and the distribution of Ward exp(-theta² / alpha²).
    table = converted(lobes("BlinnPhong", variant="Blinn1977", fresnel=None), "ward", lobe=6.0)
    assert table.exponents
    np.testing.assert_allclose(table.roughness, np.sqrt(2.0 / 2.0**6), rtol=0.1)


def test_nodes_span_the_range():
    assert nodes(0.3, 0.3, most=9, ratio=1.4, logarithmic=True).tolist() == [0.3]
    found = nodes(0.01, 0.5, most=24, ratio=1.4, logarithmic=True)
    assert (found[0], found[-1]) == (pytest.approx(0.01), pytest.approx(0.5))
    assert np.all(found[1:] / found[:-1] <= 1.4)
    assert len(nodes(1e-4, 1.0, most=5, ratio=1.01, logarithmic=True)) == 5


@pytest.fixture(scope="module")
def as_ggx():
    material = lobes("GGX")
    return material, refit(material, "ggx")


@pytest.mark.slow
def test_texels_of_the_same_model_come_back(as_ggx):
    material, found = as_ggx
    assert found.interpolation is not None
    assert found.interpolation < 1e-4
    for key in ("specularcolor", "specularlobe", "fresnel", "diffusecolor"):
        before, after = (one.textures[key] for one in (material, found.material))
        np.testing.assert_allclose(after.data, before.data, rtol=2e-4)
        assert (after.width_mm, after.height_mm) == (before.width_mm, before.height_mm)
    uv = np.array([[0.2, 0.3], [0.9, 0.7]])
    assert max(metrics.relative_cosine_rms for metrics in loss(material, found.material, uv)) < 1e-3


@pytest.mark.slow
def test_microfacet_colors_are_four_times_the_sdk_s(as_ggx):
    _, found = as_ggx
    scaled = microfacet(found.material).textures["specularcolor"].data
    np.testing.assert_array_equal(scaled, 4 * found.material.textures["specularcolor"].data)
    with pytest.raises(InputError, match="only cook-torrance and ggx"):
        microfacet(replace(found.material, specular_model="Ward"))


def test_what_cannot_be_refitted_is_refused():
    svbrdf = lobes("Ward")
    for to, problem in {
        "disney": "unknown model 'disney'",
        "ggx+glaze": "unknown model",
        "carpaint": "no car paint's color table",
        "ggx+coat": "it has no coat: use ggx",
    }.items():
        with pytest.raises(InputError, match=problem):
            refit(svbrdf, to)
    coated = replace(svbrdf, textures=dict(svbrdf.textures) | {"clearcoatior": AxfTexture((np.full((1, 1, 1), 1.5),))})
    with pytest.raises(InputError, match=r"ggx\+coat keeps it"):
        refit(coated, "ggx")
    with pytest.raises(InputError, match="no noise"):
        refit(svbrdf, "ggx", residual=NoiseWeighted())


@pytest.mark.slow
def test_a_paint_as_fewer_lobes_and_as_one_lobe_below_its_coat():
    original = paint()
    fewer = refit(original, "carpaint+coat", lobes=1)
    assert fewer.material.kind is MaterialKind.CAR_PAINT
    assert len(fewer.material.properties["CT_spreads"]) == 1
    assert fewer.material.properties["IOR"] == original.properties["IOR"]
    single = refit(original, "ggx+coat")
    assert single.material.kind is MaterialKind.SVBRDF
    assert single.material.has_clear_coat
    here = np.array([[0.5, 0.5]])
    one, other = (loss(original, found.material, here)[0] for found in (fewer, single))
    assert single.fit is not None
    assert single.fit.metrics is not None
    # The written material reflects what the fit says it does.
    assert other.log == pytest.approx(single.fit.metrics.log, rel=0.5)
    assert one.log < other.log
    wi = wo = jnp.array([0.0, 0.6, 0.8])
    assert np.all(np.asarray(to_brdf(single.material, uv=np.array([0.5, 0.5])).evaluate(wi, wo)) > 0)
