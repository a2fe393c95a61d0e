"""The laws that every reflectance obeys, as functions ``law(brdf, wi, wo)``.

A law takes one BRDF and unit directions (..., 3) that broadcast against each other, computes in their floating type
(float64 wants JAX's 64-bit mode, ``jax.enable_x64``), and raises ``AssertionError`` when it is broken. The message says
at which pair of directions it is broken most, by how much, and for how many pairs. :data:`LAWS` names them all,
:func:`laws_of` those that hold for a given BRDF, :func:`exemption` says why one does not.
"""

from collections.abc import Callable, Mapping

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit._types import Channels
from axffit.brdf import AbstractBRDF
from axffit.frames import rotate_tangent
from axffit.testing.batches import Rays, evaluate, in_batches, pairs
from axffit.testing.draws import sampling
from axffit.testing.energy import passivity
from axffit.testing.failures import demand, vector
from axffit.testing.structure import anisotropy

Law = Callable[[AbstractBRDF, Rays, Rays], None]

LARGEST_DIFFERENTIATED = 20_000
"""Entries of a parameter above which :func:`finite` leaves its gradient out: the texels of large tables, in which a
model is linear with weights in [0, 1]."""

_DIFFERENTIATED_AT_ONCE = 64
"""Pairs whose gradients are held at once."""


def reciprocity(brdf: AbstractBRDF, wi: Rays, wo: Rays, *, rtol: float | None = None) -> None:
    """Helmholtz: f(wi, wo) = f(wo, wi), to ``rtol`` (default 1e-12, in float32 1e-5) of the value.

    Both cosines should be 0.05 or more: nearer the horizon a value may hold fewer digits than that.
    """
    wi, wo = pairs(wi, wo)
    there, back = evaluate(brdf, wi, wo), evaluate(brdf, wo, wi)
    rtol = (1e-12 if there.dtype == np.float64 else 1e-5) if rtol is None else rtol
    _demand_close("reciprocity", there, back, rtol * np.abs(back), wi, wo, "f(wi, wo)", "f(wo, wi)")


def non_negativity(brdf: AbstractBRDF, wi: Rays, wo: Rays) -> None:
    """f >= 0 in every channel."""
    wi, wo = pairs(wi, wo)
    values = evaluate(brdf, wi, wo)
    demand("non-negativity", -values, 0.0, lambda k: f"f = {vector(values[k])} 1/sr is negative", wi, wo)


def horizon(brdf: AbstractBRDF, wi: Rays, wo: Rays) -> None:
    """f = 0 below the horizon: for the mirror images of the given directions and for those given that lie there."""
    wi, wo = pairs(wi, wo)
    down = np.asarray([1, 1, -1], wi.dtype)
    lights, viewers = np.concatenate([wi, wi * down, wi, wi * down]), np.concatenate([wo, wo, wo * down, wo * down])
    hidden = (lights[:, 2] <= 0) | (viewers[:, 2] <= 0)
    lights, viewers = lights[hidden], viewers[hidden]
    values = evaluate(brdf, lights, viewers)
    demand("horizon", np.abs(values), 0.0, lambda k: f"f = {vector(values[k])} 1/sr below it", lights, viewers)


def finite(brdf: AbstractBRDF, wi: Rays, wo: Rays) -> None:
    """Values and gradients, in every parameter and both directions, are finite; below the horizon they are 0.

    Holds for every input. The BRDF is brought to the directions' floating type first.
    """
    wi, wo = pairs(wi, wo)
    model = brdf.astype(jnp.dtype(wi.dtype))
    values, is_finite, is_zero = in_batches(_differentiated, model, wi, wo, batch=_DIFFERENTIATED_AT_ONCE)
    wrong = (~np.isfinite(values)).any(axis=1)
    demand("finite", wrong, 0.0, lambda k: f"f = {vector(values[k])}", wi, wo)
    hidden = (wi[:, 2] <= 0) | (wo[:, 2] <= 0)
    for name, good, zero in zip(_names(brdf), is_finite, is_zero, strict=True):
        demand("finite", ~good, 0.0, lambda k, name=name: f"the gradient in {name} is not", wi, wo)
        wrong = hidden & ~zero
        demand("finite", wrong, 0.0, lambda k, name=name: f"the gradient in {name} is not 0 below the horizon", wi, wo)


def isotropy(brdf: AbstractBRDF, wi: Rays, wo: Rays, *, turn: float = 1.234, rtol: float | None = None) -> None:
    """A common turn of both directions about the normal, by ``turn`` radians, changes nothing.

    Turning rounds the directions. By default that is allowed to change the value by what its slope in them says: by
    64 units in the last place of every component and of the value; with ``rtol`` by that share of the value.
    """
    wi, wo = pairs(wi, wo)
    turned = [np.asarray(rotate_tangent(jnp.asarray(v), jnp.asarray(turn, v.dtype))) for v in (wi, wo)]
    before, after = evaluate(brdf, wi, wo), evaluate(brdf, *turned)
    if rtol is None:
        epsilon = np.finfo(before.dtype).eps
        allowed = 64 * epsilon * (np.abs(before) + _sensitivity(brdf, wi, wo))
    else:
        allowed = rtol * np.abs(before)
    _demand_close("isotropy", after, before, allowed, wi, wo, "after the turn f", "before it", floor=1e-250)


LAWS: Mapping[str, Law] = {
    "reciprocity": reciprocity,
    "non-negativity": non_negativity,
    "horizon": horizon,
    "finite": finite,
    "isotropy": isotropy,
    "passivity": passivity,
    "sampling": sampling,
}
"""Every law by name."""


def exemption(name: str, brdf: AbstractBRDF) -> str | None:
    """Why the law ``name`` of :data:`LAWS` does not apply to ``brdf``; None when it does."""
    if name not in LAWS:
        raise ValueError(f"unknown law {name!r}; there are: {', '.join(LAWS)}")
    return anisotropy(brdf) if name == "isotropy" else None


def laws_of(brdf: AbstractBRDF) -> dict[str, Law]:
    """Those of :data:`LAWS` that hold for ``brdf``."""
    return {name: law for name, law in LAWS.items() if exemption(name, brdf) is None}


def _demand_close(law, found, expected, allowed, wi, wo, left: str, right: str, *, floor: float = 1e-300) -> None:
    with np.errstate(invalid="ignore"):
        difference = np.abs(found - expected)

    def explain(k: int) -> str:
        channel = int(np.argmax(np.nan_to_num(difference[k] - allowed[k], nan=np.inf)))
        size = np.abs(expected[k, channel])
        relative = difference[k, channel] / size if size > 0 else np.inf
        return (
            f"{left} = {found[k, channel]:.17g} but {right} = {expected[k, channel]:.17g} in channel {channel}, "
            f"a relative difference of {relative:.3g} where {(allowed[k, channel] + floor) / max(size, floor):.3g} "
            "is allowed"
        )

    demand(law, difference, allowed + floor, explain, wi, wo)


def _partition(brdf: AbstractBRDF) -> tuple[AbstractBRDF, AbstractBRDF]:
    """What :func:`finite` differentiates, and the rest."""
    return eqx.partition(brdf, lambda leaf: eqx.is_inexact_array(leaf) and leaf.size <= LARGEST_DIFFERENTIATED)


def _names(brdf: AbstractBRDF) -> list[str]:
    leaves, _ = jax.tree_util.tree_flatten_with_path(_partition(brdf)[0])
    return [jax.tree_util.keystr(path).lstrip(".") for path, _ in leaves] + ["wi", "wo"]


@eqx.filter_jit
def _differentiated(brdf: AbstractBRDF, wi: Rays, wo: Rays) -> tuple[Channels, list[jax.Array], list[jax.Array]]:
    """Values, and for each gradient of each pair whether all of it is finite, and whether all of it is 0."""
    parameters, rest = _partition(brdf)

    def total(parameters, i, o):
        value = eqx.combine(parameters, rest).masked_value(i, o)
        return jnp.sum(value), value

    def pair(i, o):
        gradients, value = jax.grad(total, argnums=(0, 1, 2), has_aux=True)(parameters, i, o)
        leaves = jax.tree.leaves(gradients)
        return value, [jnp.isfinite(leaf).all() for leaf in leaves], [(leaf == 0).all() for leaf in leaves]

    return jax.vmap(pair)(wi, wo)


def _sensitivity(brdf: AbstractBRDF, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """Sum over the components of both directions of the absolute slopes of each channel, by differences, (n, 3)."""
    step = float(np.finfo(wi.dtype).eps) ** 0.375
    total = 0.0
    for shift in step * np.eye(3, dtype=wi.dtype):
        for i, o in ((shift, 0 * shift), (0 * shift, shift)):
            total += np.abs(evaluate(brdf, wi + i, wo + o) - evaluate(brdf, wi - i, wo - o)) / (2 * step)
    return np.asarray(total)
