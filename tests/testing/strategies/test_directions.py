import numpy as np
import pytest
from hypothesis import find, given, settings

from axffit.testing.strategies import cosines, direction_pairs, directions, lower_directions


def is_unit(v):
    return abs(np.linalg.norm(v) - 1) < 1e-15


@given(directions(), directions(lowest=0.3), lower_directions())
def test_directions_are_unit_vectors_on_their_side(above, steep, below):
    assert is_unit(above)
    assert is_unit(steep)
    assert is_unit(below)
    assert above[2] > 0
    assert steep[2] >= 0.3
    assert below[2] <= 0


@given(direction_pairs(lowest=0.05))
def test_pairs_lie_above_what_is_asked(pair):
    for v in pair:
        assert is_unit(v)
        assert v[2] >= 0.05


AWKWARD = {
    "the normal": lambda i, o: i[2] == 1,
    "grazing": lambda i, o: i[2] == 1e-8,
    "barely above the horizon": lambda i, o: i[2] == 1e-300,
    "coincident": lambda i, o: (i == o).all() and i[2] < 1,
    "mirrored": lambda i, o: (i == o * [-1, -1, 1]).all() and i[2] < 0.9,
    "almost coincident": lambda i, o: 0 < np.linalg.norm(i - o) < 1e-8,
    "opposite and grazing": lambda i, o: max(i[2], o[2]) <= 1e-4 and i @ o < -0.9,
    "unrelated": lambda i, o: abs(np.cross(i, o)[2]) > 0.1,
}


@pytest.mark.parametrize("name", AWKWARD)
def test_every_awkward_case_is_drawn(name):
    find(
        direction_pairs(),
        lambda pair: bool(AWKWARD[name](*pair)),
        settings=settings(max_examples=2000, derandomize=True, database=None),
    )


@pytest.mark.parametrize("lowest", [-0.1, 1.0, np.nan])
def test_a_cosine_out_of_range_is_refused(lowest):
    with pytest.raises(ValueError, match="lowest="):
        cosines(lowest=lowest)
