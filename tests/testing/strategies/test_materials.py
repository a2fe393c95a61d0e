import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import Phase, find, given, settings

from axffit import axf
from axffit.axf.names import TEXTURE_KEYS
from axffit.axf.validation import problems
from axffit.testing.strategies import (
    axf_files,
    axf_materials,
    car_paint_materials,
    svbrdf_materials,
    textures,
)

UP = jnp.asarray([0.0, 0.0, 1.0])


def found(strategy, condition):
    # Not shrunk: it is enough that there is one.
    once = settings(max_examples=3000, phases=[Phase.generate], derandomize=True, database=None)
    return find(strategy, condition, settings=once)


@given(axf_materials(), axf_files())
@settings(max_examples=settings().max_examples // 8)
def test_what_is_drawn_is_valid(material, file):
    assert list(problems(material)) == []
    for each in file.materials:
        assert list(problems(each)) == []


@given(svbrdf_materials(), car_paint_materials())
@settings(max_examples=settings().max_examples // 8)
def test_evaluable_materials_are_valid_and_become_brdfs(svbrdf, paint):
    assert list(problems(svbrdf)) == []
    assert list(problems(paint)) == []
    axf.to_brdf(svbrdf, np.zeros(1, int), np.zeros(1, int))
    axf.to_svbrdf(paint)


CASES = {
    "a coat": (svbrdf_materials(most=1), lambda m: m.has_clear_coat),
    "no coat": (svbrdf_materials(most=1), lambda m: not m.has_clear_coat),
    "two roughnesses": (svbrdf_materials(most=1), lambda m: m.anisotropic and "anisrotation" in m.textures),
    "Phong": (svbrdf_materials(most=1), lambda m: m.specular_model == "Phong"),
    "maps of two sizes": (svbrdf_materials(), lambda m: len({t.data.shape[:2] for t in m.textures.values()}) > 1),
    "flakes": (car_paint_materials(most=1), lambda m: "btfflakes" in m.textures),
    "virtual bins": (
        car_paint_materials(most=1, flakes=True),
        lambda m: m.properties.get("num_thetaI", 9) < m.properties.get("num_thetaF", 0),
    ),
    "four lobes": (car_paint_materials(most=1), lambda m: len(m.properties["CT_coeffs"]) == 4),
    "a coat that does not bend": (car_paint_materials(most=1), lambda m: not m.coat_refracts),
    "an index that is no number": (textures(key="clearcoatior"), lambda t: bool(np.isnan(t.data).any())),
    "a negative color": (textures(key="diffusecolor"), lambda t: bool((t.data < 0).any())),
    "half precision": (textures(key="height"), lambda t: t.data.dtype == np.float16),
    "mip levels": (textures(key="btfflakes"), lambda t: len(t.levels) > 1),
}


@pytest.mark.parametrize("name", CASES)
def test_every_case_is_drawn(name):
    strategy, condition = CASES[name]
    found(strategy, condition)


def test_what_is_asked_for_is_drawn():
    assert found(svbrdf_materials(coated=True, anisotropic=True), lambda m: True).has_clear_coat
    assert found(svbrdf_materials(anisotropic=True), lambda m: True).anisotropic
    assert "btfflakes" in found(car_paint_materials(flakes=True), lambda m: True).textures
    assert found(axf_materials(id="mine"), lambda m: True).id == "mine"
    assert found(textures(key="specularlobe", channels=2), lambda t: True).channels == 2


@pytest.mark.parametrize("key", TEXTURE_KEYS)
def test_every_texture_can_be_drawn(key):
    assert found(textures(key=key), lambda t: True).channels >= 1


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="unknown texture 'bump'"):
        textures(key="bump")
    with pytest.raises(ValueError, match="has 1 or 2"):
        textures(key="specularlobe", channels=3)
    with pytest.raises(ValueError, match="at least one texel"):
        textures(key="height", most=0)
