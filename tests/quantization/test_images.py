"""FLIP, dE2000 and PSNR of pictures: published values, closed forms, an independent writing of FLIP's color part."""

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.quantization.images import delta_e_map, flip_map, image_errors, psnr


def constant(*color: float, size: int = 24) -> np.ndarray:
    return np.broadcast_to(np.array(color, float), (size, size, 3)).copy()


def hunt_lab(srgb: np.ndarray) -> np.ndarray:
    """L*, and a*, b* times 0.01 L* (Andersson et al. 2020, eq. 4), white from the sRGB matrix as in FLIP."""
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    matrix = np.array(
        [
            [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
            [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
            [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
        ]
    )
    t = (matrix @ linear) / matrix.sum(axis=1)
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    lightness = 116 * f[1] - 16
    return np.array([lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])])


def flip_of_constants(a: np.ndarray, b: np.ndarray) -> float:
    """FLIP of two uniform pictures: HyAB^0.7, mapped by p_c = 0.4, p_t = 0.95; no features (section 4 there)."""

    def hyab(x: np.ndarray, y: np.ndarray) -> float:
        d = hunt_lab(x) - hunt_lab(y)
        return abs(d[0]) + np.hypot(d[1], d[2])

    largest = hyab(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])) ** 0.7
    error, knee = hyab(a, b) ** 0.7, 0.4 * largest
    if error < knee:
        return 0.95 / knee * error
    return 0.95 + (error - knee) / (largest - knee) * 0.05


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.5, 0.5, 0.5), (0.51, 0.5, 0.5)),
        ((0.2, 0.6, 0.9), (0.3, 0.5, 0.7)),
        ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
    ],
)
def test_flip_of_uniform_pictures_as_published(a, b):
    found = flip_map(constant(*a), constant(*b))
    assert found.shape == (24, 24)
    # The package filters in float32; a uniform picture stays uniform to about 1e-4.
    np.testing.assert_allclose(found, flip_of_constants(np.array(a), np.array(b)), atol=2e-3)


def test_flip_is_a_number_and_not_a_color_map():
    """Magma would turn 0 into its darkest color, not 0, and clip the ends."""
    ramp = constant(0.5, 0.5, 0.5)
    moved = ramp.copy()
    moved[:, 12:] += np.linspace(0.0, 0.3, 12)[None, :, None]
    found = flip_map(ramp, moved)
    assert found[:, :2].max() < 0.01
    assert np.all(np.diff(found[12, 15:22]) > 0)
    assert flip_map(ramp, ramp).max() == 0.0


# Sharma, Wu and Dalal (2005), table 1: pairs 1, 7, 16, 20, 24, 34 (L, a, b twice, dE2000).
SHARMA = [
    (50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485, 2.0425),
    (50.0, 0.0, 0.0, 50.0, -1.0, 2.0, 2.3669),
    (50.0, 2.5, 0.0, 50.0, 0.0, -2.5, 4.3065),
    (50.0, 2.5, 0.0, 58.0, 24.0, 15.0, 19.4535),
    (50.0, 2.5, 0.0, 50.0, 3.2592, 0.3350, 1.0),
    (2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082),
]


@pytest.mark.parametrize("row", SHARMA, ids=lambda row: str(row[-1]))
def test_delta_e_of_published_pairs(row):
    """Through sRGB; a pair outside its gamut has values outside [0, 1], which the conversion keeps."""
    import colour

    white = colour.RGB_COLOURSPACES["sRGB"].whitepoint
    pair = [colour.XYZ_to_sRGB(colour.Lab_to_XYZ(np.array(lab), white)) for lab in (row[:3], row[3:6])]
    found = delta_e_map(*(np.broadcast_to(color, (1, 1, 3)) for color in pair))
    # The sRGB matrices of IEC 61966-2-1 have four digits and are no exact inverses.
    np.testing.assert_allclose(found, row[6], atol=2e-3)


@pytest.mark.parametrize("step", [1e-4, 1 / 255, 0.5])
def test_psnr_of_a_uniform_step_is_its_square(step):
    a = constant(0.25, 0.25, 0.25)
    np.testing.assert_allclose(psnr(a, a + step), -20 * np.log10(step), rtol=1e-9)


def test_psnr_agrees_with_colour_science():
    from colour.utilities import metric_psnr

    rng = np.random.default_rng(11)
    a, b = rng.uniform(0, 1, (2, 9, 7, 3))
    np.testing.assert_allclose(psnr(a, b), metric_psnr(a, b), rtol=1e-12)


def test_only_the_judged_pixels_count():
    before = constant(0.4, 0.4, 0.4)
    after = before.copy()
    after[:, :6] = 0.9
    judged = np.zeros((24, 24), bool)
    judged[:, 18:] = True
    errors = image_errors(before, after, judged)
    assert errors.pixels == 24 * 6
    assert errors.psnr == float("inf")
    assert errors.delta_e_2000 is not None
    assert errors.delta_e_2000.max == 0.0
    everywhere = image_errors(before, after)
    assert everywhere.delta_e_2000 is not None
    assert everywhere.flip is not None
    np.testing.assert_allclose(everywhere.psnr, -10 * np.log10(0.25 * 0.25), rtol=1e-12)
    assert everywhere.flip.mean > 0.1


def test_json_has_null_for_the_psnr_of_equal_pictures():
    picture = constant(0.1, 0.2, 0.3)
    content = image_errors(picture, picture).to_json()
    assert content["psnr_db"] is None
    assert content["flip"] == {"mean": 0.0, "p99": 0.0, "max": 0.0}
    assert content["delta_e_2000"] == {"mean": 0.0, "p99": 0.0, "max": 0.0}
    assert content["pixels"] == 576


@pytest.mark.parametrize(
    ("before", "after", "judged", "message"),
    [
        (constant(0, 0, 0), constant(0, 0, 0, size=8), None, "render both at one size"),
        (constant(0, 0, 0), constant(1.5, 0, 0), None, r"values from 0 to 1.5"),
        (constant(0, 0, 0).astype(np.uint8), constant(0, 0, 0), None, "give floats of shape"),
        (constant(np.nan, 0, 0), constant(0, 0, 0), None, r"sRGB values in \[0, 1\]"),
        (constant(0, 0, 0), constant(0, 0, 0), np.zeros((24, 24), bool), "at least one set"),
    ],
)
def test_unusable_pictures_are_refused(before, after, judged, message):
    with pytest.raises(InputError, match=message):
        image_errors(before, after, judged)
