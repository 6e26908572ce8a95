"""Linear complementarity with a symmetric A that is not negative, by principal pivots.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0
One index after the other is driven until its w is zero or its z bears; on the way those done before keep their side, or
change it where they come to zero (Dantzig; Cottle, Pang, Stone, The Linear Complementarity Problem (1992), 4.2; Baraff
1994). Every w is measured by what its own z does to it, so that contacts of any mass and unit are alike.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.results.results import Array, Mask


@record
class Pivots:
    """z (n,); bears (n,): where it is positive; depends (n,): where w is zero, too, and a self-stress could load it."""

    z: Array
    bears: Mask
    depends: Mask


def complementary(A: Array, q: Array, noise: Array) -> Pivots:
    """The solution z; noise (n,): what rounding makes of w, which is zero within it. The diagonal of A is positive."""
    n = len(q)
    unit = 1.0 / np.sqrt(np.diag(A)) if n else np.zeros(0)
    A, q, noise = A * unit[:, None] * unit, q * unit, noise * unit
    z, bears, done = np.zeros(n), np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    for _ in range(20 * n + 20):
        w = np.where(bears, 0.0, q + A @ z)
        waiting = np.flatnonzero(~done & (w < -noise))
        if not len(waiting):
            break
        drive(A, q, z, bears, done, int(waiting[np.argmin(w[waiting])]))
    else:
        raise undecided("which of the contacts that touch bear is not decided")
    w = q + A @ z
    small = z <= noise  # A's diagonal is 1: what bears less than rounding bears nothing
    z[small], bears = 0.0, bears & ~small
    closed = ~bears & (np.abs(w) <= np.maximum(noise, tolerances.CONTACT_DEPENDS * np.abs(A) @ z))
    return Pivots(z * unit, bears, closed & shared(A, bears | closed))


def shared(A: Array, closed: Mask) -> Mask:
    """Which of the contacts that are closed a self-stress of them all loads: how those share is not known."""
    own, found = np.flatnonzero(closed), np.zeros(len(closed), dtype=bool)
    if len(own) > 1:
        values, vectors = np.linalg.eigh(A[np.ix_(own, own)])
        null = np.abs(vectors[:, values <= tolerances.CONTACT_DEPENDS]).max(axis=1, initial=0.0)
        found[own] = null > math.sqrt(tolerances.CONTACT_DEPENDS)
    return found


def drive(A: Array, q: Array, z: Array, bears: Mask, done: Mask, i: int) -> None:
    """Let z_i grow until w_i is zero; those that are done keep z w = 0. In place."""
    for _ in range(20 * len(q) + 20):
        own = np.flatnonzero(bears)
        dz = np.zeros(len(q))
        dz[i] = 1.0
        if len(own):
            dz[own] = -np.linalg.solve(A[np.ix_(own, own)], A[own, i])
        w, dw = q + A @ z, A @ dz
        limits = [(-w[i] / dw[i], 1, i)] if dw[i] > tolerances.CONTACT_DEPENDS else []
        limits += [(-z[j] / dz[j], 2, int(j)) for j in own if dz[j] < 0.0]
        limits += [
            (max(w[j], 0.0) / -dw[j], 3, int(j))
            for j in np.flatnonzero(done & ~bears)
            if j != i and dw[j] < -tolerances.CONTACT_DEPENDS
        ]
        if not limits:
            raise undecided("no impulse or force of the contacts holds them apart")
        step, what, j = min(limits)
        z += step * dz
        if what == 1:
            bears[i] = done[i] = True
            return
        bears[j] = what == 3
        if what == 2:
            z[j] = 0.0
    raise undecided("which of the contacts that touch bear is not decided")


def undecided(message: str) -> SolveError:
    """The error of contacts that find no balance."""
    hint = "stops or ropes that hold the same: let one of them out, or a little more room to one"
    return SolveError(Problem("contacts-undecided", message, hint=hint))
