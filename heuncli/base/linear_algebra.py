"""Null spaces and least squares by singular values, each with the threshold below which a value counts as zero."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def count_rank(sizes: Array, tolerance: float = tolerances.RANK, *, min_scale: float = 1.0) -> int:
    """Count the singular values, the largest first, that exceed a tolerance relative to the largest of them, or to
    `min_scale` if that is larger: 1 for a matrix whose rows have lengths of about 1.
    """
    return int(np.count_nonzero(sizes > tolerance * max(min_scale, float(sizes[0])))) if len(sizes) else 0


def compute_null_space(A: Array, tolerance: float = tolerances.RANK, *, min_scale: float = 1.0) -> Array:
    """Return the null space of A (m, n), orthonormal columns (n, n - rank); tolerance, min_scale: of `count_rank`."""
    _, sizes, Vt = np.linalg.svd(A, full_matrices=True)
    return Vt[count_rank(sizes, tolerance, min_scale=min_scale) :].T


def split_null_space(A: Array, rounding: float) -> tuple[Array, Array]:
    """Return orthonormal bases of the null space of A, and of its complement.

    rounding: absolute; singular values up to it count as zero
    """
    _, sizes, Vt = np.linalg.svd(A, full_matrices=True)
    rank = int(np.count_nonzero(sizes > rounding))
    return Vt[rank:].T, Vt[:rank].T


def solve_least_squares(A: Array, b: Array, tolerance: float | None = None) -> Array:
    """Return the shortest x of least |A x - b|; b (m,) or (m, k).

    tolerance: relative to the largest singular value of A; without one that of a matrix known to all its digits,
    NO_SINGULAR_VALUE times its longer side
    """
    rcond = tolerances.NO_SINGULAR_VALUE * max(A.shape) if tolerance is None else tolerance
    return np.asarray(np.linalg.lstsq(A, b, rcond=rcond)[0])


def solve_with_null_space(A: Array, b: Array) -> tuple[Array, Array, Array]:
    """Return the shortest x of least |A x - b|, the null space of A (n, n - rank), and b - A x; rows of lengths about
    1, whose rank is decided by RANK.
    """
    if not A.size:
        return np.zeros(A.shape[1]), np.eye(A.shape[1]), b
    U, sizes, Vt = np.linalg.svd(A, full_matrices=A.shape[0] < A.shape[1])
    rank = count_rank(sizes)
    x = Vt[:rank].T @ ((U[:, :rank].T @ b) / sizes[:rank])
    return x, Vt[rank:].T, b - A @ x
