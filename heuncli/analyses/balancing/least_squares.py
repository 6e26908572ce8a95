"""The products of counterweights with the least sum of squares over a cycle.

Where all are linear it is one system, of least |U| where several U serve as well. A weight whose mass counts is along a
direction linear in its size, so that of many directions the best with its sizes is where Newton's iteration begins; the
size may not be below 0, and is 0 where no weight helps. All is done in the few numbers that QR leaves of the cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np

from heuncli.analyses.balancing.candidates import NO_EFFECT, Candidate
from heuncli.results.results import Array

DEPENDENT = 1e-10  # of the largest singular value: places that serve as well as each other
MOST_STARTS = 1000  # of directions, all weights together
LEAST_DIRECTIONS = 6
MOST_STEPS, HALVINGS = 200, 40
DIFFERENCE = 1e-5  # of |U|: by which second derivatives are found; first ones are exact
GONE = 1e-9  # of the largest: a weight that its iteration makes so small is none


def solved(left: Array, candidates: Sequence[Candidate], linear: Sequence[bool], unit: float) -> tuple[Array, bool]:
    """U (k, 2) of each candidate, and whether others serve as well; left (n, 6): force and moment as weighed."""
    columns = [left.reshape(-1, 1), *(one.columns for one in candidates)]
    R: Array = np.linalg.qr(np.concatenate(columns, axis=1))[1]
    small = [one.with_columns(R[:, 1 + 7 * k : 8 + 7 * k]) for k, one in enumerate(candidates)]
    size = unit * math.sqrt(left.shape[0])
    if all(linear):
        U, several = straight(np.concatenate([one.by_product for one in small], axis=1), R[:, 0], size)
        return U.reshape(-1, 2), several
    best = min(starts(R[:, 0], small, linear, size), key=lambda U: float(np.sum(rest(R[:, 0], small, U) ** 2)))
    return polished(R[:, 0], small, best), False


def straight(A: Array, left: Array, size: float) -> tuple[Array, bool]:
    """The x of least |A x + left|, of these the least; whether there are several. size: of columns that act."""
    doing = np.sqrt(np.sum(A * A, axis=0)) > NO_EFFECT * size
    x = np.zeros(A.shape[1])
    if not doing.any():
        return x, True
    own, _, rank, _ = np.linalg.lstsq(A[:, doing] / size, -left / size, rcond=DEPENDENT)
    x[doing] = own
    return x, int(rank) < A.shape[1]


def rest(left: Array, candidates: Sequence[Candidate], U: Array) -> Array:
    """What weights leave, (n,)."""
    return np.asarray(
        left + sum((one.effect(own) for one, own in zip(candidates, U, strict=True)), np.zeros_like(left))
    )


def starts(left: Array, candidates: Sequence[Candidate], linear: Sequence[bool], size: float) -> Iterator[Array]:
    """Weights to begin with: for many directions of those that are not linear, their best sizes and the others'."""
    curved = [k for k, easy in enumerate(linear) if not easy]
    many = max(LEAST_DIRECTIONS, int(MOST_STARTS ** (1.0 / len(curved))))
    angles = 2.0 * math.pi * np.arange(min(many, 72)) / min(many, 72)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for chosen in product(directions, repeat=len(curved)):
        yield sized(left, candidates, dict(zip(curved, chosen, strict=True)), size)


def sized(left: Array, candidates: Sequence[Candidate], along: dict[int, Array], size: float) -> Array:
    """The best weights with some along given directions; of these none is below 0."""
    U = np.zeros((len(candidates), 2))
    free = list(along)
    while True:
        own = {k: along[k] for k in free}
        columns = [one.by_product for k, one in enumerate(candidates) if k not in along]
        columns += [(candidates[k].by_product @ u + candidates[k].of_size(u))[:, None] for k, u in own.items()]
        if not columns:
            return U
        x, _ = straight(np.concatenate(columns, axis=1), left, size)
        sizes = x[len(x) - len(free) :] if free else x[:0]
        if (sizes >= 0.0).all():
            break
        free = [k for k, value in zip(free, sizes, strict=True) if value >= 0.0]
    others = [k for k in range(len(candidates)) if k not in along]
    for i, k in enumerate(others):
        U[k] = x[2 * i : 2 * i + 2]
    for k, value in zip(free, sizes, strict=True):
        U[k] = value * along[k]
    return U


def polished(left: Array, candidates: Sequence[Candidate], U: Array) -> Array:
    """Newton's iteration for the weights that are not 0, each step halved until it leads down."""
    active = [k for k in range(len(U)) if np.any(U[k])]
    if not active:
        return U
    some = [candidates[k] for k in active]

    def slope(x: Array) -> tuple[Array, Array]:
        own = x.reshape(-1, 2)
        J = np.concatenate([one.slope(each) for one, each in zip(some, own, strict=True)], axis=1)
        return J.T @ rest(left, some, own), J

    x = U[active].ravel()
    for _ in range(MOST_STEPS):
        g, J = slope(x)
        step = downhill(curvature(lambda at: slope(at)[0], x), J.T @ J, g)
        now = np.sum(rest(left, some, x.reshape(-1, 2)) ** 2)
        for _ in range(HALVINGS):
            if np.sum(rest(left, some, (x + step).reshape(-1, 2)) ** 2) < now:
                break
            step = 0.5 * step
        else:
            break
        x = x + step
    found = U.copy()
    found[active] = x.reshape(-1, 2)
    sizes = np.sqrt(np.sum(found**2, axis=1))
    found[sizes <= GONE * sizes.max()] = 0.0
    return found


def curvature(slope: Callable[[Array], Array], x: Array) -> Array:
    """Second derivatives, by central differences of the first."""
    h = DIFFERENCE * float(np.abs(x).max())
    rows = [(slope(x + h * e) - slope(x - h * e)) / (2.0 * h) for e in np.eye(len(x))]
    H = np.array(rows)
    return np.asarray(0.5 * (H + H.T))


def downhill(H: Array, gauss: Array, g: Array) -> Array:
    """Newton's step; Gauss and Newton's where that would lead up."""
    for matrix in (H, gauss):
        step = -np.linalg.lstsq(matrix, g, rcond=None)[0]
        if step @ g < 0.0:
            return np.asarray(step)
    return -g
