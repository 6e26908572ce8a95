"""Sums of open components whose factors turn with the pose, so that no constant ones would do.

Two balls on one body leave open what acts along the line between them; across it each is certain, in directions that
turn with the body: sum of c_i(t) F_i, at every instant with the c that all self-stresses of that instant cancel in,
of unit length (so of one joint's force it is the component in a direction), and without jumps of sign.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.results import Array

SAME = 1e-7  # of the largest singular value of some rows: below it one of them is told by the others
ABSENT = 1e-9  # of unit length: a factor that is nowhere larger is none

Shares = Mapping[str, Array]  # components' shares of every self-stress, (poses, k)


def turning_sums(poses: Shares, told: Shares) -> list[dict[str, Array]]:
    """Of each component that those before it tell in all poses: factors at the told instants, (n_t,) each."""
    free: list[str] = []
    found: list[dict[str, Array]] = []
    for name in poses:
        names = dependent(poses, free, name)
        if not names:
            free.append(name)
        elif (c := factors(np.stack([told[n] for n in names], axis=1))) is not None:
            found.append(dict(zip(names, c.T, strict=True)))
    return found


def dependent(poses: Shares, free: Sequence[str], name: str) -> list[str]:
    """Those of the free components, and `name`, that are dependent in every pose; empty if they are not.

    Being independent in one pose is enough: in others it is by accident that they are not.
    """
    names = [*free, name]
    rows = np.stack([poses[n] for n in names], axis=1)
    size = np.sqrt(np.sum(rows * rows, axis=2)).max(axis=0)
    U, sigma = _left(rows / size[None, :, None])
    lacks = np.sum(sigma <= SAME * np.maximum(sigma[:, :1], 1e-300), axis=1)
    if (lacks == 0).any():
        return []
    c = np.abs(U[lacks == 1, :, -1] / size)
    used = (c > ABSENT * c.max(axis=1, keepdims=True)).any(axis=0) if len(c) else np.ones(len(names), dtype=bool)
    return [n for n, is_used in zip(names, used, strict=True) if is_used]


def factors(rows: Array) -> Array | None:
    """Unit vectors c (n_t, n) with c . rows = 0 for rows (n_t, n, k), each nearest to the one before.

    None where there are none at some instant.
    """
    size = np.sqrt(np.sum(rows * rows, axis=2)).max(axis=0)
    U, sigma = _left(rows / size[None, :, None])
    lacks = np.sum(sigma <= SAME * np.maximum(sigma[:, :1], 1e-300), axis=1)
    if (lacks == 0).any():
        return None
    c = U[:, :, -1].copy()
    first = int(np.argmax(lacks == lacks.min()))
    c[first] *= np.sign(c[first][np.argmax(np.abs(c[first]) > 0.1)])
    for order in (range(first + 1, len(c)), range(first - 1, -1, -1)):
        before = c[first]
        for t in order:
            N = U[t, :, rows.shape[1] - lacks[t] :]
            near = N @ (N.T @ before)
            if (part := float(np.sqrt(near @ near))) > SAME:
                c[t] = near / part
            before = c[t]
    c = c / size
    unit: Array = c / np.sqrt(np.sum(c * c, axis=1))[:, None]
    return unit


def _left(rows: Array) -> tuple[Array, Array]:
    """Left singular vectors (n_t, n, n) and n singular values of each of (n_t, n, k), descending."""
    U, sigma, _ = np.linalg.svd(rows, full_matrices=rows.shape[2] < rows.shape[1])
    lack = rows.shape[1] - sigma.shape[1]
    return U, np.pad(sigma, ((0, 0), (0, max(lack, 0))))
