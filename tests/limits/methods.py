"""The methods that fail, as plain code: a step of Runge and Kutta, a constrained system solved by normal equations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from heuncli.results.results import Array
from tests.oracle.loads import gathered, pushes
from tests.oracle.read import model, start_state
from tests.oracle.rows import assemble
from tests.oracle.solve import inertia

Slope = Callable[[Array], Array]


def heun(slope: Slope, y: Array, h: float) -> Array:
    """A step of Heun's method of order 2."""
    first = slope(y)
    return y + h / 2 * (first + slope(y + h * first))


def rk4(slope: Slope, y: Array, h: float) -> Array:
    """A step of the classical method of order 4."""
    a = slope(y)
    b = slope(y + h / 2 * a)
    c = slope(y + h / 2 * b)
    return y + h / 6 * (a + 2 * (b + c) + slope(y + h * c))


def stepped(step: Callable[[Slope, Array, float], Array], slope: Slope, y: Array, h: float, n: int) -> Iterator[Array]:
    """What a method with n steps of h passes, the start among it."""
    yield y
    for _ in range(n):
        y = step(slope, y, h)
        yield y


class Equations:
    """M V' - J^T λ = F - b, J V' = -γ of a scene at its start: all rows of all joints, none left out.

    Rows and inertias are the oracle's (tests/oracle), of bodies apart, in absolute coordinates.
    """

    def __init__(self, scene: dict[str, Any]) -> None:
        read, state = model(scene), start_state(scene)
        rows = assemble(read, state, 0.0)
        self.M, b = inertia(read, state)
        self.F = gathered(read, state, pushes(read, state, 0.0)) - b
        self.J, self.wanted, self.rows = rows.J, rows.acceleration - rows.gamma, rows.rows

    def normal(self) -> tuple[Array, Array]:
        """A = J M^-1 J^T and the right-hand side of A λ = ..."""
        free = np.linalg.solve(self.M, self.J.T)
        return self.J @ free, self.wanted - free.T @ self.F

    def by_cholesky(self) -> Array:
        """The multipliers by Cholesky's factor of A. Raises LinAlgError where A has none."""
        A, right = self.normal()
        L = np.linalg.cholesky(A)
        return np.asarray(np.linalg.solve(L.T, np.linalg.solve(L, right)))

    def without(self, order: list[int]) -> Array:
        """The multipliers where each row that depends on those before it is dropped, taken in this order."""
        kept: list[int] = []
        for k in order:
            if np.linalg.matrix_rank(self.J[[*kept, k]], 1e-9) > len(kept):
                kept.append(k)
        A, right = self.normal()
        found = np.zeros(len(right))
        found[kept] = np.linalg.solve(A[np.ix_(kept, kept)], right[kept])
        return found

    def force(self, found: Array, joint: str) -> Array:
        """A joint's force on its `to` body, (3,)."""
        parts = [x * row.force for x, row in zip(found, self.rows, strict=True) if row.joint == joint]
        return np.asarray(np.sum(parts, axis=0))

    def least_squares(self) -> tuple[Array, float]:
        """V' of all equations at once in the mean, and the largest part of J V' + γ that is left over."""
        zero = np.zeros((len(self.J), len(self.J)))
        whole = np.block([[self.M, -self.J.T], [self.J, zero]])
        found = np.linalg.lstsq(whole, np.concatenate([self.F, self.wanted]), rcond=None)[0]
        accelerations = found[: len(self.M)]
        return accelerations, float(np.abs(self.J @ accelerations - self.wanted).max())
