"""Untrusted files: one clear line that names the file, never a crash, a hang or gigabytes."""

import random
import re
import time
from typing import Any

import h5py
import numpy as np
import pytest

from axffit import axf
from axffit.axf import hdf5
from axffit.errors import InputError

MATERIAL = "com.xrite.Materials/m"


def refused(path):
    """The message of the refusal: one line that begins with the file."""
    start = time.perf_counter()
    with pytest.raises(InputError) as caught:
        axf.read(path)
    assert time.perf_counter() - start < 5.0
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


@pytest.fixture
def good(tmp_path):
    rng = np.random.default_rng(0)

    def texture(*shape):
        return axf.AxfTexture((rng.random(shape).astype(np.float32),), 1.0, 1.0)

    material = axf.AxfMaterial(
        "m",
        "m",
        axf.MaterialKind.SVBRDF,
        anisotropic=True,
        textures={"diffusecolor": texture(12, 12, 3), "specularlobe": texture(3, 3, 2)},
        properties={"cc_no_refraction": 1},
    )
    axf.write(tmp_path / "good.axf", material)
    return tmp_path / "good.axf"


@pytest.fixture
def made(tmp_path):
    """A file whose material's group a function fills."""

    def make(fill):
        path = tmp_path / "made.axf"
        with h5py.File(path, "w") as file:
            fill(file.create_group(MATERIAL))
        return path

    return make


def test_a_missing_file(tmp_path):
    assert refused(tmp_path / "none.axf").startswith("no such file")


def test_a_folder(tmp_path):
    assert refused(tmp_path).startswith("not a file")


@pytest.mark.parametrize("content", [b"", b"just some text\n", b"\x89HDF", b"\x89HDF\r\n\x1a\n"])
def test_what_is_no_hdf5(tmp_path, content):
    path = tmp_path / "text.axf"
    path.write_bytes(content)
    assert re.match("not an AxF file|damaged or truncated HDF5", refused(path))


def test_an_empty_hdf5(tmp_path):
    h5py.File(tmp_path / "empty.axf", "w").close()
    assert refused(tmp_path / "empty.axf").startswith("no material; an AxF file has a group /com.xrite.Materials/")


@pytest.mark.parametrize("part", [0.01, 0.3, 0.6, 0.9, 0.999])
def test_a_truncated_file(good, part):
    content = good.read_bytes()
    good.write_bytes(content[: int(len(content) * part)])
    assert re.match("damaged|not an AxF file", refused(good))


def test_an_external_link(made):
    def fill(group):
        group["Color"] = h5py.ExternalLink("other.h5", "/data")

    assert refused(made(fill)) == f"/{MATERIAL}/Color: external link to another file; store the data in this file"


def test_external_storage(made):
    def fill(group):
        group.create_dataset("DiffuseColor", (1, 1, 3), "f4", external=[("/etc/hostname", 0, 12)])

    assert refused(made(fill)).startswith(f"/{MATERIAL}/DiffuseColor: data in an external file")


def test_a_virtual_dataset(made):
    def fill(group):
        virtual = h5py.VirtualLayout((1, 1, 3), "f4")
        virtual[0, 0] = h5py.VirtualSource("other.h5", "data", (3,))
        group.create_virtual_dataset("DiffuseColor", virtual)

    assert refused(made(fill)).startswith(f"/{MATERIAL}/DiffuseColor: virtual dataset")


def test_loops_of_links_are_walked_once(good):
    with h5py.File(good, "a") as file:
        group: Any = file[MATERIAL]
        group["soft"] = h5py.SoftLink(f"/{MATERIAL}")
        group["hard"] = group
        group["self"] = h5py.SoftLink("self")
    unused = axf.read(good).material().unrecognized
    assert f"/{MATERIAL}/hard (a group that was met before)" in unused
    assert f"/{MATERIAL}/self (soft link to self, not followed)" in unused


@pytest.mark.parametrize("options", [{}, {"chunks": (64, 64, 64)}])
def test_a_declared_size_beyond_reason(made, options):
    def fill(group):
        group.create_dataset("BRDFcolors", (200_000, 200_000, 300), "f4", **options)

    message = refused(made(fill))
    assert "shape (200000, 200000, 300) declares 44703.5 GiB; at most 4 GiB are read" in message


def test_a_size_that_no_data_stand_behind(made):
    def fill(group):
        group.create_dataset("BRDFcolors", (8000, 8000, 3), "f4", chunks=(100, 100, 3))

    assert "declares 732 MiB but 0 bytes are stored" in refused(made(fill))


def test_chunks_larger_than_the_data(made):
    def fill(group):
        group.create_dataset("BRDFcolors", (1, 1, 3), "f4", chunks=(10_000, 10_000, 3), maxshape=(None, None, 3))

    assert "chunks of 1144 MiB for 0 MiB of data" in refused(made(fill))


def test_too_deep(made):
    def fill(group):
        group.create_dataset("/".join(["a"] * (hdf5.MAXIMUM_DEPTH + 2)), data=1.0)

    assert "nested deeper than 32 groups" in refused(made(fill))


def test_too_many(made, monkeypatch):
    monkeypatch.setattr(hdf5, "MAXIMUM_NODES", 50)

    def fill(group):
        for number in range(60):
            group.create_dataset(f"n{number}", data=number)

    assert "more than 50 nodes" in refused(made(fill))


@pytest.mark.parametrize(
    "value",
    [
        h5py.ref_dtype,
        h5py.regionref_dtype,
        h5py.vlen_dtype(np.int32),
        np.zeros((2, 2, 3), np.complex64),
        np.zeros((2, 2, 3), bool),
        h5py.Empty("f4"),
        np.bytes_("text"),
    ],
    ids=["reference", "region", "ragged", "complex", "boolean", "empty", "text"],
)
def test_a_map_of_another_type_is_listed_and_not_used(good, value):
    with h5py.File(good, "a") as file:
        group: Any = file[MATERIAL]
        if isinstance(value, np.dtype):
            group.create_dataset("Fresnel", (2, 2, 3), value)
        else:
            group.create_dataset("Fresnel", data=value)
        group.attrs["IOR"] = np.zeros(4, np.complex64)
    material = axf.read(good).material()
    assert "fresnel" not in material.textures
    assert {f"/{MATERIAL}/Fresnel", f"/{MATERIAL}@IOR"} <= {line.split(" (")[0] for line in material.unrecognized}


def test_a_name_that_is_no_text_is_listed(good):
    with h5py.File(good, "a") as file:
        group: Any = file[MATERIAL]
        h5py.h5g.create(group.id, b"\xff\xfe\n")
        group.attrs["line\nbreak"] = 1
    unused = axf.read(good).material().unrecognized
    assert f"/{MATERIAL}@line\\nbreak" in unused
    assert any("an empty group" in line and "\n" not in line for line in unused)


OWN = f"{MATERIAL}/com.xrite.Representations/axffit.Material"


@pytest.mark.parametrize(
    ("node", "value", "message"),
    [
        ("Id", np.float32(1), "axffit.Material/Id holds no single text"),
        ("Id", None, "material 'm': axffit.Material/Id is missing"),
        ("Class", np.bytes_("BTF"), "axffit.Material/Class is 'BTF'; allowed: SVBRDF, CarPaint2"),
        ("SpecularModel/TypeKey", np.bytes_("x"), "TypeKey is 'x'; allowed: com.xrite.WardSpecularModel"),
        ("Properties/cc_no_refraction", np.bytes_("x"), "cc_no_refraction holds no number"),
        ("Properties/cc_no_refraction", np.float32(np.nan), "is not a whole number"),
        ("Properties/gloss", np.float32(1), "Properties/gloss is no AxF property; allowed: CT_diffuse"),
        ("Index", np.float32(np.inf), "Index is [inf]; it must be one finite number"),
    ],
)
def test_a_damaged_description_is_named(good, node, value, message):
    with h5py.File(good, "a") as file:
        own: Any = file[OWN]
        if node in own:
            del own[node]
        if value is not None:
            own[node] = value
    assert message in refused(good)


def test_additions_to_a_file_of_our_own_are_listed(good):
    with h5py.File(good, "a") as file:
        file[f"{OWN}/Extra"] = 1
        file[f"{MATERIAL}/IOR"] = np.float32(1.7)
        file[f"{MATERIAL}/key"] = np.bytes_("com.xrite.GGXSpecularModel")
    material = axf.read(good).material()
    assert set(material.unrecognized) == {f"/{OWN}/Extra", f"/{MATERIAL}/IOR", f"/{MATERIAL}/key"}
    assert material.specular_model == "Ward"
    assert "IOR" not in material.properties


def test_two_materials_of_one_id(good):
    with h5py.File(good, "a") as file:
        file.copy(MATERIAL, "com.xrite.Materials/other")
    assert refused(good) == "two materials share an id; give each its own"


@pytest.mark.parametrize("seed", range(60))
def test_changed_bytes_give_a_material_or_a_clean_refusal(good, seed):
    chance = random.Random(seed)
    content = bytearray(good.read_bytes())
    for _ in range(chance.choice([1, 2, 4, 16])):
        content[chance.randrange(len(content))] = chance.choice([0, 255, chance.randrange(256)])
    good.write_bytes(content)
    outcome: object
    try:
        outcome = axf.read(good)
    except InputError as error:
        outcome = str(error)
    if isinstance(outcome, axf.AxfFile):
        assert outcome.materials
    else:
        assert str(outcome).startswith(f"{good}: ")
        assert "\n" not in str(outcome)
