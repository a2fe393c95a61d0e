"""Linear algebra of small matrices, one a lane: an entry is an array over lanes, and all loops are unrolled.

Matrices are symmetric and given as rows of their lower triangle: ``a[i][j]`` for j <= i.
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

Triangle = Sequence[Sequence[Array]]
Vector = Sequence[Array]

_PIVOT = 1e-13
"""A pivot below this share of its diagonal entry is a direction that the data do not determine."""


class Factor(NamedTuple):
    """Cholesky factor L, rows of its lower triangle with the inverse of the diagonal in place of the diagonal.

    ``regular`` holds where every pivot was positive; elsewhere the pivot's row and column count as those of the
    identity with a right-hand side of 0.
    """

    rows: list[list[Array]]
    keep: list[Array]
    regular: Array


def cholesky(a: Triangle) -> Factor:
    """L of a = L L^T."""
    rows: list[list[Array]] = []
    keep: list[Array] = []
    for i, row in enumerate(a):
        below: list[Array] = []
        for j in range(i):
            total = row[j]
            for k in range(j):
                total = total - below[k] * rows[j][k]
            below.append(total * rows[j][j])
        pivot = row[i]
        for k in range(i):
            pivot = pivot - below[k] * below[k]
        good = pivot > _PIVOT * row[i]
        keep.append(good)
        inverse = jax.lax.rsqrt(jnp.where(good, pivot, 1.0))
        rows.append([jnp.where(good, entry, 0.0) for entry in below] + [inverse])
    regular = keep[0]
    for good in keep[1:]:
        regular = regular & good
    return Factor(rows, keep, regular)


def half_solve(factor: Factor, b: Vector) -> list[Array]:
    """L^-1 b, 0 where a pivot was none."""
    y: list[Array] = []
    for i, row in enumerate(factor.rows):
        total = b[i]
        for k in range(i):
            total = total - row[k] * y[k]
        y.append(jnp.where(factor.keep[i], total * row[i], 0.0))
    return y


def back_solve(factor: Factor, y: Vector) -> list[Array]:
    """L^-T y."""
    n = len(factor.rows)
    x: list[Array] = [y[0]] * n
    for i in reversed(range(n)):
        total = y[i]
        for k in range(i + 1, n):
            total = total - factor.rows[k][i] * x[k]
        x[i] = total * factor.rows[i][i]
    return x


def solve(factor: Factor, b: Vector) -> list[Array]:
    """a^-1 b."""
    return back_solve(factor, half_solve(factor, b))


def restricted(a: Triangle, used: Vector) -> list[list[Array]]:
    """``a`` with the rows and columns that are not ``used`` (booleans) replaced by those of the identity."""
    return [
        [
            jnp.where(used[i] & used[j], a[i][j], 0.0) if j < i else jnp.where(used[i], a[i][i], 1.0)
            for j in range(i + 1)
        ]
        for i in range(len(a))
    ]


def solve_nonnegative(a: Triangle, b: Vector) -> list[Array]:
    """argmin x^T a x / 2 - b^T x over x >= 0, exact: the best feasible stationary point of the 2^n - 1 faces.

    A face whose matrix is singular is left to the smaller ones. As
    :func:`axffit.fitting.nonnegative.solve_nonnegative`, which holds one matrix; a test compares the two.
    """
    n = len(b)
    faces = (np.arange(1, 2**n)[:, None] >> np.arange(n) & 1).astype(bool)
    shape = (len(faces), *(1,) * b[0].ndim)
    used = [jnp.asarray(faces[:, i].reshape(shape)) for i in range(n)]
    factor = cholesky(restricted([[entry[None] for entry in row] for row in a], used))
    half = half_solve(factor, [jnp.where(used[i], b[i][None], 0.0) for i in range(n)])
    # At a face's stationary point the objective is -|L^-1 b|² / 2.
    gain = sum((value * value for value in half[1:]), half[0] * half[0])
    x = back_solve(factor, half)
    feasible = factor.regular
    for value in x:
        feasible = feasible & (value >= 0)
    gain = jnp.where(feasible, gain, -1.0)
    best = gain[0]
    chosen = [jnp.where(best > 0, value[0], 0.0) for value in x]
    best = jnp.maximum(best, 0.0)
    for face in range(1, len(faces)):
        better = gain[face] > best
        best = jnp.where(better, gain[face], best)
        chosen = [jnp.where(better, value[face], old) for value, old in zip(x, chosen, strict=True)]
    return chosen
