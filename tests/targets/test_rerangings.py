"""The engines' own re-rangings: inverse after forward, formulas, counts."""

import numpy as np
import pytest

from axffit.targets.rerangings import (
    AtLeast,
    ChannelScale,
    FlippedNormal,
    Gamma,
    PositiveAngle,
    ThroughHalf,
    ThroughRgbe,
    TwoComponents,
    UsableIor,
)
from axffit.textures.rerange import Counts

RNG = np.random.default_rng(7)
UNIT = RNG.normal(size=(500, 3))
UNIT = UNIT / np.linalg.norm(UNIT, axis=-1, keepdims=True)
UPPER = UNIT * np.sign(UNIT[:, 2:])

CASES = {
    "gamma": (Gamma(), RNG.random((500, 3)), "x^(1/2.2)", 1e-12),
    "positive angle": (PositiveAngle(), RNG.uniform(-np.pi, np.pi, (500, 1)), "(x < 0: x + 2 pi) / (2 pi)", 1e-12),
    "half": (ThroughHalf(), RNG.uniform(-100, 100, (500, 3)), "half(x)", 0.04),
    "channel scale": (ChannelScale((0.5, 2.0, 0.1)), RNG.random((500, 3)), "x / (0.5, 2, 0.1)", 1e-12),
    "two components": (TwoComponents(), UPPER, "0.5 (n_xy + 1), z = sqrt(1 - x² - y²)", 1e-7),
    "at least": (AtLeast(0.25), RNG.uniform(0.25, 1, (500, 1)), "max(0.25, x)", 0.0),
    "flipped normal": (FlippedNormal(), UNIT, "0.5 ((x, -y, z) / |n| + 1)", 1e-12),
    "usable index": (UsableIor(), RNG.uniform(1, 3, (500, 1)), "x > 0: x, otherwise 1.5", 0.0),
    "rgbe": (ThroughRgbe(), RNG.random((500, 3)), "RGBE(x)", 2.0**-7),
}


@pytest.mark.parametrize("name", CASES)
def test_the_inverse_gives_back_what_was_in_range(name):
    reranging, values, formula, tolerance = CASES[name]
    assert reranging.formula == formula
    np.testing.assert_allclose(reranging.inverse(reranging.forward(values)), values, rtol=0, atol=tolerance)
    assert reranging.count(values) == Counts()


COUNTED = {
    "angles by whole turns": (PositiveAngle(), np.array([[4.0], [0.0]]), Counts(wrapped=1)),
    "halves": (ThroughHalf(), np.array([[7e4], [1.0]]), Counts(clamped=1, excess=7e4 - 65504)),
    "normals below": (TwoComponents(), np.array([[0.6, 0.0, -0.8], [0.0, 0.0, 1.0]]), Counts(folded=1)),
    "below the least": (AtLeast(0.25), np.array([[0.125], [0.5]]), Counts(clamped=1, excess=0.125)),
    "indices": (UsableIor(), np.array([[np.nan], [0.0], [1.5]]), Counts(replaced=2)),
}


@pytest.mark.parametrize("name", COUNTED)
def test_what_is_lost_is_counted(name):
    reranging, values, counts = COUNTED[name]
    assert reranging.count(values) == counts
    assert np.all(np.isfinite(reranging.inverse(reranging.forward(values))))


def test_rgbe_keeps_the_largest_to_a_part_in_128_and_nothing_grows():
    colors = np.exp(RNG.normal(size=(2000, 3)) * 5)
    held = ThroughRgbe().forward(colors)
    largest = colors.max(axis=-1, keepdims=True)
    assert np.all((held <= colors) & (colors - held < largest * 2.0**-7))
    np.testing.assert_array_equal(ThroughRgbe().forward(held), held)
    np.testing.assert_array_equal(ThroughRgbe().forward(np.zeros((1, 3))), np.zeros((1, 3)))
