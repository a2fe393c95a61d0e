"""Two materials differ in exactly what was changed."""

import dataclasses

import jsonschema
import numpy as np
import pytest
from hypothesis import given

from axffit.axf import AxfExtra, AxfTexture
from axffit.axf.difference import difference, schema
from axffit.synthesis import brushed_carbon, metallic_paint
from axffit.testing.strategies import axf_materials

CARBON = brushed_carbon(64)


def changed(key, change, **sizes):
    """The carbon with one texel array changed."""
    old = CARBON.textures[key]
    data = old.data.copy()
    new = AxfTexture((change(data),), sizes.get("width_mm", old.width_mm), old.height_mm)
    return dataclasses.replace(CARBON, textures={**CARBON.textures, key: new})


def test_a_material_is_the_same_as_itself():
    content = difference(CARBON, brushed_carbon(64))
    assert content["same"]
    jsonschema.Draft202012Validator.check_schema(schema())


@given(axf_materials(), axf_materials())
def test_any_two_materials(a, b):
    content = difference(a, b)
    jsonschema.validate(content, schema(), cls=jsonschema.Draft202012Validator)
    assert content["same"] == a.identical(b)
    assert difference(a, a)["same"]


def test_one_texel_is_found_where_it_is():
    def change(data):
        data[3, 7, 1] += 0.25
        return data

    (found,) = difference(CARBON, changed("diffusecolor", change))["textures"]
    assert found["name"] == "diffusecolor"
    assert found["what"] == ["values"]
    values = found["values"]
    assert values["differing"] == 1
    assert values["at_level_and_index"] == [0, 3, 7, 1]
    assert values["largest"] == pytest.approx(0.25, abs=1e-7)
    assert values["mean"] == pytest.approx(0.25 / values["count"], rel=1e-6)


def test_nan_in_one_only_counts():
    def change(data):
        first = np.argwhere(np.isfinite(data))[0]
        data[tuple(first)] = np.nan
        return data

    (found,) = difference(CARBON, changed("clearcoatior", change))["textures"]
    assert found["values"]["finite_in_one_only"] == found["values"]["differing"] == 1
    assert found["values"]["largest"] == 0


def test_shape_type_and_size_are_named():
    (found,) = difference(CARBON, changed("diffusecolor", lambda data: data[:32]))["textures"]
    assert found["what"] == ["shape: 64 x 64 x 3 and 32 x 64 x 3"]
    assert found["values"] is None
    (found,) = difference(CARBON, changed("diffusecolor", lambda data: data, width_mm=5.0))["textures"]
    assert found["what"] == ["size: 16 x 16 mm and 5 x 16 mm"]
    (found,) = difference(CARBON, changed("diffusecolor", lambda data: data.astype(np.float16)))["textures"]
    assert found["what"] == ["type: float32 and float16", "values"]


def test_the_sign_of_a_zero_is_a_difference_of_bits_alone():
    def zero(sign):
        def change(data):
            data[0, 0, 0] = sign * 0.0
            return data

        return changed("diffusecolor", change)

    (found,) = difference(zero(1), zero(-1))["textures"]
    assert found["values"]["differing"] == 0
    assert found["what"] == ["bits of equal values (zeros' signs, NaN)"]


def test_properties_fields_and_metadata():
    paint = metallic_paint(64)
    other = dataclasses.replace(
        paint,
        name="other",
        properties={**paint.properties, "CT_diffuse": 0.5, "IOR": np.nextafter(np.float32(1.5), np.float32(2))},
        metadata={"generator": paint.metadata["generator"], "by": "hand"},
    )
    content = difference(paint, other)
    assert [row["name"] for row in content["fields"]] == ["name"]
    assert {row["name"] for row in content["properties"]} == {"CT_diffuse", "IOR"}
    assert [(row["name"], row["a"] is None) for row in content["metadata"]] == [("synthetic", False), ("by", True)]


def test_what_only_one_has():
    less = dataclasses.replace(CARBON, textures={k: t for k, t in CARBON.textures.items() if k != "normal"})
    assert difference(CARBON, less)["textures"][0]["only_in"] == "a"
    assert difference(less, CARBON)["textures"][0]["only_in"] == "b"


def test_what_lies_beside_the_textures_is_compared():
    other = brushed_carbon(64)
    changed_ones = {
        "previews": {"Preview": np.zeros((1, 1, 3), np.uint8)},
        "extras": (AxfExtra(("note",), "soft link", content=("/a",)),),
        "alternatives": (dataclasses.replace(other, representation="1"),),
        "representation": "2",
    }
    for name, value in changed_ones.items():
        content = difference(CARBON, dataclasses.replace(other, **{name: value}))
        jsonschema.validate(content, schema(), cls=jsonschema.Draft202012Validator)
        assert not content["same"]
        assert [field["name"] for field in content["fields"]] == [name]


def test_spectra_are_compared():
    rgb, spectra = np.ones((1, 1, 3), np.float32), np.ones((1, 1, 31), np.float32)

    def of(texture):
        return dataclasses.replace(CARBON, textures={"diffusecolor": texture})

    spectral = of(AxfTexture((rgb,), spectra=(spectra,)))
    cases = {
        "spectra in one only, or converted in one only": of(AxfTexture((rgb,))),
        "spectra": of(AxfTexture((rgb,), spectra=(0.5 * spectra,))),
    }
    for what, other in cases.items():
        (found,) = difference(spectral, other)["textures"]
        assert found["what"] == [what]
    unconverted = [of(AxfTexture((), spectra=(scale * spectra,))) for scale in (1, 0.5)]
    (found,) = difference(*unconverted)["textures"]
    assert found["what"] == ["values"]
    assert found["values"]["largest"] == 0.5
