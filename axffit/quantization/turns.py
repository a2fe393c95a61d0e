"""How far packing turned a texel: angles between directions, and a frame's turn split at its normal. NumPy float64."""

import jax
import jax.numpy as jnp
import numpy as np

from ..frames import tangent_frame


def frames_of(normal: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """`frames.tangent_frame` of normals (n, 3) and rotations (n,): (n, 3, 3), the axes as rows."""
    with jax.enable_x64(new_val=True):
        return np.asarray(tangent_frame(jnp.asarray(normal), jnp.asarray(rotation)))


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) at length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles between unit vectors (n, 3); atan2 keeps the digits of small ones."""
    return 2.0 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))


def polar(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polar angle and azimuth of vectors (n, 3)."""
    return np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2]), np.arctan2(v[:, 1], v[:, 0])


def swing_and_twist(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the smallest rotation between the normals, and of the turn about the normal that comes before it.

    Frames (n, 3, 3) with the axes as rows. Of the quaternion of the rotation, the turn about z is (w, 0, 0, z).
    """
    turn = np.einsum("nik,njk->nij", before, after)
    twist = 2.0 * np.arctan2(turn[:, 1, 0] - turn[:, 0, 1], 1.0 + np.trace(turn, axis1=1, axis2=2))
    return angle(before[:, 2], after[:, 2]), np.abs(twist)


def roomy(angles: np.ndarray) -> np.ndarray:
    """Angles with room for their own rounding."""
    return angles * (1 + 2.0**-40) + 2.0**-48
