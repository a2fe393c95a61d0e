"""What the camera sees: a sphere of radius 1 on a studio floor, its points with frames and texture coordinates.

Frame of the scene: x to the right, y up, z towards the camera. Everything here is NumPy, computed once a size.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

CAMERA_DISTANCE = 7.0
CAMERA_ELEVATION = np.radians(11.0)
SPHERE_FILL = 0.84
SPHERE_LIFT = 0.035
GRAZING = 0.05
"""Footprints grow no further than they do at this cosine with the view."""


class Points(NamedTuple):
    """Visible points of a surface, one a pixel that the surface covers."""

    rows: np.ndarray
    """(P,) picture rows."""
    columns: np.ndarray
    """(P,) picture columns."""
    frames: np.ndarray
    """(P, 3, 3) tangent, bitangent and normal of each point in the scene."""
    wo: np.ndarray
    """(P, 3) unit direction to the camera, in the point's frame."""
    uv: np.ndarray
    """(P, 2) texture coordinates; one unit spans pi units of length, half the circumference of the sphere."""
    footprint: np.ndarray
    """(P,) longest side of what a pixel covers, in uv: as hardware without anisotropic filtering has it."""


class Scene(NamedTuple):
    """A shape seen by a camera."""

    points: Points
    coverage: np.ndarray
    """(H, W) part of each pixel that the shape covers."""
    shadow: np.ndarray
    """(H, W) part of a uniform sky that the shape hides from the floor seen there; 0 where no floor is."""
    height: np.ndarray
    """(H, W) height in the picture, 0 at the bottom, 1 at the top."""


class Camera(NamedTuple):
    """A pinhole camera that looks at the origin from ``CAMERA_ELEVATION`` above the floor's plane."""

    position: np.ndarray
    right: np.ndarray
    up: np.ndarray
    forward: np.ndarray

    def rays(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Directions, not unit, through points (x, y) of the picture plane at distance 1."""
        return x[..., None] * self.right + y[..., None] * self.up + self.forward


def camera(distance: float) -> Camera:
    """The camera at a distance from the origin."""
    sine, cosine = np.sin(CAMERA_ELEVATION), np.cos(CAMERA_ELEVATION)
    x, y, z = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, -sine, -cosine]])
    return Camera(distance * np.array([0.0, sine, cosine]), x, y, z)


def picture_height(height: int, width: int) -> np.ndarray:
    """`Scene.height` of a picture."""
    return np.broadcast_to(1.0 - (np.arange(height)[:, None] + 0.5) / height, (height, width))


def _sphere_frames(normal: np.ndarray) -> np.ndarray:
    """Frames (..., 3, 3) of unit normals: tangent along the parallel, bitangent along the meridian."""
    x, z = normal[..., 0], normal[..., 2]
    around = np.maximum(np.hypot(x, z), 1e-6)
    tangent = np.stack([z / around, np.zeros_like(x), -x / around], axis=-1)
    return np.stack([tangent, np.cross(normal, tangent), normal], axis=-2)


@lru_cache(maxsize=4)
def sphere_scene(size: int) -> Scene:
    """The sphere in a square picture of ``size`` pixels."""
    view = camera(CAMERA_DISTANCE)
    rim = 1.0 / np.sqrt(CAMERA_DISTANCE**2 - 1.0)
    step = 2.0 * rim / (SPHERE_FILL * size)
    axis = (np.arange(size) + 0.5) - size / 2
    x, y = np.meshgrid(axis * step, -(axis + SPHERE_LIFT * size) * step)
    radius = np.hypot(x, y)
    coverage = np.clip(0.5 + (rim - radius) / step, 0.0, 1.0)
    rows, columns = np.nonzero(coverage > 0.0)

    # Pixels whose middle lies outside the outline take the nearest point inside it.
    inward = np.minimum(1.0, (rim - 0.75 * step) / np.maximum(radius, 1e-12))[rows, columns]
    ray = view.rays(x[rows, columns] * inward, y[rows, columns] * inward)
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    along = -ray @ view.position
    distance = along - np.sqrt(np.maximum(along**2 - CAMERA_DISTANCE**2 + 1.0, 0.0))
    normal = view.position + distance[:, None] * ray
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    frames = _sphere_frames(normal)
    wo = np.einsum("pij,pj->pi", frames, -ray)
    uv = np.stack([np.arctan2(normal[:, 0], normal[:, 2]), np.arcsin(np.clip(normal[:, 1], -1, 1))], axis=-1) / np.pi
    around = np.maximum(np.hypot(normal[:, 0], normal[:, 2]), GRAZING)
    points = Points(
        rows,
        columns,
        frames.astype(np.float32),
        wo.astype(np.float32),
        uv + 0.5,
        footprint(step * distance, wo) / around,
    )
    return Scene(points, coverage, _floor_shadow(view, x, y), picture_height(size, size))


def footprint(pixel: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """Longest side, in uv, of what a pixel of width ``pixel`` (P,) covers on a surface seen under ``wo`` (P, 3)."""
    return pixel / np.maximum(wo[:, 2], GRAZING) / np.pi


def _floor_shadow(view: Camera, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Cosine-weighted part of the sky that the unit sphere hides from the floor y = -1: cos / distance²."""
    floor, hits = floor_points(view, x, y)
    squared = np.maximum(np.sum(floor * floor, axis=-1), 1.0)
    return np.where(hits, squared**-1.5, 0.0)


def floor_points(view: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (H, W, 3) of the floor y = -1 that rays meet, and where they meet it."""
    ray = view.rays(x, y)
    hits = ray[..., 1] < -1e-3
    distance = np.where(hits, -(1.0 + view.position[1]) / np.where(hits, ray[..., 1], -1.0), 0.0)
    return view.position + distance[..., None] * ray, hits
