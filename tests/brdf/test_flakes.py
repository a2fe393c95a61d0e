"""Flakes: which slices a pair of angles sees, and what bounds them."""

import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import CarPaint, ClearCoat, Flakes, texture_map

BIN = np.pi / 2 / 12
LUT = (0, 7, 14, 21, 28, 35, 42, 48, 53, 57, 60, 62, *[0] * 52)


def stack(depth=62, size=1, scale=1.0):
    """Slice k is constant and holds (k + 1, 1, 0)."""
    values = np.zeros((depth, size, size, 3))
    values[..., 0], values[..., 1] = scale * (np.arange(depth)[:, None, None] + 1), scale
    return texture_map([values])


def flakes(slices=None, lut=LUT, num_theta_f=12, num_theta_i=12, max_theta_i=12, **options):
    return Flakes(
        stack() if slices is None else slices,
        lut,
        num_theta_f=num_theta_f,
        num_theta_i=num_theta_i,
        max_theta_i=max_theta_i,
        **options,
    )


def look(f, bins_h, bins_d):
    """Value at angles given in bins: bin k is met exactly at k - 1/2, since 1/2 is added."""
    return np.asarray(f.lookup(jnp.asarray((bins_h - 0.5) * BIN), jnp.asarray((bins_d - 0.5) * BIN)))


@pytest.mark.parametrize(("bin_h", "bin_d"), [(1, 1), (6, 0.5), (2, 7), (3, 8)])
def test_a_bin_shows_its_own_slice(bin_h, bin_d):
    if bin_d == int(bin_d):
        np.testing.assert_allclose(look(flakes(), bin_h, bin_d), [LUT[bin_d] + bin_h + 1, 1, 0], rtol=1e-12)
    else:  # half way between bins 0 and 1 of theta_d
        expected = 0.5 * (LUT[0] + LUT[1]) + bin_h + 1
        np.testing.assert_allclose(look(flakes(), bin_h, bin_d), [expected, 1, 0], rtol=1e-12)


def test_between_bins_the_four_slices_are_mixed():
    value = look(flakes(), 2.25, 3.75)
    expected = 0.25 * (LUT[3]) + 0.75 * LUT[4] + 2.25 + 1
    np.testing.assert_allclose(value, [expected, 1, 0], rtol=1e-12)


def test_past_the_limit_of_a_bin_nothing_contributes():
    # Bin 1 has the slices 7..13, seven of them.
    np.testing.assert_array_equal(flakes().lookup(jnp.asarray(6.6 * BIN), jnp.asarray(0.5 * BIN)), 0)
    np.testing.assert_allclose(look(flakes(), 6.5, 1), [7.0, 0.5, 0], rtol=1e-12)  # half of slice 13, half of nothing
    rounding = 1e-12  # of the bin's position
    np.testing.assert_allclose(look(flakes(), 1, 11), 0, atol=rounding)  # lut[12] is 0: entry 11 starts no bin
    np.testing.assert_allclose(look(flakes(), 1, 12), 0, atol=rounding)
    np.testing.assert_allclose(look(flakes(max_theta_i=3), 1, 3), 0, atol=rounding)


def test_equal_bounds_are_no_flakes():
    f = flakes(lut=(5,) * 20)
    for h in np.linspace(0, 12, 7):
        for d in np.linspace(0, 12, 7):
            np.testing.assert_array_equal(look(f, h, d), 0)


def test_virtual_bins_are_bounded_by_their_own_next_entry():
    """Six stored bins of theta_d serve twelve; the limit is the *own* bin's, not the next virtual bin's."""
    lut = (0, 2, 4, 6, 8, 10, 12, 0)
    f = flakes(stack(12), lut, num_theta_i=6, max_theta_i=6)
    for bin_d in range(2, 11):
        own = bin_d * 6 // 12
        np.testing.assert_allclose(look(f, 1, bin_d), [lut[own] + 2, 1, 0], rtol=1e-12)
        np.testing.assert_allclose(look(f, 2, bin_d), 0, atol=1e-12)


def test_virtual_bins_shift_the_uv_and_exchange_it_when_odd():
    size = 16
    values = np.random.default_rng(2).normal(size=(12, size, size, 3))
    offsets = np.random.default_rng(3).random((20, 2))
    uv = np.asarray([0.3, 0.8])
    f = flakes(
        texture_map([values]), (0, 2, 4, 6, 8, 10, 12), num_theta_i=6, max_theta_i=6, uv=uv, virtual_offsets=offsets
    )
    for bin_d in (4, 5):
        at = (uv if bin_d % 2 == 0 else uv[::-1]) + offsets[bin_d]
        expected = f.slices.fetch(jnp.asarray(at), None, jnp.asarray(4 + 1, jnp.int32))
        np.testing.assert_allclose(look(f, 1, bin_d), expected, rtol=1e-9)


def test_angles_stop_at_one_radian_on_request():
    free, clamped = flakes(), flakes(clamp_angles=True)
    above = (jnp.asarray(0.2), jnp.asarray(1.3))
    np.testing.assert_array_equal(clamped.lookup(*above), free.lookup(above[0], jnp.asarray(1.0)))
    below = (jnp.asarray(0.2), jnp.asarray(0.9))
    np.testing.assert_array_equal(clamped.lookup(*below), free.lookup(*below))


def test_flakes_are_added_to_the_paint_and_not_colored_by_its_table():
    paint = CarPaint(0.3, (1.0,), (0.1,), (0.2,))
    wi, wo = jnp.asarray([0.0, 0, 1]), jnp.asarray([0.0, 0.6, 0.8])
    theta = 0.5 * np.arccos(0.8)
    added = CarPaint(0.3, (1.0,), (0.1,), (0.2,), flakes=flakes()).evaluate(wi, wo) - paint.evaluate(wi, wo)
    np.testing.assert_allclose(added, flakes().lookup(jnp.asarray(theta), jnp.asarray(theta)), rtol=1e-12)
    none = CarPaint(0.3, (1.0,), (0.1,), (0.2,), flakes=flakes(stack(scale=0.0)))
    np.testing.assert_array_equal(none.evaluate(wi, wo), paint.evaluate(wi, wo))


def test_under_a_refracting_coat_the_angles_are_those_inside():
    paint = ClearCoat(CarPaint(0.0, (0.0,), (0.0,), (1.0,), flakes=flakes()), 1.5)
    cosine = 0.8
    wi, wo = jnp.asarray([0.6, 0, cosine]), jnp.asarray([-0.6, 0, cosine])
    inside = np.arcsin(0.6 / 1.5)
    loss = (1 - paint.reflectance(jnp.asarray(cosine))) ** 2
    expected = loss * flakes().lookup(jnp.asarray(0.0), jnp.asarray(inside))
    np.testing.assert_allclose(paint.evaluate(wi, wo), expected, rtol=1e-12)


def test_tables_that_leave_the_stack_are_refused():
    with pytest.raises(ValueError, match=r"0\.\.62"):
        flakes(lut=(0, 63, 0), max_theta_i=3)
    with pytest.raises(ValueError, match="at most the table's length"):
        flakes(max_theta_i=65)
