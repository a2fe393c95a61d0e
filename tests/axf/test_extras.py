"""What was not understood is kept and written back bit for bit."""

from typing import Any

import h5py
import h5py.h5d
import h5py.h5s
import h5py.h5t
import numpy as np
import pytest

from axffit import axf
from axffit.axf.extras import AxfExtra
from axffit.axf.material import same_extras
from axffit.errors import InputError

MATERIAL = "com.xrite.Materials/m"
TEXT_PAIR = np.dtype([("t", h5py.string_dtype()), ("v", "f8")])


def pairs():
    values = np.empty(2, TEXT_PAIR)
    values["t"], values["v"] = ["one", "two"], [1.5, np.nan]
    return values


def ragged():
    values = np.empty(2, object)
    values[:] = [np.arange(2, dtype=np.float32), np.arange(3, dtype=np.float32)]
    return values


DATASETS = {
    "integers": (np.arange(-3, 3, dtype=np.int64), None),
    "big-endian": (np.arange(4, dtype=">u2").reshape(2, 2), None),
    "double": (np.array([np.nan, -0.0, np.pi]), None),
    "complex": (np.array([1 + 2j]), None),
    "boolean": (np.array([True, False]), None),
    "scalar": (np.float32(7), None),
    "none": (np.zeros((0, 3), np.float32), None),
    "fixed text": (np.array([b"ab", b"c"]), None),
    "free text": ("äöü", None),
    "ASCII texts": (["a", "bb"], h5py.string_dtype("ascii")),
    "compound": (np.array([(1, b"x", (2, 3))], np.dtype([("x", "f4"), ("y", "S3"), ("z", "i2", (2,))])), None),
    "texts in a compound": (pairs(), TEXT_PAIR),
    "ragged": (ragged(), h5py.vlen_dtype(np.float32)),
    "enumeration": (np.array([0, 1], np.int8), h5py.enum_dtype({"NO": 0, "YES": 1}, "i1")),
    "opaque": (np.array([b"\0\1\2", b"\xff\0\0"], "V3"), None),
    "empty": (h5py.Empty("f4"), None),
}


def fill(group):
    """Every kind of node that no reader of AxF knows."""
    for name, (value, dtype) in DATASETS.items():
        group.create_dataset(f"unknown/{name}", data=value, dtype=dtype)
        group["unknown"].attrs.create(f"attribute {name}", value, dtype=dtype)
    space = h5py.h5s.create_simple((3,))
    h5py.h5d.create(group.id, b"bits", h5py.h5t.STD_B16BE, space)
    group.create_dataset("large", data=np.arange(5000.0), chunks=(100,), compression="gzip", fletcher32=True)
    group["type"] = np.dtype([("x", "f4")])
    group["soft"] = h5py.SoftLink("/somewhere/else")
    group["loop"] = h5py.SoftLink("loop")
    group["again"] = group["unknown"]
    group.create_group("hollow/inside")
    group.create_group("with note").attrs["note"] = "nothing else"
    references = np.array([group["large"].ref, h5py.Reference()], h5py.ref_dtype)
    group.create_dataset("references", data=references, dtype=h5py.ref_dtype)
    group["unknown"].attrs["reference"] = group["large"].ref


@pytest.fixture
def foreign(tmp_path):
    path = tmp_path / "foreign.axf"
    with h5py.File(path, "w") as file:
        material: Any = file.create_group(MATERIAL)
        color = material.create_group("com.xrite.Resources/DiffuseModel/Color")
        color["Data"] = np.full((2, 2, 3), 0.5, np.float32)
        color["ColorSpace"] = "sRGB,E"
        color["Data"].attrs["gamma"] = 1.0
        color.attrs["unit"] = "reflectance"
        material.attrs["author"] = "somebody"
        fill(material)
        fill(file.create_group("elsewhere"))
        file.attrs["tool"] = "x"
        file["com.xrite.Materials"].attrs["m"] = 3
    return path


def test_every_node_is_kept_and_written_back(foreign, tmp_path):
    first = axf.read(foreign)
    assert not any("not kept" in line for line in (*first.unrecognized, *first.material().unrecognized))
    axf.write(tmp_path / "b.axf", first)
    second = axf.read(tmp_path / "b.axf")
    assert second.material().identical(first.material())
    assert same_extras(second.extras, first.extras)
    assert len(first.extras) > 2 * len(DATASETS)
    assert sorted(second.material().unrecognized) == sorted(first.material().unrecognized)


def test_the_values_are_those_that_h5py_sees(foreign, tmp_path):
    axf.write(tmp_path / "b.axf", axf.read(foreign))
    with h5py.File(foreign) as a, h5py.File(tmp_path / "b.axf") as b:
        for base in (f"{MATERIAL}/unknown", "elsewhere/unknown"):
            for name in DATASETS:
                old: Any = a[f"{base}/{name}"]
                new: Any = b[f"{base}/{name}"]
                assert old.id.get_type().equal(new.id.get_type())
                assert old.shape == new.shape
                assert repr(old[()]) == repr(new[()])
                assert repr(a[base].attrs[f"attribute {name}"]) == repr(b[base].attrs[f"attribute {name}"])
        material: Any = b[MATERIAL]
        assert material.get("soft", getlink=True).path == "/somewhere/else"
        assert material["again"] == material["unknown"]
        assert isinstance(material["type"], h5py.Datatype)
        assert isinstance(material["hollow/inside"], h5py.Group)
        references = material["references"][()]
        assert b[references[0]] == material["large"]
        assert not references[1]
        assert b[material["unknown"].attrs["reference"]] == material["large"]
        assert material.attrs["author"] == "somebody"
        assert material["com.xrite.Resources/DiffuseModel/Color/Data"].attrs["gamma"] == 1.0
        assert b["com.xrite.Materials"].attrs["m"] == 3


def test_names_that_are_no_text_come_back(tmp_path):
    with h5py.File(tmp_path / "a.axf", "w") as file:
        material = file.create_group(MATERIAL)
        material["DiffuseColor"] = np.ones((1, 1, 3), np.float32)
        h5py.h5g.create(material.id, b"\xff\xfe")
    axf.write(tmp_path / "b.axf", axf.read(tmp_path / "a.axf"))
    with h5py.File(tmp_path / "b.axf") as file:
        group: Any = file[MATERIAL]
        assert b"\xff\xfe" in list(group.id)


@pytest.mark.parametrize("dtype", [h5py.regionref_dtype, np.dtype([("r", h5py.ref_dtype)])], ids=["region", "inside"])
def test_references_that_cannot_be_kept_are_said(tmp_path, dtype):
    with h5py.File(tmp_path / "a.axf", "w") as file:
        material = file.create_group(MATERIAL)
        material["DiffuseColor"] = np.ones((1, 1, 3), np.float32)
        material.create_dataset("pointer", (2,), dtype)
    material = axf.read(tmp_path / "a.axf").material()
    assert material.extras == ()
    assert material.unrecognized == (f"/{MATERIAL}/pointer (not kept: references of this kind cannot be kept)",)


def test_what_is_too_large_is_listed_and_not_kept(foreign, monkeypatch):
    monkeypatch.setattr("axffit.axf.reader.MAXIMUM_KEPT", 20_000)
    material = axf.read(foreign).material()
    assert any("/large (not kept: 0 MiB)" in line for line in material.unrecognized)
    assert any(extra.path == "soft" for extra in material.extras)


def test_a_texture_gives_way_to_what_is_kept(tmp_path):
    """Something else at AxF's own place stays there; the texture goes beside it, and is found."""
    kept = AxfExtra(
        ("com.xrite.Resources", "DiffuseModel", "Color", "Data"),
        "dataset",
        h5py.h5t.py_create(np.dtype("S3")).encode(),
        (),
        b"abc",
    )
    texture = axf.AxfTexture((np.ones((1, 1, 3), np.float32),))
    for textures in ({"diffusecolor": texture}, {}):
        made = axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF, textures=textures, extras=(kept,))
        axf.write(tmp_path / "a.axf", made)
        assert axf.read(tmp_path / "a.axf").material().identical(made)


def test_what_lies_where_a_material_belongs_is_refused(tmp_path):
    kept = AxfExtra(("com.xrite.Representations",), "soft link", content=("/nowhere",))
    made = axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF, extras=(kept,))
    with pytest.raises(
        InputError, match=r"com.xrite.Representations: cannot be written back .* remove it from `extras`"
    ):
        axf.write(tmp_path / "a.axf", made)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("parts", [("com.xrite.Resources",), ("com.xrite.Resources", "DiffuseModel")])
def test_what_lies_where_textures_belong_is_refused(tmp_path, parts):
    kept = AxfExtra(parts, "soft link", content=("/nowhere",))
    made = axf.AxfMaterial(
        "m",
        "m",
        axf.MaterialKind.SVBRDF,
        textures={"diffusecolor": axf.AxfTexture((np.ones((1, 1, 3), np.float32),))},
        extras=(kept,),
    )
    with pytest.raises(InputError, match="is a soft link where AxF has a group"):
        axf.write(tmp_path / "a.axf", made)


def test_empty_groups_of_axf_are_made_again(tmp_path):
    with h5py.File(tmp_path / "a.axf", "w") as file:
        material = file.create_group(MATERIAL)
        material["DiffuseColor"] = np.ones((1, 1, 3), np.float32)
        material.create_group("com.xrite.Representations")
        material.create_group("com.xrite.Resources/DiffuseModel")
        material.create_group("com.xrite.Resources/SpecularModel/Color")
    material = axf.read(tmp_path / "a.axf").material()
    assert [extra.path for extra in material.extras] == ["com.xrite.Resources/SpecularModel/Color"]
    axf.write(tmp_path / "b.axf", material)
    assert axf.read(tmp_path / "b.axf").material().identical(material)


def test_a_hard_link_to_what_is_gone_becomes_a_soft_one(tmp_path):
    kept = AxfExtra(("link",), "hard link", content=("/gone",))
    axf.write(tmp_path / "a.axf", axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF, extras=(kept,)))
    assert (
        "/com.xrite.Materials/m/link (soft link to /gone, not followed)"
        in axf.read(tmp_path / "a.axf").material().unrecognized
    )
