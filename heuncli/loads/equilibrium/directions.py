"""Decompose a matrix by its eigenvectors, with nearly parallel ones together in one block.

    A = X diag(lambda_1 ... lambda_g, B) X^-1

Where forces follow the motion, or a pose is still pushed, eigenvectors may coincide (A is then defective, as [[0, 0],
[k, 0]] for a carriage that carries a level bar). They have no coordinates of their own, and a push would be lost
between them. They share an orthonormal basis instead, in which B is used as a matrix. Orthonormal means by the mass:
about a rest pose under loads with a potential A is symmetric there.
"""

from __future__ import annotations

from math import factorial

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record
from heuncli.results.results import Array, Mask

MAX_EXPONENT = 300.0  # larger exponents count as infinite
SERIES_LIMIT = 1e-8  # below it the series has all digits
TERMS = 12  # of the series of the exponential, below a norm of 1/4: 0.25**13 / 13! is nothing
SUMMATION_LIMIT = 1.0  # below it phi is summed: above, differences keep all but a digit of it
SUM_TERMS = 18  # terms of that sum: 1/18! is nothing
SCALED_NORM = 0.25


@record
class SpectralDecomposition:
    """X (f, f) and its inverse, and the eigenvalues (f,), those of the block B (m, m) last.

    defect: number of directions of the block that coincide with others; the error of its eigenvalues is a root of the
    error of B, of the order defect + 1
    """

    eigenvalues: Array
    X: Array
    inverse: Array
    B: Array
    defect: int

    @property
    def single_count(self) -> int:
        """Number of single directions, which come first."""
        return len(self.eigenvalues) - len(self.B)

    def reassemble(self, is_kept: Mask) -> Array:
        """Return the matrix without the eigenvalues that are not kept; the block counts as one."""
        g = self.single_count
        middle = np.zeros(self.X.shape, dtype=complex)
        middle[range(g), range(g)] = np.where(is_kept[:g], self.eigenvalues[:g], 0.0)
        middle[g:, g:] = self.B if is_kept[g:].any() else 0.0
        return np.asarray((self.X @ middle @ self.inverse).real)

    def integrate(self, h: float, c: Array, order: int = 1) -> Array:
        """Return h phi(h A) c in X's coordinates, (f,), with phi_1(x) = (e^x - 1)/x, phi_k+1(x) = (phi_k(x) - 1/k!)/x.

        For order 1 this is the result of dz/ds = c + A z at s = h; for order k, times (k - 1)!, where c grows as
        (s/h)^(k - 1). Not finite if it grows beyond all numbers.
        """
        g = self.single_count
        with np.errstate(over="ignore", invalid="ignore"):
            x = h * self.eigenvalues[:g]
            x = np.where(x.real > MAX_EXPONENT, MAX_EXPONENT, x)
            single = h * phi(x, order) * c[:g]
        return np.concatenate([single, integrate_block(self.B, h, c[g:].real, order)])

    def solve_compliance(self, c: Array, eigenvalue_errors: Array) -> Array:
        """Return -A^-1 c in X's coordinates, where eigenvalues exceed their errors; for B, by singular values."""
        g = self.single_count
        is_decided = np.abs(self.eigenvalues[:g]) > eigenvalue_errors[:g]
        single = np.where(is_decided, -c[:g] / np.where(is_decided, self.eigenvalues[:g], 1.0), 0.0)
        if not len(self.B):
            return np.asarray(single)
        U, s, V = np.linalg.svd(self.B)
        is_held = s > max(tolerances.NEARLY_DEFECTIVE * s[0], eigenvalue_errors[g:].max())
        components = np.where(is_held, (U.T @ c[g:].real) / np.where(is_held, s, 1.0), 0.0)
        return np.concatenate([single, -(V.T @ components)])


def phi(x: Array, order: int) -> Array:
    """Return phi_k of numbers (n,): phi_1(x) = (e^x - 1)/x, phi_k+1(x) = (phi_k(x) - 1/k!)/x."""
    small = np.abs(x) < SERIES_LIMIT
    value = np.where(small, 1.0 + 0.5 * x, np.expm1(x) / np.where(small, 1.0, x))
    if order == 1:
        return np.asarray(value)
    is_near = np.abs(x) < SUMMATION_LIMIT
    safe, near_values = np.where(is_near, 1.0, x), np.where(is_near, x, 0.0)
    for k in range(1, order):
        value = (value - 1.0 / factorial(k)) / safe
    summed = np.zeros_like(value)
    for j in reversed(range(SUM_TERMS)):
        summed = summed * near_values + 1.0 / factorial(j + order)
    return np.where(is_near, summed, value)


def integrate_block(B: Array, h: float, c: Array, order: int = 1) -> Array:
    """Return h phi(h B) c from the exponential of [[h B, c, 0], [0, 0, 1], [0, 0, 0]] (k rows after B for phi_k).

    By scaling and squaring of its series. Not finite if it grows.
    """
    m = len(B)
    if not c.any():
        return np.zeros(m)
    size = float(np.abs(c).max())
    augmented = np.zeros((m + order, m + order))
    augmented[:m, :m] = h * B
    augmented[:m, m] = c / size
    augmented[range(m, m + order - 1), range(m + 1, m + order)] = 1.0
    norm = float(np.abs(augmented).sum(axis=1).max())
    halvings = max(0, int(np.ceil(np.log2(norm / SCALED_NORM)))) if norm > 0.0 else 0
    power = np.eye(m + order)
    exponential = power.copy()
    for k in range(1, TERMS + 1):
        power = power @ (augmented / 2.0**halvings) / k
        exponential = exponential + power
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(halvings):
            exponential = exponential @ exponential
        return np.asarray(h * size * exponential[:m, m + order - 1])


def decompose(A: Array, mass: Array) -> SpectralDecomposition:
    """Decompose a matrix (f, f); mass (f, f): of the same coordinates, positive semidefinite."""
    f = len(A)
    if not f:
        return SpectralDecomposition(np.zeros(0), A, A, A, 0)
    regularisation = tolerances.NO_INERTIA * float(np.trace(mass))
    L = np.linalg.cholesky(0.5 * (mass + mass.T) + (regularisation if regularisation > 0.0 else 1.0) * np.eye(f))
    S = np.linalg.solve(L, (L.T @ A).T).T  # L' A L'^-1
    eigenvalues, V = np.linalg.eig(S)
    _, sizes, R = np.linalg.svd(V)
    defect = int(np.count_nonzero(sizes <= tolerances.NEARLY_DEFECTIVE))
    if not defect:
        return SpectralDecomposition(eigenvalues, np.linalg.solve(L.T, V), np.linalg.inv(V) @ L.T, np.zeros((0, 0)), 0)
    is_single, Q = separate_eigenvectors(S, eigenvalues, np.abs(R[-defect:]).max(axis=0))
    X = np.hstack([V[:, is_single], Q])
    if np.linalg.svd(X, compute_uv=False)[-1] <= tolerances.NEARLY_DEFECTIVE:
        is_single, X = np.zeros(f, dtype=bool), np.eye(f)  # no direction is clearly separate
    g = int(np.count_nonzero(is_single))
    inverse = np.linalg.inv(X)
    B = (inverse[g:] @ S @ X[:, g:]).real
    values = np.concatenate([eigenvalues[is_single], np.linalg.eigvals(B)])
    return SpectralDecomposition(values, np.linalg.solve(L.T, X), inverse @ L.T, B, defect)


def decompose_with_null_space(
    A: Array, mass: Array, right_null: Array, left_null: Array
) -> SpectralDecomposition | None:
    """Decompose a matrix (f, f) with the known null spaces A right_null = 0 = left_null' mass A, (f, g), whose
    eigenvalue is exactly 0.

    Its directions come after the single ones. Returns None where the rest is not separate from it: A is defective
    there.
    """
    f, g = right_null.shape
    if not g or g == f:
        return decompose(A if not g else np.zeros((f, f)), mass)
    regularisation = tolerances.NO_INERTIA * float(np.trace(mass))
    across = (0.5 * (mass + mass.T) + (regularisation if regularisation > 0.0 else 1.0) * np.eye(f)) @ left_null
    rest_basis = np.linalg.svd(across / np.sqrt(np.sum(across**2, axis=0)), full_matrices=True)[0][:, g:]
    free = right_null / np.sqrt(np.sum(right_null**2, axis=0))
    if np.linalg.svd(np.hstack([rest_basis, free]), compute_uv=False)[-1] <= tolerances.NEARLY_DEFECTIVE:
        return None
    rest = decompose(solve_least_squares(rest_basis, A @ rest_basis), rest_basis.T @ mass @ rest_basis)
    X = rest_basis @ rest.X
    single_count = rest.single_count
    X = np.hstack([X[:, :single_count], free, X[:, single_count:]])
    values = np.concatenate([rest.eigenvalues[:single_count], np.zeros(g), rest.eigenvalues[single_count:]])
    return SpectralDecomposition(values, X, np.asarray(np.linalg.inv(X), dtype=X.dtype), rest.B, rest.defect)


def separate_eigenvectors(S: Array, eigenvalues: Array, shares: Array) -> tuple[Mask, Array]:
    """Return which eigenvectors are separate from all others, and an orthonormal basis of the span of the remaining
    ones.

    shares (f,): share of each eigenvector in what they lose together

    The basis is orthogonal to the left eigenvectors of all separate ones.
    """
    f = len(S)
    tolerance = tolerances.NEARLY_DEFECTIVE * float(np.linalg.norm(S))  # distance of clustered eigenvalues
    is_clustered = shares > tolerances.NEARLY_DEFECTIVE**0.5 * shares.max()
    while True:
        distance = np.abs(eigenvalues[:, None] - eigenvalues[None, is_clustered]).min(axis=1)
        distance = np.minimum(
            distance, np.abs(eigenvalues.conj()[:, None] - eigenvalues[None, is_clustered]).min(axis=1)
        )
        if not (more := (distance <= tolerance) & ~is_clustered).any():
            break
        is_clustered |= more
    left_values, left_vectors = np.linalg.eig(S.T)
    order = np.argsort(-np.abs(left_values[:, None] - eigenvalues[None, is_clustered]).min(axis=1))
    g = f - int(np.count_nonzero(is_clustered))
    separate_left = left_vectors[:, order[:g]]
    _, _, Q = np.linalg.svd(np.hstack([separate_left.real, separate_left.imag]).T) if g else (0, 0, np.eye(f))
    return ~is_clustered, Q[g:].T
