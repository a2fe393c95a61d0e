"""Sampling consistency: whether ``sample`` draws what ``pdf`` says, cheaply.

A small histogram that follows the lobe: an ellipse of eight sectors is laid where the first quarter of the draws is
densest, the rest is counted in the sectors, and the density is integrated over them by quadrature. That suits any lobe,
however narrow, and notices a density that is wrong by a tenth where most draws fall; the project's own tests look
everywhere.
"""

import numpy as np

from axffit.brdf import AbstractBRDF
from axffit.brdf.sampling import DOWN
from axffit.testing.batches import Rays, pdf, sample, viewers
from axffit.testing.failures import vector

MOST_VIEWERS = 4

_SECTORS = 8
_LARGEST_CHI_SQUARE = 46.0
"""Of eight sectors and what lies outside them: false-alarm rate 2.4e-7 a viewer (eight degrees of freedom)."""

_RADII, _ANGLES = 12, 6
"""Of the finer quadrature rule in a sector; the coarser one has half of each."""

_FEWEST = 8
"""Draws that lay an ellipse. Fewer carry light where nearly all are hidden, below a tilted normal's horizon."""

_WIDEST = 0.9
"""The ellipse ends before the rim of the disc into which the hemisphere about its center projects."""


def sampling(brdf: AbstractBRDF, wi: Rays, wo: Rays, *, count: int = 16384, seed: int = 0) -> None:
    """``sample`` and ``pdf`` agree: draws are unit vectors with a density, or (0, 0, -1); their share in a bin fits.

    Args:
        brdf: one BRDF.
        wi: not used; laws are all called alike.
        wo: viewers; at most 4 of those above the horizon are used.
        count: draws a viewer.
        seed: of the draws.
    """
    for o in viewers(wo, MOST_VIEWERS):
        u = np.random.default_rng(seed).random((count, 3)).astype(o.dtype)
        viewer = np.broadcast_to(o, (count, 3))
        draws = sample(brdf, viewer, u)
        density = pdf(brdf, draws, viewer)
        _check_draws(draws, density, o)
        _check_share(brdf, draws.astype(np.float64), density, o)


def _check_draws(draws: np.ndarray, density: np.ndarray, wo: np.ndarray) -> None:
    tolerance = 1e-9 if draws.dtype == np.float64 else 1e-5
    lit = draws[:, 2] > 0
    down = (draws == np.asarray(DOWN)).all(axis=1)
    for wrong, what in (
        (~(np.abs(np.linalg.norm(draws, axis=1) - 1) <= tolerance), "is no unit vector"),
        (~np.isfinite(density), "has a density that is not finite"),
        (lit & ~(density > 0), "has no density although it was drawn"),
        (~lit & ~down, "lies below the horizon and is not (0, 0, -1)"),
        (~lit & (density != 0), "carries no light but has a density"),
    ):
        if wrong.any():
            k = int(np.argmax(wrong))
            raise AssertionError(
                f"sampling: the draw wi = {vector(draws[k])} (density {density[k]:g}/sr) for wo = {vector(wo)} "
                f"{what}; so are {np.count_nonzero(wrong)} of {len(wrong)}"
            )


def _check_share(brdf: AbstractBRDF, draws: np.ndarray, density: np.ndarray, wo: np.ndarray) -> None:
    quarter = len(draws) // 4
    first, dense, rest = draws[:quarter], density[:quarter], draws[quarter:]
    # The densest quarter of the quarter lays the ellipse; all that carry light if they are fewer.
    used = first[(dense >= np.quantile(dense, 0.75)) & (dense > 0)]
    if len(used) < _FEWEST:
        return
    frame = _frame(used.mean(axis=0))
    flat = (used @ frame.T)[:, :2]
    middle = flat.mean(axis=0)
    # The floor keeps the ellipse of coinciding draws from vanishing; it is far below any lobe.
    floor = 1e-26 if density.dtype == np.float64 else 1e-12
    values, axes = np.linalg.eigh(np.cov(flat.T, ddof=0) + floor * np.eye(2))
    axes = axes * np.sqrt(values) * min(1.5, (_WIDEST - np.linalg.norm(middle)) / np.sqrt(values[1]))
    counted = _counts(rest, frame, middle, axes)
    fine, coarse = (_integrals(brdf, wo, frame, middle, axes, fineness) for fineness in (2, 1))
    if not np.isfinite(fine).all():
        raise AssertionError(f"sampling: pdf is not finite near its own draws for wo = {vector(wo)}")
    # Last, what lies outside. The difference of the rules bounds the error of the finer one.
    expected = np.append(fine, max(1.0 - fine.sum(), 0.0)) * len(rest)
    slack = 2 * np.append(np.abs(fine - coarse), np.abs(fine - coarse).sum()) * len(rest)
    surplus = np.maximum(np.abs(np.append(counted, len(rest) - counted.sum()) - expected) - slack, 0)
    chi_square = float(np.sum(surplus**2 / np.maximum(expected, 5.0)))
    if chi_square > _LARGEST_CHI_SQUARE:
        shares = (", ".join(f"{share:.4f}" for share in v) for v in (counted / len(rest), fine))
        raise AssertionError(
            "sampling: in eight sectors about wi = {}, for wo = {}, lie {} of the draws where pdf says {} "
            "(chi square {:.1f}, allowed {:.1f})".format(
                vector(used.mean(axis=0)), vector(wo), *shares, chi_square, _LARGEST_CHI_SQUARE
            )
        )


def _counts(draws: np.ndarray, frame, middle, axes) -> np.ndarray:
    """Number of draws that carry light in each sector of the ellipse."""
    local = draws @ frame.T
    x, y = np.linalg.solve(axes, (local[:, :2] - middle).T)
    inside = (x * x + y * y <= 1) & (local[:, 2] > 0) & (draws[:, 2] > 0)
    sector = np.floor(np.arctan2(y, x) / (2 * np.pi) * _SECTORS).astype(int) % _SECTORS
    return np.bincount(sector[inside], minlength=_SECTORS)


def _frame(center: np.ndarray) -> np.ndarray:
    """Orthonormal rows, the last of them along ``center``, which is above the horizon."""
    z = center / np.linalg.norm(center)
    x = np.array([z[2], 0.0, -z[0]]) / np.hypot(z[0], z[2])
    return np.stack([x, np.cross(z, x), z])


def _integrals(brdf: AbstractBRDF, wo: np.ndarray, frame, middle, axes, fineness: int) -> np.ndarray:
    """Integral of the density over each sector: Gauss-Legendre in the squared radius and in the angle.

    A point of the disc that the directions about the center project into stands for dp dq / cos of solid angle, cos
    being taken from the center.
    """
    radii, radial = np.polynomial.legendre.leggauss(fineness * _RADII // 2)
    angles, angular = np.polynomial.legendre.leggauss(fineness * _ANGLES // 2)
    rho = np.sqrt(0.5 * (radii + 1))
    angle = (np.arange(_SECTORS)[:, None] + 0.5 * (angles + 1)) * (2 * np.pi / _SECTORS)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    unit = (circle[:, :, None, :] * rho[:, None]).reshape(-1, 2)
    flat = middle + unit @ axes.T
    cosine = np.sqrt(np.maximum(1 - np.sum(flat * flat, axis=1), 1e-3))
    wi = (np.concatenate([flat, cosine[:, None]], axis=1) @ frame).astype(wo.dtype)
    density = pdf(brdf, wi, np.broadcast_to(wo, wi.shape)).astype(np.float64) / cosine
    each = 0.25 * np.outer(angular, radial).ravel() * np.pi / _SECTORS
    return abs(np.linalg.det(axes)) * (density.reshape(_SECTORS, -1) @ each)
