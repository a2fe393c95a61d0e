"""Profile likelihood: how much worse the best fit becomes when one parameter is held elsewhere.

For each value v of the parameter all others are fitted again: C(v) = min over the others of half the sum of squares.
The 95 % interval holds the v with

    2 (C(v) - C(best)) <= 3.841 a

with a = 1 in the noise-weighted metric (Wilks' theorem), and elsewhere the ratio of the sandwich's variance of the
parameter to that of (J^T J)^-1: the adjustment of a composite likelihood (Varin, Reid & Firth, Statistica Sinica 21(1),
2011). Unlike a standard error it needs no straight valley: a side on which the fit does not become worse is open, and
is said to be so.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import lineax as lx
import numpy as np
import optimistix as optx
from jaxtyping import Array, Float

from axffit.fitting.estimates import Estimates
from axffit.fitting.models import ROUGHNESS_BOUNDS, AbstractFitModel, CarPaintModel, Shapes
from axffit.fitting.separable import SeparableProblem, Weights

LEVEL = 3.841458820694124
"""0.95 quantile of chi square with one degree of freedom."""

_POINTS_A_SIDE = 12
_CLOSE = 0.005
_SMALL = 1e-12


class Profile(NamedTuple):
    """The profile of one parameter.

    Attributes:
        name: of the parameter.
        values: (n,) where it was held, ascending; the estimate is one of them.
        excess: (n,) 2 (C(v) - C(best)) / a; 3.84 at the ends of the 95 % interval.
        low: lower end, or None: down to the parameter's legal bound the fit does not become noticeably worse.
        high: upper end, or None.
        lower_cost_found: whether a fit with the parameter held elsewhere was better than the fit: its minimum is not
            the lowest.
    """

    name: str
    values: np.ndarray
    excess: np.ndarray
    low: float | None
    high: float | None
    lower_cost_found: bool

    def to_json(self) -> dict[str, Any]:
        """The fields by name."""
        return self._asdict() | {"values": self.values.tolist(), "excess": self.excess.tolist()}


class _Physical(NamedTuple):
    """The parameters of a model by the names of the estimates, free of order: one array each."""

    diffuse: Array
    color: Array
    roughness: Array | None
    f0: Array | None


def _split(model: AbstractFitModel, shapes: Shapes, weights: Weights) -> _Physical:
    if isinstance(model, CarPaintModel):
        diffuse, coefficients, f0 = model.split(weights)
        return _Physical(diffuse[None], coefficients, shapes.roughness, f0)
    f0 = None if shapes.f0 is None else shapes.f0[None]
    return _Physical(weights[0], weights[1:].ravel(), shapes.roughness, f0)


def _joined(model: AbstractFitModel, at: _Physical) -> tuple[Shapes, Weights]:
    if isinstance(model, CarPaintModel) and at.f0 is not None:
        pairs = jnp.stack([at.color * at.f0, at.color * (1.0 - at.f0)], axis=1).ravel()
        return Shapes(at.roughness), jnp.concatenate([at.diffuse, pairs])[:, None]
    f0 = None if at.f0 is None else at.f0[0]
    return Shapes(at.roughness, f0), jnp.concatenate([at.diffuse, at.color]).reshape(-1, len(at.diffuse))


def _names(model: AbstractFitModel, at: _Physical) -> dict[str, tuple[str, int]]:
    """Name of a parameter -> (field, index) of `_Physical`."""
    if isinstance(model, CarPaintModel):
        fields = {"coefficient": "color", "f0": "f0", "spread": "roughness"}
        lobes = {f"{name} {k + 1}": (field, k) for k in range(model.lobes) for name, field in fields.items()}
        return {"diffuse": ("diffuse", 0)} | lobes
    channels = len(at.diffuse)
    suffixes = [""] if channels == 1 else [f" {'RGB'[c] if channels == 3 else c}" for c in range(channels)]
    names = {f"diffuse{end}": ("diffuse", c) for c, end in enumerate(suffixes)}
    if at.roughness is not None:
        names |= {f"specular{end}": ("color", c) for c, end in enumerate(suffixes)} | {"roughness": ("roughness", 0)}
    return names if at.f0 is None else names | {"f0": ("f0", 0)}


def names_of(model: AbstractFitModel, shapes: Shapes, weights: Weights) -> tuple[str, ...]:
    """Names of the parameters that can be profiled."""
    return tuple(_names(model, _split(model, shapes, weights)))


def _range_of(field: str) -> tuple[float, float]:
    if field == "roughness":
        return ROUGHNESS_BOUNDS
    return (0.0, 1.0) if field == "f0" else (0.0, math.inf)


def _raw(at: _Physical) -> _Physical:
    """Weights as u², F0 as sin² u, roughness as its logarithm: every bound of a weight and of F0 can be reached."""
    # At u = 0 the derivative is 0 and a parameter could not leave: it starts a little beside.
    size = _SMALL + 1e-6 * jnp.max(jnp.concatenate([at.diffuse, at.color]))
    root = [jnp.sqrt(jnp.maximum(x, size)) for x in (at.diffuse, at.color)]
    f0 = None if at.f0 is None else jnp.arcsin(jnp.sqrt(jnp.clip(at.f0, 1e-6, 1.0 - 1e-6)))
    return _Physical(root[0], root[1], None if at.roughness is None else jnp.log(at.roughness), f0)


def _forward(raw: _Physical) -> _Physical:
    f0 = None if raw.f0 is None else jnp.sin(raw.f0) ** 2
    roughness = None if raw.roughness is None else jnp.clip(jnp.exp(raw.roughness), *ROUGHNESS_BOUNDS)
    return _Physical(raw.diffuse**2, raw.color**2, roughness, f0)


@eqx.filter_jit
def _held(
    problem: SeparableProblem, raw: _Physical, field: str, index: int, value: Float[Array, ""], max_steps: int
) -> tuple[Float[Array, ""], _Physical]:
    """Cost of the best fit with one parameter at ``value``, and its raw parameters; starts from ``raw``."""

    def placed(raw: _Physical) -> _Physical:
        at = _forward(raw)
        return at._replace(**{field: getattr(at, field).at[index].set(value)})

    def residuals(raw: _Physical, _: None) -> Array:
        shapes, weights = _joined(problem.model, placed(raw))
        return problem.residuals(problem.design(shapes), weights)

    solver = optx.LevenbergMarquardt(1e-9, 1e-9, linear_solver=lx.QR())
    found = optx.least_squares(residuals, solver, raw, options={"jac": "fwd"}, max_steps=max_steps, throw=False).value
    return 0.5 * jnp.sum(residuals(found, None) ** 2), found


def profile(
    problem: SeparableProblem,
    shapes: Shapes,
    weights: Weights,
    found: Estimates,
    name: str,
    *,
    max_steps: int = 60,
) -> Profile:
    """The profile of the parameter ``name`` of a fit.

    Args:
        problem: what was fitted.
        shapes: the solution's shapes.
        weights: the solution's weights.
        found: the estimates of the solution.
        name: one of :func:`names_of`.
        max_steps: of the solver at each value.
    """
    at = _split(problem.model, shapes, weights)
    field, index = _names(problem.model, at)[name]
    bounds = _range_of(field)
    place = next(k for k, one in enumerate(found.parameters) if one.name == name)
    estimate, scale = found.parameters[place], float(found.inflation[place])
    if not math.isfinite(scale):
        # Without a standard error of its own the parameter takes the most cautious of the others'.
        scale = float(np.nanmax(found.inflation, initial=1.0))
    best = 0.5 * float(jnp.sum(problem.residuals(problem.design(shapes), weights) ** 2))
    curve = {estimate.value: 0.0}

    raw = _raw(at)

    def evaluate(value: float, warm: _Physical | None) -> tuple[float, _Physical]:
        cost, ended = _held(problem, raw if warm is None else warm, field, index, jnp.asarray(value), max_steps)
        curve[value] = 2.0 * (float(cost) - best) / scale
        return curve[value], ended

    step = _first_step(estimate.value, estimate.standard_error, bounds)
    low, high = (_walk(evaluate, estimate.value, sign, step, bounds) for sign in (-1, 1))
    values = np.array(sorted(curve))
    excess = np.array([curve[value] for value in values.tolist()])
    return Profile(name, values, excess, low, high, bool(np.min(excess) < -0.01 * LEVEL))


Evaluate = Callable[[float, _Physical | None], tuple[float, _Physical]]


def _first_step(value: float, error: float | None, bounds: tuple[float, float]) -> float:
    if error is not None and error > 0:
        return 1.5 * error
    widest = bounds[1] - bounds[0] if math.isfinite(bounds[1]) and bounds[1] <= 1.0 else max(value, 1e-3)
    return 0.05 * widest


def _walk(evaluate: Evaluate, start: float, sign: int, step: float, bounds: tuple[float, float]) -> float | None:
    """Where the root of the excess crosses that of `LEVEL` on one side of ``start``; None if it does not."""
    target = math.sqrt(LEVEL)
    inside, root_inside, warm = start, 0.0, None
    limit = bounds[0] if sign < 0 else bounds[1]
    for _ in range(_POINTS_A_SIDE):
        value = inside + sign * step
        value = max(value, limit) if sign < 0 else min(value, limit)
        if value == inside:
            return None
        excess, ended = evaluate(value, warm)
        root = math.sqrt(max(excess, 0.0))
        if root >= target:
            return _cross(evaluate, (inside, root_inside), (value, root), ended, target)
        inside, root_inside, warm, step = value, root, ended, 2.0 * step
    return None


def _cross(
    evaluate: Evaluate, inside: tuple[float, float], beyond: tuple[float, float], warm: _Physical, target: float
) -> float:
    """Illinois' false position between a value inside of the interval and one beyond it."""
    (a, at_a), (b, at_b) = inside, beyond
    fa, fb = at_a - target, at_b - target
    value = b
    for _ in range(_POINTS_A_SIDE):
        value = (a * fb - b * fa) / (fb - fa)
        excess, warm = evaluate(value, warm)
        f = math.sqrt(max(excess, 0.0)) - target
        if abs(f) < _CLOSE:
            break
        if (f > 0) == (fb > 0):
            fa *= 0.5
        else:
            a, fa = b, fb
        b, fb = value, f
    return value
