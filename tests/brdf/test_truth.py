"""Values and gradients of every model against their formulas at 50 digits.

A value may err by 32 eps (1 + kappa): eps is the spacing of the floats at 1 and kappa the condition number of the
formula in its inputs, sum |x df/dx| / |f| over all parameters and over the six components of the directions, each by
itself. The formula is evaluated for the directions divided by their length, so that kappa also has to cover how far a
float lies beside the unit sphere. The gradients in kappa are the model's own, in float64.

Only what axf-models section 1 calls right is compared: cosines above the limit of the type (1e-4, 1e-8), those with a
tilted normal or below a coat too, and true values in 1e-30..1e30 (float32) and 1e-290..1e290 (float64).
"""

from dataclasses import dataclass
from functools import cache

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

from tests.brdf import truth
from tests.brdf.truth_cases import CASES, COMPOSED, LOBES, Case, digits, directions, tangent_of_half, unit_rows

BATCH = 300
ALL = 34  # batches: 10 200 directions
FACTOR = 32.0
TYPES = (np.float64, np.float32)
LIMIT = {np.float64: 1e-8, np.float32: 1e-4}
RANGE = {np.float64: (1e-290, 1e290), np.float32: (1e-30, 1e30)}
OUTRIGHT = {np.float64: 1e-12, np.float32: 5e-6}
GRADIENT = 1e-9

every_model = pytest.mark.parametrize("name", CASES)
every_type = pytest.mark.parametrize("dtype", TYPES, ids=lambda t: t.__name__)


@dataclass(frozen=True)
class Inputs:
    """A batch of direction pairs with the parameters and the channel that go with each."""

    wi: np.ndarray
    wo: np.ndarray
    parameters: dict[str, np.ndarray]
    channel: np.ndarray

    def row(self, k: int) -> dict[str, mp.mpf | tuple[mp.mpf, ...]]:
        return {name: digits(values[k]) for name, values in self.parameters.items()}


@cache
def pairs_of(batch: int, dtype: type) -> tuple[np.ndarray, np.ndarray, tuple[truth.Pair, ...]]:
    """Directions, the same for all models, and the pairs on the sphere that they stand for."""
    wi, wo = (v.astype(dtype) for v in directions(np.random.default_rng(batch), BATCH, LIMIT[dtype]))
    with mp.workdps(truth.DIGITS):
        return wi, wo, tuple(truth.on_sphere(i, o, LIMIT[dtype]) for i, o in zip(wi, wo, strict=True))


def inputs_of(case: Case, batch: int, dtype: type) -> Inputs:
    wi, wo, _ = pairs_of(batch, dtype)
    parameters = case.parameters(np.random.default_rng([batch, 1]), tangent_of_half(wi, wo))
    return Inputs(wi, wo, {name: v.astype(dtype) for name, v in parameters.items()}, np.arange(BATCH) % 3)


@cache
def compiled(name: str, dtype: type):
    """The public evaluation of a batch, each pair with its own model."""
    build = CASES[name].build

    def evaluate(parameters, wi, wo):
        return build(**parameters).astype(jnp.dtype(dtype)).evaluate(wi, wo)

    return jax.jit(jax.vmap(evaluate))


@cache
def compiled_slopes(name: str):
    """One channel's value in float64 with its gradients in parameters and in the components of both directions."""
    build = CASES[name].build

    def channel_value(parameters, wi, wo, channel):
        return build(**parameters).masked_value(wi, wo)[channel]

    return jax.jit(jax.vmap(jax.value_and_grad(channel_value, argnums=(0, 1, 2))))


def evaluate(name: str, inputs: Inputs) -> np.ndarray:
    values = compiled(name, inputs.wi.dtype.type)(inputs.parameters, inputs.wi, inputs.wo)
    assert values.dtype == inputs.wi.dtype
    return np.asarray(values)[np.arange(BATCH), inputs.channel]


def condition(name: str, inputs: Inputs) -> np.ndarray:
    """kappa of each pair, at the unit vectors."""
    wi, wo = (unit_rows(v.astype(float)) for v in (inputs.wi, inputs.wo))
    parameters = {key: values.astype(float) for key, values in inputs.parameters.items()}
    value, (by_parameter, by_wi, by_wo) = compiled_slopes(name)(parameters, wi, wo, inputs.channel)
    total = np.sum(np.abs(wi * by_wi) + np.abs(wo * by_wo), axis=-1)
    for key, values in parameters.items():
        total += np.sum(np.abs(values * np.asarray(by_parameter[key])).reshape(BATCH, -1), axis=-1)
    value = np.abs(np.asarray(value))
    return np.divide(total, value, out=np.zeros(BATCH), where=value > 0)


def relative_error(value: np.floating, true: mp.mpf) -> float:
    return float(abs(mp.mpf(float(value)) - true) / abs(true))


def worst_ratio(name: str, batch: int, dtype: type) -> tuple[float, int]:
    """The largest error in units of eps (1 + kappa), and how many values could be compared."""
    case, (_, _, pairs) = CASES[name], pairs_of(batch, dtype)
    inputs = inputs_of(case, batch, dtype)
    values, kappa = evaluate(name, inputs), condition(name, inputs)
    low, high = RANGE[dtype]
    ratios = [0.0]
    with mp.workdps(truth.DIGITS):
        for k, pair in enumerate(pairs):
            try:
                true = case.truth(pair, inputs.row(k), int(inputs.channel[k]))
            except truth.TooLow:
                continue
            if low < true < high:
                ratios.append(relative_error(values[k], true) / (np.finfo(dtype).eps * (1 + kappa[k])))
    return max(ratios), len(ratios) - 1


@every_type
@every_model
def test_values_are_right_to_their_condition(name, dtype):
    ratio, count = worst_ratio(name, 0, dtype)
    assert count > BATCH // 3
    assert ratio <= FACTOR


@pytest.mark.slow
@every_type
@every_model
def test_values_are_right_to_their_condition_everywhere(name, dtype, record_property):
    ratios, counts = zip(*(worst_ratio(name, batch, dtype) for batch in range(1, ALL)), strict=True)
    record_property("worst ratio", float(max(ratios)))
    assert sum(counts) > 3000
    assert max(ratios) <= FACTOR


def outright_errors(name: str, batch: int, dtype: type) -> list[float]:
    """Relative errors of an isotropic lobe whose roughness is at least 0.01 where its power is at least 1e-6.

    The components of the directions are exact here (`truth.as_given`): beside the sphere by the float's rounding, a
    narrow lobe at grazing angles differs by more than this from the lobe on it.
    """
    case, inputs, (parameter, power) = CASES[name], inputs_of(CASES[name], batch, dtype), LOBES[name]
    width = inputs.parameters[parameter]
    chosen = width <= 2 / 0.01**2 - 2 if parameter == "exponent" else width >= 0.01
    values, (low, high) = evaluate(name, inputs), RANGE[dtype]
    errors = []
    with mp.workdps(truth.DIGITS):
        for k in np.flatnonzero(chosen).tolist():
            pair, row = truth.as_given(inputs.wi[k], inputs.wo[k]), inputs.row(k)
            true = case.truth(pair, row, int(inputs.channel[k]))
            if power(pair, row[parameter]) > 1e-6 and low < true < high:
                errors.append(relative_error(values[k], true))
    return errors


@every_type
@pytest.mark.parametrize("name", LOBES)
def test_isotropic_lobes_are_right_outright(name, dtype):
    errors = outright_errors(name, 0, dtype)
    assert len(errors) > BATCH // 5
    assert max(errors) <= OUTRIGHT[dtype]


@pytest.mark.slow
@every_type
@pytest.mark.parametrize("name", LOBES)
def test_isotropic_lobes_are_right_outright_everywhere(name, dtype, record_property):
    errors = [error for batch in range(1, ALL) for error in outright_errors(name, batch, dtype)]
    record_property("worst error", float(max(errors)))
    assert max(errors) <= OUTRIGHT[dtype]


SETS = 4
STEP = mp.mpf(10) ** -26


def gradient_inputs(name: str, batch: int) -> Inputs:
    """Four sets of parameters, each over its share of the directions.

    A turn or a refraction leaves a grazing cosine few digits, whatever the formula; models that do so are
    differentiated at cosines from 0.02 on.
    """
    wi, wo = directions(np.random.default_rng([batch, 2]), BATCH, 0.02 if name in COMPOSED else LIMIT[np.float64])
    sets = CASES[name].parameters(np.random.default_rng(3), np.array([1e-3, 0.03, 0.3, 1.0]))
    rows = np.arange(BATCH) % SETS
    return Inputs(wi, wo, {key: values[rows] for key, values in sets.items()}, np.arange(BATCH) // SETS % 3)


def stepped(value: mp.mpf, name: str) -> mp.mpf:
    """The parameter a little further, inwards from the end of its range."""
    step = STEP * abs(value) if value else STEP * STEP
    return value - step if name == "f0" and value == 1 else value + step


def true_slopes(case: Case, inputs: Inputs, k: int) -> dict[tuple[str, int | None], mp.mpf]:
    """One-sided differences of the formula in every component of every parameter, by name and component."""
    pair, row, channel = truth.as_given(inputs.wi[k], inputs.wo[k]), inputs.row(k), int(inputs.channel[k])
    here, found = case.truth(pair, row, channel), {}
    for name, before in row.items():
        if isinstance(before, tuple):
            moves = [(part, old, stepped(old, name)) for part, old in enumerate(before)]
            steps = [(part, (*before[:part], new, *before[part + 1 :]), new - old) for part, old, new in moves]
        else:
            new = stepped(before, name)
            steps = [(None, new, new - before)]
        for part, after, distance in steps:
            found[name, part] = (case.truth(pair, row | {name: after}, channel) - here) / distance
    return found


def worst_gradient(name: str, batches: range, rows: int) -> float:
    """Largest error of a gradient, in units of the parameter's largest gradient over the directions of its set."""
    case = CASES[name]
    errors, largest = {}, {}
    for batch in batches:
        inputs = gradient_inputs(name, batch)
        _, (slopes, _, _) = compiled_slopes(name)(inputs.parameters, inputs.wi, inputs.wo, inputs.channel)
        slopes = {key: np.asarray(values) for key, values in slopes.items()}
        with mp.workdps(truth.DIGITS + 20):
            for k in range(rows):
                for (key, part), true in true_slopes(case, inputs, k).items():
                    found, where = slopes[key][k] if part is None else slopes[key][k, part], (key, part, k % SETS)
                    errors[where] = max(errors.get(where, 0.0), abs(float(found) - true))
                    largest[where] = max(largest.get(where, 0.0), abs(true))
    # A lobe so narrow that no direction sees it has nothing to compare; every parameter is seen in some set.
    seen = {where: size for where, size in largest.items() if size > RANGE[np.float64][0]}
    assert {where[:2] for where in seen} == {where[:2] for where in largest}
    return float(max(errors[where] / size for where, size in seen.items()))


@every_model
def test_gradients_in_every_parameter_are_right(name):
    """500 directions."""
    assert worst_gradient(name, range(2), 250) <= GRADIENT


@pytest.mark.slow
@every_model
def test_gradients_in_every_parameter_are_right_everywhere(name, record_property):
    """10 200 directions."""
    worst = worst_gradient(name, range(2, ALL + 2), BATCH)
    record_property("worst gradient", float(worst))
    assert worst <= GRADIENT
