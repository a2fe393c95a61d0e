"""Repeating value noise: the same pattern at every resolution, fixed by a seed."""

import numpy as np

Rng = np.random.Generator


def unit_grid(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Texture coordinates u, v (size, size) of texel centers; row 0 is v = 0."""
    centers = (np.arange(size) + 0.5) / size
    v, u = np.meshgrid(centers, centers, indexing="ij")
    return u, v


def value_noise(rng: Rng, u: np.ndarray, v: np.ndarray, cells: tuple[int, int]) -> np.ndarray:
    """Smooth noise in [-1, 1] that repeats with period 1 in both coordinates.

    Random values on a lattice of `cells` (along u, along v), joined by the quintic 6t⁵ - 15t⁴ + 10t³ (Perlin 2002).
    """
    across, down = cells
    lattice = 2.0 * rng.random((down, across)) - 1.0
    x, y = u * across, v * down
    column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    s, t = _quintic(x - column), _quintic(y - row)
    near, far = row % down, (row + 1) % down
    left, right = column % across, (column + 1) % across
    top = (1 - s) * lattice[near, left] + s * lattice[near, right]
    bottom = (1 - s) * lattice[far, left] + s * lattice[far, right]
    return (1 - t) * top + t * bottom


def fractal_noise(
    rng: Rng, u: np.ndarray, v: np.ndarray, cells: tuple[int, int], *, octaves: int, size: int
) -> np.ndarray:
    """Octaves of `value_noise`, each twice as fine and half as strong; those finer than the texels are left out."""
    total = np.zeros_like(u)
    for octave in range(octaves):
        scale = 2**octave
        # Drawing before testing keeps the coarser octaves the same at every size.
        layer = value_noise(rng, u, v, (cells[0] * scale, cells[1] * scale))
        if octave == 0 or 2 * max(cells) * scale <= size:
            total += layer / scale
    return total


def normal_noise(rng: Rng, shape: tuple[int, ...]) -> np.ndarray:
    """Standard normal deviates by Box-Muller, from uniform deviates only: those are the same in every NumPy."""
    radius = np.sqrt(-2.0 * np.log(1.0 - rng.random(shape)))
    return radius * np.cos(2.0 * np.pi * rng.random(shape))


def unit_vectors(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Normals (..., 3) of slopes: (x, y, 1) at unit length."""
    vectors = np.stack([x, y, np.ones_like(x)], axis=-1)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _quintic(t: np.ndarray) -> np.ndarray:
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)
