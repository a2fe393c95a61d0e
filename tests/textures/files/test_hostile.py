"""Files that are cut off, damaged or absurd yield one clean error each: no crash, no memory taken."""

import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.textures.files import CONTAINERS, container_for, load, save
from axffit.textures.files.containers import StoredFile
from tests.textures.files.images import random_image

EXAMPLES = {
    "exr": ("RGBA16F", {"levels": 3, "slices": 2}),
    "png": ("RGBA16_UNORM", {}),
    "dds": ("RGBA16F", {"levels": 3, "slices": 2}),
    "ktx2": ("RGBA16F", {"levels": 3, "slices": 2}),
}
every_kind = pytest.mark.parametrize("kind", EXAMPLES)


def example(kind, folder):
    format, shape = EXAMPLES[kind]
    path = folder / f"example{CONTAINERS[kind].suffix}"
    CONTAINERS[kind].write(path, random_image(format, **shape))
    return path


@every_kind
def test_every_beginning_of_a_file_is_refused(kind, tmp_path):
    path = example(kind, tmp_path)
    content = path.read_bytes()
    for length in [*range(0, len(content), max(1, len(content) // 150)), len(content) - 1]:
        path.write_bytes(content[:length])
        with pytest.raises(InputError, match=path.name):
            CONTAINERS[kind].read(path, None)


@every_kind
def test_a_changed_byte_is_refused_or_changes_values_only(kind, tmp_path):
    path = example(kind, tmp_path)
    content = path.read_bytes()
    shapes = [level.shape for level in random_image(EXAMPLES[kind][0], **EXAMPLES[kind][1]).levels]
    rng = np.random.default_rng(5)
    refused = []
    # The headers byte by byte, the rest at random.
    places = [*range(min(160, len(content))), *rng.integers(0, len(content), 60)]
    for place in places:
        damaged = bytearray(content)
        damaged[place] ^= int(rng.integers(1, 256))
        path.write_bytes(damaged)
        try:
            image = CONTAINERS[kind].read(path, None)
            assert len(image.levels) <= len(shapes)
        except InputError as error:
            refused.append(str(error))
    assert len(refused) > 20
    assert not [message for message in refused if path.name not in message]


@every_kind
def test_another_kind_of_file_is_refused_by_its_first_bytes(kind, tmp_path):
    path = tmp_path / "text"
    path.write_bytes(b"this is no image file\n" * 40)
    with pytest.raises(InputError, match="first bytes"):
        CONTAINERS[kind].read(path, None)
    with pytest.raises(InputError, match="no such file"):
        CONTAINERS[kind].read(tmp_path, None)


def patched(content, at, form, *values):
    return content[:at] + struct.pack(form, *values) + content[at + struct.calcsize(form) :]


def chunk_table(content):
    """Where the table of the six chunks begins: its first entry points right behind it."""
    return next(at for at in range(len(content)) if struct.unpack_from("<Q", content, at)[0] == at + 6 * 8)


def png_of(width, height, color=6, bits=16, more=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">2I5B", width, height, bits, color, 0, 0, 0)
    pixels = chunk(b"IDAT", zlib.compress(bytes(1000)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + more + pixels + chunk(b"IEND", b"")


HUGE = 60000
# Fields of the DDS header: height 12, width 16, levels 28, code 84; of its extension: format 128, dimension 132,
# flags 136, slices 140. Of KTX2: format 12, width 20, height 24, depth 28, layers 32, faces 36, levels 40, packing 44.
CRAFTED = {
    "DDS of 60000 x 60000": ("dds", lambda c: patched(c, 12, "<2I", HUGE, HUGE), "declares"),
    "DDS of 0 rows": ("dds", lambda c: patched(c, 12, "<I", 0), "declares"),
    "DDS of 2^32 - 1 slices": ("dds", lambda c: patched(c, 140, "<I", 2**32 - 1), "declares"),
    "DDS without slices": ("dds", lambda c: patched(c, 140, "<I", 0), "at least 1"),
    "DDS of 200 levels": ("dds", lambda c: patched(c, 28, "<I", 200), "200 levels"),
    "DDS without the new header": ("dds", lambda c: patched(c, 84, "<4s", b"DXT1"), "DX10"),
    "DDS of a block format": ("dds", lambda c: patched(c, 128, "<I", 95), "DXGI format 95"),
    "DDS of a volume": ("dds", lambda c: patched(c, 132, "<I", 4), "only 2D"),
    "DDS of a cube": ("dds", lambda c: patched(c, 136, "<I", 4), "only 2D"),
    "DDS with more behind": ("dds", lambda c: c + b"more", "damaged"),
    "KTX2 of 60000 x 60000": ("ktx2", lambda c: patched(c, 20, "<2I", HUGE, HUGE), "declares"),
    "KTX2 of one dimension": ("ktx2", lambda c: patched(c, 24, "<I", 0), "declares"),
    "KTX2 of 2^32 - 1 layers": ("ktx2", lambda c: patched(c, 32, "<I", 2**32 - 1), "declares"),
    "KTX2 of a volume": ("ktx2", lambda c: patched(c, 28, "<I", 3), "only 2D"),
    "KTX2 of a cube": ("ktx2", lambda c: patched(c, 36, "<I", 6), "only 2D"),
    "KTX2 of 200 levels": ("ktx2", lambda c: patched(c, 40, "<I", 200), "200 levels"),
    "KTX2 with supercompression": ("ktx2", lambda c: patched(c, 44, "<I", 2), "supercompression"),
    "KTX2 of an unknown format": ("ktx2", lambda c: patched(c, 12, "<I", 1000), "Vulkan format 1000"),
    "KTX2 level beyond the file": ("ktx2", lambda c: patched(c, 80, "<Q", 2**63), "level 0"),
    "PNG of 60000 x 60000": ("png", lambda c: png_of(HUGE, HUGE), "declares"),
    "PNG of 0 columns": ("png", lambda c: png_of(0, 5), "declares"),
    "PNG with too few pixels": ("png", lambda c: png_of(1000, 1000), "damaged"),
    "PNG with a palette": ("png", lambda c: png_of(4, 4, color=3, bits=8), "color type 3"),
    "PNG of 1 bit": ("png", lambda c: png_of(4, 4, color=0, bits=1), "1 bits"),
    "PNG with tRNS": ("png", lambda c: png_of(4, 4, more=struct.pack(">I4s", 0, b"tRNS") + bytes(4)), "tRNS"),
    "EXR with tiles": ("exr", lambda c: patched(c, 4, "<I", 0x1202), "only scan lines"),
    "EXR of deep data": ("exr", lambda c: patched(c, 4, "<I", 0x1802), "only scan lines"),
    "EXR of version 1": ("exr", lambda c: patched(c, 4, "<I", 0x1001), "version"),
    "EXR of 60000 x 60000": (
        "exr",
        lambda c: patched(c, c.index(b"box2i") + 10, "<4i", 0, 0, HUGE, HUGE),
        "declares",
    ),
    "EXR of negative size": ("exr", lambda c: patched(c, c.index(b"box2i") + 10, "<4i", 9, 9, 0, 0), "declares"),
    "EXR of no channel": ("exr", lambda c: patched(c, c.index(b"chlist") + 11, "<B", 0), "channels none"),
    "EXR of a subsampled channel": ("exr", lambda c: patched(c, c.index(b"chlist") + 21, "<2i", 2, 2), "sampled 2 x 2"),
    "EXR without a data window": ("exr", lambda c: c.replace(b"dataWindow", b"dataWindew"), "without dataWindow"),
    "EXR of unknown compression": (
        "exr",
        lambda c: patched(c, c.index(b"compression\0compression") + 28, "<B", 77),
        "compression 77",
    ),
    "EXR of unknown parts": ("exr", lambda c: c.replace(b"level1.slice0", b"levelX.slice0"), "levelX.slice0"),
    "EXR of an unknown format": ("exr", lambda c: c.replace(b"RGBA16F", b"RGBA17F"), "RGBA17F"),
    "EXR never finished": ("exr", lambda c: patched(c, chunk_table(c), "<Q", 0), "never finished"),
}


@pytest.mark.parametrize("name", CRAFTED)
def test_a_crafted_file_is_refused_with_its_reason(name, tmp_path):
    kind, change, message = CRAFTED[name]
    path = example(kind, tmp_path)
    content = path.read_bytes()
    path.write_bytes(change(content))
    assert path.read_bytes() != content
    with pytest.raises(InputError, match=message):
        CONTAINERS[kind].read(path, None)


BOMB = """
import resource, sys
from pathlib import Path
import axffit.textures.files as files
start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
for name in sys.argv[2:]:
    try:
        files.CONTAINERS[name.rsplit(".")[-1]].read(Path(sys.argv[1]) / name, None)
    except files.image.InputError:
        print("refused", name)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - start) // 1024)
"""


def test_absurd_sizes_take_no_memory(tmp_path):
    names = []
    for name, (kind, change, _) in CRAFTED.items():
        if "60000" in name or "2^32" in name:
            names.append(f"{len(names)}.{kind}")
            (tmp_path / names[-1]).write_bytes(change(example(kind, tmp_path).read_bytes()))
    command = [sys.executable, "-c", BOMB, str(tmp_path), *names]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    assert shown.count("refused") == len(names) == 6
    assert int(shown[-1]) < 64, "MiB taken"


@pytest.mark.parametrize(("kind", "format", "other"), [("dds", "R8_UNORM", "R8_UINT"), ("ktx2", "R16F", "R16_UNORM")])
def test_another_format_than_expected_is_refused(kind, format, other, tmp_path):
    path = tmp_path / "a"
    CONTAINERS[kind].write(path, random_image(format))
    with pytest.raises(InputError, match=f"holds {format}, not {other}"):
        CONTAINERS[kind].read(path, other)


def test_a_png_that_does_not_fit_the_format_is_refused(tmp_path):
    path = tmp_path / "a.png"
    CONTAINERS["png"].write(path, random_image("RGB8_UNORM"))
    for format, message in {
        "RGBA8_UNORM": "stored as 4 channels of 8 bits",
        "RGB16_UNORM": "stored as 3 channels of 16 bits",
        "RG8_UNORM": "blue 0",
        "RGBA16F": "cannot be stored as PNG",
    }.items():
        with pytest.raises(InputError, match=message):
            CONTAINERS["png"].read(path, format)


def test_an_exr_that_does_not_fit_the_format_is_refused(tmp_path):
    path = tmp_path / "a.exr"
    CONTAINERS["exr"].write(path, random_image("RG16F"))
    for format, message in {"RGBA16F": "needs A, B, G, R", "RG32F": "needs float32", "RG8_UNORM": "outside"}.items():
        with pytest.raises(InputError, match=message):
            CONTAINERS["exr"].read(path, format)


def test_files_of_another_size_or_missing_ones_are_refused(tmp_path):
    image = random_image("RGBA8_UNORM", slices=2, levels=2)
    container = container_for(image, "png")
    files = save(tmp_path, "map", image, container)
    shapes = [level.shape[:-1] for level in image.levels]
    with pytest.raises(InputError, match="expected 7x6"):
        load(tmp_path, files, container, "RGBA8_UNORM", [(2, 7, 6), (2, 3, 2)])
    with pytest.raises(InputError, match="no file is named for level 1, slice 1"):
        load(tmp_path, files[:-1], container, "RGBA8_UNORM", shapes)
    (tmp_path / files[2].file).unlink()
    with pytest.raises(InputError, match=r"map\.level1\.slice0\.png: no such file"):
        load(tmp_path, files, container, "RGBA8_UNORM", shapes)
    dds = CONTAINERS["dds"]
    dds.write(tmp_path / "map.dds", image)
    with pytest.raises(InputError, match="holds 2x7x5, 2x3x2 texels; expected 2x7x5"):
        load(tmp_path, [StoredFile("map.dds")], dds, "RGBA8_UNORM", shapes[:1])
