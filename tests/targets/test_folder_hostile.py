"""A `material.json` or image that was damaged or made up yields one clean error; nothing outside the folder is read."""

import copy
import json
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.errors import InputError
from axffit.targets import folder
from axffit.textures.files import CONTAINERS, TextureImage
from tests.targets.materials import paint, ward, without


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """A small paint's folder and what its `material.json` says."""
    out = tmp_path_factory.mktemp("exported")
    (item,) = folder.write(without(paint(size=8), "brdfcolors"), out)
    return item.folder, json.loads((item.folder / "material.json").read_text())


def places(value, path=()):
    """The path of every value in JSON content."""
    yield path
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(item, (*path, key))


def changed_at(content, path, value):
    content = copy.deepcopy(content)
    if not path:
        return value
    inner = content
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return content


def read_with(exported, content):
    """Reads the folder as if its `material.json` said this."""
    path = exported[0] / "material.json"
    kept = path.read_bytes()
    try:
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return folder.read(exported[0])
    finally:
        path.write_bytes(kept)


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=4,
)


@given(data=st.data(), value=ANYTHING)
def test_any_entry_may_be_anything(exported, data, value):
    path = data.draw(st.sampled_from(sorted(places(exported[1]), key=str)))
    content = changed_at(exported[1], path, value)
    try:
        read = read_with(exported, content)
        assert len(read.materials) == 1
    except InputError as error:
        message = str(error)
    else:
        return
    assert "\n" not in message
    assert "material.json" in message or "unknown target" in message or str(exported[0]) in message


@given(data=st.data())
def test_any_entry_may_be_missing(exported, data):
    path = data.draw(st.sampled_from(sorted((p for p in places(exported[1]) if p), key=str)))
    content = copy.deepcopy(exported[1])
    inner = content
    for key in path[:-1]:
        inner = inner[key]
    del inner[path[-1]]
    try:
        assert len(read_with(exported, content).materials) == 1
    except InputError as error:
        message = str(error)
    else:
        return
    assert str(exported[0]) in message


TEXTURE = ("textures", 0)
WRONG = {
    "no JSON": ("{", "no JSON"),
    "deep nesting": ("[" * 100_000, "no JSON"),
    "a list": ([], "must be an object"),
    "another schema": ((("schema",), "axffit.verdict"), "no axffit.material"),
    "a later version": ((("schema_version",), 2), "of version 1"),
    "flipped rows": ((("rows", "flipped"), True), "rows are"),
    "an unknown target": ((("target",), "unity_1850"), "unknown target 'unity_1850'"),
    "an unknown kind": ((("material", "kind"), "BTF"), "allowed: SVBRDF, CarPaint2"),
    "a version of two numbers": ((("axf", "version"), [1, 5]), "it needs 3"),
    "a negative version": ((("axf", "index"), True), "must be a whole number"),
    "a text as value": ((("values", "_flags"), "six"), r"values\._flags: is a text"),
    "an integer without meaning": ((("values", "_CarPaint_lobesCount"), 9), "_CarPaint_lobesCount is 9"),
    "a list as integer": ((("values", "_CarPaint_lobesCount"), [1.0]), "do not fit unity_2018"),
    "a value of 400 digits": ((("values", "_CarPaint_IOR"), 10**400), "must fit 64 bits"),
    "an unknown texture": (((*TEXTURE, "name"), "_BumpMap"), "no texture '_BumpMap'"),
    "a texture twice": (((*TEXTURE, "name"), "_SVBRDF_ClearCoatNormalMap"), "share a name"),
    "an unknown AxF name": ((("textures", 1, "axf_name"), "bump"), "made from 'bump'"),
    "an unknown format": (((*TEXTURE, "format"), "BC7"), "format is 'BC7'"),
    "five channels": (((*TEXTURE, "channels"), 5), "channels is 5"),
    "no levels": (((*TEXTURE, "levels"), []), "levels: each must be"),
    "levels of different rank": (((*TEXTURE, "levels"), [[4, 4], [1, 2, 2]]), "levels: each must be"),
    "absurd levels": (((*TEXTURE, "levels"), [[10**9, 10**9]]), "declares"),
    "a size of text": (((*TEXTURE, "width_mm"), "wide"), "width_mm: is a text"),
    "no file": (((*TEXTURE, "files"), []), "names no file"),
    "a missing file": (((*TEXTURE, "files"), [{"file": "gone.exr"}]), r"gone\.exr: no such file"),
    "a file above": (((*TEXTURE, "files"), [{"file": "../secret.exr"}]), "in the material's own folder"),
    "a file elsewhere": (((*TEXTURE, "files"), [{"file": "/etc/passwd"}]), "in the material's own folder"),
    "a file of another texture": (
        ((*TEXTURE, "files"), [{"file": "_SVBRDF_ClearCoatNormalMap.png"}]),
        "twice",
    ),
    "a file of another kind": (((*TEXTURE, "container"), "ktx2"), "first bytes"),
    "a level of text": (((*TEXTURE, "files", 0, "level"), "fine"), "level: is a text"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_material_json_is_refused_with_its_reason(name, exported):
    change, message = WRONG[name]
    content = changed_at(exported[1], *change) if isinstance(change, tuple) else change
    with pytest.raises(InputError, match=message):
        read_with(exported, content)


def test_a_huge_material_json_is_refused_unread(tmp_path):
    path = tmp_path / "material.json"
    path.touch()
    os.truncate(path, 2**40)
    with pytest.raises(InputError, match="at most"):
        folder.read(tmp_path)


def test_folders_without_an_export_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        folder.read(tmp_path / "missing")
    with pytest.raises(InputError, match=r"holds a material\.json"):
        folder.read(tmp_path)


def test_every_damaged_image_names_itself(tmp_path):
    (item,) = folder.write(ward(), tmp_path)
    for path in sorted(item.folder.glob("*.*")):
        if path.suffix == ".json":
            continue
        kept = path.read_bytes()
        path.write_bytes(kept[: len(kept) // 2])
        with pytest.raises(InputError, match=path.name):
            folder.read(tmp_path)
        path.write_bytes(kept)
    assert len(folder.read(tmp_path).materials) == 1


def test_textures_the_target_has_not_are_refused_before_any_image_is_read(exported, monkeypatch):
    content = copy.deepcopy(exported[1])
    content["textures"] += [content["textures"][0] | {"name": f"_More{number}"} for number in range(40)]
    monkeypatch.setattr(folder, "load", None)
    with pytest.raises(InputError, match="no texture '_More0'"):
        read_with(exported, content)


def test_images_that_declare_more_than_their_files_hold_are_not_read(exported, monkeypatch):
    content = changed_at(exported[1], (*TEXTURE, "levels"), [[8192, 8192]])
    monkeypatch.setattr(folder, "load", None)
    with pytest.raises(InputError, match=r"declares \d+ bytes of texels where \d+ bytes are stored"):
        read_with(exported, content)


def test_an_edited_image_is_what_is_imported(tmp_path):
    (item,) = folder.write(ward(), tmp_path)
    path = item.folder / "_SVBRDF_DiffuseColorMap_sRGB.exr"
    half = np.full((16, 16, 4), 0.25, np.float16).view(np.uint16)
    CONTAINERS["exr"].write(path, TextureImage("RGBA16F", (half,)))
    (back,) = folder.read(tmp_path).materials
    assert np.all(back.textures["diffusecolor"].data == 0.25)
