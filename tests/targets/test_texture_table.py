"""Every row of the specification's texture table: present, absent (its default), and wrong (rank, channels, range)."""

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.targets import unity_2018
from axffit.textures import format_named
from axffit.textures.rerange import Counts
from tests.targets.materials import paint, ward, with_texture, without


def color(x):
    return np.maximum(x, 0.0)


def offset(x):
    return 0.5 * (x + 1.0)


def same(x):
    return x


@dataclass(frozen=True)
class Row:
    """One row of the table, written down a second time: nothing here is taken from the package.

    ``formats`` is format to re-ranging, the advised one first; ``default`` is in the target's range; ``absent`` says
    what must be missing for the default to be made (None: nothing is made); ``outside`` is an array out of range with
    the error or the counts it leads to.
    """

    axf_name: str
    make: Callable
    formats: dict[str, Callable]
    default: tuple[float, ...]
    absent: tuple[str, ...] | None
    outside: tuple[np.ndarray, str | Counts]
    channels: int = 3
    wrong_channels: int = 2


COLOR = {"RGBA16F": color, "RGBA32F": color, "RGBA8_UNORM_SRGB": color}
NORMAL = {"RGBA16_UNORM": offset, "RGBA16F": same, "RGBA32F": same}
ANGLE = {"RGBA16_UNORM": lambda x: 0.5 * (1 + x / np.pi), "R16F": same, "R32F": same}
F0 = {name: lambda x: ((x - 1) / (x + 1)) ** 2 for name in ("R16F", "R32F")}
NEGATIVE = (np.full((2, 2, 3), -0.25), Counts(clamped=4, excess=0.25))
LONG = (np.full((2, 2, 3), 1.5), "tangent-space component) outside [-1, 1]")
COAT = ("clearcoatcolor", "clearcoatnormal", "clearcoatior")
FLAT, WHITE, BLACK = (0.5, 0.5, 1.0, 1.0), (1.0,) * 4, (0.0,) * 4

TABLE = {
    "_SVBRDF_DiffuseColorMap_sRGB": Row("diffusecolor", ward, COLOR, BLACK, (), NEGATIVE),
    "_SVBRDF_SpecularColorMap_sRGB": Row("specularcolor", ward, COLOR, WHITE, (), NEGATIVE),
    "_SVBRDF_NormalMap": Row("normal", ward, NORMAL, FLAT, (), LONG),
    "_SVBRDF_SpecularLobeMap": Row(
        "specularlobe", ward, {"RG16F": same, "RG32F": same}, (1.0, 1.0), (),
        (np.full((2, 2, 2), 1.5), "roughness) outside [0, 1]"), channels=2, wrong_channels=3,
    ),
    "_SVBRDF_OpacityMap": Row(
        "opacity", ward, {"R8_UNORM": same}, (1.0,), (), (np.full((2, 2, 1), 1.5), "opacity) outside [0, 1]"),
        channels=1,
    ),
    "_SVBRDF_FresnelMap_sRGB": Row(
        "fresnel", ward, COLOR, BLACK, (), (np.full((2, 2, 3), 1.5), "F0) outside (-inf, 1]")
    ),
    "_SVBRDF_AnisotropicRotationAngleMap": Row(
        "anisrotation", ward, ANGLE, (0.5, 0.0, 0.0, 1.0), (), (np.full((2, 2, 1), 4.0), Counts(wrapped=4)), channels=1
    ),
    "_SVBRDF_HeightMap": Row(
        "height", ward, {"R16F": same, "R32F": same}, (0.0,), None, (np.full((2, 2, 1), np.inf), "not finite"),
        channels=1,
    ),
    "_CarPaint_BRDFColorMap_sRGB": Row("brdfcolors", paint, COLOR, WHITE, (), NEGATIVE),
    "_CarPaint_BTFFlakesMap_sRGB": Row(
        "btfflakes", paint, COLOR, BLACK, (), (np.full((10, 2, 2, 3), -0.25), Counts(clamped=40, excess=0.25))
    ),
    "_SVBRDF_ClearCoatColorMap_sRGB": Row("clearcoatcolor", ward, COLOR, WHITE, COAT, NEGATIVE),
    "_SVBRDF_ClearCoatNormalMap": Row("clearcoatnormal", ward, NORMAL, FLAT, COAT, LONG),
    "_SVBRDF_ClearCoatIORMap_sRGB": Row(
        "clearcoatior", ward, F0, (0.04,), COAT, (np.full((2, 2, 1), -1.0), Counts(replaced=4)), channels=1
    ),
}  # fmt: skip

SLICES = "_CarPaint_thetaFI_sliceLUTMap"
every_row = pytest.mark.parametrize("name", TABLE)


def decoded(texture, level=0):
    return format_named(texture.format).decode(texture.levels[level])


def test_the_table_is_complete():
    assert {*TABLE, SLICES} == {row.name for row in unity_2018.ENGINE.tables.textures}


@every_row
def test_present(name):
    row = TABLE[name]
    material = row.make()
    if row.axf_name not in material.textures:
        material = with_texture(material, row.axf_name, np.full((4, 4, row.channels), 0.5))
    original = material.textures[row.axf_name]
    for number, (format, rerange) in enumerate(row.formats.items()):
        chosen = {} if number == 0 else {row.axf_name: format}
        packed = unity_2018.pack(material, formats=chosen)
        texture = packed.textures[name]
        assert (texture.format, texture.axf_name, texture.defaulted) == (format, row.axf_name, False)
        assert len(texture.levels) == len(original.levels)
        scale_name = next(r.scale for r in unity_2018.ENGINE.tables.textures if r.name == name)
        scale = 1.0 if scale_name is None else packed.values[scale_name]
        assert (scale == 1.0) or not format.endswith("F")
        for level, values in enumerate(original.levels):
            usable = np.where(np.isnan(values), 1.5, values).astype(np.float64)
            form, wanted = format_named(format), rerange(usable) / scale
            shown = decoded(texture, level)[..., : row.channels]
            top = form.codecs[0].highest
            padded = np.zeros((*wanted.shape[:-1], form.channels))
            padded[..., : row.channels] = np.minimum(wanted, top)
            bound = form.error_bound(padded)[..., : row.channels]
            assert np.all(np.abs(shown - padded[..., : row.channels]) <= bound + 1e-15)


@every_row
def test_absent(name):
    row = TABLE[name]
    packed = unity_2018.pack(without(row.make(), row.axf_name))
    if row.absent is None:
        # Flag bit 3 says that it is not sampled.
        assert name not in packed.textures
        assert packed.values["_flags"] & 8 == 0
        return
    texture = packed.textures[name]
    assert texture.defaulted
    assert texture.levels[0].shape[-3:-1] == (4, 4)
    advised = next(iter(row.formats))
    assert texture.format == advised
    form = format_named(advised)
    wanted = np.broadcast_to(np.array(row.default), (4, 4, form.channels))
    assert np.all(np.abs(decoded(texture) - wanted) <= form.error_bound(wanted))
    if row.absent:
        # Only some clear-coat texture makes the default of another; without any, flag bit 1 is 0 and none is made.
        bare = unity_2018.pack(without(row.make(), *row.absent))
        assert name not in bare.textures
        assert bare.values["_flags"] & 2 == 0


@every_row
def test_wrong_rank(name):
    row = TABLE[name]
    rank = 4 if row.axf_name == "btfflakes" else 3
    message = f"{row.axf_name} of rank 2 (shape (4, 3)); it must have rank {rank}"
    with pytest.raises(InputError, match=re.escape(message)):
        unity_2018.pack(with_texture(row.make(), row.axf_name, np.zeros((4, 3))))


@every_row
def test_wrong_channels(name):
    row = TABLE[name]
    shape = (10, 4, 4, 2) if row.axf_name == "btfflakes" else (4, 4, row.wrong_channels)
    with pytest.raises(InputError, match=f"{row.axf_name} has {shape[-1]} channels; it must have"):
        unity_2018.pack(with_texture(row.make(), row.axf_name, np.zeros(shape)))


@every_row
def test_wrong_range(name):
    row = TABLE[name]
    values, outcome = row.outside
    material = with_texture(row.make(), row.axf_name, values)
    if isinstance(outcome, str):
        with pytest.raises(InputError, match=re.escape(outcome)):
            unity_2018.pack(material)
        return
    texture = unity_2018.pack(material).textures[name]
    assert texture.counts == outcome
    assert np.all(np.isfinite(decoded(texture)))
    assert np.all(decoded(texture) >= 0)


@every_row
def test_nothing_but_an_index_may_be_nan(name):
    row = TABLE[name]
    shape = (10, 4, 4, 3) if row.axf_name == "btfflakes" else (4, 4, row.channels)
    material = with_texture(row.make(), row.axf_name, np.full(shape, np.nan))
    if row.axf_name == "clearcoatior":
        texture = unity_2018.pack(material).textures[name]
        assert texture.counts == Counts(replaced=16)
        np.testing.assert_allclose(decoded(texture), 0.04, rtol=2.0**-11)
        return
    with pytest.raises(InputError, match=f"in {row.axf_name} not finite"):
        unity_2018.pack(material)


def test_heights_in_an_integer_format_are_rescaled_by_their_maximum():
    packed = unity_2018.pack(ward(), formats={"height": "R16_UNORM"})
    heights = ward().textures["height"].data
    assert packed.values["_SVBRDF_heightMapMax_mm"] == heights.max()
    shown = decoded(packed.textures["_SVBRDF_HeightMap"]) * packed.values["_SVBRDF_heightMapMax_mm"]
    assert np.abs(shown - heights).max() <= 0.5 / 65535 * heights.max() + 1e-9


def test_an_isotropic_lobe_has_one_channel():
    lobe = np.full((4, 4, 1), 0.25)
    material = with_texture(ward(), "specularlobe", lobe)
    packed = unity_2018.pack(without(material, "anisrotation"), formats={"specularlobe": "R32F"})
    np.testing.assert_array_equal(decoded(packed.textures["_SVBRDF_SpecularLobeMap"]), lobe)


def test_the_slice_table_present():
    packed = unity_2018.pack(paint())
    np.testing.assert_array_equal(decoded(packed.textures[SLICES]).reshape(-1) * 255, [0, 5, 8, 10, 0, 0])
    assert packed.textures[SLICES].format == "R8_UNORM"
    exact = unity_2018.pack(paint(), formats={"thetaFI_sliceLUT": "R8_UINT"}).textures[SLICES]
    np.testing.assert_array_equal(exact.levels[0].reshape(-1), [0, 5, 8, 10, 0, 0])


def test_the_slice_table_absent():
    packed = unity_2018.pack(without(paint(), "thetaFI_sliceLUT"))
    assert SLICES not in packed.textures
    assert [p.obligation for p in unity_2018.validate(packed)] == ["slices"]
    assert unity_2018.validate(unity_2018.pack(without(paint(), "thetaFI_sliceLUT", "btfflakes"))) == ()


@pytest.mark.parametrize(
    ("entries", "message"),
    [([0, 300], "300"), ([0, 5, 3], "falls from 5 to 3"), ([0, 5, 99], "99"), ([0, 5], "one entry a bin")],
)
def test_the_slice_table_wrong(entries, message):
    material = paint()
    properties = {**material.properties, "thetaFI_sliceLUT": entries}
    broken = type(material)(id="paint", name="", kind=material.kind, textures=material.textures, properties=properties)
    with pytest.raises(InputError, match=message):
        unity_2018.pack(broken)
