"""Shading normals that face away from the viewer, and what to do about them.

A normal map may tilt a normal so far that the viewer, or the mirror image of the view, lies below it or below the
surface: the lobe is then cut off and the point turns black, in dots along the outline where the map's tilt and the
surface's add up. The remedy here is the one of Iray (Keller et al. 2017, appendix A.3) and Cycles: the normal is bent
back towards the surface's own, in the plane of the two, just until the mirrored view lies above the surface. Normals
that need none are not touched.
"""

import equinox as eqx
import jax.numpy as jnp

from axffit._types import Direction
from axffit.brdf import AbstractBRDF, ClearCoat, Framed, Sum
from axffit.numerics import normalize

LOWEST_MIRROR = 0.01
"""Sine of the mirrored view's least elevation above the surface."""


def bent_normal(normal: Direction, wo: Direction) -> Direction:
    """``normal`` (3,), bent until the mirror image of ``wo`` has z >= t = min(0.9 o_z, 0.01); unit length if bent.

    With the tangential part of the normal along x, n = x sin p + z cos p and the mirror image r = 2 <n, o> n - o,
    r_z = o_x sin 2p + o_z cos 2p = |(o_x, o_z)| cos(2p - atan2(o_x, o_z)), so the largest tilt allowed is
    p = (atan2(o_x, o_z) + acos(t / |(o_x, o_z)|)) / 2. Then also <n, o> > 0.

    Args:
        normal: shading normal in the surface's frame, any length.
        wo: unit direction to the viewer, o_z > 0.
    """
    unit = normalize(normal)
    tilt = jnp.sqrt(jnp.maximum(unit[0] ** 2 + unit[1] ** 2, 1e-20))
    along = jnp.where(tilt > 1e-6, unit[:2] / tilt, jnp.array([1.0, 0.0], wo.dtype))
    o_x, o_z = jnp.sum(along * wo[:2]), wo[2]
    length = jnp.sqrt(o_x * o_x + o_z * o_z)
    least = jnp.minimum(0.9 * o_z, LOWEST_MIRROR)
    toward = jnp.sum(unit * wo)
    angle = 0.5 * (jnp.arctan2(o_x, o_z) + jnp.arccos(jnp.clip(least / jnp.maximum(length, 1e-6), 0.0, 1.0)))
    bent = jnp.concatenate([jnp.sin(angle) * along, jnp.cos(angle)[None]])
    fine = (toward > 0.0) & (unit[2] > 0.0) & (2.0 * toward * unit[2] - o_z >= least)
    return jnp.where(fine, normal, bent)


def facing(brdf: AbstractBRDF, wo: Direction) -> AbstractBRDF:
    """``brdf`` with the normals of its coat and of its outermost frame bent as :func:`bent_normal` says."""
    if isinstance(brdf, Framed):
        return eqx.tree_at(lambda x: x.normal, brdf, bent_normal(brdf.normal, wo))
    if isinstance(brdf, ClearCoat):
        new = (facing(brdf.base, wo), bent_normal(brdf.normal, wo))
        return eqx.tree_at(lambda x: (x.base, x.normal), brdf, new)
    if isinstance(brdf, Sum):
        return Sum(tuple(facing(term, wo) for term in brdf.terms))
    return brdf


def lobe_normal(brdf: AbstractBRDF, wo: Direction) -> Direction:
    """Unit normal (3,) that the lobes stand about: the outermost frame's, else (0, 0, 1); it only steers samples."""
    if isinstance(brdf, Framed):
        return normalize(brdf.normal)
    if isinstance(brdf, ClearCoat):
        return lobe_normal(brdf.base, wo)
    if isinstance(brdf, Sum):
        framed = [term for term in brdf.terms if isinstance(term, Framed)]
        return lobe_normal(framed[0], wo) if framed else jnp.array([0.0, 0.0, 1.0], wo.dtype)
    return jnp.array([0.0, 0.0, 1.0], wo.dtype)
