"""Small oscillations: the motions exp(l t) of the reduced linear equations.

    l = growth + 2 pi i frequency;   damping ratio = -growth / |l|
What nothing holds is found from the null space of the stiffness and taken out before the rest is looked for: of the
double eigenvalue 0 of a free motion rounding makes two of the order of its root, which would read as a frequency.
Where neither damping nor gyroscopic terms are, l^2 are the eigenvalues of -K, half as many, and real for what has a
potential. What an eigenvalue may be off by is rounding times its own condition; a growth within that is none.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.motion.linearisation.indifference import Loose
from heuncli.motion.linearisation.reduced_equations import ReducedEquations
from heuncli.results.results import Array

Kind = Literal["free", "decay", "divergence", "oscillation", "flutter"]


@record
class Mode:
    """One motion: its eigenvalue l [1/s] and what that may be off by; shape (n,) on the freedoms of the tree, complex.

    A pair of conjugate eigenvalues is one motion, with the positive frequency; what is free has the eigenvalue 0, and
    its error bounds the frequency and growth below which no motion is told from a free one.
    """

    kind: Kind
    eigenvalue: complex
    error: float
    shape: Array

    @property
    def frequency(self) -> float:
        """[Hz]"""
        return self.eigenvalue.imag / (2.0 * np.pi)

    @property
    def growth(self) -> float:
        """[1/s]"""
        return self.eigenvalue.real

    @property
    def damping(self) -> float:
        """Lehr's ratio: 1 of what decays without oscillating, -1 of what so diverges, 0 of what is free."""
        return 0.0 - self.eigenvalue.real / abs(self.eigenvalue) if self.eigenvalue else 0.0


def oscillations(system: ReducedEquations, loose: Loose) -> list[Mode]:
    """All motions: what is free, what creeps or diverges, and oscillations by their frequency."""
    if system.count == 0:
        return []
    if not system.A11.any() and not system.A22.any():
        found = without_rates(system, loose)
    else:
        found = with_rates(system, loose)
    modes = [mode_of(system, value, float(error), x, free) for value, error, x, free in found]
    return sorted(modes, key=lambda mode: (mode.kind != "free", mode.frequency, abs(mode.growth)))


def mode_of(system: ReducedEquations, eigenvalue: complex, error: float, x: Array, free: bool) -> Mode:
    """A motion by its eigenvalue and its displacement x in the reduced coordinates."""
    return motion_of(system.tangent @ x, system.mass, eigenvalue, error, free)


def motion_of(shape: Array, mass: Array, eigenvalue: complex, error: float, free: bool) -> Mode:
    """A motion by its eigenvalue and its displacement (n,) of the tree's freedoms, whose mass matrix that is."""
    if free:
        return Mode("free", 0j, error, shape)
    error += 0.5 * abs(eigenvalue) * tolerances.EIGENVALUE * cancelled(mass, shape)
    growth = eigenvalue.real if abs(eigenvalue.real) > error else 0.0
    if eigenvalue.imag == 0.0:
        return Mode("divergence" if growth > 0.0 else "decay", complex(growth), error, shape)
    return Mode("flutter" if growth > 0.0 else "oscillation", complex(growth, eigenvalue.imag), error, shape)


def cancelled(M: Array, v: Array) -> float:
    """How large the terms of v* M v are against their sum: of a light body's motion on heavy ones much may cancel."""
    size = np.abs(v)
    return float(size @ np.abs(M) @ size / abs(v.conj() @ M @ v))


Row = tuple[complex, float, Array, bool]


def without_rates(system: ReducedEquations, loose: Loose) -> list[Row]:
    """x'' + K x = 0: l^2 = -k of the eigenvalues k of K."""
    K = -system.A21
    rounding = tolerances.EIGENVALUE * len(K) * max(norm(K), system.terms)
    all_taken = sooner_or_later(loose)
    rows: list[Row] = [(0j, float(np.sqrt(loose.unsure)), x, True) for x in all_taken.T]
    taken, rest = completed(all_taken)
    if not rest.shape[1]:
        return rows
    B = rest.T @ K @ rest
    if np.abs(B - B.T).max() <= rounding:
        values, vectors = symmetric(B, loose, rest)
        errors = np.minimum(rounding, loose.hidden(rest @ vectors))
    else:
        values, vectors, condition = eigenvalues(B)
        errors = condition * rounding
    for k, error, v in zip(values, errors, whole(K, taken, rest, values, vectors, errors).T, strict=True):
        rows += roots(complex(k), float(error), v)
    return rows


def stiffnesses(system: ReducedEquations, loose: Loose) -> tuple[Array, Array]:
    """The eigenvalues of K, per unit mass, of all that is held or pushed off, real parts (m,), and shapes x (f, m)."""
    K = system.stiffness
    _, rest = completed(sooner_or_later(loose))
    if not rest.shape[1]:
        return np.zeros(0), rest
    B = rest.T @ K @ rest
    rounding = tolerances.EIGENVALUE * len(K) * max(norm(K), system.terms)
    values, vectors = symmetric(B, loose, rest) if np.abs(B - B.T).max() <= rounding else np.linalg.eig(B)
    return values.real, rest @ vectors


def symmetric(B: Array, loose: Loose, rest: Array) -> tuple[Array, Array]:
    """Eigenvalues and vectors of a symmetric B = rest' K rest, small ones to their own digits beside large ones.

    k = v' K v - sum (v' K w)^2 / (l - k)    over the other vectors w: what is left of their rounding, at second order
    """
    _, V = np.linalg.eigh(0.5 * (B + B.T))
    own = loose.between(rest @ V)
    values = np.diag(own).copy()
    apart = values[None, :] - values[:, None]
    coupled = 0.5 * (own + own.T) - np.diag(values)
    far = np.abs(apart) > np.abs(coupled)
    return values - np.where(far, coupled**2 / np.where(far, apart, 1.0), 0.0).sum(axis=1), V


def sooner_or_later(loose: Loose) -> Array:
    """What K takes to nothing, and what it takes to that, (f, m): the other halves of a double eigenvalue 0."""
    found = [loose.right]
    while (again := found[-1] @ null_space(loose.left.T @ found[-1], tolerances.NEARLY_DEFECTIVE)[0]).shape[1]:
        found.append(unit(loose.held @ again))
    return np.concatenate(found, axis=1)


def roots(k: complex, error: float, x: Array) -> list[Row]:
    """The motions l = +-sqrt(-k): one oscillates, or two diverge and decay, or flutter and its counterpart."""
    root = complex(np.sqrt(-k + 0j))
    off = error / (2.0 * abs(root))
    if abs(k.imag) <= error:
        if k.real > 0.0:
            return [(1j * abs(root), off, x, False)]
        return [(complex(abs(root)), off, x, False), (complex(-abs(root)), off, x, False)]
    if k.imag < 0.0:
        return []  # the conjugate says the same
    root = root if root.imag > 0.0 else -root
    # l and -l*, the other of the four with a positive frequency: that of the conjugate shape
    return [(root, off, x, False), (-root.conjugate(), off, x.conj(), False)]


def with_rates(system: ReducedEquations, loose: Loose) -> list[Row]:
    """(x, z)' = A (x, z), rates in units of the fastest of its motions, what is free taken out first."""
    f, K = system.count, system.stiffness
    scale = max(float(np.sqrt(max(norm(K), system.terms))), norm(system.A22), norm(system.A11))
    A = np.block([[system.A11, scale * np.eye(f)], [system.A21 / scale, system.A22]])
    rounding = tolerances.EIGENVALUE * len(A) * scale
    rows: list[Row] = [(0j, float(np.sqrt(loose.unsure)), x, True) for x in loose.right.T]
    taken, rest = completed(left_alone(system, loose, scale))
    if not rest.shape[1]:
        return rows
    values, vectors, condition = eigenvalues(rest.T @ A @ rest)
    errors = condition * rounding
    shapes = whole(A, taken, rest, values, vectors, errors)[:f]
    for value, error, x in zip(values, errors.tolist(), shapes.T, strict=True):
        if abs(value.imag) <= error:  # a double root, at the aperiodic limit, is split by rounding
            rows.append((complex(value.real), error, x, False))
        elif value.imag > 0.0:
            rows.append((complex(value), error, x, False))
    return rows


def left_alone(system: ReducedEquations, loose: Loose, scale: float) -> Array:
    """All (x, z / scale) that A takes to nothing sooner or later, (2 f, m): begun with what stays, x' = z' = 0.

    A w_k = w_(k-1):   K x_k = A22 x_(k-1) - z_(k-1),  z_k = x_(k-1) - A11 x_k,  where the left null space of K lets it
    """
    A11, A22 = system.A11, system.A22
    X, Z = loose.right, -A11 @ loose.right
    found = [np.concatenate([X, Z / scale])]
    # where gyroscopic terms cancel, A11 and A22 are nothing but rounding of terms as fast as the spins
    small = tolerances.EIGENVALUE * system.count * (norm(A11) + norm(A22) + float(np.sqrt(system.terms)))
    while X.shape[1]:
        asked = A22 @ X - Z
        on = null_space(loose.left.T @ asked, small)[0]
        new = loose.held @ asked @ on
        X, Z = new, X @ on - A11 @ new
        found.append(np.concatenate([X, Z / scale]))
        small = tolerances.NEARLY_DEFECTIVE * norm(np.concatenate([X, Z, A22 @ X - Z]))
    return unit(np.concatenate(found, axis=1))


def unit(columns: Array) -> Array:
    """Columns of length 1."""
    return np.asarray(columns / np.sqrt(np.sum(columns**2, axis=0)))


def completed(columns: Array) -> tuple[Array, Array]:
    """Orthonormal bases of what columns span, which are independent (the first m what the first m do), of the rest."""
    n, m = columns.shape
    Q = np.linalg.qr(columns, mode="complete")[0] if m else np.eye(n)
    return Q[:, :m], Q[:, m:]


def whole(A: Array, taken: Array, rest: Array, values: Array, vectors: Array, errors: Array) -> Array:
    """Eigenvectors of A from those of its quotient: what they have of the subspace taken out follows.

    (k - N) y = T' A v,  N = T' A T: A takes each column of T to those before it: N is 0 on and below its diagonal.
    Of a k that may be 0 there is no such part: it cannot be told from what was taken out.
    """
    found = rest @ vectors
    if not taken.shape[1]:
        return found
    N, across = np.triu(taken.T @ A @ taken, 1), taken.T @ A @ rest
    one = np.eye(len(N))
    parts = [
        np.linalg.solve(k * one - N, across @ v) if abs(k) > error else np.zeros(len(N))
        for k, v, error in zip(values, vectors.T, errors, strict=True)
    ]
    return np.asarray(found + taken @ np.array(parts).T)


def eigenvalues(A: Array) -> tuple[Array, Array, Array]:
    """Eigenvalues, right vectors, and the condition of each: |x| |y| / |y x| of the right and the left vector."""
    values, vectors = np.linalg.eig(A)
    left = np.linalg.pinv(vectors)
    lengths = np.sqrt(np.sum(np.abs(left) ** 2, axis=1))
    return values, vectors, lengths * np.sqrt(np.sum(np.abs(vectors) ** 2, axis=0))


def null_space(A: Array, rounding: float) -> tuple[Array, Array]:
    """Orthonormal bases of what A takes to nothing, and of what is left."""
    _, s, V = np.linalg.svd(A)
    kept = int(np.sum(s > rounding))
    return V[kept:].T, V[:kept].T


def norm(A: Array) -> float:
    """The largest singular value; 0 of nothing."""
    return float(np.linalg.norm(A, 2)) if A.size else 0.0
