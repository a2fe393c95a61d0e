"""Surfaces of every kind are drawn, and can be evaluated anywhere."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import Phase, find, given, settings

from axffit.brdf import AbstractBRDF
from axffit.testing.strategies import svbrdfs, texture_maps

FEW = settings(max_examples=settings().max_examples // 4)


@given(texture_maps(channels=2, slices=3, lowest=-0.5, highest=2.0))
@FEW
def test_maps_hold_the_range_and_fill_their_levels(texture):
    assert (float(texture.texels.min()), float(texture.texels.max())) == (-0.5, 2.0)
    assert texture.texels.shape[1] == 2
    assert {slices for slices, _, _ in texture.shapes} == {3}


@given(svbrdfs(most=1))
@settings(max_examples=settings().max_examples // 8)
def test_surfaces_have_a_brdf_everywhere(surface):
    model = surface.at(jnp.asarray([0.3, -1.7]))
    assert isinstance(model, AbstractBRDF)
    up = jnp.asarray([0.0, 0.0, 1.0])
    assert np.isfinite(model.evaluate(up, up)).all()
    assert 0 <= float(surface.opacity(jnp.asarray([0.3, 0.7]))) <= 1


CASES = {
    "one texel": (texture_maps(), lambda t: t.shapes == ((1, 1, 1),)),
    "mip levels": (texture_maps(), lambda t: len(t.shapes) == 4),
    "not square": (texture_maps(), lambda t: t.shapes[0][1] > 2 * t.shapes[0][2]),
    "mirrored": (texture_maps(), lambda t: t.mirrored),
    "tiled": (texture_maps(), lambda t: t.tiles[0] > 1 > t.tiles[1]),
    "flakes": (svbrdfs(most=1), lambda s: isinstance(s.shared, dict) and "flakes" in s.shared),
    "coat": (svbrdfs(most=1), lambda s: s.shared is None and "coat_color" in s.maps),
    "alpha": (svbrdfs(most=1), lambda s: s.alpha is not None),
    "height": (svbrdfs(most=1), lambda s: s.height is not None),
    "bare maps": (svbrdfs(most=1), lambda s: "roughness" in s.maps and s.maps["roughness"] is not None),
}


SLOW = ("flakes",)


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in CASES])
def test_every_case_is_drawn(name):
    strategy, condition = CASES[name]
    once = settings(max_examples=500, phases=[Phase.generate], derandomize=True, database=None)
    find(strategy, lambda drawn: bool(condition(drawn)), settings=once)


def test_arguments_are_checked():
    for wrong in ({"channels": 0}, {"most": 0}, {"slices": 0}):
        with pytest.raises(ValueError, match="at least one of each"):
            texture_maps(**wrong)
    with pytest.raises(ValueError, match="finite range"):
        texture_maps(lowest=1.0, highest=0.0)
    with pytest.raises(ValueError, match="at least one texel"):
        svbrdfs(most=0)
