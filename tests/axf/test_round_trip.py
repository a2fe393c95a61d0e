"""What is written is read back bit for bit."""

import pytest
from hypothesis import given, settings

from axffit import axf
from axffit.synthesis import brushed_carbon, metallic_paint
from axffit.testing.strategies import axf_files


def assert_same(found, expected):
    assert found.version == expected.version
    assert [material.id for material in found.materials] == [material.id for material in expected.materials]
    assert found.unrecognized == ()
    assert found.inferred == ()
    for a, b in zip(found.materials, expected.materials, strict=True):
        assert a.identical(b)
        assert a.unrecognized == ()
        assert a.inferred == ()


# 500 of them: test_interoperability.py.
@settings(max_examples=40)
@given(file=axf_files())
def test_any_material(file, tmp_path_factory):
    path = tmp_path_factory.mktemp("round") / "a.axf"
    axf.write(path, file)
    assert_same(axf.read(path), file)


@pytest.mark.parametrize("make", [brushed_carbon, metallic_paint])
def test_synthetic_materials(make, tmp_path):
    file = axf.AxfFile((make(),))
    axf.write(tmp_path / "a.axf", file)
    assert_same(axf.read(tmp_path / "a.axf"), file)


def test_the_source_of_a_texture_is_its_node(tmp_path):
    axf.write(tmp_path / "a.axf", metallic_paint())
    flakes = axf.read(tmp_path / "a.axf").material().textures["btfflakes"]
    assert flakes.source == "/com.xrite.Materials/metallic_paint/com.xrite.Resources/CarPaintModel/BTFflakes"
