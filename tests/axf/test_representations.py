"""Several representations over one pool of resources: each is a material, one stands in front, none is lost."""

from typing import Any

import h5py
import numpy as np
import pytest

from axffit import axf
from axffit.axf import representations
from axffit.errors import InputError

MATERIAL = "com.xrite.Materials/m"
RESOURCES = f"{MATERIAL}/com.xrite.Resources"


def values(*shape):
    return np.random.default_rng(sum(shape)).uniform(0.1, 0.9, shape).astype(np.float32)


def read(folder, tree):
    with h5py.File(folder / "a.axf", "w") as file:
        for node, value in tree.items():
            file[node] = value
    return axf.read(folder / "a.axf")


POOL = {
    f"{RESOURCES}/DiffuseModel/Color/Data": values(2, 2, 7),
    f"{RESOURCES}/DiffuseModel/Color_1/Data": values(2, 2, 3),
    f"{RESOURCES}/DiffuseModel/Color_2/Data": values(3, 3, 3),
    f"{RESOURCES}/SpecularModel_2/Lobes/Data": values(3, 3, 2),
    f"{RESOURCES}/DiffuseModel/Normal/Data": values(4, 4, 3),
    f"{MATERIAL}/com.xrite.Representations/x/model_1": np.bytes_("com.xrite.GGXSpecularModel"),
    f"{MATERIAL}/com.xrite.Representations/x/model": np.bytes_("com.xrite.WardSpecularModel"),
    f"{MATERIAL}/com.xrite.Representations/x/variant": np.bytes_("Duer2006"),
}


def test_each_number_is_a_representation_over_the_pool(tmp_path):
    file = read(tmp_path, POOL)
    front = file.material("m")
    assert [entry.representation for entry in (front, *front.alternatives)] == ["1", "2", ""]
    second, spectral = file.material("m", "2"), file.material("m", "")
    assert file.material("m", "1") is front
    assert front.anisotropic
    assert front.textures["diffusecolor"].data.shape == (2, 2, 3)
    assert second.textures["diffusecolor"].data.shape == (3, 3, 3)
    assert second.textures["normal"] is front.textures["normal"]
    assert spectral.textures["diffusecolor"].spectra[0].shape == (2, 2, 7)
    assert (front.specular_model, second.specular_model) == ("GGX", "Ward")
    assert second.specular_variant == "Duer2006"
    assert front.unrecognized == ()
    assert "representation '1' stands in front of '2', ''" in front.inferred[0]


def test_they_are_written_over_one_pool_and_read_back(tmp_path):
    material = read(tmp_path, POOL).material()
    axf.write(tmp_path / "b.axf", material)
    again = axf.read(tmp_path / "b.axf").material()
    assert again.identical(material)
    assert again.unrecognized == ()
    with h5py.File(tmp_path / "b.axf") as file:
        resources: Any = file[RESOURCES]
        # Three colors, but the normals that all share and the lobes that two share stand there once.
        assert sorted(resources["DiffuseModel"]) == ["Color", "Color_1", "Color_2", "Normal"]
        assert list(resources["SpecularModel"]) == ["Lobes"]


def test_a_car_paint_and_an_svbrdf_of_one_material_are_two(tmp_path):
    tree = {
        f"{MATERIAL}/BRDFcolors": values(4, 4, 3),
        f"{MATERIAL}/CT_diffuse": np.float32(0.3),
        f"{MATERIAL}/IOR": np.float32(1.4),
        f"{MATERIAL}/DiffuseColor": values(2, 2, 3),
        f"{MATERIAL}/SpecularLobe": values(2, 2, 1),
        f"{MATERIAL}/ClearcoatNormal": values(2, 2, 3),
    }
    material = read(tmp_path, tree).material()
    (svbrdf,) = material.alternatives
    assert (material.kind, material.representation) == (axf.MaterialKind.CAR_PAINT, "CarPaint2")
    assert (svbrdf.kind, svbrdf.representation) == (axf.MaterialKind.SVBRDF, "SVBRDF")
    assert set(material.textures) == {"brdfcolors", "clearcoatnormal"}
    assert set(svbrdf.textures) == {"diffusecolor", "specularlobe", "clearcoatnormal"}
    assert set(svbrdf.properties) == {"IOR"}
    axf.write(tmp_path / "b.axf", material)
    assert axf.read(tmp_path / "b.axf").material().identical(material)


def test_a_representation_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match="material 'm' has no representation '7'; it has '', '1', '2'"):
        read(tmp_path, POOL).material("m", "7")


def test_an_alternative_may_be_of_another_use(tmp_path):
    """What cannot be used does not stand in front, whatever its number, and is still written back."""
    tree = {f"{MATERIAL}/DiffuseColor": values(2, 2, 2), f"{MATERIAL}/DiffuseColor_1": values(2, 2, 3)}
    material = read(tmp_path, tree).material()
    assert material.representation == "1"
    axf.write(tmp_path / "b.axf", material)
    assert axf.read(tmp_path / "b.axf").material().identical(material)


def test_more_representations_than_any_file_has(tmp_path):
    tree = {f"{MATERIAL}/Alpha_{k}": values(1, 1, 1) for k in range(representations.MAXIMUM_REPRESENTATIONS + 1)}
    with pytest.raises(InputError, match="material 'm' has 65 representations; at most 64 are read"):
        read(tmp_path, tree)


def test_pictures_and_metadata_are_kept(tmp_path):
    picture = np.random.default_rng(0).integers(0, 256, (5, 4, 3), np.uint8)
    tree = {
        f"{MATERIAL}/DiffuseColor": values(2, 2, 3),
        f"{MATERIAL}/com.xrite.PreviewImages/Front/Data": picture,
        f"{MATERIAL}/Thumbnail": picture[..., 0],
        f"{MATERIAL}/com.xrite.Metadata/Author": "Ä. Nobody",
        f"{MATERIAL}/com.xrite.Metadata/more/Date": np.bytes_("2018-06-08"),
        f"{MATERIAL}/com.xrite.Metadata/Count": np.int32(3),
    }
    material = read(tmp_path, tree).material()
    assert material.metadata == {"Author": "Ä. Nobody", "more/Date": "2018-06-08"}
    assert set(material.previews) == {"com.xrite.PreviewImages/Front/Data", "Thumbnail"}
    np.testing.assert_array_equal(material.previews["com.xrite.PreviewImages/Front/Data"], picture)
    assert material.unrecognized == (f"/{MATERIAL}/com.xrite.Metadata/Count",)
    axf.write(tmp_path / "b.axf", material)
    again = axf.read(tmp_path / "b.axf").material()
    assert again.identical(material)
    with h5py.File(tmp_path / "b.axf") as file:
        stored: Any = file[MATERIAL]
        assert stored["Thumbnail"][()].tobytes() == picture[..., 0].tobytes()


def test_a_picture_that_no_reader_would_find_is_refused():
    with pytest.raises(InputError, match="preview at 'a/b'; a reader finds it by 'preview' or 'thumbnail'"):
        axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF, previews={"a/b": np.zeros((1, 1, 3), np.uint8)})


@pytest.mark.parametrize(("word", "what"), [("BTF", "bidirectional"), ("Layered", "layered"), ("volumetric", "volum")])
def test_what_is_not_supported_beside_what_is_stays_in_the_file(tmp_path, word, what):
    tree = {f"{MATERIAL}/DiffuseColor": values(2, 2, 3), f"{MATERIAL}/com.xrite.Resources/{word}/Data": values(9)}
    material = read(tmp_path, tree).material()
    assert material.unrecognized == (f"/{MATERIAL}/com.xrite.Resources/{word}/Data",)
    axf.write(tmp_path / "b.axf", material)
    assert axf.read(tmp_path / "b.axf").material().identical(material)
    del tree[f"{MATERIAL}/DiffuseColor"]
    with pytest.raises(InputError, match=f"is a {what}"):
        read(tmp_path, tree)
