"""A shape like a car's body: a long rounded volume with a cabin, a character line and hollow flanks.

The shape is the zero set of F(x, y, z) = (|z| / side)^4 + (y / roof)^5 + |x / 2.1|^6 - 1 in the body's own frame: x
along its length, y up from the floor, z across. ``roof`` (of x and z) swells to the cabin and has a crease along the
bonnet, ``side`` (of y and x) narrows towards the roof, breaks at the character line and is hollow below. Rays are
marched in steps and refined by bisection; normals are the gradient of F by central differences. NumPy, once a size.
"""

from functools import lru_cache

import numpy as np

from axffit.preview.scene import Points, Scene, camera, floor_points, footprint, picture_height

LENGTH, HEIGHT, WIDTH = 2.1, 1.3, 1.0
"""Half length, full height and half width of the box that holds the shape."""

TURN = np.radians(33.0)
"""Of the body about the vertical, its front towards the camera and to the left."""

DISTANCE, FIELD, LIFT = 9.0, 0.262, 0.085
"""Of the camera; half the picture's width at distance 1; how much higher the camera looks than at the body's floor."""

STEPS, BISECTIONS = 90, 24

_COSINE, _SINE = np.cos(TURN), np.sin(TURN)
_TO_BODY = np.array([[_COSINE, 0.0, -_SINE], [0.0, 1.0, 0.0], [_SINE, 0.0, _COSINE]])
"""Rows: the body's axes in the scene."""

Values = np.ndarray


def _bump(x: Values, center: float, width: float, power: int = 2) -> Values:
    t = ((x - center) / width) ** 2
    return np.exp(-(t ** (power // 2)))


def _edge(x: Values, radius: float) -> Values:
    """|x| with its corner rounded over ``radius``."""
    return np.sqrt(x * x + radius * radius) - radius


def implicit(point: Values) -> Values:
    """F (...) of points (..., 3) in the body's frame; negative inside."""
    x, y, z = point[..., 0], point[..., 1], point[..., 2]
    crease = 0.049 * _edge(np.abs(z) - 0.42, 0.012) * _bump(x, -1.15, 0.75, 4)
    roof = 0.66 + 0.50 * _bump(x, 0.35, 0.95, 4) - 0.05 * (x + 0.2) - crease
    shoulder = 0.86 - 0.10 * _edge(y - 0.56 - 0.02 * x, 0.012)
    hollow = 0.075 * _bump(y, 0.34, 0.13) * _bump(x, 0.1, 1.25, 6)
    side = shoulder - hollow - 0.30 * np.maximum(y - 0.58, 0.0) ** 1.2 - 0.02 * (x - 0.3) ** 2
    side = np.maximum(side, 0.2)
    across, up, along = z / side, y / np.maximum(roof, 0.2), (x / LENGTH) ** 2
    # Products: a power of arrays costs as much as the whole rest.
    return (across * across) ** 2 + np.abs(up) * (up * up) ** 2 + along * along * along - 1.0


def _gradient(point: Values) -> Values:
    step = 1e-4
    parts = [implicit(point + step * axis) - implicit(point - step * axis) for axis in np.eye(3)]
    return np.stack(parts, axis=-1) / (2.0 * step)


def _entry(origin: Values, ray: Values) -> tuple[Values, Values]:
    """Where rays (N, 3) enter and leave the box that holds the shape."""
    low = np.array([-LENGTH, 0.02, -WIDTH]) * 1.02
    high = np.array([LENGTH, HEIGHT, WIDTH]) * 1.02
    with np.errstate(divide="ignore"):
        first, second = (low - origin) / ray, (high - origin) / ray
    return np.minimum(first, second).max(axis=-1), np.maximum(first, second).min(axis=-1)


def _nearest(origin: Values, ray: Values) -> tuple[Values, Values]:
    """Distances at which rays first enter the shape, or come closest to it, and whether they enter it."""
    start, stop = _entry(origin, ray)
    distance = np.full(len(ray), np.inf)
    lowest = np.full(len(ray), np.inf)
    alive = np.flatnonzero(stop > start)
    inside = np.zeros(len(ray), bool)
    for k in range(STEPS + 1):
        t = start[alive] + (stop - start)[alive] * (k / STEPS)
        value = implicit(origin + t[:, None] * ray[alive])
        better = value < lowest[alive]
        lowest[alive[better]], distance[alive[better]] = value[better], t[better]
        inside[alive[value < 0.0]] = True
        alive = alive[value >= 0.0]
    hit = np.flatnonzero(inside)
    above, below = distance[hit] - (stop - start)[hit] / STEPS, distance[hit].copy()
    for _ in range(BISECTIONS):
        middle = 0.5 * (above + below)
        outside = implicit(origin + middle[:, None] * ray[hit]) > 0.0
        above, below = np.where(outside, middle, above), np.where(outside, below, middle)
    distance[hit] = below
    return distance, inside


def _softened(hit: Values) -> Values:
    """Coverage (H, W): the part of a pixel and its eight neighbors that is hit, for an outline without steps."""
    padded = np.pad(hit.astype(np.float64), 1, mode="edge")
    rows = padded[:-2] + padded[1:-1] + padded[2:]
    return (rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:]) / 9.0


@lru_cache(maxsize=2)
def body_scene(width: int) -> Scene:
    """The body in a picture of ``width`` x ``width`` / 2 pixels."""
    height = width // 2
    view = camera(DISTANCE)
    step = 2.0 * FIELD / width
    x, y = np.meshgrid(
        ((np.arange(width) + 0.5) - width / 2) * step, -((np.arange(height) + 0.5) - height / 2) * step - LIFT
    )
    ray = view.rays(x, y).reshape(-1, 3)
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    origin, local = _TO_BODY @ (view.position + [0.0, 1.0, 0.0]), ray @ _TO_BODY.T
    distance, hit = _nearest(origin, local)
    coverage = _softened(hit.reshape(height, width)) * np.isfinite(distance).reshape(height, width)
    rows, columns = np.nonzero(coverage > 0.0)
    chosen = rows * width + columns
    point = origin + distance[chosen, None] * local[chosen]
    gradient = _gradient(point)

    normal = (gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)) @ _TO_BODY
    toward = -ray[chosen]
    # At the outline the gradient may face away by a rounding or a part of a pixel.
    facing = np.sum(normal * toward, axis=-1, keepdims=True)
    normal = normal + np.maximum(0.02 - facing, 0.0) * toward
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    frames = _frames(normal)
    wo = np.einsum("pij,pj->pi", frames, toward)
    # Along the length, and up the flank and on across the roof: nowhere stretched by more than a square root of 2.
    uv = np.stack([point[:, 0], point[:, 1] - point[:, 2]], axis=-1) / np.pi
    side = footprint(step * distance[chosen], wo)
    points = Points(rows, columns, frames.astype(np.float32), wo.astype(np.float32), uv, side)
    return Scene(points, coverage, _shadow(x, y), picture_height(height, width))


def _frames(normal: Values) -> Values:
    """Frames (P, 3, 3): tangent along the body as far as the surface runs along it."""
    along = np.broadcast_to(_TO_BODY[0], normal.shape)
    tangent = along - np.sum(along * normal, axis=-1, keepdims=True) * normal
    # Where the surface faces along the body, any tangent does.
    short = np.linalg.norm(tangent, axis=-1, keepdims=True) < 1e-3
    tangent = np.where(short, np.cross(_TO_BODY[1], normal), tangent)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    return np.stack([tangent, np.cross(normal, tangent), normal], axis=-2)


def _shadow(x: Values, y: Values) -> Values:
    """As if an ellipsoid of the body's size lay on the floor: the sphere's shadow, stretched."""
    floor, hits = floor_points(camera(DISTANCE), x, y)
    local = floor @ _TO_BODY.T
    squared = (local[..., 0] / (0.85 * LENGTH)) ** 2 + (local[..., 2] / (1.0 * WIDTH)) ** 2
    return np.where(hits, 1.0 / (0.55 + squared**1.5 + 0.45 * squared), 0.0).clip(0.0, 1.0)
