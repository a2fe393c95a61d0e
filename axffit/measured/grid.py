"""The reference grid on which analytic and neural BRDFs are sampled, and metrics are comparable across materials."""

from typing import NamedTuple

import jax
import numpy as np

from axffit.frames import half_difference_to_directions

THETA_H_COUNT, THETA_D_COUNT, PHI_D_COUNT = 60, 45, 36


class HalfDifferenceGrid(NamedTuple):
    """Cells of a half/difference grid whose directions are both above the horizon.

    ``wi``, ``wo`` (N, 3) at phi_h = 0; ``weights`` (N,), the solid angles of both directions, summing to 1;
    ``theta_h``, ``theta_d``, ``phi_d`` (N,), radians; ``index`` (N,), the cells' places in the whole grid of
    [theta_h, theta_d, phi_d], cells below the horizon counted.
    """

    wi: np.ndarray
    wo: np.ndarray
    weights: np.ndarray
    theta_h: np.ndarray
    theta_d: np.ndarray
    phi_d: np.ndarray
    index: np.ndarray


def reference_grid(
    theta_h_count: int = THETA_H_COUNT, theta_d_count: int = THETA_D_COUNT, phi_d_count: int = PHI_D_COUNT
) -> HalfDifferenceGrid:
    """The grid of the project's metrics, or a coarser one of the same law.

    theta_h = (pi/2) ((k + 1/2) / 60)², dense at the highlight; theta_d and phi_d at the centers of 45 and 36 cells of
    [0, pi/2] and [0, pi]. Weight sin theta_h · sqrt(theta_h) · sin theta_d cos theta_d: the element of both solid
    angles, sqrt(theta_h) being the spacing of the rows.
    """
    theta_h = (np.pi / 2) * ((np.arange(theta_h_count) + 0.5) / theta_h_count) ** 2
    theta_d = (np.pi / 2) * (np.arange(theta_d_count) + 0.5) / theta_d_count
    phi_d = np.pi * (np.arange(phi_d_count) + 0.5) / phi_d_count
    theta_h, theta_d, phi_d = (a.ravel() for a in np.meshgrid(theta_h, theta_d, phi_d, indexing="ij"))
    weights = np.sin(theta_h) * np.sqrt(theta_h) * np.sin(theta_d) * np.cos(theta_d)
    with jax.enable_x64(new_val=True):
        angles = (jax.numpy.asarray(angle) for angle in (theta_h, theta_d, phi_d))
        wi, wo = (np.array(v) for v in half_difference_to_directions(*angles))
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    kept = [array[above] for array in (wi, wo, weights, theta_h, theta_d, phi_d)]
    kept[2] = kept[2] / kept[2].sum()
    return HalfDifferenceGrid(*kept, index=np.flatnonzero(above))
