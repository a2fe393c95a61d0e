"""The property table to the letter, and every row packed present and absent."""

import numpy as np
import pytest

from axffit.axf import MaterialKind
from axffit.axf.names import TEXTURE_KEYS
from axffit.axf.properties import PROPERTY_TYPES
from axffit.targets import unity_2018
from axffit.targets.table import Absent, ValueType
from axffit.targets.unity_properties import TEXTURE_ROWS, VALUE_ROWS
from axffit.textures import FORMATS
from tests.targets.materials import MATERIALS, paint, ward, without

SPECIFIED = {
    "_SVBRDF_DiffuseColorMap_sRGB": ("diffusecolor", "RGBA16F", (0, 0, 0, 0)),
    "_SVBRDF_SpecularColorMap_sRGB": ("specularcolor", "RGBA16F", (1, 1, 1, 1)),
    "_SVBRDF_NormalMap": ("normal", "RGBA16_UNORM", (0.5, 0.5, 1, 1)),
    "_SVBRDF_SpecularLobeMap": ("specularlobe", "RG16F", (1, 1, 1, 1)),
    "_SVBRDF_OpacityMap": ("opacity", "R8_UNORM", (1,)),
    "_SVBRDF_FresnelMap_sRGB": ("fresnel", "RGBA16F", (0, 0, 0, 0)),
    "_SVBRDF_AnisotropicRotationAngleMap": ("anisrotation", "RGBA16_UNORM", (0.5,)),
    "_SVBRDF_HeightMap": ("height", "R16F", (0,)),
    "_CarPaint_BRDFColorMap_sRGB": ("brdfcolors", "RGBA16F", (1, 1, 1, 1)),
    "_CarPaint_BTFFlakesMap_sRGB": ("btfflakes", "RGBA16F", (0, 0, 0, 0)),
    "_CarPaint_thetaFI_sliceLUTMap": ("thetaFI_sliceLUT", "R8_UNORM", (0,)),
    "_SVBRDF_ClearCoatColorMap_sRGB": ("clearcoatcolor", "RGBA16F", (1, 1, 1, 1)),
    "_SVBRDF_ClearCoatNormalMap": ("clearcoatnormal", "RGBA16_UNORM", (0.5, 0.5, 1, 1)),
    "_SVBRDF_ClearCoatIORMap_sRGB": ("clearcoatior", "R16F", (0.04,)),
}
"""Target texture: AxF name, advised format (anisotropic lobe), default."""

EXPOSED = {"_materialSizeU_mm", "_materialSizeV_mm", "_CarPaint_FlakesTiling"}

ROWS = {row.name: row for row in TEXTURE_ROWS}
every_row = pytest.mark.parametrize("name", SPECIFIED)


def material_for(row):
    return ward() if MaterialKind.SVBRDF in row.kinds else paint()


def test_the_table_has_exactly_the_specified_textures():
    assert set(ROWS) == set(SPECIFIED)
    assert {row.axf_name for row in TEXTURE_ROWS} == {*TEXTURE_KEYS, "thetaFI_sliceLUT"}


@every_row
def test_texture_row_is_as_specified(name):
    row = ROWS[name]
    axf_name, format, default = SPECIFIED[name]
    assert (row.axf_name, row.default) == (axf_name, default)
    advised = row.choices[max(row.choices)][0]
    assert (advised.format, advised.announced) == (format, False)
    assert row.provenance
    for choices in row.choices.values():
        assert all(choice.format in FORMATS for choice in choices)


@every_row
def test_texture_present(name):
    row = ROWS[name]
    texture = unity_2018.pack(material_for(row)).textures[name]
    assert not texture.defaulted
    assert texture.axf_name == row.axf_name
    assert texture.format == row.choices[texture.channels][0].format


@every_row
def test_texture_absent(name):
    row = ROWS[name]
    packed = unity_2018.pack(without(material_for(row), row.axf_name))
    if row.absent in (Absent.HEIGHT_FLAG, Absent.FLAKES):
        assert name not in packed.textures
        return
    texture = packed.textures[name]
    assert texture.defaulted
    assert texture.levels[0].shape[-3:-1] == (4, 4)
    form = texture.number_format
    decoded = form.decode(texture.levels[0])
    expected = (np.array(row.default) if len(row.default) > 1 else np.array([*row.default, 0, 0, 1]))[: form.channels]
    assert np.all(np.abs(decoded - expected) <= form.error_bound(np.broadcast_to(expected, decoded.shape)))


def test_without_any_coat_texture_none_is_made():
    packed = unity_2018.pack(without(ward(), "clearcoatcolor", "clearcoatnormal", "clearcoatior"))
    assert not [name for name in packed.textures if "ClearCoat" in name]


@pytest.mark.parametrize("name", MATERIALS)
def test_textures_of_the_other_kind_are_not_packed(name):
    material = MATERIALS[name]()
    packed = unity_2018.pack(material)
    assert set(packed.textures) == {row.name for row in TEXTURE_ROWS if material.kind in row.kinds} - (
        {"_SVBRDF_ClearCoatColorMap_sRGB"} - set(packed.textures)
    )


def test_the_value_table():
    rows = {row.name: row for row in VALUE_ROWS}
    assert {row.name for row in VALUE_ROWS if row.exposed} == EXPOSED
    assert rows["_CarPaint_FlakesTiling"].default == 10
    assert {row.axf_name for row in VALUE_ROWS if row.axf_name} == set(PROPERTY_TYPES) - {
        "thetaFI_sliceLUT", "cc_no_refraction",
    }  # fmt: skip
    padding = {row.name: row.default for row in VALUE_ROWS if row.type is ValueType.FLOAT4}
    assert padding == {"_CarPaint_CT_F0s": 0, "_CarPaint_CT_coefs": 0, "_CarPaint_CT_spreads": 1}
    assert len(rows) == 18


@pytest.mark.parametrize("name", MATERIALS)
def test_every_value_of_the_kind_is_packed(name):
    material = MATERIALS[name]()
    packed = unity_2018.pack(material)
    assert set(packed.values) == {row.name for row in VALUE_ROWS if material.kind in row.kinds}


@pytest.mark.parametrize("row", [row for row in VALUE_ROWS if row.axf_name], ids=lambda row: row.name)
def test_value_present_and_absent(row):
    material = paint()
    given = np.asarray(material.properties[row.axf_name], dtype=np.float64)
    packed = np.asarray(unity_2018.pack(material).values[row.name], dtype=np.float64)
    np.testing.assert_array_equal(np.atleast_1d(packed)[: given.size], np.atleast_1d(given))
    np.testing.assert_array_equal(np.atleast_1d(packed)[given.size :], row.default)
    gone = without(material, *(("CT_coeffs", "CT_F0s", "CT_spreads") if row.axf_name[:3] == "CT_" else (row.axf_name,)))
    if row.axf_name == "CT_diffuse":
        gone = without(material, row.axf_name)
    np.testing.assert_array_equal(
        unity_2018.pack(gone).values[row.name], np.full(packed.shape, np.float32(row.default))
    )
