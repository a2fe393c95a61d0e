"""Directional albedo of the synthetic SVBRDFs, integrated: bases are passive, also under a coat."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from axffit import axf, brdf
from axffit.brdf.albedo import albedo
from axffit.synthesis.carbon import carbon_twill
from axffit.synthesis.fabrics import lace
from axffit.synthesis.leathers import leather, patent_leather
from axffit.synthesis.metal import brushed_metal, hammered_copper, turned_brass
from axffit.synthesis.variants import brushed_titanium
from axffit.synthesis.wood import lacquered_walnut

SIZE = 32
TEXELS = 24
VIEWS = np.deg2rad([0.0, 35.0, 65.0])


def chosen(material):
    """BRDFs of random texels without planted glints, and the part of them below the coat, frames taken off."""
    rng = np.random.Generator(np.random.PCG64(11))
    specular = np.broadcast_to(material.textures["specularcolor"].data, (SIZE, SIZE, 3))
    rows, columns = np.nonzero((specular <= 1).all(axis=-1))
    picked = rng.permutation(len(rows))[:TEXELS]
    return axf.to_brdf(material, rows[picked], columns[picked])


def reflected(model, *, mirror=False):
    wo = jnp.asarray(np.stack([np.sin(VIEWS), 0 * VIEWS, np.cos(VIEWS)], axis=-1), jnp.float32)
    return np.asarray(eqx.filter_vmap(lambda one: albedo(one, wo, samples=1024, mirror=mirror))(model))


def without_frame(model):
    base = model.base if isinstance(model, brdf.ClearCoat) else model
    assert isinstance(base, brdf.Framed)
    return base.base


@pytest.mark.slow
@pytest.mark.parametrize(
    "make",
    [leather, brushed_metal, carbon_twill, lacquered_walnut, turned_brass, lace, hammered_copper, brushed_titanium],
)
def test_no_base_reflects_more_than_it_receives(make):
    total = reflected(without_frame(chosen(make(SIZE))))
    assert total.shape == (TEXELS, len(VIEWS), 3)
    assert total.max() <= 1.005
    assert total.max() > 0.02


@pytest.mark.slow
@pytest.mark.parametrize("make", [patent_leather, turned_brass])
def test_a_coat_that_does_not_refract_leaves_them_passive(make):
    """Mirror and base together, the normals of both as the maps have them."""
    model = chosen(make(SIZE))
    assert isinstance(model, brdf.ClearCoat)
    assert not model.refracting
    total = reflected(model, mirror=True)
    assert 0.03 < total.min()
    assert total.max() <= 1.005
