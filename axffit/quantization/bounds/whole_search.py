"""The largest errors of whole materials that can be found: gradient ascent with the library's own models.

As `search`, for any form: over directions, the directions of the tilts, and where the parameters and their errors lie
in the class. Everything happens in the base's own frame before quantization; directions are given below the coat
(`pairs`) and leave it by refraction. What a light sends is f i_z; what counts is its change and its height below the
highest light of its view.
"""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from ...frames import dot, half_difference_to_directions, reflect
from ...numerics import normalize
from ..definitions import RELEVANT
from ..directions import LOWEST
from ..tolerances import KINDS, Kind
from .kindred import BEFORE, ERRORS, Kindred, Numbers
from .search import ROUNDING, SEED, TINY, error_value
from .views import Grid

STARTS, TRIES, STEPS = 512, 8192, 90
"""Ascents for each definition, pairs they are chosen from, and steps of each."""

LINES, ROUNDS = 64, 4
"""Places looked along, with `TRIES` points together, and rounds of moving the best along every coordinate."""

MARGIN = 0.03
"""Above log 1e-3, what counts as relevant until the exact peak is known."""

DIRECTIONS = 4
"""y, psi, theta_d as a share of its range, phi."""

FINE, COARSE = (61, 25, 30, 11), (25, 12, 4, 5)
"""Half vectors in y and in azimuth, zooms, and points of a zoom: for single views, and for all cells."""


VARYING = (*BEFORE, *ERRORS, "tilt", "twist", "coat_tilt")
COORDINATES = DIRECTIONS + 2 + len(VARYING)
"""Directions, azimuths of the two tilts, and the place of everything that varies in its range, in [0, 1]."""


def _texel(at: Numbers, spans: Numbers, place: jax.Array) -> tuple[dict, dict]:
    """Parameters before and errors at a point of the search."""
    shares = place[DIRECTIONS + 2 :]
    values = {n: spans[n][0] + shares[k] * (spans[n][1] - spans[n][0]) for k, n in enumerate(VARYING)}
    before = dict(at) | {name: values[name] for name in BEFORE}
    errors = {name: values[name] for name in (*ERRORS, "tilt", "twist", "coat_tilt")}
    return before, errors | {"tilt_azimuth": place[DIRECTIONS], "coat_azimuth": place[DIRECTIONS + 1]}


def _pair(kin: Kindred, before: Numbers, place: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Directions below the coat, which the share of theta_d keeps in the domain.

    <i, m> = r cos(theta_d - e) with r cos e = <h, m> and r sin e = <d, m>, so that a cosine of at least c for both
    directions means theta_d <= arccos(c / r) - |e|; likewise for the mirror direction of the viewer.
    """
    y, psi, share, phi = place[:DIRECTIONS]
    a_x, a_y = kin.width(before)
    p, s = a_x * jnp.sinh(y) * jnp.cos(psi), a_y * jnp.sinh(y) * jnp.sin(psi)
    theta_h, phi_h = jnp.arctan(jnp.sqrt(p * p + s * s + 1e-60)), jnp.arctan2(s, p + 1e-60)
    h, _ = half_difference_to_directions(theta_h, jnp.zeros(()), phi, phi_h)
    d, _ = half_difference_to_directions(theta_h, jnp.asarray(0.5 * np.pi), phi, phi_h)
    normal, low = kin.normal(before), jnp.asarray(LOWEST * (1 + 1e-9))
    below = jnp.sqrt(1.0 - (1.0 - low * low) / before["ior"] ** 2) if kin.coat == "refracting" else low
    base, flipped = jnp.asarray([0.0, 0.0, 1.0]), normal * jnp.array([-1.0, -1.0, 1.0])
    limits = []
    for axis, least, mirror in ((base, low, False), (normal, below, False), (flipped, below, True)):
        along, across = dot(h, axis), dot(d, axis)
        reach = jnp.sqrt(along * along + across * across)
        away = jnp.arctan2(across, along)
        limits.append(jnp.arccos(jnp.minimum(least / reach, 1.0)) - (away if mirror else jnp.abs(away)))
    largest = jnp.maximum(jnp.min(jnp.stack(limits)), 0.0)
    theta_d = largest * (1.0 - (1.0 - share) ** 2)
    return half_difference_to_directions(theta_h, theta_d, phi, phi_h)


def _errors_at(kin: Kindred, at: Numbers, spans: Numbers, place: jax.Array) -> tuple[jax.Array, ...]:
    """log f'/f, log f i_z, the smallest cosine of the domain, and the view outside in the coat's frame."""
    before, errors = _texel(at, spans, place)
    inner = _pair(kin, before, place)
    low = kin.lowest(before, *inner)
    inside = low >= LOWEST
    # Outside the domain the values of a harmless pair, so that gradients stay finite.
    wi, wo = (jnp.where(inside, kin.outwards(before, w)[0], kin.normal(before)) for w in inner)
    value = kin.radiance(kin.model(before), before, wi, wo)
    moved = kin.radiance(kin.model(before, errors), before, wi, wo)
    log_value = jnp.log(jnp.maximum(value, TINY))
    return jnp.log(jnp.maximum(moved, TINY)) - log_value, log_value, low, *_view(kin, before, wo)


def _view(kin: Kindred, before: Numbers, wo: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Cosine and azimuth of a view about the outermost normal."""
    if kin.coat is None:
        return wo[2], jnp.arctan2(wo[1], wo[0] + 1e-60)
    first, second = kin.axes(before)
    return dot(wo, kin.normal(before)), jnp.arctan2(dot(wo, second), dot(wo, first) + 1e-60)


def find_peaks(
    kin: Kindred, at: Numbers, cosine: jax.Array, azimuth: jax.Array, sizes: tuple[int, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The highest lights of views (n,): slopes of their half vectors in the base's frame, and log f i_z there."""
    found = _find_peaks(kin, at, jnp.asarray(cosine), jnp.asarray(azimuth), sizes)
    return tuple(np.asarray(x) for x in found)  # pyright: ignore[reportReturnType]


@partial(jax.jit, static_argnums=(0, 4))
def _find_peaks(
    kin: Kindred, at: Numbers, cosine: jax.Array, azimuth: jax.Array, sizes: tuple[int, ...]
) -> tuple[jax.Array, jax.Array, jax.Array]:
    rings, spokes, zooms, points = sizes
    a_x, a_y = kin.width(at)
    highest = jnp.arcsinh(20.0 / jnp.minimum(a_x, a_y))
    u = jnp.linspace(0.0, 1.0, rings)
    turn = jnp.linspace(-np.pi, np.pi, spokes, endpoint=False) if not kin.turning else jnp.linspace(0.0, np.pi, spokes)
    grid = [m.reshape(-1) for m in jnp.meshgrid(u, turn)]
    line = jnp.linspace(-1.0, 1.0, points)
    steps = [m.reshape(-1) for m in jnp.meshgrid(line, line)]
    spacing = (1.0 / (rings - 1), 2 * np.pi / spokes)
    model = kin.brightest(at)
    first, second = kin.axes(at)
    flat = kin.coat is None
    if kin.turning:
        azimuth = jnp.zeros_like(azimuth)

    def single(cosine: jax.Array, azimuth: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        sine = jnp.sqrt(1.0 - cosine * cosine)
        x, y = sine * jnp.cos(azimuth), sine * jnp.sin(azimuth)
        wo = jnp.stack([x, y, cosine]) if flat else x * first + y * second + cosine * kin.normal(at)
        inner = kin.inwards(at, wo)

        def slopes(u: jax.Array, turn: jax.Array) -> tuple[jax.Array, jax.Array]:
            r = jnp.sinh(highest * u * u)
            return a_x * r * jnp.cos(turn), a_y * r * jnp.sin(turn)

        def height(u: jax.Array, turn: jax.Array) -> jax.Array:
            p, s = slopes(u, turn)
            h = normalize(jnp.stack([p, s, jnp.ones_like(p)]))
            light = reflect(inner, h)
            wi, low = kin.outwards(at, light)
            good = (low >= LOWEST) & (light[2] >= LOWEST) & (dot(inner, h) > 0)
            wi = jnp.where(good, wi, kin.normal(at))
            value = jnp.log(jnp.maximum(kin.radiance(model, at, wi, wo), TINY))
            return jnp.where(good, value, -jnp.inf)

        def best_of(u: jax.Array, turn: jax.Array) -> tuple[jax.Array, ...]:
            heights = jax.vmap(height)(u, turn)
            best = jnp.argmax(heights)
            return u[best], turn[best], heights[best]

        def zoom(carry: tuple, scale: jax.Array) -> tuple[tuple, None]:
            u, turn, value = carry
            us = jnp.clip(u + scale * spacing[0] * steps[0], 0.0, 1.0)
            new = best_of(us, turn + scale * spacing[1] * steps[1])
            better = new[2] > value
            return tuple(jnp.where(better, a, b) for a, b in zip(new, carry, strict=True)), None

        scales = 1.5 * 0.65 ** jnp.arange(zooms, dtype=cosine.dtype)
        (u, turn, value), _ = jax.lax.scan(zoom, best_of(*grid), scales)
        return *slopes(u, turn), value

    return jax.lax.map(lambda view: single(*view), (cosine, azimuth), batch_size=64)


def find_errors(kin: Kindred, at: Numbers, spans: Numbers, grid: Grid, log_peak: np.ndarray) -> dict[Kind, float]:
    """The largest errors found by `STARTS` ascents for each definition; needs JAX with x64 enabled.

    Args:
        kin: the form.
        at: numbers of the texel in the middle of the class.
        spans: ranges of what varies.
        grid: cells of views.
        log_peak: log of the highest f i_z of the cells' middles.
    """
    table = jnp.asarray(log_peak.reshape(len(grid.edges) - 1, grid.azimuths))
    tries = _places(kin, at, spans)
    found: dict[Kind, float] = {}
    for kind in KINDS:
        log_ratio = jnp.asarray(kind == "log_ratio")

        def scores_at(places: np.ndarray, log_ratio: jax.Array = log_ratio) -> np.ndarray:
            return np.asarray(_values(kin, at, spans, table, jnp.asarray(places), log_ratio)[0])

        values = np.asarray(_values(kin, at, spans, table, jnp.asarray(tries), log_ratio)[1])
        starts = jnp.asarray(_starts(tries, values))
        values, places = (np.asarray(x) for x in _ascend(kin, at, spans, table, starts, log_ratio))
        places = places[np.argsort(-values)]
        # The best few again, with the peak of exactly their views and texels.
        few = [*places[:4], *_refined(tries, places, scores_at)[:4]]
        found[kind] = max(*(_exactly(kin, at, spans, kind, place) for place in few), ROUNDING) - ROUNDING
    return found


def _exactly(kin: Kindred, at: Numbers, spans: Numbers, kind: Kind, place: np.ndarray) -> float:
    before, _ = _texel(at, spans, jnp.asarray(place))
    change, log_value, low, cosine, azimuth = (
        np.asarray(x)[None] for x in _errors_of(kin, at, spans, jnp.asarray(place))
    )
    _, _, peak = find_peaks(kin, before, jnp.asarray(cosine), jnp.asarray(azimuth), FINE)
    # The peak is at least as high as the light itself.
    height = log_value - np.maximum(peak, log_value)
    return float(np.where(low >= LOWEST, error_value(kind, change, height), 0.0)[0])


@partial(jax.jit, static_argnums=0)
def _errors_of(kin: Kindred, at: Numbers, spans: Numbers, place: jax.Array) -> tuple[jax.Array, ...]:
    return _errors_at(kin, at, spans, place)


def _places(kin: Kindred, at: Numbers, spans: Numbers) -> np.ndarray:
    """`TRIES` points to start from, most of them near the lobe, with the errors at corners of their ranges."""
    rng = np.random.default_rng(SEED)
    narrow = float(jnp.minimum(*kin.width(at)))
    highest = np.arcsinh(20.0 / narrow)
    share = rng.random((TRIES, COORDINATES))
    spread = np.where(np.arange(TRIES) % 4 == 0, highest, 2.5)
    share[:, 0] *= np.minimum(spread, highest)
    share[:, 1] = 0.0 if kin.turning else 2 * np.pi * share[:, 1]
    share[:, 3:6] *= 2 * np.pi
    share[:, 6:] = np.rint(share[:, 6:])
    return share


def _interpolated(table: jax.Array, cosine: jax.Array, azimuth: jax.Array) -> jax.Array:
    """Log of the peak between the cells' middles."""
    rows, columns = table.shape
    row = jnp.clip(rows * (1.0 - jnp.log(cosine) / np.log(LOWEST)) - 0.5, 0.0, rows - 1.0)
    floor = jnp.floor(row)
    low, weight = floor.astype(jnp.int32), row - floor
    high = jnp.minimum(low + 1, rows - 1)

    def at(column: jax.Array) -> jax.Array:
        return (1.0 - weight) * table[low, column] + weight * table[high, column]

    if columns == 1:
        return at(jnp.int32(0))
    column = (azimuth + np.pi) * (columns / (2 * np.pi)) - 0.5
    left = jnp.floor(column)
    weight_2 = column - left
    left = left.astype(jnp.int32)
    return (1.0 - weight_2) * at(left % columns) + weight_2 * at((left + 1) % columns)


def _objective(
    kin: Kindred, at: Numbers, spans: Numbers, table: jax.Array, place: jax.Array, log_ratio: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """What the ascent climbs, and the error; both of one of the two kinds."""
    # The margin leaves room for peaks higher than between the table's.
    relevant = np.log(RELEVANT) + MARGIN
    change, log_value, low, cosine, azimuth = _errors_at(kin, at, spans, place)
    inside = low >= LOWEST
    cosine = jnp.where(inside, cosine, 1.0)
    log_height = jnp.minimum(log_value - _interpolated(table, cosine, azimuth), 0.0)
    size = jnp.where(log_ratio, jnp.abs(change), jnp.abs(jnp.expm1(change)))
    add = jnp.where(log_ratio, 3.0 * jnp.minimum(log_height - relevant, 0.0), log_height)
    looks = inside & (~log_ratio | (log_height >= relevant))
    value = jnp.where(looks, size * jnp.where(log_ratio, 1.0, jnp.exp(log_height)), 0.0)
    score = jnp.where(inside, jnp.log(size + TINY) + add, 100.0 * jnp.minimum(low - LOWEST, 0.0))
    return score, value


@partial(jax.jit, static_argnums=0)
def _values(
    kin: Kindred, at: Numbers, spans: Numbers, table: jax.Array, places: jax.Array, log_ratio: jax.Array
) -> tuple[jax.Array, jax.Array]:
    return jax.vmap(lambda place: _objective(kin, at, spans, table, place, log_ratio))(places)


def _starts(tries: np.ndarray, values: np.ndarray) -> np.ndarray:
    """`STARTS` of the tries: half of them the best, the others spread over what lies in the domain."""
    order = np.argsort(-values)
    half, inside = STARTS // 2, max(int(np.sum(values > 0)), STARTS)
    return tries[order[np.concatenate([np.arange(half), np.arange(half) * inside // half])]]


def _refined(tries: np.ndarray, best: np.ndarray, scores_at: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """The best places, and tries that no ascent came from, moved along one coordinate after another; best first.

    Between the texels of a color table f falls to 0 within a sliver of theta_d, which has no slope that leads to it:
    it is looked for along lines.
    """
    quarter = LINES // 4
    places = np.concatenate([best[:quarter], tries[: LINES - quarter]])

    def moved(places: np.ndarray, side: int, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Each place's best along a coordinate, and its score."""
        choices = np.repeat(places[:, None], len(offsets), axis=1)
        choices[..., side] += offsets
        choices[..., 0] = np.maximum(choices[..., 0], 0.0)
        choices[..., 2] = np.clip(choices[..., 2], 0.0, 1.0)
        scores = scores_at(choices.reshape(-1, COORDINATES)).reshape(choices.shape[:2])
        chosen, each = np.argmax(scores, axis=1), np.arange(len(places))
        return choices[each, chosen], scores[each, chosen]

    places, scores = moved(places, 2, np.concatenate([[0.0], np.linspace(-1.0, 1.0, TRIES // LINES - 1)]))
    places = places[np.argsort(-scores)[:quarter]]
    steps = 4.0 ** -np.arange(12.0)
    for _ in range(ROUNDS):
        for side in (2, 0, 1, 3, 4, 5):
            places, scores = moved(places, side, np.concatenate([[0.0], steps, -steps]))
    return places[np.argsort(-scores)]


@partial(jax.jit, static_argnums=0)
def _ascend(
    kin: Kindred, at: Numbers, spans: Numbers, table: jax.Array, place: jax.Array, log_ratio: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """Adam on the logarithm of the error: the best values and places of every start."""

    def objective(place: jax.Array) -> tuple[jax.Array, jax.Array]:
        return _objective(kin, at, spans, table, place, log_ratio)

    slope = jax.vmap(jax.grad(objective, has_aux=True))

    def step(carry: tuple, rate: jax.Array) -> tuple[tuple, None]:
        place, first, second, best, best_place = carry
        gradient, value = slope(place)
        gradient = jnp.nan_to_num(gradient, posinf=0.0, neginf=0.0)
        better = value > best
        best, best_place = jnp.where(better, value, best), jnp.where(better[:, None], place, best_place)
        first, second = 0.8 * first + 0.2 * gradient, 0.95 * second + 0.05 * gradient**2
        place = place + rate * first / (jnp.sqrt(second) + 1e-12)
        place = place.at[:, 0].set(jnp.maximum(place[:, 0], 0.0))
        place = place.at[:, 2].set(jnp.clip(place[:, 2], 0.0, 1.0))
        place = place.at[:, DIRECTIONS + 2 :].set(jnp.clip(place[:, DIRECTIONS + 2 :], 0.0, 1.0))
        return (place, first, second, best, best_place), None

    zero = jnp.zeros_like(place)
    rates = 0.1 * (2e-3 ** (jnp.arange(STEPS, dtype=place.dtype) / STEPS))
    (_, _, _, best, best_place), _ = jax.lax.scan(step, (place, zero, zero, jnp.zeros(len(place)), place), rates)
    return best, best_place
