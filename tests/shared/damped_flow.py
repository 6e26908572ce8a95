"""Where a heavily damped motion from the start comes to rest: dq/ds = a(q, rates 0), followed to ten digits.

LSODA follows it from contact to contact; the rest pose is then made exact by Newton's steps in long doubles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import LSODA
from scipy.optimize import brentq

from tests.shared.rest_trees import STIFF, TOUCHES, Equations, Pushed, Vector, bearing, solve

RTOL, ATOL = 1e-10, 1e-13
MOST_STEPS = 6_000
MOST_SWITCHES = 200
SLOW = 1e-8  # of the first acceleration: then Newton's steps are tried
NEAR = 1e-6  # how far they may lead
DRAWN = 1e-12  # how near a start is to an unstable pose that is drawn in it
FAR = 150.0  # rad or m
FLAT = 1e-9  # of the largest eigenvalue: what is indifferent


class NoRest(Exception):
    """Why the flow comes to no rest."""


@dataclass
class Rest:
    """place: of the rest; points (p, 3) there, in long doubles; eigenvalues of the law about it; bears: contacts.

    steps, switches: of the flow, of its contacts; ridge: the least acceleration on the way before it grew again, of the
    first one; margin: how near the contacts are to a change; off: how far the flow's end is from the rest.
    """

    place: Vector
    points: Vector
    eigenvalues: Vector
    bears: list[int]
    steps: int
    switches: int
    ridge: float
    margin: float
    off: float

    @property
    def indifferent(self) -> int:
        size = float(np.abs(self.eigenvalues).max(initial=0.0))
        return int((np.abs(self.eigenvalues) <= FLAT * size).sum())

    @property
    def unstable(self) -> bool:
        """Whether a small motion grows, x'' = A x."""
        size = float(np.abs(self.eigenvalues).max(initial=0.0))
        s = np.sqrt(self.eigenvalues[np.abs(self.eigenvalues) > FLAT * size].astype(complex))
        return bool((np.abs(s.real) > 1e-6 * np.sqrt(size)).any())


class Flow:
    """A flow under way."""

    def __init__(self, eq: Equations, y0: Vector | None = None, rtol: float = RTOL) -> None:
        self.eq, self.rtol = eq, rtol
        self.y = eq.y0.copy() if y0 is None else y0
        self.bears: list[int] = []
        self.steps = self.switches = 0
        self.ridge = 1.0
        self.low = self.first = 0.0

    def answer(self, y: Vector, at: Pushed | None = None) -> tuple[Vector, Vector, Pushed]:
        """Accelerations, lambda of the contacts that bear."""
        at = self.eq.pushed_at(y) if at is None else at
        J = np.concatenate([at.J, at.C[self.bears]])
        a, lam = solve(at.M, at.Q, J, -STIFF * np.concatenate([at.phi, at.gaps[self.bears]]))
        return a, lam[len(at.J) :], at

    def law(self, s: float, y: Vector) -> Vector:
        return self.eq.rates(y, self.answer(y)[0])

    def settle(self, leave: int = -1) -> None:
        """The contacts that bear from here on."""
        at = self.eq.pushed_at(self.y)
        self.bears, _ = bearing(at, np.flatnonzero(at.gaps <= TOUCHES).tolist(), leave)
        self.left = leave

    def run(self) -> Rest:
        """To the rest. Raises NoRest."""
        self.settle()
        self.first = float(np.abs(self.answer(self.y)[0]).max(initial=0.0))
        if self.first == 0.0:
            self.first = 1.0
        self.low = self.first
        while True:
            found = self.stretch()
            if found is not None:
                return found
            self.switches += 1
            if self.switches > MOST_SWITCHES:
                raise NoRest("contacts change without end")

    def stretch(self) -> Rest | None:
        """From one change of the contacts to the next, or to the rest."""
        flow = LSODA(self.law, 0.0, self.y, np.inf, rtol=self.rtol, atol=ATOL)
        a, lam, at = self.answer(self.y)
        due = 0
        found = self.at_rest()
        if found is not None:
            return found
        while True:
            before = flow.y.copy()
            message = flow.step()
            self.steps += 1
            if flow.status == "failed":
                raise NoRest(f"the flow cannot be followed: {message}")
            self.y = flow.y
            a, lam, at = self.answer(self.y)
            if len(at.gaps) and self.changes(flow, before, lam, at):
                return None
            size = float(np.abs(a).max(initial=0.0))
            if size > 10 * self.low:
                self.ridge = min(self.ridge, self.low / self.first)
            self.low = min(self.low, size)
            if np.abs(self.y).max() > FAR or not np.isfinite(size):
                raise NoRest("runs away")
            if self.steps > MOST_STEPS:
                raise NoRest("does not end")
            due -= 1
            if size < SLOW * self.first and due <= 0:
                found = self.at_rest()
                if found is not None:
                    return found
                due = 10

    def changes(self, flow: LSODA, before: Vector, lam: Vector, at: Pushed) -> bool:
        """Whether a contact closed or let go in the last step; then y is the place where the first did."""
        open_ = [k for k in range(len(at.gaps)) if k not in self.bears]
        closed = [k for k in open_ if at.gaps[k] < (-1e-12 if k != self.left else -10 * TOUCHES)]
        pulls = [n for n in range(len(lam)) if lam[n] < -1e-12 * float(np.abs(at.Q).max())]
        if not closed and not pulls:
            return False
        between = flow.dense_output()
        first, which, leave = flow.t, -1, -1
        for kind, ks in ((0, closed), (1, pulls)):
            for k in ks:

                def value(s: float, kind: int = kind, k: int = k) -> float:
                    _, lam, at = self.answer(between(s))
                    return float(lam[k] if kind else at.gaps[k])

                low = value(flow.t_old)
                s = flow.t_old if low <= 0.0 else brentq(value, flow.t_old, flow.t, xtol=1e-15 * max(flow.t, 1e-300))
                if s <= first:
                    first, which, leave = s, kind, self.bears[k] if kind else -1
        self.y = between(first) if first > flow.t_old else before
        self.settle(leave if which == 1 else -1)
        return True

    # ---- the pose itself ----------------------------------------------------------------------------------------
    def at_rest(self) -> Rest | None:
        """The rest pose next to y, if y is that near to one that holds it; None else."""
        eq, bears = self.eq, self.bears
        y = self.y.astype(np.longdouble)
        at = eq.pushed_at(y)
        m = len(at.J) + len(bears)
        lam = self.multipliers(at)
        off = 0.0
        for _ in range(8):
            K, J, M = self.slopes(y, lam)
            at = eq.pushed_at(y)
            rows = np.concatenate([at.J, at.C[bears]])
            left = np.concatenate([at.Q + rows.T @ lam, np.concatenate([at.phi, at.gaps[bears]])])
            T, A = tangent(K, J, M)
            by, change = step(K, J, T, A, left.astype(float), M)
            off = max(off, float(np.abs(by).max(initial=0.0)))
            if off > NEAR:
                return None
            y, lam = eq.moved(y, by), lam + change[:m]
            if np.abs(by).max(initial=0.0) < 1e-12:  # the next one's is the square, or 1e-8 of it
                break
        values = np.linalg.eigvals(A) if len(A) else np.zeros(0)
        size = float(np.abs(values).max(initial=0.0))
        if (values.real > FLAT * size).any() and off > DRAWN:
            return None  # the flow passes by
        at = eq.pushed_at(y)
        slack = np.delete(at.gaps, bears)
        pulls = lam[len(at.J) :] / (np.abs(at.Q).max(initial=0.0) + 1e-300)
        if (slack < -1e-9).any() or (pulls < -1e-9).any():
            return None
        margin = min([1.0, *slack.astype(float), *np.abs(pulls).astype(float)])
        return Rest(y, at.P[eq.told], values, bears, self.steps, self.switches, self.ridge, margin, off)

    def multipliers(self, at: Pushed) -> Vector:
        J = np.concatenate([at.J, at.C[self.bears]]).astype(float)
        if not len(J):
            return np.zeros(0, dtype=np.longdouble)
        return np.linalg.lstsq(J.T, -at.Q.astype(float), rcond=1e-11)[0].astype(np.longdouble)

    def slopes(self, y: Vector, lam: Vector) -> tuple[Vector, Vector, Vector]:
        """d(Q + J' lambda)/dq, J, M."""
        eq, h = self.eq, np.longdouble(1e-6)

        def left(by: Vector) -> Vector:
            at = eq.pushed_at(eq.moved(y, by))
            return at.Q + np.concatenate([at.J, at.C[self.bears]]).T @ lam

        K = np.zeros((eq.f, eq.f))
        for k in range(eq.f):
            e = np.zeros(eq.f, dtype=np.longdouble)
            e[k] = h
            K[:, k] = ((left(e) - left(-e)) / (2 * h)).astype(float)
        at = eq.pushed_at(y)
        return K, np.concatenate([at.J, at.C[self.bears]]).astype(float), at.M.astype(float)


def tangent(K: Vector, J: Vector, M: Vector) -> tuple[Vector, Vector]:
    """What the rows leave free, (f, m), and the law along it, (m, m)."""
    if len(J):
        _, sizes, rows = np.linalg.svd(J / np.linalg.norm(J, axis=1)[:, None])
        T = rows[int((sizes > 1e-8).sum()) :].T
    else:
        T = np.eye(len(M))
    return T, np.linalg.solve(T.T @ M @ T, T.T @ K @ T) if T.shape[1] else np.zeros((0, 0))


def step(K: Vector, J: Vector, T: Vector, A: Vector, left: Vector, M: Vector) -> tuple[Vector, Vector]:
    """Newton's step and the change of lambda; along what is indifferent none."""
    f, m = len(K), len(J)
    by = np.linalg.lstsq(J, -left[f:], rcond=1e-11)[0] if m else np.zeros(f)
    if T.shape[1]:
        rest = -np.linalg.solve(T.T @ M @ T, T.T @ (left[:f] + K @ by))
        by = by + T @ np.linalg.lstsq(A, rest, rcond=FLAT)[0]
    change = np.linalg.lstsq(J.T, -(left[:f] + K @ by), rcond=1e-11)[0] if m else np.zeros(0)
    return by, change


def rest_of(eq: Equations, y0: Vector | None = None, rtol: float = RTOL) -> Rest:
    """Where it comes to rest. Raises NoRest."""
    with np.errstate(all="ignore"):
        return Flow(eq, y0, rtol).run()
