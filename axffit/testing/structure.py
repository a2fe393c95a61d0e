"""What a BRDF's make-up says about the laws it obeys."""

from collections.abc import Iterator

import equinox as eqx
import jax
import numpy as np

from axffit.brdf import AbstractBRDF, ClearCoat, Framed, Sum

_PER_AXIS = ("roughness", "exponents")


def modules(brdf: AbstractBRDF) -> Iterator[eqx.Module]:
    """The BRDF and every module inside it."""
    found: list[eqx.Module] = []

    def visit(node) -> bool:
        if isinstance(node, eqx.Module):
            found.append(node)
        return False

    jax.tree.leaves(brdf, is_leaf=visit)
    yield from found


def anisotropy(brdf: AbstractBRDF) -> str | None:
    """Why the value may change when both directions turn about the normal; None for an isotropic BRDF."""
    match brdf:
        case Sum():
            return next(filter(None, map(anisotropy, brdf.terms)), None)
        case Framed() | ClearCoat():
            return tilt(brdf) or anisotropy(brdf.base)
    for name in _PER_AXIS:
        values = np.asarray(getattr(brdf, name, 0.0))
        if values.ndim and np.any(values != values[0]):
            return f"{type(brdf).__name__} has two different values of its {name}"
    return None


def tilt(brdf: AbstractBRDF) -> str | None:
    """Which normal inside ``brdf`` is not (0, 0, 1) in direction; None if all are."""
    for module in modules(brdf):
        if isinstance(module, Framed | ClearCoat) and np.any(np.asarray(module.normal)[:2] != 0):
            whose = "shading" if isinstance(module, Framed) else "coat's"
            return f"the {whose} normal is tilted"
    return None


def refraction(brdf: AbstractBRDF) -> ClearCoat | None:
    """The first coat inside ``brdf`` that refracts, or None."""
    coats = (module for module in modules(brdf) if isinstance(module, ClearCoat))
    return next((coat for coat in coats if coat.refracting and float(coat.ior) != 1.0), None)
