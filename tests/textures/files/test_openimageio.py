"""EXR and PNG as OpenImageIO reads them, and PNG as Pillow does: pixel values compared."""

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image

from axffit.textures import format_named
from axffit.textures.files import CONTAINERS
from tests.textures.files.images import random_image

EXR = ["R16F", "RG16F", "RGB16F", "RGBA16F", "R32F", "RG32F", "RGB32F", "RGBA32F"]
EXR_OF_CODES = ["R8_UNORM", "RGBA16_UNORM", "RGBA8_UNORM_SRGB", "R8_UINT"]
PNG = [f"{c}{b}_UNORM" for c in ("R", "RG", "RGB", "RGBA") for b in (8, 16)] + ["RGBA8_UNORM_SRGB", "R8_UINT"]


def parts_of(path):
    """Every part of a file, its pixels as they are stored: alpha is not multiplied in."""
    hint = oiio.ImageSpec()
    hint.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), hint)
    assert source, oiio.geterror()
    found, part = [], 0
    while source.seek_subimage(part, 0):
        spec = source.spec()
        found.append((spec, source.read_image(part, 0, 0, spec.nchannels, spec.format)))
        part += 1
    source.close()
    return found


def finite_image(format, **shape):
    """Random codes without NaN and infinity, which compare unequal to themselves."""
    image = random_image(format, **shape)
    for level in image.levels:
        level[~np.isfinite(level.view(np.float16 if level.dtype == np.uint16 else np.float32))] = 0
    return image


@pytest.mark.parametrize("format", EXR)
def test_openimageio_reads_the_same_floats_from_exr(format, tmp_path):
    image = finite_image(format, size=(33, 20), levels=3, slices=2)
    CONTAINERS["exr"].write(tmp_path / "a.exr", image)
    found = parts_of(tmp_path / "a.exr")
    assert [spec.getattribute("oiio:subimagename") for spec, _ in found] == [
        f"level{level}.slice{index}" for level in range(3) for index in range(2)
    ]
    for number, (spec, pixels) in enumerate(found):
        codes = image.slice(*divmod(number, 2))
        assert spec.channelnames == tuple("RGBA"[: codes.shape[-1]])
        assert str(spec.format) == ("half" if format.endswith("16F") else "float")
        assert np.array_equal(pixels.view(codes.dtype), codes)


@pytest.mark.parametrize("format", EXR_OF_CODES)
def test_openimageio_reads_the_numbers_of_codes_from_exr(format, tmp_path):
    image = random_image(format)
    CONTAINERS["exr"].write(tmp_path / "a.exr", image)
    ((_, pixels),) = parts_of(tmp_path / "a.exr")
    expected = format_named(format).decode(image.levels[0])
    np.testing.assert_array_equal(pixels, expected.astype(np.float32))


@pytest.mark.parametrize("format", PNG)
def test_openimageio_reads_the_same_codes_from_png(format, tmp_path):
    image = random_image(format)
    CONTAINERS["png"].write(tmp_path / "a.png", image)
    ((spec, pixels),) = parts_of(tmp_path / "a.png")
    codes = image.levels[0]
    assert str(spec.format) == ("uint8" if codes.dtype == np.uint8 else "uint16")
    assert np.array_equal(pixels[..., : codes.shape[-1]], codes)
    assert not pixels[..., codes.shape[-1] :].any()


@pytest.mark.parametrize("format", [format for format in PNG if "16" not in format])
def test_pillow_reads_the_same_codes_from_png_of_8_bits(format, tmp_path):
    image = random_image(format)
    CONTAINERS["png"].write(tmp_path / "a.png", image)
    with Image.open(tmp_path / "a.png") as opened:
        pixels = np.asarray(opened)
        assert ("srgb" in opened.info) == format.endswith("_SRGB")
        assert not {"gamma", "icc_profile"} & set(opened.info)
    codes = image.levels[0]
    assert np.array_equal(pixels.reshape(*codes.shape[:2], -1)[..., : codes.shape[-1]], codes)


def write_with_openimageio(path, pixels, kind):
    target = oiio.ImageOutput.create(str(path))
    assert target is not None
    height, width, channels = pixels.shape
    assert target.open(str(path), oiio.ImageSpec(width, height, channels, kind))
    assert target.write_image(pixels)
    target.close()


def test_exr_written_by_openimageio_is_read(tmp_path):
    pixels = np.random.default_rng(1).random((9, 6, 3)).astype(np.float16)
    write_with_openimageio(tmp_path / "b.exr", pixels, "half")
    image = CONTAINERS["exr"].read(tmp_path / "b.exr", None)
    assert image.format == "RGB16F"
    assert np.array_equal(image.levels[0], pixels.view(np.uint16))


def test_png_written_by_openimageio_is_read(tmp_path):
    pixels = np.random.default_rng(1).integers(0, 65536, (9, 6, 3)).astype(np.uint16)
    write_with_openimageio(tmp_path / "b.png", pixels, "uint16")
    image = CONTAINERS["png"].read(tmp_path / "b.png", None)
    assert image.format == "RGB16_UNORM"
    assert np.array_equal(image.levels[0], pixels)
