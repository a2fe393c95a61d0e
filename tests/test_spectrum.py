"""Spectra become linear RGB under illuminant E, and stay spectra."""

import sys
from typing import Any

import h5py
import numpy as np
import pytest

from axffit import axf, spectrum
from axffit.errors import InputError

suppress_warnings = pytest.importorskip("colour.utilities").suppress_warnings
colour = pytest.importorskip("colour", reason="colour-science (extra color) is not installed")

NANOMETERS = np.linspace(400, 700, 31)
GRIDS = [
    NANOMETERS,
    np.linspace(380, 780, 81),
    np.linspace(360, 830, 471),
    np.linspace(400, 700, 5),
    np.array([400, 431, 470, 555, 600, 611, 700.0]),
]


@pytest.fixture
def without_colour(monkeypatch):
    spectrum.weights.cache_clear()
    monkeypatch.setitem(sys.modules, "colour", None)
    yield
    spectrum.weights.cache_clear()


@pytest.mark.parametrize("wavelengths", GRIDS, ids=len)
@pytest.mark.parametrize("gray", [1.0, 0.18])
def test_a_gray_diffuser_is_its_reflectance(wavelengths, gray):
    found = spectrum.to_rgb(np.full((2, 1, wavelengths.size), gray, np.float32), wavelengths)
    np.testing.assert_array_equal(found, np.full((2, 1, 3), np.float32(gray)))
    # In float64 the weights themselves sum to 1 to rounding.
    assert np.abs(spectrum.weights(tuple(wavelengths)).sum(axis=0) - 1).max() < 1e-14


def checker():
    """The 24 patches of the ColorChecker, as published spectra at 400-700 nm."""
    shape = colour.SpectralShape(400, 700, 10)
    return {name: each.copy().align(shape) for name, each in colour.SDS_COLOURCHECKERS["ISO 17321-1"].items()}


def test_the_patches_of_the_color_checker_agree_with_astm_e308():
    """colour's own route (ASTM E308 under illuminant E) to XYZ, then the matrix written out by hand."""
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    x, y = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]]).T
    primaries = np.stack([x / y, np.ones(3), (1 - x - y) / y])
    from_rgb = primaries * np.linalg.solve(primaries, np.ones(3))
    patches = checker()
    assert len(patches) == 24
    for name, patch in patches.items():
        with suppress_warnings(colour_runtime_warnings=True):
            xyz = colour.sd_to_XYZ(patch, observer, colour.SDS_ILLUMINANTS["E"], method="ASTM E308") / 100
        found = spectrum.to_rgb(patch.values.astype(np.float32), patch.wavelengths)
        np.testing.assert_allclose(found, np.linalg.solve(from_rgb, xyz), atol=3e-4, err_msg=name)


def test_the_published_white_point_and_luminance():
    """CIE 15: the white of illuminant E is (1/3, 1/3); Rec. 709 primaries with it have these luminances."""
    x, y = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]]).T
    luminance = np.linalg.solve(np.stack([x / y, np.ones(3), (1 - x - y) / y]), np.ones(3))
    wavelengths = tuple(range(360, 831))
    photopic = spectrum.weights(tuple(map(float, wavelengths))) @ luminance
    # CIE 1924 luminous efficiency: 1 at 555 nm, 0.503 at 510 nm, 0.107 at 650 nm.
    ratio = photopic / photopic[555 - 360]
    for nanometer, efficiency in ((555, 1.0), (510, 0.503), (650, 0.107), (450, 0.038)):
        assert ratio[nanometer - 360] == pytest.approx(efficiency, abs=2e-3)


def test_a_conversion_is_linear_and_keeps_negative_colors():
    green = np.exp(-(((NANOMETERS - 520) / 10) ** 2))
    found = spectrum.to_rgb(green, NANOMETERS)
    assert found[0] < 0 < found[1]  # outside the gamut of Rec. 709
    np.testing.assert_allclose(spectrum.to_rgb(2 * green, NANOMETERS), 2 * found, rtol=1e-6)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ([400, 500, 600], [400, 500, 600]),
        ([0.4, 0.5, 0.6], [400, 500, 600]),
        ([4e-7, 5e-7, 6e-7], [400, 500, 600]),
        ([500, 400], None),
        ([1, 20, 300], None),
        ([np.nan, 500], None),
        ([400], None),
    ],
)
def test_units_of_wavelengths(given, expected):
    found = spectrum.in_nanometers(np.array(given))
    assert (None if found is None else found.tolist()) == expected


def test_wavelengths_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="30 wavelengths for 31 channels"):
        spectrum.to_rgb(np.ones(31), NANOMETERS[:30])


RESOURCE = "com.xrite.Materials/m/com.xrite.Resources/DiffuseModel/Color"


def spectra(*shape):
    return np.random.default_rng(5).random(shape).astype(np.float32)


def file_of(path, data, wavelengths=None, at=f"{RESOURCE}/Wavelengths"):
    with h5py.File(path, "w") as file:
        file[f"{RESOURCE}/Data"] = data
        if wavelengths is not None:
            file[at] = wavelengths
    return path


def test_31_channels_are_converted_kept_and_said(tmp_path):
    data = spectra(4, 3, 31)
    material = axf.read(file_of(tmp_path / "a.axf", data)).material()
    found = material.textures["diffusecolor"]
    np.testing.assert_array_equal(found.spectra[0], data)
    np.testing.assert_array_equal(found.data, spectrum.to_rgb(data, NANOMETERS))
    np.testing.assert_array_equal(found.wavelengths, NANOMETERS)
    assert any("31 channels without wavelengths: taken as 400-700 nm by 10 nm" in line for line in material.inferred)
    axf.write(tmp_path / "b.axf", material)
    again = axf.read(tmp_path / "b.axf").material()
    assert again.identical(material)
    assert again.inferred == ()
    with h5py.File(tmp_path / "b.axf") as file:
        stored: Any = file[f"{RESOURCE}/Data"]
        assert stored[()].tobytes() == data.tobytes()
    axf.to_brdf(again)


@pytest.mark.parametrize("at", [f"{RESOURCE}/Wavelengths", "com.xrite.Materials/m/wavelength"])
@pytest.mark.parametrize("unit", [1, 1e-3, 1e-9])
def test_wavelengths_of_the_file_hold(tmp_path, at, unit):
    nanometers = np.linspace(380, 730, 36)
    path = file_of(tmp_path / "a.axf", spectra(2, 2, 36), (nanometers * unit).astype(np.float32), at)
    material = axf.read(path).material()
    found = material.textures["diffusecolor"].wavelengths
    assert found is not None
    np.testing.assert_allclose(found, nanometers, rtol=1e-6)
    assert material.unrecognized == ()
    assert any("in nanometers: by the size" in line for line in material.inferred) == (unit != 1)


def refuses_evaluation(material, message):
    for evaluate in (axf.to_brdf, axf.to_svbrdf):
        with pytest.raises(InputError, match=message):
            evaluate(material)


def test_channels_without_wavelengths_are_kept_and_not_evaluated(tmp_path):
    material = axf.read(file_of(tmp_path / "a.axf", spectra(2, 2, 16))).material()
    assert any("the file gives no wavelengths for its 16 channels" in line for line in material.inferred)
    refuses_evaluation(material, "DiffuseModel/Color is a spectrum and cannot be evaluated: the file gives no wavelen")
    axf.write(tmp_path / "b.axf", material)
    assert axf.read(tmp_path / "b.axf").material().identical(material)


@pytest.mark.usefixtures("without_colour")
def test_without_colour_science_spectra_are_kept_and_the_extra_is_named(tmp_path):
    material = axf.read(file_of(tmp_path / "a.axf", spectra(2, 2, 31))).material()
    assert material.textures["diffusecolor"].levels == ()
    assert any("pip install 'axffit[color]'" in line for line in material.inferred)
    refuses_evaluation(material, r"cannot be evaluated: .* pip install 'axffit\[color\]'")
    axf.write(tmp_path / "b.axf", material)
    assert axf.read(tmp_path / "b.axf").material().identical(material)


def test_a_file_written_without_colour_science_is_converted_where_it_is(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        spectrum.weights.cache_clear()
        patch.setitem(sys.modules, "colour", None)
        axf.write(tmp_path / "b.axf", axf.read(file_of(tmp_path / "a.axf", spectra(2, 2, 31))))
    found = axf.read(tmp_path / "b.axf").material().textures["diffusecolor"]
    np.testing.assert_array_equal(found.data, spectrum.to_rgb(spectra(2, 2, 31), NANOMETERS))


def test_spectral_flakes_keep_their_levels(tmp_path):
    levels = (spectra(2, 4, 4, 31), spectra(2, 2, 2, 31))
    rgb = tuple(spectrum.to_rgb(level, NANOMETERS) for level in levels)
    flakes = axf.AxfTexture(rgb, 5.0, 5.0, spectra=levels, wavelengths=NANOMETERS)
    paint = axf.AxfMaterial("p", "p", axf.MaterialKind.CAR_PAINT, textures={"btfflakes": flakes})
    axf.write(tmp_path / "a.axf", paint)
    assert axf.read(tmp_path / "a.axf").material().identical(paint)


@pytest.mark.parametrize(
    ("key", "texture", "message"),
    [
        ("normal", {"spectra": (spectra(1, 1, 31),)}, "only colors may be spectra"),
        ("diffusecolor", {"spectra": (spectra(1, 31),)}, "float32 or float16 of rank 3"),
        ("diffusecolor", {"spectra": (spectra(2, 2, 31),), "levels": (spectra(1, 1, 3),)}, "unequal sizes"),
        ("diffusecolor", {"spectra": (np.full((1, 1, 31), np.inf, np.float32),)}, "not finite"),
    ],
)
def test_wrong_spectra_are_refused(tmp_path, key, texture, message):
    made = axf.AxfTexture(**{"levels": (), **texture})
    with pytest.raises(InputError, match=message):
        axf.write(tmp_path / "a.axf", axf.AxfMaterial("m", "m", axf.MaterialKind.SVBRDF, textures={key: made}))


def test_wavelengths_belong_to_channels():
    with pytest.raises(InputError, match="30 wavelengths for its spectra"):
        axf.AxfTexture((), spectra=(spectra(1, 1, 31),), wavelengths=NANOMETERS[:30])
