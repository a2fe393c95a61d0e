"""Directions and angles: the conventions of axffit, stated once.

- A direction is a unit vector with components along (tangent, bitangent, normal); the normal n is (0, 0, 1).
- ``wi`` points to the light, ``wo`` to the viewer; both point away from the surface.
- h' = wi + wo is the half vector, h = h' / |h'|. theta_h is the angle between h and n, theta_d the angle between
  wi and h (equally wo and h), phi_h and phi_d their azimuths (Rusinkiewicz 1998).
- Angles are radians. A rotation by g turns the lobe's x axis to (cos g, sin g, 0).
- Every function takes any number of leading batch axes; vectors lie on the last axis.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import Angles, Directions
from axffit.numerics import normalize, safe_atan2, safe_norm, safe_sqrt

NORMAL = (0.0, 0.0, 1.0)
"""The surface normal in its own tangent frame."""


def dot(a: Directions, b: Directions) -> Angles:
    """Inner product along the last axis."""
    return jnp.sum(a * b, axis=-1)


def spherical_to_direction(theta: Angles, phi: Angles) -> Directions:
    """Unit vector of polar angle ``theta`` and azimuth ``phi`` (radians)."""
    sine = jnp.sin(theta)
    return jnp.stack(jnp.broadcast_arrays(sine * jnp.cos(phi), sine * jnp.sin(phi), jnp.cos(theta)), axis=-1)


def direction_to_spherical(v: Directions) -> tuple[Angles, Angles]:
    """Polar angle in [0, pi] and azimuth in (-pi, pi] of ``v``; the azimuth of the pole is 0."""
    return safe_atan2(safe_norm(v[..., :2]), v[..., 2]), safe_atan2(v[..., 1], v[..., 0])


def _half_vector_frame(theta_h: Angles, phi_h: Angles) -> tuple[Directions, Directions, Directions]:
    """Axes x, y and h of the frame that turning n to h (by theta_h in the plane of azimuth phi_h) produces."""
    ct, st, cp, sp = jnp.cos(theta_h), jnp.sin(theta_h), jnp.cos(phi_h), jnp.sin(phi_h)
    x = jnp.stack([ct * cp, ct * sp, -st], axis=-1)
    y = jnp.stack([-sp, cp, jnp.zeros_like(cp)], axis=-1)
    h = jnp.stack([st * cp, st * sp, ct], axis=-1)
    return x, y, h


def half_difference_to_directions(
    theta_h: Angles, theta_d: Angles, phi_d: Angles, phi_h: Angles | None = None
) -> tuple[Directions, Directions]:
    """Directions (wi, wo) of Rusinkiewicz's half/difference angles (radians); ``phi_h`` defaults to 0.

    wi = sin theta_d (cos phi_d x + sin phi_d y) + cos theta_d h, and wo the same with phi_d + pi.
    """
    phi_h = jnp.zeros_like(theta_h) if phi_h is None else phi_h
    theta_h, theta_d, phi_d, phi_h = jnp.broadcast_arrays(theta_h, theta_d, phi_d, phi_h)
    x, y, h = _half_vector_frame(theta_h, phi_h)
    difference = jnp.sin(theta_d)[..., None] * (jnp.cos(phi_d)[..., None] * x + jnp.sin(phi_d)[..., None] * y)
    along = jnp.cos(theta_d)[..., None] * h
    return along + difference, along - difference


def directions_to_half_difference(wi: Directions, wo: Directions) -> tuple[Angles, Angles, Angles, Angles]:
    """Half/difference angles (theta_h, theta_d, phi_d, phi_h) of a pair of directions (radians).

    theta_d = atan2(|wi - wo|, |wi + wo|) keeps full precision at 0 and at pi/2, where an arc cosine loses half of
    the digits. Azimuths that have no meaning (phi_h at h = n, phi_d at wi = wo) are 0.
    """
    half, difference = wi + wo, wi - wo
    theta_h = safe_atan2(safe_norm(half[..., :2]), half[..., 2])
    phi_h = safe_atan2(half[..., 1], half[..., 0])
    theta_d = safe_atan2(safe_norm(difference), safe_norm(half))
    x, y, _ = _half_vector_frame(theta_h, phi_h)
    phi_d = safe_atan2(dot(difference, y), dot(difference, x))
    return theta_h, theta_d, phi_d, phi_h


def rotate_tangent(v: Directions, rotation: Angles) -> Directions:
    """Components of ``v`` in the frame whose x axis is (cos g, sin g, 0), g = ``rotation`` (radians)."""
    cosine, sine = jnp.cos(rotation), jnp.sin(rotation)
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    return jnp.stack(jnp.broadcast_arrays(cosine * x + sine * y, cosine * y - sine * x, z), axis=-1)


def tangent_frame(normal: Directions, rotation: Angles | None = None) -> Float[Array, "... 3 3"]:
    """Orthonormal frame of a shading normal: rows tangent, bitangent and normal.

    The frame is the smallest rotation that takes (0, 0, 1) to ``normal``, then the tangent plane is turned by
    ``rotation`` (radians). Unlike orthogonalizing the surface's tangent against the normal it is singular only at
    (0, 0, -1), which no shading normal reaches; for the small tilts of normal maps the two agree to second order.
    ``normal`` need not have unit length; the zero vector counts as (0, 0, 1).
    """
    n = normalize(normal)
    x, y, z = n[..., 0], n[..., 1], n[..., 2]
    below = z <= -1.0
    k = 1.0 / jnp.where(below, 1.0, 1.0 + z)
    tangent = jnp.stack([1.0 - x * x * k, -x * y * k, -x], axis=-1)
    bitangent = jnp.stack([-x * y * k, 1.0 - y * y * k, -y], axis=-1)
    if rotation is not None:
        cosine, sine = jnp.cos(rotation)[..., None], jnp.sin(rotation)[..., None]
        tangent, bitangent = cosine * tangent + sine * bitangent, cosine * bitangent - sine * tangent
    return jnp.stack([tangent, bitangent, n], axis=-2)


def to_local(frame: Float[Array, "... 3 3"], v: Directions) -> Directions:
    """Components of ``v`` in ``frame`` (rows are the frame's axes)."""
    return jnp.sum(frame * v[..., None, :], axis=-1)


def to_world(frame: Float[Array, "... 3 3"], v: Directions) -> Directions:
    """Inverse of :func:`to_local`."""
    return jnp.sum(frame * v[..., :, None], axis=-2)


def reflect(v: Directions, normal: Directions) -> Directions:
    """Mirror image of ``v`` about the unit ``normal``: 2 <v, n> n - v."""
    return 2.0 * dot(v, normal)[..., None] * normal - v


def refract(v: Directions, normal: Directions, ior: Angles) -> Directions:
    """Direction inside a medium of index ``ior``, pointing away from the surface on ``v``'s own side.

    Snell: the part of ``v`` along the surface shrinks to t / n, and the cosine c with ``normal`` becomes
    sqrt(n² - 1 + c²) / n, which at n = 1 is c to the last digit. Where ``ior`` < 1 reflects totally the cosine is 0.
    """
    cosine, ior = dot(v, normal)[..., None], ior[..., None]
    cosine_inside = safe_sqrt((ior - 1.0) * (ior + 1.0) + cosine * cosine) / ior
    return (v - cosine * normal) / ior + cosine_inside * normal
