"""What is written is read back bit for bit."""

import string

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from axffit import axf
from axffit.axf.names import FRESNEL_VARIANTS, SPECULAR_MODELS, SPECULAR_VARIANTS, TEXTURES
from axffit.synthesis import brushed_carbon, metallic_paint

FLOATS = st.sampled_from([np.dtype(np.float32), np.dtype(np.float16)])
NAMES = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=12)

RANGES = {
    "normal": (-1.0, 1.0),
    "clearcoatnormal": (-1.0, 1.0),
    "specularlobe": (0.0, 1.0),
    "opacity": (0.0, 1.0),
    "fresnel": (-1.0, 1.0),
}


def arrays(key, dtype, shape):
    if key == "clearcoatior":
        return hnp.arrays(dtype, shape)
    low, high = RANGES.get(key, (-1000.0, 1000.0))
    elements = st.floats(low, high, width=dtype.itemsize * 8)
    if "normal" in key:
        # One component is never 0, so that no normal is without a direction.
        return hnp.arrays(dtype, (*shape[:-1], 2), elements=elements).map(
            lambda xy: np.concatenate([xy, np.ones((*shape[:-1], 1), dtype)], axis=-1)
        )
    return hnp.arrays(dtype, shape, elements=elements)


# The strategies draw the arguments; the objects are made in the test, because beartype, which the suite runs under,
# chooses what to check with `random`, which Hypothesis forbids while drawing.
@st.composite
def textures(draw, key):
    layout = TEXTURES[key]
    dtype = draw(FLOATS)
    channels = draw(st.sampled_from(layout.channels))
    height, width = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    depth = (draw(st.integers(1, 4)),) if layout.rank == 4 else ()
    shapes = [(*depth, height, width, channels)]
    if layout.rank == 4:
        for _ in range(draw(st.integers(0, 3))):
            height, width = max(height // 2, 1), max(width // 2, 1)
            shapes.append((*depth, height, width, channels))
    levels = tuple(draw(arrays(key, dtype, shape)) for shape in shapes)
    size = st.floats(-1.0, 1e6, width=32)
    return levels, draw(size), draw(size)


def floats(low, high):
    return st.floats(float(np.float32(low)), high, width=32)


@st.composite
def properties(draw):
    found = {}
    lobes = draw(st.integers(0, 4))
    if lobes:
        for name, low, high in (("CT_coeffs", 0, 100), ("CT_F0s", 0, 1), ("CT_spreads", 1.1e-4, 8)):
            found[name] = draw(st.lists(floats(low, high), min_size=lobes, max_size=lobes))
    optional = {
        "CT_diffuse": floats(0, 1),
        "IOR": floats(1e-3, 10),
        "num_thetaF": st.integers(1, 64),
        "num_thetaI": st.integers(1, 64),
        "cc_no_refraction": st.integers(-(2**31), 2**31 - 1),
        "thetaFI_sliceLUT": st.lists(st.integers(1, 255), min_size=1, max_size=20).map(sorted),
    }
    for name, strategy in optional.items():
        value = draw(st.none() | strategy)
        if value is not None:
            found[name] = value
    return found


@st.composite
def materials(draw, identifier):
    keys = draw(st.sets(st.sampled_from(sorted(set(TEXTURES) - {"btfflakes"}))))
    found = {key: draw(textures(key)) for key in sorted(keys)}
    values = draw(properties())
    if "thetaFI_sliceLUT" not in values and draw(st.booleans()):
        found["btfflakes"] = draw(textures("btfflakes"))
    return {
        "id": identifier,
        "name": draw(NAMES),
        "kind": draw(st.sampled_from(axf.MaterialKind)),
        "diffuse_model": draw(st.sampled_from(["Lambert", "OrenNayar"])),
        "specular_model": draw(st.sampled_from(sorted(set(SPECULAR_MODELS)))),
        "specular_variant": draw(st.none() | st.sampled_from(sorted(SPECULAR_VARIANTS))),
        "fresnel_variant": draw(st.none() | st.sampled_from(FRESNEL_VARIANTS)),
        "anisotropic": draw(st.booleans()),
        "textures": found,
        "properties": values,
        "metadata": draw(st.dictionaries(NAMES, st.text(string.printable, max_size=20), max_size=3)),
    }


@st.composite
def files(draw):
    ids = draw(
        st.lists(NAMES | st.sampled_from([".", "..", "a/b", "100%", "../x"]), min_size=1, max_size=3, unique=True)
    )
    version = draw(st.tuples(*[st.integers(0, 2**32 - 1)] * 3))
    return [draw(materials(identifier)) for identifier in ids], version


def built(arguments):
    textures = {key: axf.AxfTexture(*texture) for key, texture in arguments["textures"].items()}
    return axf.AxfMaterial(**{**arguments, "textures": textures})


def assert_same(found, expected):
    assert found.version == expected.version
    assert [material.id for material in found.materials] == [material.id for material in expected.materials]
    assert found.unrecognized == ()
    assert found.inferred == ()
    for a, b in zip(found.materials, expected.materials, strict=True):
        assert a.identical(b)
        assert a.unrecognized == ()
        assert a.inferred == ()


@given(drawn=files())
def test_any_material(drawn, tmp_path_factory):
    arguments, version = drawn
    file = axf.AxfFile(tuple(map(built, arguments)), version=version)
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
