"""Draws fall as the density says: chi square tests of ``sample`` against ``pdf`` for every model.

False alarm: 1e-4 for all tests here and in ``test_furnace`` together (``chi2.LEVEL``, Šidák). Power: a density scaled
by 1.02 in a wedge about the lobe that holds a tenth of the hemisphere's solid angle and a tenth of the draws, and then
everywhere so that its integral is the same, is rejected with a probability above .99. Each model gets as many draws as
that needs. The fast tests make fewer and see a scale of 1.1.
"""

import numpy as np
import pytest

from tests.brdf import chi2
from tests.brdf.models import MODELS

FAST = ["phong", "ward smooth", "ggx anisotropic", "coated, schlick"]
SCALE, FAST_SCALE, POWER = 1.02, 1.1, 0.99
REPEATS = 8


def check(name, scale, draws=None):
    model = MODELS[name]()
    table = chi2.tabulate(model, chi2.VIEWERS)
    wrong = table.wrong(scale)
    draws = draws or chi2.draws_needed(table.shares, wrong, chi2.LEVEL, POWER)
    # A spread of chi square is 20 here.
    assert table.bias(draws) < 0.5
    assert chi2.power(table.shares, wrong, draws, chi2.LEVEL) > POWER
    p = chi2.p_value(table.counts(model, draws, seed=21), table.shares)
    assert p > chi2.LEVEL, f"{draws} draws a viewer: p = {p:.3g}"


def test_every_model_and_the_fast_ones_are_counted_in_the_level():
    assert len(MODELS) + len(FAST) == chi2.CHI_SQUARE_TESTS
    tests = chi2.CHI_SQUARE_TESTS + chi2.FURNACE_TESTS
    assert 1 - (1 - chi2.LEVEL) ** tests == pytest.approx(chi2.FALSE_ALARM)


@pytest.mark.parametrize("name", FAST)
def test_few_draws_fall_as_the_density_says(name):
    check(name, FAST_SCALE, draws=chi2.BATCH)


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_draws_fall_as_the_density_says(name):
    check(name, SCALE)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["lambert", "ggx smooth"])
def test_a_density_wrong_by_two_percent_is_rejected(name):
    """By real draws, and by 1000 made-up tables: as often as the non-central distribution says."""
    model = MODELS[name]()
    table = chi2.tabulate(model, chi2.VIEWERS)
    wrong = table.wrong(SCALE)
    draws = chi2.draws_needed(table.shares, wrong, chi2.LEVEL, POWER)
    seeds = range(100, 100 + 10 * REPEATS, 10)
    missed = [chi2.p_value(table.counts(model, draws, seed), wrong) > chi2.LEVEL for seed in seeds]
    # At a power of .99 two or more of eight are missed once in 370.
    assert sum(missed) <= 1
    rng = np.random.default_rng(22)
    made_up = [[rng.multinomial(draws, share / share.sum()) for share in table.shares] for _ in range(1000)]
    rejected = np.mean([chi2.p_value(counts, wrong) < chi2.LEVEL for counts in made_up])
    predicted = chi2.power(table.shares, wrong, draws, chi2.LEVEL)
    assert abs(rejected - predicted) < 4 * np.sqrt(predicted * (1 - predicted) / 1000)


@pytest.mark.parametrize("scale", [1.0, 1.3])
def test_the_table_is_right_where_it_is_known_exactly(scale):
    """The cosine's integral over a wedge that starts at the zenith is the wedge's angle / 2 pi."""
    bins, wedge = chi2.lay(MODELS["lambert"](), np.array([0.0, 0.0, 1.0]))
    level = chi2.Bins(np.eye(3), bins.azimuths, bins.angles)
    density = chi2.density_of(MODELS["lambert"](), np.array([0.0, 0.0, 1.0]))
    total, within, _ = chi2.integrate(level, (-1.0, 0.5), density, lambda wi: scale * density(wi)[:, None])
    sines = np.sin(np.minimum(level.angles, np.pi / 2)) ** 2
    expected = np.diff(level.azimuths)[:, None] / (2 * np.pi) * np.diff(sines, axis=1)
    np.testing.assert_allclose(total[:, 0], scale * expected.ravel(), atol=1e-9)
    assert within.sum() == pytest.approx(scale * 1.5 / (2 * np.pi), abs=1e-8)
