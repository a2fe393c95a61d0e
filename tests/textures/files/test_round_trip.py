"""Every format in every kind of file that holds it comes back bit for bit, with levels and slices."""

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.textures import FORMATS
from axffit.textures.files import CONTAINERS, TextureImage, container_for, load, save
from axffit.textures.files.image import code_type_of
from tests.textures.files.images import ALL_FORMATS, random_image, same

HELD = [(kind, format) for kind, entry in CONTAINERS.items() for format in ALL_FORMATS if entry.holds(format)]
SHAPES = {
    "plain": {},
    "one texel": {"size": (1, 1)},
    "levels": {"size": (9, 4), "levels": 4},
    "array": {"slices": 3},
    "array of one": {"slices": 1, "levels": 2},
    "array with levels": {"size": (4, 8), "slices": 2, "levels": 4},
}


@pytest.mark.parametrize(("kind", "format"), HELD)
def test_codes_come_back_bit_for_bit(kind, format, tmp_path):
    for name, shape in SHAPES.items():
        image = random_image(format, **shape)
        container = container_for(image, kind)
        folder = tmp_path / name
        folder.mkdir()
        files = save(folder, "map", image, container)
        assert {path.name for path in folder.iterdir()} == {stored.file for stored in files}
        back = load(folder, files, container, format, [level.shape[:-1] for level in image.levels])
        assert same(back, image), name


@pytest.mark.parametrize(("kind", "format"), [pair for pair in HELD if pair[0] != "png"])
def test_the_file_itself_says_its_format(kind, format, tmp_path):
    image = random_image(format, levels=2)
    path = tmp_path / "map"
    CONTAINERS[kind].write(path, image)
    assert same(CONTAINERS[kind].read(path, None), image)


@pytest.mark.parametrize("format", [format for kind, format in HELD if kind == "exr" and "UNORM" in format])
def test_every_code_comes_back_from_the_float_of_an_exr_file(format, tmp_path):
    form = FORMATS[format]
    count = 2 ** max(codec.bits for codec in form.codecs)
    codes = np.stack([np.arange(count) % 2**codec.bits for codec in form.codecs], axis=-1)
    image = TextureImage(format, (codes.astype(code_type_of(form)).reshape(-1, 64, form.channels),))
    CONTAINERS["exr"].write(tmp_path / "a.exr", image)
    assert same(CONTAINERS["exr"].read(tmp_path / "a.exr", None), image)


def test_the_issue_s_formats_are_held_where_it_asks_for_them():
    asked = ("RGBA16_UNORM", "R8_UNORM", "R8_UINT", "R16_UNORM", "R16F", "RG16F", "RGBA16F", "RGBA32F", "R32F")
    for format in (*asked, "RGBA8_UNORM", "RGBA8_UNORM_SRGB"):
        assert CONTAINERS["dds"].holds(format), format
        assert CONTAINERS["ktx2"].holds(format), format
    assert not [format for format in ALL_FORMATS if not CONTAINERS["ktx2"].holds(format)]


@pytest.mark.parametrize(
    ("format", "shape", "expected"),
    [
        ("RGBA16F", {}, "exr"),
        ("RGBA16_UNORM", {}, "png"),
        ("R8_UINT", {}, "png"),
        ("RGBA16F", {"slices": 2}, "dds"),
        ("RGBA16_UNORM", {"levels": 2}, "dds"),
        ("RGB16F", {"slices": 2}, "ktx2"),
        ("RGB16_UNORM", {"slices": 2, "levels": 2}, "png"),
    ],
)
def test_auto_chooses_by_what_a_texture_is(format, shape, expected):
    assert container_for(random_image(format, **shape)).name == expected


def test_levels_that_do_not_halve_go_to_parts_or_single_files(tmp_path):
    odd = TextureImage("RGBA16F", tuple(np.zeros((side, side, 4), np.uint16) for side in (8, 5, 1)))
    container = container_for(odd)
    assert container.name == "exr"
    files = save(tmp_path, "odd", odd, container)
    assert same(load(tmp_path, files, container, "RGBA16F", [(8, 8), (5, 5), (1, 1)]), odd)
    for kind in ("dds", "ktx2"):
        with pytest.raises(InputError, match="choose auto or exr"):
            container_for(odd, kind)
        with pytest.raises(InputError, match="half the size"):
            CONTAINERS[kind].write(tmp_path / "x", odd)


def test_what_a_kind_of_file_cannot_hold_is_refused():
    with pytest.raises(
        InputError, match="RGBA16F of 7x5 texels cannot be stored as png; choose auto or exr, dds, ktx2"
    ):
        container_for(random_image("RGBA16F"), "png")
    with pytest.raises(InputError, match="unknown image format 'bmp'; allowed: auto, exr, png, dds, ktx2"):
        container_for(random_image("RGBA16F"), "bmp")
    with pytest.raises(InputError, match="choose auto or ktx2"):
        container_for(random_image("RGB16F", levels=2), "dds")


@pytest.mark.parametrize(("kind", "format"), [("dds", "RGB16F"), ("png", "RGBA16F")])
def test_a_writer_refuses_a_format_it_has_no_code_for(kind, format, tmp_path):
    with pytest.raises(InputError, match=format):
        CONTAINERS[kind].write(tmp_path / "x", random_image(format))


WRONG = {
    "no level": ("R8_UNORM", ()),
    "channels": ("R8_UNORM", (np.zeros((2, 2, 2), np.uint8),)),
    "type": ("R8_UNORM", (np.zeros((2, 2, 1), np.uint16),)),
    "rank": ("R8_UNORM", (np.zeros((2, 1), np.uint8),)),
    "no texel": ("R8_UNORM", (np.zeros((0, 2, 1), np.uint8),)),
    "slices": ("R8_UNORM", (np.zeros((2, 2, 2, 1), np.uint8), np.zeros((1, 1, 1, 1), np.uint8))),
}


@pytest.mark.parametrize("name", WRONG)
def test_levels_that_are_no_codes_of_the_format_are_refused(name):
    with pytest.raises(InputError, match="R8_UNORM"):
        TextureImage(*WRONG[name])
