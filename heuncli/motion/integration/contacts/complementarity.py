"""Solve linear complementarity problems of contacts: each bears, or opens.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0,      A = W M^-1 W'  (through all bilateral constraints)

A is symmetric and positive semidefinite, so the problem is solved by principal pivoting. One index after the other is
driven until its w is zero or its z bears. Meanwhile those done before keep their side, or change it where they come to
zero (Dantzig; Cottle, Pang, Stone, The Linear Complementarity Problem (1992), 4.2; Baraff 1994). Every w is scaled by
the effect of its own z, so that contacts of any mass and unit are treated alike.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask

# what ends the drive of an index: its own w is zero; a z of another, or a w of one that is done, comes to zero
IS_DRIVEN, OPENS, BEARS = 1, 2, 3
# of indices, and of changes while one is driven, for each contact and for all: more means a cycle by rounding
PIVOTS_PER_CONTACT, EXTRA_PIVOTS = 20, 20


@record
class ComplementaritySolution:
    """The solution z (n,).

    bears (n,): where z is positive
    depends (n,): where w is zero too, and a self-stress could load the contact
    """

    z: Array
    bears: Mask
    depends: Mask


def solve_complementarity(A: Array, q: Array, noise: Array) -> ComplementaritySolution:
    """Solve for z; noise (n,): rounding error of w, which is zero within it. The diagonal of A must be positive."""
    n = len(q)
    unit = 1.0 / np.sqrt(np.diag(A)) if n else np.zeros(0)
    A, q, noise = A * unit[:, None] * unit, q * unit, noise * unit
    z, bears, is_done = np.zeros(n), np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    for _ in range(PIVOTS_PER_CONTACT * n + EXTRA_PIVOTS):
        w = np.where(bears, 0.0, q + A @ z)
        violated = np.flatnonzero(~is_done & (w < -noise))
        if not len(violated):
            break
        drive_index(A, q, z, bears, is_done, int(violated[np.argmin(w[violated])]))
    else:
        raise undecided_error("which of the touching contacts carry load cannot be determined")
    w = q + A @ z
    is_small = z <= noise  # A's diagonal is 1, so z below the rounding of w counts as zero
    z[is_small], bears = 0.0, bears & ~is_small
    is_closed = ~bears & (np.abs(w) <= np.maximum(noise, tolerances.CONTACT_DEPENDS * np.abs(A) @ z))
    return ComplementaritySolution(z * unit, bears, is_closed & find_shared(A, bears | is_closed))


def find_shared(A: Array, is_closed: Mask) -> Mask:
    """Return which of the closed contacts a self-stress of them loads, so that it is unknown how they share the
    load.
    """
    indices, is_shared = np.flatnonzero(is_closed), np.zeros(len(is_closed), dtype=bool)
    if len(indices) > 1:
        values, vectors = np.linalg.eigh(A[np.ix_(indices, indices)])
        null = np.abs(vectors[:, values <= tolerances.CONTACT_DEPENDS]).max(axis=1, initial=0.0)
        is_shared[indices] = null > math.sqrt(tolerances.CONTACT_DEPENDS)
    return is_shared


def drive_index(A: Array, q: Array, z: Array, bears: Mask, is_done: Mask, i: int) -> None:
    """Increase z_i until w_i is zero, in place; those that are done keep z w = 0."""
    for _ in range(PIVOTS_PER_CONTACT * len(q) + EXTRA_PIVOTS):
        bearing = np.flatnonzero(bears)
        dz = np.zeros(len(q))
        dz[i] = 1.0
        if len(bearing):
            dz[bearing] = -np.linalg.solve(A[np.ix_(bearing, bearing)], A[bearing, i])
        w, dw = q + A @ z, A @ dz
        limits = [(-w[i] / dw[i], IS_DRIVEN, i)] if dw[i] > tolerances.CONTACT_DEPENDS else []
        limits += [(-z[j] / dz[j], OPENS, int(j)) for j in bearing if dz[j] < 0.0]
        limits += [
            (max(w[j], 0.0) / -dw[j], BEARS, int(j))
            for j in np.flatnonzero(is_done & ~bears)
            if j != i and dw[j] < -tolerances.CONTACT_DEPENDS
        ]
        if not limits:
            raise undecided_error("no contact forces or impulses prevent the contacts from penetrating")
        step, event, j = min(limits)
        z += step * dz
        if event == IS_DRIVEN:
            bears[i] = is_done[i] = True
            return
        bears[j] = event == BEARS
        if event == OPENS:
            z[j] = 0.0
    raise undecided_error("which of the touching contacts carry load cannot be determined")


def undecided_error(message: str) -> SolveError:
    """Make the error of contacts that find no balance."""
    hint = "stops or ropes constrain the same motion: remove one of them, or give one a little clearance"
    return SolveError(Problem("contacts-undecided", message, hint=hint))


def find_coupled_groups(A: Array) -> list[Indices]:
    """Return the groups of contacts whose impulses change each other's rates, directly or through others, in their
    order.
    """
    coupling_matrix = is_coupled(A)
    np.fill_diagonal(coupling_matrix, True)
    for _ in range(len(A)):
        is_reached = coupling_matrix @ coupling_matrix
        if np.array_equal(is_reached, coupling_matrix):
            break
        coupling_matrix = is_reached
    return [np.flatnonzero(row) for k, row in enumerate(coupling_matrix) if not row[:k].any()]


def is_coupled(A: Array) -> Mask:
    """Return whether the impulse of one contact changes the rate of the other, (k, k)."""
    size = np.sqrt(np.maximum(np.diag(A), 0.0))
    return np.asarray(np.abs(A) > tolerances.SUM_ROUNDING * size[:, None] * size)
