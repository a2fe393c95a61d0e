"""DDS as the Rust crate ddsfile reads it, KTX2 as the npm package ktx-parse does: headers and pixel values compared."""

import base64
import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from axffit.textures.files import CONTAINERS
from axffit.textures.files.dds import DXGI_FORMATS
from axffit.textures.files.ktx2 import VULKAN_FORMATS
from tests.textures.files.images import ALL_FORMATS, random_image
from tests.tools import fetch, find_tool, run_tool

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
SHAPES = {
    "plain": {},
    "levels": {"size": (9, 4), "levels": 4},
    "array": {"size": (3, 5), "slices": 3},
    "array_levels": {"size": (4, 8), "slices": 2, "levels": 3},
}


def write_all(kind, folder):
    """One file for each format and shape; returns the images by the name of the file."""
    images = {}
    for format in ALL_FORMATS:
        if CONTAINERS[kind].holds(format):
            for name, shape in SHAPES.items():
                path = folder / f"{format}.{name}.{kind}"
                images[path.name] = random_image(format, **shape)
                CONTAINERS[kind].write(path, images[path.name])
    assert len(images) > 60
    return images


def texels_of(codes, form):
    """Bytes of codes as a GPU reads them: channels of whole bytes, or one word with the first channel lowest."""
    bits = [codec.bits for codec in form.codecs]
    if len(set(bits)) == 1 and bits[0] in (8, 16, 32):
        kind = {8: "u1", 16: "<u2", 32: "<u4"}[bits[0]]
        return codes.astype(kind).tobytes()
    if form.name == "RGB9E5":
        codes, bits = np.concatenate([codes & np.uint16(511), codes[..., :1] >> np.uint16(9)], axis=-1), [9, 9, 9, 5]
    words = sum(codes[..., channel].astype(np.uint64) << np.uint64(sum(bits[:channel])) for channel in range(len(bits)))
    assert sum(bits) == 32
    return np.asarray(words).astype("<u4").tobytes()


@pytest.fixture(scope="module")
def dds_reader(tmp_path_factory):
    """The program tests/textures/files/ddsfile_reader.rs, built."""
    cargo = find_tool("cargo", mend="the Rust toolchain")
    folder = tmp_path_factory.mktemp("ddsfile")
    (folder / "src").mkdir()
    (folder / "Cargo.toml").write_text(
        '[package]\nname = "reader"\nversion = "0.0.0"\nedition = "2021"\n[dependencies]\nddsfile = "=0.6.0"\n'
    )
    shutil.copy(HERE / "ddsfile_reader.rs", folder / "src" / "main.rs")
    fetch([cargo, "fetch"], folder)
    run_tool([cargo, "build", "--offline"], folder)
    return folder / "target" / "debug" / ("reader.exe" if sys.platform == "win32" else "reader")


@pytest.fixture(scope="module")
def ktx_reader(tmp_path_factory):
    """The command that runs tests/textures/files/ktx_parse_reader.mjs."""
    npm, node = find_tool("npm", mend="comes with Node.js"), find_tool("node", mend="Node.js 18 or newer")
    folder = tmp_path_factory.mktemp("ktx")
    (folder / "package.json").write_text('{"name": "reader", "private": true}')
    fetch([npm, "install", "--no-audit", "--no-fund", "ktx-parse@2.0.0"], folder)
    shutil.copy(HERE / "ktx_parse_reader.mjs", folder)
    return [node, folder / "ktx_parse_reader.mjs"]


def test_ddsfile_reads_the_same_texels(dds_reader, tmp_path):
    images = write_all("dds", tmp_path)
    shown = run_tool([dds_reader, *sorted(images)], tmp_path).splitlines()
    assert len(shown) == len(images)
    for name, line in zip(sorted(images), shown, strict=True):
        image = images[name]
        code, width, height, levels, layers, *data = line.split()
        assert int(code) == DXGI_FORMATS[image.format], name
        assert (int(height), int(width)) == image.levels[0].shape[-3:-1], name
        assert (int(levels), int(layers)) == (len(image.levels), image.slices), name
        expected = [
            b"".join(texels_of(image.slice(k, index), image.number_format) for k in range(len(image.levels)))
            for index in range(image.slices)
        ]
        assert [bytes.fromhex(layer) for layer in data] == expected, name


def test_ktx_parse_reads_the_same_texels(ktx_reader, tmp_path):
    images = write_all("ktx2", tmp_path)
    shown = run_tool([*ktx_reader, *sorted(images)], tmp_path).splitlines()
    assert len(shown) == len(images)
    for name, line in zip(sorted(images), shown, strict=True):
        image, found = images[name], json.loads(line)
        form = image.number_format
        assert found["vkFormat"] == VULKAN_FORMATS[image.format], name
        assert (found["pixelHeight"], found["pixelWidth"]) == image.levels[0].shape[-3:-1], name
        assert found["layerCount"] == (image.slices if image.is_array else 0), name
        assert found["keyValue"] == {"KTXorientation": "rd", "KTXwriter": "axffit"}
        levels = [base64.b64decode(level) for level in found["levels"]]
        assert levels == [texels_of(level, form) for level in image.levels], name
        check_descriptor(found["descriptor"], form, name)


def check_descriptor(block, form, name):
    """What the data format specification asks of the basic block of an uncompressed format."""
    assert (block["vendorId"], block["descriptorType"], block["versionNumber"]) == (0, 0, 2)
    assert block["colorModel"] == 1, name
    assert block["transferFunction"] == (2 if "_SRGB" in name else 1), name
    assert block["bytesPlane"] == [form.bytes_per_texel, *[0] * 7], name
    samples = block["samples"]
    used = sorted({(sample["bitOffset"], sample["bitLength"]) for sample in samples})
    # Each bit of the texel belongs to a sample; ktx-parse keeps lengths less one, as the file does.
    end = 0
    for start, length in used:
        assert start == end, name
        end = start + length + 1
    assert end == 8 * form.bytes_per_texel, name
