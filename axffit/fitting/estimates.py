"""From a covariance to named parameters with an honest status each."""

from typing import Any, NamedTuple

import numpy as np

from axffit.fitting.models import ROUGHNESS_BOUNDS, AbstractFitModel, CarPaintModel, Shapes
from axffit.fitting.parameters import ParameterEstimate, Status
from axffit.fitting.separable import SeparableProblem, Weights
from axffit.fitting.uncertainty import Covariance, parameter_covariance

_WIDEST_F0 = 0.5
_WIDEST_LOG_ROUGHNESS = 1.0
_CHANNELS = ("R", "G", "B")


def channel_name(name: str, channel: int, count: int) -> str:
    """``name`` with R, G or B, or with a number, where there are several channels."""
    return name if count == 1 else f"{name} {_CHANNELS[channel] if count == 3 else channel}"


class Estimates(NamedTuple):
    """Parameters and how their estimates scatter together.

    ``correlations`` (P, P) of the estimates, NaN where one of a pair has no standard error; ``inflation`` (P,) their
    variance over that of (J^T J)^-1, 1 where the noise is known, NaN without a standard error.
    """

    parameters: tuple[ParameterEstimate, ...]
    correlations: np.ndarray
    inflation: np.ndarray

    def fields(self) -> dict[str, Any]:
        """The fields of :class:`axffit.fitting.FitResult` that they fill."""
        return {"parameters": self.parameters, "correlations": self.correlations}


class LinearEstimator:
    """Makes estimates from one covariance; ``conditional`` turns identified parameters into conditional ones."""

    def __init__(self, covariance: Covariance, *, conditional: bool):
        """No estimate yet."""
        self.covariance = covariance
        self.conditional = conditional
        self.found: list[ParameterEstimate] = []
        self.gradients: list[np.ndarray] = []

    def unit(self, index: int) -> np.ndarray:
        """Gradient (P,) of the parameter ``index`` of the covariance."""
        return np.eye(len(self.covariance.free))[index]

    def estimate(
        self,
        name: str,
        value: float,
        gradient: np.ndarray,
        *,
        high: float = np.inf,
        low: float = 0.0,
        at_bound: bool = False,
        undetermined: bool = False,
    ) -> None:
        """Add an estimate that is linear in the covariance's parameters, ``gradient`` (P,)."""
        touched = gradient != 0
        lost = not np.all(self.covariance.determined[touched & self.covariance.free])
        status: Status = "conditional" if self.conditional else "identified"
        if undetermined or lost:
            status = "not identified"
        if at_bound and not undetermined:
            status = "at bound"
        known = status in ("identified", "conditional")
        error = self.covariance.error(gradient) if known else None
        self.found.append(ParameterEstimate(name, float(value), error, status, low, high))
        self.gradients.append(gradient if known else np.full_like(gradient, np.nan))

    def split_undetermined(self, p: float, q: float, in_p: np.ndarray, in_q: np.ndarray) -> bool:
        """Whether F0 = p / (p + q) ranges over more than half of [0, 1] within the 99.9 % intervals of p and q.

        The ratio is too far from linear for its own standard error to say so.
        """
        dp, dq = 3.29 * self.covariance.error(in_p), 3.29 * self.covariance.error(in_q)
        least, most = max(p - dp, 0.0), p + dp
        lowest = least / (least + q + dq) if least > 0 else 0.0
        highest = most / (most + max(q - dq, 0.0)) if most > 0 else 0.0
        return highest - lowest > _WIDEST_F0

    def roughness(self, name: str, value: float, index: int, *, active: bool) -> None:
        """Add the roughness that is the parameter ``index``; not ``active``: its lobe has no weight."""
        low, high = ROUGHNESS_BOUNDS
        gradient = self.unit(index)
        wide = self.covariance.error(gradient) > _WIDEST_LOG_ROUGHNESS * value
        on_bound = active and (value < low * 1.001 or value > high * 0.999)
        self.estimate(name, value, gradient, low=low, high=high, at_bound=on_bound, undetermined=not active or wide)

    def estimates(self) -> Estimates:
        """All that were added."""
        gradients = np.stack(self.gradients)
        joint = gradients @ self.covariance.matrix @ gradients.T
        errors = np.sqrt(np.diagonal(joint))
        plain = np.einsum("pi,ij,pj->p", gradients, self.covariance.plain, gradients)
        with np.errstate(invalid="ignore", divide="ignore"):
            correlations = np.clip(joint / np.outer(errors, errors), -1.0, 1.0)
            return Estimates(tuple(self.found), correlations, errors**2 / plain)


def estimates(
    problem: SeparableProblem, shapes: Shapes, weights: Weights, *, color: np.ndarray | None = None
) -> Estimates:
    """The parameters of the fitted model of ``problem`` with their standard errors and correlations.

    With ``color`` (n, channels) they are those of the brightness of a car paint for this color of each sample, and
    every interval is called conditional.
    """
    model = problem.model
    if isinstance(model, CarPaintModel):
        return _car_paint(problem, model, shapes, weights, color)
    return _colored(problem, model, shapes, weights)


def _car_paint(
    problem: SeparableProblem,
    model: CarPaintModel,
    shapes: Shapes,
    weights: Weights,
    color: np.ndarray | None,
) -> Estimates:
    """A diffuse term, then s_k, F0_k, alpha_k and s_k F0_k of each lobe."""
    spreads, values = np.asarray(shapes.roughness), np.asarray(weights)[:, 0]
    count = model.lobes
    p, q = values[1::2], values[2::2]
    low, high = ROUGHNESS_BOUNDS
    on = p + q > 0
    free_spreads = on & (spreads > low * 1.001) & (spreads < high * 0.999)
    # Both weights of a lobe take part even where one ended at 0: only so does its F0 show how little is known of it.
    free = np.concatenate([free_spreads, [True], np.repeat(on, 2)])
    covariance = parameter_covariance(problem, shapes, weights, free, color=color)
    make = LinearEstimator(covariance, conditional=color is not None)
    # Below a refracting coat (1 - <h,o>)⁵ stays under 0.00107 and depends on theta_d alone: a free table takes up
    # almost all that could tell F0 from the coefficient.
    absorbed = color is not None and model.coat is not None and model.coat.refracting
    diffuse = float(values[0])
    make.estimate("diffuse", diffuse, make.unit(count), at_bound=diffuse == 0)
    p, q, spreads = p.tolist(), q.tolist(), spreads.tolist()
    for k in range(count):
        s, lit = p[k] + q[k], bool(on[k])
        in_p, in_q = make.unit(count + 1 + 2 * k), make.unit(count + 2 + 2 * k)
        in_f0 = (q[k] * in_p - p[k] * in_q) / s**2 if lit else 0.0 * in_p
        vague = lit and (absorbed or make.split_undetermined(p[k], q[k], in_p, in_q))
        f0_on_edge = lit and (p[k] == 0 or q[k] == 0)
        f0, unknown = p[k] / s if lit else 1.0, vague or not lit
        make.estimate(f"coefficient {k + 1}", s, in_p + in_q, at_bound=not lit, undetermined=vague)
        make.estimate(f"f0 {k + 1}", f0, in_f0, high=1.0, at_bound=f0_on_edge, undetermined=unknown)
        make.roughness(f"spread {k + 1}", spreads[k], k, active=lit)
        make.estimate(f"coefficient x f0 {k + 1}", p[k], in_p, at_bound=p[k] == 0)
    return make.estimates()


def _colored(problem: SeparableProblem, model: AbstractFitModel, shapes: Shapes, weights: Weights) -> Estimates:
    """Diffuse and specular colors, roughness, F0, and the product of color and F0 where F0 is fitted."""
    values = np.asarray(weights)
    m, channels = values.shape
    terms = values.tolist()
    low, high = ROUGHNESS_BOUNDS
    lobe = model.lobe_count > 0
    on = lobe and bool(np.any(values[1] > 0))
    roughness = float(np.asarray(shapes.roughness)[0]) if lobe else 1.0
    f0 = None if shapes.f0 is None else float(shapes.f0)
    f0_on_edge = f0 is not None and (f0 == 0.0 or f0 == 1.0)
    free_shapes = [on and low * 1.001 < roughness < high * 0.999] if lobe else []
    if f0 is not None:
        free_shapes.append(on)
    # A term takes part in every channel of which any has it: as for car paint, zeros may be off 0 in truth.
    free_terms = np.any(values > 0, axis=1)
    free_terms[0] = True
    free = np.concatenate([np.array(free_shapes, bool), np.tile(free_terms, channels)])
    make = LinearEstimator(parameter_covariance(problem, shapes, weights, free), conditional=False)
    first = len(free_shapes)
    in_f0 = make.unit(1) if f0 is not None else np.zeros(len(make.covariance.free))
    vague = False
    if f0 is not None and on:
        brightest = int(np.argmax(values[1]))
        s, in_s = terms[1][brightest], make.unit(first + brightest * m + 1)
        in_p, in_q = f0 * in_s + s * in_f0, (1.0 - f0) * in_s - s * in_f0
        vague = make.split_undetermined(s * f0, s * (1.0 - f0), in_p, in_q)
    for c in range(channels):
        diffuse = terms[0][c]
        name = channel_name("diffuse", c, channels)
        make.estimate(name, diffuse, make.unit(first + c * m), at_bound=diffuse == 0)
    for c in range(channels if lobe else 0):
        s, in_s = terms[1][c], make.unit(first + c * m + 1)
        name = channel_name("specular", c, channels)
        make.estimate(name, s, in_s, at_bound=s == 0, undetermined=vague)
    if lobe:
        make.roughness("roughness", roughness, 0, active=on)
    if f0 is not None:
        make.estimate("f0", f0, in_f0, high=1.0, at_bound=on and f0_on_edge, undetermined=vague or not on)
        for c in range(channels):
            s, in_s = terms[1][c], make.unit(first + c * m + 1)
            name = channel_name("specular x f0", c, channels)
            product = s * f0
            make.estimate(name, product, f0 * in_s + s * in_f0, at_bound=product == 0)
    return make.estimates()
