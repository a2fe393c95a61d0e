import jax
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.fitting.bijections import Interval, LogInterval, forward_tree, start_tree

BIJECTIONS = {
    "unit interval": lambda: Interval(0.0, 1.0),
    "interval around 0": lambda: Interval(-3.0, 2.0),
    "roughness": lambda: LogInterval(1e-3, 10.0),
}


@pytest.fixture(params=BIJECTIONS, ids=str)
def bijection(request):
    return BIJECTIONS[request.param]()


def inside(bijection, count=41):
    return bijection.at(jnp.linspace(0.001, 0.999, count))


def test_inverse_undoes_forward(bijection):
    values = inside(bijection)
    np.testing.assert_allclose(bijection.forward(bijection.inverse(values)), values, rtol=1e-12, atol=1e-14)
    raw = jnp.linspace(-20.0, 20.0, 41)
    np.testing.assert_allclose(bijection.inverse(bijection.forward(raw)), raw, rtol=1e-6, atol=1e-6)


def test_every_raw_value_lands_inside_the_bounds(bijection):
    values = bijection.forward(jnp.array([-1e300, -50.0, 0.0, 50.0, 1e300]))
    assert np.all((values >= bijection.lower) & (values <= bijection.upper * (1 + 1e-12)))
    assert np.all(np.diff(values) >= 0)


def test_the_slope_is_positive_inside(bijection):
    slopes = jax.vmap(jax.grad(bijection.forward))(jnp.linspace(-8.0, 8.0, 17))
    assert np.all(slopes > 0)


def test_fraction_runs_from_bound_to_bound(bijection):
    ends = bijection.fraction(jnp.array([bijection.lower, bijection.upper]))
    np.testing.assert_allclose(ends, [0.0, 1.0], atol=1e-12)


def test_a_start_on_a_bound_is_moved_inside_and_one_beyond_is_refused(bijection):
    for bound in (bijection.lower, bijection.upper):
        raw = bijection.start(bound)
        assert np.isfinite(raw)
        assert bijection.lower < bijection.forward(raw) < bijection.upper
    with pytest.raises(ValueError, match="lies outside"):
        bijection.start(bijection.upper + 0.1)
    with pytest.raises(ValueError, match="lies outside"):
        bijection.start(np.nan)


def test_values_near_a_bound_are_recognized(bijection):
    values = bijection.at(jnp.array([1e-6, 0.5, 1.0 - 1e-6]))
    assert bijection.at_bound(values).tolist() == [True, False, True]


def test_trees_of_bijections_map_trees_of_values():
    bounds = {"a": Interval(0.0, 1.0), "b": LogInterval(0.1, 10.0)}
    values = {"a": jnp.array([0.2, 0.4]), "b": jnp.array(2.0)}
    back = forward_tree(bounds, start_tree(bounds, values))
    np.testing.assert_allclose(back["a"], values["a"])
    np.testing.assert_allclose(back["b"], values["b"])


@pytest.mark.parametrize("make", [lambda: Interval(1.0, 1.0), lambda: LogInterval(0.0, 1.0)])
def test_empty_ranges_are_refused(make):
    with pytest.raises(ValueError, match="lower"):
        make()
