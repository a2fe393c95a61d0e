"""Looking up a texture of BRDFs: bilinear and repeating, as a GPU filters the maps.

A map of BRDFs is a module whose array leaves carry two leading axes (height, width); row 0 is v = 0. Parameters are
filtered, not radiance, each in its own way: an anisotropy angle through the double angle (axes are equal modulo pi),
normals by component and normalized later by the frame, everything else linearly.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit.brdf import AbstractBRDF, Framed


def map_shape(brdf_map: AbstractBRDF) -> tuple[int, int]:
    """(height, width) of a map of BRDFs."""
    leaves = jax.tree.leaves(eqx.filter(brdf_map, eqx.is_inexact_array))
    return leaves[0].shape[0], leaves[0].shape[1]


def _bilinear(height: int, width: int, uv: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rows, columns and weights of the four neighbors of each coordinate; texel centers at (k + 0.5) / size."""
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = x - column, y - row
    return [
        ((row + dy) % height, (column + dx) % width, np.abs(1 - dx - fx) * np.abs(1 - dy - fy))
        for dy in (0, 1)
        for dx in (0, 1)
    ]


def look_up(brdf_map: AbstractBRDF, uv: np.ndarray) -> AbstractBRDF:
    """The BRDFs at texture coordinates ``uv`` (P, 2): a module whose array leaves carry one leading axis of P."""
    height, width = map_shape(brdf_map)
    neighbors = _bilinear(height, width, uv)

    def weighted(values: np.ndarray) -> np.ndarray:
        broadcast = (slice(None), *[None] * (values.ndim - 2))
        parts = [values[row, column] * weight[broadcast].astype(values.dtype) for row, column, weight in neighbors]
        return parts[0] + parts[1] + parts[2] + parts[3]

    return _filter(brdf_map, weighted)


def minified(brdf_map: AbstractBRDF, factor: int) -> AbstractBRDF:
    """The map with every ``factor`` × ``factor`` texels averaged to one, as in a mip level; rests are cut off."""
    height, width = (size // factor for size in map_shape(brdf_map))

    def averaged(values: np.ndarray) -> np.ndarray:
        cut = values[: height * factor, : width * factor]
        return cut.reshape(height, factor, width, factor, *values.shape[2:]).mean(axis=(1, 3), dtype=values.dtype)

    return brdf_map if factor == 1 else _filter(brdf_map, averaged)


def _filter(brdf_map: AbstractBRDF, weighted: Callable[[np.ndarray], np.ndarray]) -> AbstractBRDF:
    """``brdf_map`` with a linear filter applied to every array leaf, angles through the double angle."""

    def filtered(leaf: jax.Array, transform: Callable = lambda x: x) -> np.ndarray:
        return weighted(transform(np.asarray(leaf)))

    def framed(node):
        if not isinstance(node, Framed):
            return jnp.asarray(filtered(node)) if eqx.is_inexact_array(node) else node
        cosine, sine = (
            filtered(node.rotation, lambda g: np.cos(2 * g)),
            filtered(node.rotation, lambda g: np.sin(2 * g)),
        )
        rotation = jnp.asarray(0.5 * np.arctan2(sine, cosine))
        base = jax.tree.map(framed, node.base, is_leaf=lambda x: isinstance(x, Framed))
        normal = jnp.asarray(filtered(node.normal))
        return eqx.tree_at(lambda x: (x.base, x.normal, x.rotation), node, (base, normal, rotation))

    return jax.tree.map(framed, brdf_map, is_leaf=lambda x: isinstance(x, Framed))


def lobe_normals(brdf: AbstractBRDF, count: int) -> np.ndarray:
    """Where the lobes of ``count`` looked-up BRDFs stand, (count, 3): the outermost frame's normal, else (0, 0, 1)."""
    nodes = jax.tree.leaves(brdf, is_leaf=lambda x: isinstance(x, Framed))
    for node in nodes:
        if isinstance(node, Framed):
            normal = np.broadcast_to(np.asarray(node.normal, np.float32), (count, 3))
            return normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-6)
    return np.broadcast_to(np.array([0.0, 0.0, 1.0], np.float32), (count, 3))
