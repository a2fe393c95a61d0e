import jax.numpy as jnp
import numpy as np
import pytest

from axffit.errors import InputError
from axffit.fitting import CarPaintModel, Coat, LambertModel, SingleLobeModel, parse_model
from axffit.fitting.models import Shapes
from axffit.fitting.names import MODEL_NAMES

from .paints import GRID

WI, WO = jnp.asarray(GRID.wi[::17]), jnp.asarray(GRID.wo[::17])
ROUGHNESS, F0 = jnp.array([0.2]), jnp.array(0.3)
COLORS = jnp.array([[0.1, 0.2, 0.3], [0.5, 0.4, 0.6]])

PROBLEMS = {
    "lambert": (LambertModel(), Shapes(), COLORS[:1]),
    "lambert under a coat": (LambertModel(coat=Coat()), Shapes(), COLORS[:1]),
    "ward": (SingleLobeModel(lobe="ward"), Shapes(ROUGHNESS, F0), COLORS),
    "cook-torrance, exact Fresnel": (
        SingleLobeModel(lobe="cook-torrance", fresnel="exact"),
        Shapes(ROUGHNESS, F0),
        COLORS,
    ),
    "ggx without Fresnel": (SingleLobeModel(lobe="ggx", fresnel="none"), Shapes(ROUGHNESS), COLORS),
    "ggx under a coat": (SingleLobeModel(lobe="ggx", coat=Coat(1.4)), Shapes(ROUGHNESS, F0), COLORS),
    "car paint": (
        CarPaintModel(lobes=2),
        Shapes(jnp.array([0.1, 0.4])),
        jnp.array([[0.1], [0.02], [0.05], [0.03], [0.0]]),
    ),
    "car paint under a coat that does not refract": (
        CarPaintModel(lobes=1, coat=Coat(1.6, refracting=False)),
        Shapes(jnp.array([0.1])),
        jnp.array([[0.1], [0.02], [0.05]]),
    ),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_basis_times_weights_is_the_assembled_brdf(name):
    model, shapes, weights = PROBLEMS[name]
    product = model.basis(shapes, WI, WO) @ weights
    values = model.assemble(shapes, weights).evaluate(WI, WO)
    np.testing.assert_allclose(jnp.broadcast_to(product, values.shape), values, rtol=1e-12)


# The scan basis of car paint is its basis, and the scan only approximates the exact Fresnel.
SCANNED = ("ward", "ggx without Fresnel", "ggx under a coat")


@pytest.mark.parametrize("name", SCANNED)
def test_the_scan_basis_spans_the_lobe_whatever_its_f0(name):
    model, shapes, _ = PROBLEMS[name]
    p, q = np.asarray(model.scan_basis(shapes.roughness[0], WI, WO)).T
    lobe = np.asarray(model.basis(shapes, WI, WO))[:, 1]
    f0 = 1.0 if shapes.f0 is None else float(shapes.f0)
    np.testing.assert_allclose(f0 * p + (1 - f0) * q, lobe, rtol=1e-10)


def test_f0_of_a_car_paint_lobe_is_the_ratio_of_its_weights():
    diffuse, coefficients, f0 = CarPaintModel(lobes=2).split(jnp.array([[0.1], [0.03], [0.01], [0.0], [0.0]]))
    assert float(diffuse) == 0.1
    np.testing.assert_allclose(coefficients, [0.04, 0.0])
    np.testing.assert_allclose(f0, [0.75, 1.0])


@pytest.mark.parametrize("name", MODEL_NAMES)
def test_every_name_is_parsed_with_and_without_a_coat(name):
    assert parse_model(name).name == name
    assert parse_model(name).coat is None
    coated = parse_model(name.upper() + "+coat ", ior=1.4)
    assert coated.name == f"{name}+coat"
    assert coated.coat is not None
    assert coated.coat.ior == 1.4


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "phongg"}, "unknown model 'phongg': choose one of lambert, ward"),
        ({"name": "ggx+paint"}, "unknown model"),
        ({"name": "carpaint", "lobes": 5}, "1 to 4"),
        ({"name": "ggx+coat", "ior": 0.5}, "index of refraction 0.5"),
    ],
)
def test_unknown_names_and_counts_are_refused_with_the_choices(arguments, message):
    with pytest.raises(InputError, match=message):
        parse_model(**arguments)
