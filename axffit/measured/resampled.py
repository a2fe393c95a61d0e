"""Any samples as a BRDF that can be evaluated anywhere, for pictures and plots: the nearest sample on a grid of angles.

Directions are compared as points (h, d) with the light and viewer's half and difference vector, phi_h = 0 where the
samples are isotropic, and d or -d, whichever is nearer (reciprocity). No fit and no smoothing: what was not measured
shows the nearest measured value.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.spatial import KDTree

from axffit._types import RGB, Direction
from axffit.brdf.base import as_parameter
from axffit.errors import InputError
from axffit.frames import directions_to_half_difference
from axffit.measured.color import to_rgb
from axffit.measured.evaluated import AbstractMeasuredBRDF
from axffit.measured.grid import PHI_D_COUNT, THETA_D_COUNT, THETA_H_COUNT
from axffit.measured.measurements import Measurements


class ResampledTable(AbstractMeasuredBRDF):
    """f over theta_h (dense at 0), theta_d and phi_d in [0, pi], trilinear between cell centers.

    ``values`` (theta_h, theta_d, phi_d, 3), linear RGB, 1/sr, at theta_h = (pi/2) ((k + 1/2) / n)² and the centers of
    even cells of the other two.
    """

    values: Float[Array, "theta_h theta_d phi_d 3"] = eqx.field(converter=as_parameter)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The interpolated value; phi_d is folded into [0, pi)."""
        theta_h, theta_d, phi_d, _ = directions_to_half_difference(wi, wo)
        phi_d = jnp.where(phi_d < 0, phi_d + jnp.pi, phi_d)
        units = (jnp.sqrt(2.0 * theta_h / jnp.pi), 2.0 * theta_d / jnp.pi, phi_d / jnp.pi)
        position = jnp.stack([unit * size - 0.5 for unit, size in zip(units, self.values.shape[:3], strict=True)])
        channels = jnp.moveaxis(self.values, -1, 0)
        return jax.vmap(
            lambda table: jax.scipy.ndimage.map_coordinates(table, list(position), order=1, mode="nearest")
        )(channels)


def resampled(measurements: Measurements) -> ResampledTable:
    """The valid samples as a table of half and difference angles, negatives at 0; samples count as isotropic.

    Raises:
        InputError: no sample is valid, or spectra cannot be converted.
    """
    samples = to_rgb(measurements)
    valid = np.flatnonzero(samples.valid)
    if not len(valid):
        raise InputError(f"{samples.name or 'samples'}: none of {len(samples)} samples is valid; nothing to show")
    with jax.enable_x64(new_val=True):
        angles = directions_to_half_difference(jnp.asarray(samples.wi[valid]), jnp.asarray(samples.wo[valid]))
        theta_h, theta_d, phi_d, _ = (np.asarray(angle) for angle in angles)
    points = _points(theta_h, theta_d, phi_d)
    # Both d and -d, since f is reciprocal.
    tree = KDTree(np.concatenate([points, points * [1, 1, -1, -1, 1]]))
    counts = THETA_H_COUNT, THETA_D_COUNT, PHI_D_COUNT
    unit = [(np.arange(count) + 0.5) / count for count in counts]
    grid = np.meshgrid(0.5 * np.pi * unit[0] ** 2, 0.5 * np.pi * unit[1], np.pi * unit[2], indexing="ij")
    _, nearest = tree.query(_points(*(angle.ravel() for angle in grid)))
    values = np.maximum(samples.values[valid][nearest % len(valid)], 0.0)
    with jax.enable_x64(new_val=True):
        return ResampledTable(values.reshape(*counts, 3))


def _points(theta_h: np.ndarray, theta_d: np.ndarray, phi_d: np.ndarray) -> np.ndarray:
    """Points (N, 5) whose distance is small where lobes look alike: sqrt(theta_h) spreads the highlight."""
    spread = np.sqrt(theta_h)
    return np.stack(
        [
            2.0 * spread,
            theta_h,
            np.sin(theta_d) * np.cos(phi_d),
            np.sin(theta_d) * np.sin(phi_d),
            np.cos(theta_d),
        ],
        axis=1,
    )
