"""From solutions to AxF's maps and their standard errors.

The full problem's covariance in blocks, with H, A = Phi^T W Phi and B = Phi^T W J of
:mod:`axffit.fitting.texels.problem`:

    cov theta = H^-1,   cov(x_c, theta) = -A_c^-1 B_c H^-1,   cov x_c = A_c^-1 + A_c^-1 B_c H^-1 B_c^T A_c^-1

What AxF stores are functions of (theta, x): their errors are by linearization. A value has no standard error (NaN)
where the data do not determine it: at a bound, of a lobe of zero weight, the rotation of a lobe that is round within
three standard errors, an F0 whose 99.9 % range spans half of [0, 1]. The others are then given that it is fixed.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from axffit.fitting.texels.batch import Outcome, TexelFit
from axffit.fitting.texels.problem import HIGHEST_LOG_ROUGHNESS, LOWEST_LOG_ROUGHNESS, TexelModel

_NULL = 1e-11
"""An eigenvalue of a scaled information matrix below it is a direction that the data do not determine."""

_ROUND = 3.0
_F0_RANGE = 0.5 / (2.0 * 3.29)


class Map(NamedTuple):
    """Values and standard errors, (channels, texels) each, float64."""

    values: Float[np.ndarray, "channels texels"]
    errors: Float[np.ndarray, "channels texels"]


def layout(model: TexelModel, channels: int) -> Mapping[str, int]:
    """AxF's names of the maps that a model gives, and their channels."""
    shapes = {"diffusecolor": channels, "specularcolor": channels, "specularlobe": 1 + model.anisotropic}
    if model.anisotropic:
        shapes["anisrotation"] = 1
    if model.normal:
        shapes["normal"] = 3
    if model.fresnel:
        shapes["fresnel"] = channels
    return shapes


def _inverse(
    matrices: Float[np.ndarray, "... n n"], used: np.ndarray
) -> tuple[Float[np.ndarray, "... n n"], np.ndarray]:
    """Inverses over the ``used`` rows (..., n), others 0; and where they exist."""
    n = matrices.shape[-1]
    both = used[..., :, None] & used[..., None, :]
    diagonal = np.diagonal(matrices, axis1=-2, axis2=-1)
    scale = 1.0 / np.sqrt(np.where(used, diagonal, 1.0))
    scaled = np.where(both, matrices * scale[..., :, None] * scale[..., None, :], np.eye(n))
    regular = np.linalg.eigvalsh(scaled)[..., 0] > _NULL
    inverse = np.linalg.inv(np.where(regular[..., None, None], scaled, np.eye(n)))
    return np.where(both, inverse * scale[..., :, None] * scale[..., None, :], 0.0), regular


def _full(rows: Float[np.ndarray, "*batch packed texels"], n: int) -> Float[np.ndarray, "*batch texels n n"]:
    """Symmetric matrices of their packed lower triangles."""
    full = np.empty((*rows.shape[:-2], rows.shape[-1], n, n))
    for i in range(n):
        for j in range(i + 1):
            full[..., i, j] = full[..., j, i] = rows[..., i * (i + 1) // 2 + j, :]
    return full


class _Covariance(NamedTuple):
    """Of theta (t, p, p), of x (c, t, k, k), and their inverses' existence by texel."""

    theta: np.ndarray
    weights: np.ndarray
    free: np.ndarray
    used: np.ndarray


def _covariance(model: TexelModel, fit: TexelFit, scale: np.ndarray) -> _Covariance:
    hessian = _full(fit.hessian, model.shapes)
    free = (np.diagonal(hessian, axis1=-2, axis2=-1) > 0.0).copy()
    free[:, 0] &= (fit.theta[0] > LOWEST_LOG_ROUGHNESS) & (fit.theta[0] < HIGHEST_LOG_ROUGHNESS)
    of_theta, regular = _inverse(hessian, free)
    used = np.moveaxis(fit.weights > 0.0, 1, -1)
    inverse, determined = _inverse(_full(fit.gram, model.weights), used)
    towards = inverse @ np.moveaxis(fit.mixed, -1, 1)
    of_weights = inverse + towards @ of_theta @ np.swapaxes(towards, -1, -2)
    good = regular & np.all(determined, axis=0) & (fit.outcome <= Outcome.FINISHED)
    return _Covariance(
        of_theta * scale[:, None, None], of_weights * scale[:, None, None], free & good[:, None], used & good[:, None]
    )


def _error(gradient: np.ndarray, covariance: np.ndarray, known: np.ndarray) -> np.ndarray:
    variance = np.einsum("...i,...ij,...j->...", gradient, covariance, gradient)
    return np.where(known, np.sqrt(np.maximum(variance, 0.0)), np.nan)


def reduced_chi_square(model: TexelModel, fit: TexelFit, precisions: Float[np.ndarray, "c n texels"]) -> np.ndarray:
    """Sum of squares over degrees of freedom of each texel, parameters at 0 not counted; NaN where none are left."""
    count = np.count_nonzero(precisions > 0, axis=(0, 1))
    freedom = count - model.shapes - np.count_nonzero(fit.weights > 0, axis=(0, 1))
    return np.where(freedom > 0, 2.0 * fit.cost / np.maximum(freedom, 1), np.nan)


def maps_of(
    model: TexelModel, fit: TexelFit, noise_scale: Float[np.ndarray, " texels"] | None = None
) -> dict[str, Map]:
    """The maps of AxF by their names, with standard errors.

    Args:
        model: what was fitted.
        fit: its solutions.
        noise_scale: what the noise variance is to be multiplied by, such as the reduced chi-square where only the
            noise's shape is known; None takes the noise as stated.
    """
    texels = fit.outcome.size
    covariance = _covariance(model, fit, np.ones(texels) if noise_scale is None else noise_scale)
    maps = _colors(model, fit, covariance) | _lobes(model, fit, covariance)
    if model.normal:
        maps["normal"] = _normals(fit, covariance)
    nothing = fit.outcome == Outcome.TOO_FEW_SAMPLES
    for name, map_ in maps.items():
        blank = np.array([[0.0], [0.0], [1.0]]) if name == "normal" else 0.0
        maps[name] = Map(np.where(nothing, blank, map_.values), map_.errors)
    return {name: maps[name] for name in layout(model, len(fit.weights))}


def _colors(model: TexelModel, fit: TexelFit, covariance: _Covariance) -> dict[str, Map]:
    weights, used = np.moveaxis(fit.weights, 1, -1), covariance.used
    unit = np.eye(model.weights)

    def one(index: int) -> np.ndarray:
        return _error(unit[index], covariance.weights, used[..., index])

    diffuse = Map(weights[..., 0], one(0))
    if not model.fresnel:
        return {"diffusecolor": diffuse, "specularcolor": Map(weights[..., 1], one(1))}
    p, q = weights[..., 1], weights[..., 2]
    specular = p + q
    safe = np.where(specular > 0, specular, 1.0)
    slope = np.stack([np.zeros_like(p), q / safe**2, -p / safe**2], axis=-1)
    f0_error = _error(slope, covariance.weights, used[..., 1] & used[..., 2])
    f0_error = np.where(f0_error <= _F0_RANGE, f0_error, np.nan)
    total = _error(unit[1] + unit[2], covariance.weights, used[..., 1] | used[..., 2])
    return {
        "diffusecolor": diffuse,
        "specularcolor": Map(specular, total),
        "fresnel": Map(np.where(specular > 0, p / safe, 0.0), f0_error),
    }


def _lobes(model: TexelModel, fit: TexelFit, covariance: _Covariance) -> dict[str, Map]:
    theta, known = fit.theta, covariance.free[:, 0]
    if not model.anisotropic:
        alpha = np.exp(theta[0])
        return {
            "specularlobe": Map(alpha[None], (alpha * _error(np.ones(1), covariance.theta[:, :1, :1], known))[None])
        }
    e1, e2 = theta[1], theta[2]
    stretch = np.hypot(e1, e2)
    safe = np.where(stretch > 0, stretch, 1.0)
    # Of a round lobe any direction is the long one.
    along = np.where(stretch > 0, np.stack([e1, e2]) / safe, np.array([[1.0], [0.0]]))
    own, known = covariance.theta[:, :3, :3], known & covariance.free[:, 1] & covariance.free[:, 2]
    values, errors = [], []
    for sign in (1.0, -1.0):
        alpha = np.exp(theta[0] + sign * stretch)
        gradient = np.stack([np.ones_like(stretch), sign * along[0], sign * along[1]], axis=-1)
        # AxF's map ends at 1: beyond it a lobe is not told from a wider one.
        values.append(np.minimum(alpha, 1.0))
        errors.append(np.where(alpha <= 1.0, alpha * _error(gradient, own, known), np.nan))
    zero = np.zeros_like(stretch)
    radial = _error(np.stack([zero, along[0], along[1]], axis=-1), own, known)
    turn = np.stack([zero, -along[1], along[0]], axis=-1) / (2.0 * safe)[:, None]
    rotation_error = _error(turn, own, known & (stretch > _ROUND * np.where(known, radial, np.inf)))
    rotation = 0.5 * np.arctan2(e2, e1)
    return {
        "specularlobe": Map(np.stack(values), np.stack(errors)),
        "anisrotation": Map(rotation[None], rotation_error[None]),
    }


def _normals(fit: TexelFit, covariance: _Covariance) -> Map:
    """n = (x, y, 1) / l, l² = 1 + x² + y²; dn = (d(x, y, 1) - n <n, d(x, y, 1)>) / l."""
    x, y = fit.theta[-2:]
    length = np.sqrt(1.0 + x * x + y * y)
    normal = np.stack([x, y, np.ones_like(x)]) / length
    known = covariance.free[:, -1] & covariance.free[:, -2]
    own = covariance.theta[:, -2:, -2:]
    errors = []
    for component in range(3):
        gradient = np.stack(
            [(float(component == k) - normal[component] * normal[k]) / length for k in range(2)], axis=-1
        )
        errors.append(_error(gradient, own, known))
    return Map(normal, np.stack(errors))
