import jax.numpy as jnp
import numpy as np
import pytest

from axffit.errors import InputError
from axffit.fitting import Coat, LobesModel, Outcome, SingleLobeModel, fit, parse_f0, parse_model
from axffit.fitting.models import Shapes
from axffit.fitting.studies import Study

from .paints import GRID, sampled

WI, WO = jnp.asarray(GRID.wi), jnp.asarray(GRID.wo)
ROUGHNESS = jnp.array([0.4, 0.08])
KINDS = {"each": 5, "shared": 3, 0.2: 3}


def case(f0, coat=None):
    model = LobesModel(lobe="ggx", lobes=2, coat=coat, f0=f0)
    shapes = Shapes(ROUGHNESS, jnp.array(0.3) if f0 == "shared" else None)
    return model, shapes, jnp.asarray(np.random.default_rng(3).uniform(0.1, 0.4, (KINDS[f0], 3)))


@pytest.mark.parametrize("coat", [None, Coat(1.4)], ids=["bare", "coated"])
@pytest.mark.parametrize("f0", KINDS)
def test_the_basis_times_the_weights_is_the_model(f0, coat):
    model, shapes, weights = case(f0, coat)
    expected = model.assemble(shapes, weights).evaluate(WI, WO)
    np.testing.assert_allclose(model.basis(shapes, WI, WO) @ weights, expected, rtol=1e-10)


def test_one_lobe_with_a_shared_f0_is_the_single_lobe():
    shapes, weights = Shapes(jnp.array([0.3]), jnp.array(0.1)), jnp.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
    several, single = LobesModel(lobe="ward", lobes=1, f0="shared"), SingleLobeModel(lobe="ward")
    np.testing.assert_allclose(several.basis(shapes, WI, WO), single.basis(shapes, WI, WO), rtol=1e-12)
    assert several.name == single.name
    np.testing.assert_allclose(
        several.assemble(shapes, weights).evaluate(WI, WO), single.assemble(shapes, weights).evaluate(WI, WO)
    )


@pytest.mark.parametrize("f0", KINDS)
def test_lobes_are_ordered_by_roughness_and_those_without_weight_are_last(f0):
    model, shapes, weights = case(f0)
    ordered, values = model.ordered(shapes, weights)
    np.testing.assert_array_equal(ordered.roughness, [0.08, 0.4])
    before, after = model.assemble(shapes, weights), model.assemble(ordered, values)
    np.testing.assert_allclose(after.evaluate(WI, WO), before.evaluate(WI, WO), rtol=1e-12)
    size = 2 if f0 == "each" else 1
    unlit, _ = model.ordered(shapes, weights.at[1 + size :].set(0.0))
    np.testing.assert_array_equal(unlit.roughness, [0.4, 0.08])


def test_a_known_f0_stays_known_and_is_no_parameter():
    model, shapes, weights = case(0.2)
    result = fit(model, sampled(model.assemble(shapes, weights), noise=0.01))
    assert result.outcome is Outcome.CONVERGED
    names = [parameter.name for parameter in result.parameters]
    assert names[:5] == ["diffuse R", "diffuse G", "diffuse B", "roughness 1", "specular 1 R"]
    assert not any("f0" in name for name in names)
    for name, value in (("roughness 1", 0.08), ("roughness 2", 0.4), ("specular 2 G", float(weights[1, 1]))):
        found = result.parameter(name)
        assert found.standard_error is not None
        assert abs(found.value - value) < 4.5 * found.standard_error


@pytest.mark.slow
def test_each_lobe_and_channel_may_have_its_own_f0():
    model, shapes, weights = case("each")
    result = fit(model, sampled(model.assemble(shapes, weights), noise=0.002))
    p, q = float(weights[3, 2]), float(weights[4, 2])
    assert result.parameter("specular x f0 1 B").value == pytest.approx(p, rel=0.05)
    assert result.parameter("f0 1 B").value == pytest.approx(p / (p + q), abs=0.1)
    with pytest.raises(InputError, match="profiles"):
        fit(model, sampled(model.assemble(shapes, weights)), study=Study(bootstrap=20))


def test_names_and_numbers_of_the_command_line():
    assert parse_model("ggx", lobes=2) == LobesModel(lobe="ggx", lobes=2, f0="shared")
    assert parse_model("ggx", f0=0.04) == LobesModel(lobe="ggx", lobes=1, f0=0.04)
    assert parse_model("ward:duer2006") == SingleLobeModel(lobe="ward:Duer2006")
    assert parse_model("carpaint").lobe_count == 3
    assert (parse_f0("each"), parse_f0("0.04")) == ("each", 0.04)


@pytest.mark.parametrize(
    "make",
    [
        lambda: LobesModel(lobe="phongg"),
        lambda: LobesModel(lobe="ggx", lobes=5),
        lambda: LobesModel(lobe="ggx", f0=1.5),
        lambda: parse_model("ggx", lobes=0),
        lambda: parse_model("carpaint", f0=0.04),
        lambda: parse_f0("some"),
    ],
)
def test_unusable_choices_are_refused(make):
    with pytest.raises(InputError):
        make()
