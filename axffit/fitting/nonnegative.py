"""Small non-negative quadratic programs, solved exactly by looking at every face.

    minimize  c^T H c / 2 - b^T c   subject to  c >= 0

for n <= 10 unknowns. The solution is the stationary point of one of the 2^n faces {c_j = 0 for j not in P}; all are
solved at once. No iteration, no active-set bookkeeping, works under ``jit`` and ``vmap``.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

MAX_UNKNOWNS = 10
_RIDGE = 1e-13
_FEASIBLE = 1e-12


def faces(n: int) -> np.ndarray:
    """All 2^n subsets of n unknowns, (2^n, n) bool."""
    if not 1 <= n <= MAX_UNKNOWNS:
        raise ValueError(f"{n} linear parameters: 1 to {MAX_UNKNOWNS} are supported")
    return (np.arange(2**n)[:, None] >> np.arange(n)[None, :] & 1).astype(bool)


def solve_on_face(hessian: Float[Array, "n n"], b: Float[Array, " n"], face: Bool[Array, " n"]) -> Float[Array, " n"]:
    """Stationary point with c_j = 0 off ``face``; NaN where the face's Hessian is not positive definite.

    The unknowns are scaled to a unit diagonal first, so columns of very different size do no harm.
    """
    diagonal = jnp.diagonal(hessian)
    used = face & (diagonal > 0)
    scale = jnp.where(used, jax.lax.rsqrt(jnp.where(used, diagonal, 1.0)), 0.0)
    scaled = hessian * scale[:, None] * scale[None, :]
    # Unused rows become those of the identity; the ridge decides between exactly collinear columns.
    scaled = scaled + jnp.diag(jnp.where(used, _RIDGE, 1.0))
    factor = jnp.linalg.cholesky(scaled)
    half = jax.scipy.linalg.solve_triangular(factor, b * scale, lower=True)
    return scale * jax.scipy.linalg.solve_triangular(factor, half, lower=True, trans=1)


def solve_nonnegative(hessian: Float[Array, "n n"], b: Float[Array, " n"]) -> Float[Array, " n"]:
    """The minimizer c >= 0; components that the data leave at the bound are exactly 0."""
    all_faces = jnp.asarray(faces(len(b)))
    candidates = jax.vmap(solve_on_face, in_axes=(None, None, 0))(hessian, b, all_faces)
    size = jnp.sqrt(jnp.maximum(jnp.diagonal(hessian), 0.0))
    scaled = candidates * size[None, :]
    tolerance = _FEASIBLE * jnp.max(jnp.abs(scaled), axis=1, keepdims=True)
    feasible = jnp.all(jnp.isfinite(candidates), axis=1) & jnp.all(scaled >= -tolerance, axis=1)
    objective = 0.5 * jnp.einsum("fi,ij,fj->f", candidates, hessian, candidates) - candidates @ b
    objective = jnp.where(feasible, objective, jnp.inf)
    return jnp.maximum(candidates[jnp.argmin(objective)], 0.0)
