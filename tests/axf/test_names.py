import pytest

from axffit.axf import names
from axffit.axf.properties import PROPERTY_TYPES
from axffit.axf.ranges import PROPERTY_RANGES, TEXTURE_RANGES

TEXTURE_SPELLINGS = [
    # (group, resource, canonical name): the evidenced HDF5 layout
    ("DiffuseModel", "Color", "diffusecolor"),
    ("DiffuseModel", "Normal", "normal"),
    ("SpecularModel", "Color", "specularcolor"),
    ("SpecularModel", "Lobes", "specularlobe"),
    ("SpecularModel", "AnisotropicRotation", "anisrotation"),
    ("SpecularModel", "Fresnel", "fresnel"),
    ("DisplacementFilter", "Height", "height"),
    ("TransparencyFilter", "Alpha", "opacity"),
    ("ClearCoat", "IOR", "clearcoatior"),
    ("ClearCoat", "Normal", "clearcoatnormal"),
    # suffixes of a second representation, type keys as groups, other cases
    ("DiffuseModel", "Color_1", "diffusecolor"),
    ("SpecularModel_2", "Color_1", "specularcolor"),
    ("com.xrite.ClearCoatFilter", "IOR", "clearcoatior"),
    ("com.xrite.ClearCoatFilter", "Color", "clearcoatcolor"),
    ("com.xrite.WardSpecularModel", "lobes", "specularlobe"),
    ("diffusemodel", "NORMAL", "normal"),
    # names of the decoder's side, and the seed's lower-case ones
    ("", "DiffuseColor", "diffusecolor"),
    ("", "Normal", "normal"),
    ("", "SpecularColor", "specularcolor"),
    ("", "SpecularLobe", "specularlobe"),
    ("", "AnisoRotation", "anisrotation"),
    ("", "anisrotation", "anisrotation"),
    ("", "Fresnel", "fresnel"),
    ("", "ClearcoatColor", "clearcoatcolor"),
    ("", "ClearcoatNormal", "clearcoatnormal"),
    ("", "ClearcoatIOR", "clearcoatior"),
    ("", "clearcoator", "clearcoatior"),
    ("", "clearcoatlOR", "clearcoatior"),
    ("", "Alpha", "opacity"),
    ("", "opacity", "opacity"),
    ("", "Height", "height"),
    ("", "BRDFcolors", "brdfcolors"),
    ("", "BTFflakes", "btfflakes"),
    ("CarPaintModel", "BTFflakes", "btfflakes"),
    # what is no texture
    ("", "Color", None),
    ("", "IOR", None),
    ("ClearCoat", "Fresnel", None),
    ("ClearCoat", "Lobes", None),
    ("", "Thumbnail", None),
]

PROPERTY_SPELLINGS = [
    ("CT_diffuse", "CT_diffuse"),
    ("ct_diffuse", "CT_diffuse"),
    ("CT_coeffs", "CT_coeffs"),
    ("CT_coefs", "CT_coeffs"),
    ("CT_F0s", "CT_F0s"),
    ("CT_spreads", "CT_spreads"),
    ("num_thetaF", "num_thetaF"),
    ("num_thetaI", "num_thetaI"),
    ("num_thetal", "num_thetaI"),
    ("max_thetal", "max_thetaI"),
    ("max_thetaI", "max_thetaI"),
    ("thetaFl_sliceLUT", "thetaFI_sliceLUT"),
    ("thetaFI_sliceLUT", "thetaFI_sliceLUT"),
    ("IOR", "IOR"),
    ("cc_no_refraction", "cc_no_refraction"),
    ("CC_NO_REFRACTION_1", "cc_no_refraction"),
    ("CT_exponents", None),
]


@pytest.mark.parametrize(("group", "resource", "expected"), TEXTURE_SPELLINGS)
def test_texture_spellings(group, resource, expected):
    assert names.canonical_texture(resource, group) == expected


@pytest.mark.parametrize(("spelling", "expected"), PROPERTY_SPELLINGS)
def test_property_spellings(spelling, expected):
    assert names.canonical_property(spelling) == expected


@pytest.mark.parametrize("key", names.TEXTURE_KEYS)
def test_every_texture_is_found_where_the_writer_puts_it(key):
    group, resource = names.TEXTURES[key].node.split("/")
    assert names.canonical_texture(resource, group) == key
    assert names.canonical_texture(key) == key


def test_no_two_properties_and_no_two_textures_share_a_spelling():
    for entries in (
        {key: layout.aliases for key, layout in names.TEXTURES.items()},
        {key: kind.aliases for key, kind in PROPERTY_TYPES.items()},
    ):
        folded = [names.fold(alias) for key, aliases in entries.items() for alias in {key, *aliases}]
        owners = {names.fold(alias): key for key, aliases in entries.items() for alias in (key, *aliases)}
        assert len(owners) <= len(folded)
        for key, aliases in entries.items():
            assert {owners[names.fold(alias)] for alias in (key, *aliases)} == {key}


def test_every_quantity_has_a_range():
    assert set(TEXTURE_RANGES) == set(names.TEXTURES)
    assert set(PROPERTY_RANGES) == set(PROPERTY_TYPES)


def test_every_variant_belongs_to_a_model():
    assert set(names.SPECULAR_VARIANTS.values()) <= set(names.SPECULAR_MODELS)
