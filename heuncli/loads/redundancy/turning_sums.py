"""Sums of open components whose factors turn with the pose, so that no constant ones would do.

Two balls on one body leave open what acts along the line between them; across it each is certain, in directions that
turn with the body: sum of c_i(t) F_i, at every instant with the c that all self-stresses of that instant cancel in,
of unit length (so of one joint's force it is the component in a direction), and without jumps of sign.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

TOGETHER = 32  # rows that are freed of what the rows before them span in one product
MOST_TERMS = 24  # nobody reads longer sums, and they take long to find
LARGE = 0.1  # of unit length: the first factor that large is positive at the start

Shares = Mapping[str, Array]  # components' shares of every self-stress, (poses, k)


def turning_sums(poses: Shares, asked: Shares) -> list[dict[str, Array]]:
    """Of each component that depends on a few before it in all poses: factors at the asked instants, (n_t,) each."""
    sums: list[dict[str, Array]] = []
    for names in dependent_components(poses):
        if len(names) <= MOST_TERMS and (c := factors(np.stack([asked[n] for n in names], axis=1))) is not None:
            sums.append({name: factor for name, factor in zip(names, c.T, strict=True) if factor.any()})
    return sums


def dependent_components(poses: Shares) -> list[list[str]]:
    """Each component that depends on those before it in every pose, last, after the independent ones that it takes.

    Being independent in one pose is enough to be so: in others it is by accident that they are not.
    """
    names = list(poses)
    if not names:
        return []
    rows = np.stack([poses[n] for n in names], axis=1)
    rows = rows[:, :, rows.any(axis=(0, 1))]  # the self-stresses that reach some of them
    rows = rows / np.sqrt(np.sum(rows * rows, axis=2)).max(axis=0)[None, :, None]
    Q = np.zeros_like(rows)  # orthonormal in each pose, zero where a free row depends on others there
    usual = np.ones(len(rows), dtype=bool)  # poses in which all the free ones are independent
    free: list[int] = []
    bound: list[int] = []
    for i in range(len(names)):
        if len(free) == rows.shape[2]:  # they span all there is
            bound += range(i, len(names))
            break
        if i % TOGETHER == 0:
            before = len(free)
            ahead = across(rows[:, i : i + TOGETHER], Q[:, :before])
        rest = across(ahead[:, i % TOGETHER, None], Q[:, before : len(free)])
        size = np.sqrt(np.einsum("tik,tik->t", rest, rest))
        new = (
            size > tolerances.DEPENDENT_SHARES
        )  # where a component vanishes, as of a crank on an axis, that is rounding
        if (usual & new).any():
            usual &= new
            Q[:, len(free)] = rest[:, 0] * (new / np.where(new, size, 1.0))[:, None]
            free.append(i)
        else:
            bound.append(i)
    if not bound:
        return []
    back = Q[usual][:, : len(free)]
    c = np.linalg.solve(back @ rows[usual][:, free].transpose(0, 2, 1), back @ rows[usual][:, bound].transpose(0, 2, 1))
    used = (np.abs(c) > tolerances.ABSENT_FACTOR * np.maximum(np.abs(c).max(axis=1, keepdims=True), 1.0)).any(axis=0)
    return [[*(names[f] for f in np.array(free)[used[:, k]]), names[i]] for k, i in enumerate(bound)]


def across(rows: Array, basis: Array) -> Array:
    """What of rows (poses, n, k) lies across an orthonormal basis (poses, m, k); taken away twice, for rounding."""
    for _ in range(2):
        rows = rows - (rows @ basis.transpose(0, 2, 1)) @ basis
    return rows


def factors(rows: Array) -> Array | None:
    """Unit vectors c (n_t, n) with c . rows = 0 for rows (n_t, n, k), the last of which depends on the others.

    No factor jumps, the first large one is positive at the start; where the others are dependent, too, c is near to
    that of the nearest instant where they are not. None where there are none at some instant.
    """
    size = np.sqrt(np.sum(rows * rows, axis=2)).max(axis=0)
    R = np.asarray(np.linalg.qr((rows / size[None, :, None]).transpose(0, 2, 1), mode="r"))
    n = rows.shape[1]
    if R.shape[1] < n:
        R = np.pad(R, ((0, 0), (0, n - R.shape[1]), (0, 0)))
    diagonal = np.abs(np.diagonal(R, axis1=1, axis2=2))
    most = np.maximum(np.abs(R).max(axis=(1, 2)), 1.0)  # of rows that vanish at an instant only rounding is left
    usual = (diagonal[:, :-1] > tolerances.DEPENDENT_SHARES * most[:, None]).all(axis=1)
    if not usual.any() or (diagonal[usual, -1] > tolerances.DEPENDENT_SHARES * most[usual]).any():
        return None
    c = np.ones((len(rows), n))
    c[usual, :-1] = solved(R[usual, :-1, :-1], -R[usual, :-1, -1], rows.shape[2])
    for t in np.flatnonzero(~usual):
        U, sigma, _ = np.linalg.svd(R[t].T)
        N = U[:, sigma <= tolerances.DEPENDENT_SHARES * most[t]]
        if not N.shape[1]:
            return None
        known = np.flatnonzero(usual)
        before = c[known[np.argmin(np.abs(known - t))]]
        c[t] = N @ (N.T @ before)
    c = c / size
    unit: Array = c / np.sqrt(np.sum(c * c, axis=1))[:, None]
    unit *= np.sign(unit[0, np.argmax(np.abs(unit[0]) > LARGE)])
    return unit


def solved(T: Array, r: Array, k: int) -> Array:
    """Solutions x (n_t, n) of triangular T x = r, from factors of k rows; zero where rounding alone may have made them.

    Householder's factors are those of columns off by at most k (n + 1) u of their lengths, here 1 at most. So x is off
    by at most that, times |T^-1|, times 1 + sum |x|.
    """
    inverse = np.linalg.inv(T)
    x = (inverse @ r[:, :, None])[:, :, 0]
    u = 0.5 * np.finfo(np.float64).eps
    off = k * (T.shape[1] + 1) * u * np.abs(inverse).sum(axis=2) * (1.0 + np.abs(x).sum(axis=1, keepdims=True))
    return np.where(np.abs(x) > off, x, 0.0)
