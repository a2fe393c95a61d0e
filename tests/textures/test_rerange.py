"""Every re-ranging: forward and inverse agree, and what cannot be kept is counted."""

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.textures.rerange import (
    Chain,
    ClampNegative,
    Counts,
    Identity,
    IorToF0,
    Reranging,
    Scale,
    SignedAngle,
    SliceIndex,
    UnitOffset,
)

LEGAL: dict[str, tuple[Reranging, np.ndarray]] = {
    "identity": (Identity(), np.linspace(-3, 3, 101)),
    "clamp": (ClampNegative(), np.linspace(0, 7, 101)),
    "normal": (UnitOffset(), np.linspace(-1, 1, 101)),
    "angle": (SignedAngle(), np.linspace(-np.pi, np.pi, 101)),
    "half-turn angle": (SignedAngle(np.pi / 2), np.linspace(-np.pi / 2, np.pi / 2, 101)),
    "ior": (IorToF0(), np.concatenate([[1.0], np.linspace(1.001, 30, 101)])),
    "scale": (Scale(2.97), np.linspace(0, 2.97, 101)),
    "clamp and scale": (Chain((ClampNegative(), Scale(4.0))), np.linspace(0, 4, 101)),
    "slice": (SliceIndex(), np.arange(256.0)),
}
"""Each re-ranging with values it must keep."""

every = pytest.mark.parametrize("name", LEGAL)


@every
def test_inverse_undoes_forward_and_nothing_is_counted(name):
    reranging, values = LEGAL[name]
    back = reranging.inverse(reranging.forward(values))
    np.testing.assert_allclose(back, values, rtol=1e-12, atol=1e-14)
    assert reranging.count(values[:, None]) == Counts()
    assert reranging.count(values.astype(np.float32)[:, None]) == Counts()


@every
def test_forward_is_monotone_and_every_formula_is_stated(name):
    reranging, values = LEGAL[name]
    assert np.all(np.diff(reranging.forward(values)) > 0)
    assert "x" in reranging.formula


@pytest.mark.parametrize("name", [n for n in LEGAL if n not in ("identity", "clamp", "clamp and scale")])
def test_forward_maps_into_the_unit_interval(name):
    reranging, values = LEGAL[name]
    target = reranging.forward(values)
    assert target.min() >= 0
    assert target.max() <= 1


def test_negative_colors_are_clamped_and_counted():
    x = np.array([[-0.25, 0.5, -1.0]], dtype=np.float32)
    assert ClampNegative().count(np.concatenate([x, x, -np.abs(0 * x)])).clamped == 2
    np.testing.assert_array_equal(ClampNegative().forward(x), [[0, 0.5, 0]])
    assert ClampNegative().count(x) == Counts(clamped=1, excess=1.0)


def test_normals_beyond_one_are_clamped_and_counted():
    x = np.array([1.5, -1.0, np.nextafter(np.float32(1), np.float32(2))])
    np.testing.assert_array_equal(UnitOffset().forward(x), [1, 0, 1])
    assert UnitOffset().count(x[:, None]) == Counts(clamped=1, excess=0.5)


def test_angles_outside_come_back_by_whole_turns():
    x = np.array([3 * np.pi / 2, -5 * np.pi / 2, np.pi, -np.pi, 0.0])
    back = SignedAngle().inverse(SignedAngle().forward(x))
    np.testing.assert_allclose(back, [-np.pi / 2, -np.pi / 2, np.pi, -np.pi, 0], atol=1e-12)
    assert SignedAngle().count(x[:, None]) == Counts(wrapped=2)
    assert SignedAngle(np.pi / 2).count(x[:, None]) == Counts(wrapped=4)


def test_an_angle_packed_for_one_target_and_read_by_the_other_turns_at_half():
    x = np.linspace(-1.5, 1.5, 7)
    np.testing.assert_allclose(SignedAngle(np.pi / 2).inverse(SignedAngle(np.pi).forward(x)), x / 2, atol=1e-12)


def test_unusable_indices_of_refraction_take_the_default_and_are_counted():
    x = np.array([np.nan, 0.0, -2.0, 1.5])
    np.testing.assert_allclose(IorToF0().forward(x), 0.04, rtol=1e-12)
    assert IorToF0().count(x[:, None]) == Counts(replaced=3)


def test_indices_that_come_back_as_others_are_counted():
    x = np.array([0.5, 1 / 3, np.inf, 1e30, 2.0])
    back = IorToF0().inverse(IorToF0().forward(x))
    np.testing.assert_allclose(back, [2, 3, np.inf, np.inf, 2], rtol=1e-12)
    assert IorToF0().count(x[:, None]) == Counts(folded=4)


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan, np.inf])
def test_a_scale_must_be_positive(scale):
    with pytest.raises(InputError, match="scale .* is not positive and finite"):
        Scale(scale)


@pytest.mark.parametrize("index", [256.0, 300.0, -1.0, 1.5, np.nan])
def test_a_slice_index_that_does_not_fit_is_refused(index):
    with pytest.raises(InputError, match="at entry 1 does not fit 8 bits"):
        SliceIndex().forward(np.array([7.0, index]))


def test_counts_add_and_keep_the_larger_excess():
    assert Counts(clamped=1, excess=2.0) + Counts(clamped=2, wrapped=3, excess=1.0) == Counts(3, 3, excess=2.0)


def test_a_chain_counts_each_step_where_it_acts():
    chain = Chain((ClampNegative(), Identity(), Scale(2.0)))
    assert chain.formula == "max(0, x), then x / 2"
    assert chain.count(np.array([[-1.0], [1.0]])) == Counts(clamped=1, excess=1.0)
