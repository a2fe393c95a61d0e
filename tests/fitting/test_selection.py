import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from axffit.errors import InputError
from axffit.fitting import LambertModel, LobesModel, SingleLobeModel, select
from axffit.fitting.models import Shapes
from axffit.fitting.selection import _folds, default_candidates

from .paints import GRID, sampled


def lobes(count):
    shapes = Shapes(jnp.array([0.08, 0.4][:count]), jnp.array(0.3))
    weights = jnp.array([[0.1, 0.2, 0.05], [0.05, 0.04, 0.06], [0.3, 0.2, 0.4]][: count + 1])
    model = LobesModel(lobe="ggx", lobes=count, f0="shared")
    return model.assemble(shapes, weights)


def test_data_of_one_lobe_choose_one_lobe():
    candidates = (LambertModel(), SingleLobeModel(lobe="ggx"))
    selection = select(sampled(lobes(1), noise=0.02), candidates)
    assert selection.chosen.model == candidates[1]
    assert selection.by_bic.model == candidates[1]
    lambert, single = selection.candidates
    assert (lambert.parameters, single.parameters) == (3, 8)
    # The noise is known, so an error of 1 is what the true model has, also on what it has not seen.
    assert single.error == pytest.approx(1.0, abs=0.05)
    assert single.validation == pytest.approx(1.0, abs=0.1)
    assert lambert.validation > 5
    content = selection.to_json()
    assert content["cross_validation"] == "ggx"
    assert [row["lobes"] for row in content["candidates"]] == [0, 1]
    assert "ggx chosen among 2 models" in selection.notes()[0]


@pytest.mark.slow
def test_data_of_two_lobes_choose_two():
    candidates = tuple(LobesModel(lobe="ggx", lobes=n, f0="shared") for n in (1, 2, 3))
    selection = select(sampled(lobes(2), noise=0.02), candidates)
    assert [one.model.lobe_count for one in (selection.chosen, selection.by_bic)] == [2, 2]


def test_swapped_and_repeated_directions_share_a_fold():
    base = sampled(lobes(1))
    swapped = dataclasses.replace(base, wi=base.wo, wo=base.wi)
    np.testing.assert_array_equal(_folds(base), _folds(swapped))
    assert np.bincount(_folds(base)).min() > len(GRID.wi) / 10


def test_there_are_thirteen_candidates():
    names = [model.name for model in default_candidates()]
    assert len(set(names)) == len(names) == 13
    assert {"lambert", "ward", "ggx, 4 lobes"} <= set(names)


@pytest.mark.parametrize("count", [3, 30])
def test_too_few_samples_tell_nothing(count):
    with pytest.raises(InputError, match="do not tell models apart"):
        select(sampled(lobes(1)).select(np.arange(300, 300 + count)))
