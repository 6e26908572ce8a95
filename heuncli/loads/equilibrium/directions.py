"""A matrix by its own directions, those that are hardly apart together in one block.

    A = X diag(lambda_1 ... lambda_g, B) X^-1
Where forces follow what they move, or a pose is still pushed, eigenvectors may fall together (A is then defective, as
[[0, 0], [k, 0]] of a carriage that a level bar hangs on): their directions have no coordinates of their own, and what
pushes would be lost between them. They share an orthonormal basis instead, in which B is followed as a matrix. What is
orthonormal is so by the mass: about a rest pose under loads with a potential A is symmetric there.
"""

from __future__ import annotations

from math import factorial

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Mask

MOST_GROWTH = 300.0  # exponents beyond it are as good as infinite
SERIES = 1e-8  # below it the series has all digits
TERMS = 12  # of the series of the exponential, below a norm of 1/4: 0.25**13 / 13! is nothing
NEAR_ZERO = 1.0  # below it phi is summed: above, differences keep all but a digit of it
SUMMED = 18  # terms of that sum: 1/18! is nothing
HALVED = 0.25


@record
class Directions:
    """X (f, f) and its inverse; the eigenvalues (f,), those of the block B (m, m) last; lost: how many directions of
    the block fall together, so that its eigenvalues are known to the root of that order more."""

    eigenvalues: Array
    X: Array
    inverse: Array
    B: Array
    lost: int

    @property
    def alone(self) -> int:
        """How many directions stand alone: the first ones."""
        return len(self.eigenvalues) - len(self.B)

    def whole(self, kept: Mask) -> Array:
        """The matrix, without the eigenvalues that are not kept; the block as one."""
        g = self.alone
        middle = np.zeros(self.X.shape, dtype=complex)
        middle[range(g), range(g)] = np.where(kept[:g], self.eigenvalues[:g], 0.0)
        middle[g:, g:] = self.B if kept[g:].any() else 0.0
        return np.asarray((self.X @ middle @ self.inverse).real)

    def led(self, h: float, c: Array, order: int = 1) -> Array:
        """h phi(h A) c in X's coordinates, (f,), by phi_1(x) = (e^x - 1)/x, phi_k+1(x) = (phi_k(x) - 1/k!)/x.

        Of order 1 it is how far dz/ds = c + A z leads in s = h; of order k, times (k - 1)!, where c grows as
        (s/h)^(k - 1). Not finite if it grows beyond all numbers.
        """
        g = self.alone
        with np.errstate(over="ignore", invalid="ignore"):
            x = h * self.eigenvalues[:g]
            x = np.where(x.real > MOST_GROWTH, MOST_GROWTH, x)
            alone = h * phi(x, order) * c[:g]
        return np.concatenate([alone, led_together(self.B, h, c[g:].real, order)])

    def softened(self, c: Array, known: Array) -> Array:
        """-A^-1 c in X's coordinates, along what is more than is known of the eigenvalues; of B, by singular values."""
        g = self.alone
        decided = np.abs(self.eigenvalues[:g]) > known[:g]
        single = np.where(decided, -c[:g] / np.where(decided, self.eigenvalues[:g], 1.0), 0.0)
        if not len(self.B):
            return np.asarray(single)
        U, s, V = np.linalg.svd(self.B)
        held = s > max(tolerances.NEARLY_DEFECTIVE * s[0], known[g:].max())
        along = np.where(held, (U.T @ c[g:].real) / np.where(held, s, 1.0), 0.0)
        return np.concatenate([single, -(V.T @ along)])


def phi(x: Array, order: int) -> Array:
    """phi_k of numbers (n,): phi_1(x) = (e^x - 1)/x, phi_k+1(x) = (phi_k(x) - 1/k!)/x."""
    small = np.abs(x) < SERIES
    value = np.where(small, 1.0 + 0.5 * x, np.expm1(x) / np.where(small, 1.0, x))
    if order == 1:
        return np.asarray(value)
    near = np.abs(x) < NEAR_ZERO
    safe, few = np.where(near, 1.0, x), np.where(near, x, 0.0)
    for k in range(1, order):
        value = (value - 1.0 / factorial(k)) / safe
    summed = np.zeros_like(value)
    for j in reversed(range(SUMMED)):
        summed = summed * few + 1.0 / factorial(j + order)
    return np.where(near, summed, value)


def led_together(B: Array, h: float, c: Array, order: int = 1) -> Array:
    """h phi(h B) c by the exponential of [[h B, c, 0], [0, 0, 1], [0, 0, 0]] (k rows behind B for phi_k).

    Its series, halved and squared. Not finite if it grows.
    """
    m = len(B)
    if not c.any():
        return np.zeros(m)
    size = float(np.abs(c).max())
    whole = np.zeros((m + order, m + order))
    whole[:m, :m] = h * B
    whole[:m, m] = c / size
    whole[range(m, m + order - 1), range(m + 1, m + order)] = 1.0
    norm = float(np.abs(whole).sum(axis=1).max())
    halvings = max(0, int(np.ceil(np.log2(norm / HALVED)))) if norm > 0.0 else 0
    power = np.eye(m + order)
    found = power.copy()
    for k in range(1, TERMS + 1):
        power = power @ (whole / 2.0**halvings) / k
        found = found + power
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(halvings):
            found = found @ found
        return np.asarray(h * size * found[:m, m + order - 1])


def directions(A: Array, mass: Array) -> Directions:
    """Those of a matrix (f, f); mass (f, f): of the same coordinates, positive or zero."""
    f = len(A)
    if not f:
        return Directions(np.zeros(0), A, A, A, 0)
    least = tolerances.NO_INERTIA * float(np.trace(mass))
    L = np.linalg.cholesky(0.5 * (mass + mass.T) + (least if least > 0.0 else 1.0) * np.eye(f))
    S = np.linalg.solve(L, (L.T @ A).T).T  # L' A L'^-1
    eigenvalues, V = np.linalg.eig(S)
    _, sizes, R = np.linalg.svd(V)
    lost = int(np.count_nonzero(sizes <= tolerances.NEARLY_DEFECTIVE))
    if not lost:
        return Directions(eigenvalues, np.linalg.solve(L.T, V), np.linalg.inv(V) @ L.T, np.zeros((0, 0)), 0)
    alone, Q = apart(S, eigenvalues, np.abs(R[-lost:]).max(axis=0))
    X = np.hstack([V[:, alone], Q])
    if np.linalg.svd(X, compute_uv=False)[-1] <= tolerances.NEARLY_DEFECTIVE:
        alone, X = np.zeros(f, dtype=bool), np.eye(f)  # nothing is well apart
    g = int(np.count_nonzero(alone))
    back = np.linalg.inv(X)
    B = (back[g:] @ S @ X[:, g:]).real
    values = np.concatenate([eigenvalues[alone], np.linalg.eigvals(B)])
    return Directions(values, np.linalg.solve(L.T, X), back @ L.T, B, lost)


def split(A: Array, mass: Array, right: Array, left: Array) -> Directions | None:
    """Those of a matrix (f, f) of which A right = 0 = left' mass A is known, (f, g): the null space has 0 exactly.

    Its directions come behind those that stand alone. None where the rest is not apart from it: A is defective there.
    """
    f, g = right.shape
    if not g or g == f:
        return directions(A if not g else np.zeros((f, f)), mass)
    least = tolerances.NO_INERTIA * float(np.trace(mass))
    across = (0.5 * (mass + mass.T) + (least if least > 0.0 else 1.0) * np.eye(f)) @ left
    kept = np.linalg.svd(across / np.sqrt(np.sum(across**2, axis=0)), full_matrices=True)[0][:, g:]
    free = right / np.sqrt(np.sum(right**2, axis=0))
    if np.linalg.svd(np.hstack([kept, free]), compute_uv=False)[-1] <= tolerances.NEARLY_DEFECTIVE:
        return None
    rest = directions(np.linalg.lstsq(kept, A @ kept, rcond=None)[0], kept.T @ mass @ kept)
    X = kept @ rest.X
    alone = rest.alone
    X = np.hstack([X[:, :alone], free, X[:, alone:]])
    values = np.concatenate([rest.eigenvalues[:alone], np.zeros(g), rest.eigenvalues[alone:]])
    return Directions(values, X, np.asarray(np.linalg.inv(X), dtype=X.dtype), rest.B, rest.lost)


def apart(S: Array, eigenvalues: Array, shares: Array) -> tuple[Mask, Array]:
    """Which eigenvectors are apart from all others, and an orthonormal basis of what the others span with their like.

    shares (f,): of the eigenvectors in what they lose together. The basis is what the left eigenvectors of all that are
    apart are across to.
    """
    f = len(S)
    near = tolerances.NEARLY_DEFECTIVE * float(np.linalg.norm(S))  # eigenvalues whose vectors are so near are so near
    alike = shares > tolerances.NEARLY_DEFECTIVE**0.5 * shares.max()
    while True:
        off = np.abs(eigenvalues[:, None] - eigenvalues[None, alike]).min(axis=1)
        off = np.minimum(off, np.abs(eigenvalues.conj()[:, None] - eigenvalues[None, alike]).min(axis=1))
        if not (more := (off <= near) & ~alike).any():
            break
        alike |= more
    others, left = np.linalg.eig(S.T)
    order = np.argsort(-np.abs(others[:, None] - eigenvalues[None, alike]).min(axis=1))
    g = f - int(np.count_nonzero(alike))
    own = left[:, order[:g]]
    _, _, Q = np.linalg.svd(np.hstack([own.real, own.imag]).T) if g else (0, 0, np.eye(f))
    return ~alike, Q[g:].T
