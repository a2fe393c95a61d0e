"""What a model computes with: Fresnel and geometry are products and square roots, no powers and no angles.

A float costs a fused multiply-add 1, a root 4, an exponential 8, a cosine 35, a power 64, an arc tangent 170: what is
algebra must not be written with the latter.
"""

import jax
import jax.numpy as jnp
import pytest

from tests.brdf.models import MODELS

COSTLY = {"pow", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "erf", "log"}
ANGLES = {name for name in MODELS if "car paint" in name}
"""Color table and flakes are tables of theta_h and theta_d."""
TURNED = {"framed", "coated svbrdf texel"}
"""The angle of a rotation map."""
LOGARITHM = {name for name in MODELS if "phong" in name}
"""c^n of any n."""


def primitives(jaxpr) -> set[str]:
    found = set()
    for equation in jaxpr.eqns:
        found.add(equation.primitive.name)
        for parameter in equation.params.values():
            for inner in parameter if isinstance(parameter, (tuple, list)) else (parameter,):
                inner = getattr(inner, "jaxpr", inner)
                if hasattr(inner, "eqns"):
                    found |= primitives(inner)
    return found


@pytest.mark.parametrize("name", MODELS)
def test_no_costly_function_is_evaluated(name):
    up = jnp.asarray([0.0, 0.0, 1.0])
    used = primitives(jax.make_jaxpr(MODELS[name]().masked_value)(up, up).jaxpr) & COSTLY
    allowed: set[str] = set()
    if name in ANGLES:
        allowed |= {"atan2"}
    if name in TURNED:
        allowed |= {"sin", "cos"}
    if name in LOGARITHM:
        allowed |= {"log"}
    assert used <= allowed


def test_powers_and_angles_are_seen():
    """The search finds what it looks for, inside jitted and custom-differentiated functions too."""
    hidden = jax.jit(lambda x: jnp.where(x > 0, jnp.power(x, 0.3), jnp.arctan2(x, 2.0)))
    assert {"pow", "atan2"} <= primitives(jax.make_jaxpr(lambda x: hidden(x) + 1)(0.5).jaxpr)
