"""Motions under loads that change their law at edges: every edge is met, for it is known where each one stands.

Coordinates x, rates u and the work done by the loads are integrated by SciPy's DOP853 from edge to edge. Within a step
each load keeps the law it began with, so what is integrated is smooth, and its interpolant a polynomial; all roots of
that polynomial are looked at, by Bernstein's bounds and then by its companion matrix. None is sampled.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy.integrate import DOP853
from scipy.special import comb

Law = Callable[[float], float]
Vector = np.ndarray
Accelerations = Callable[[float, Vector, Vector, Vector], Vector]  # of t, x, u and the forces along the coordinates

MOST_STEPS = 2000
MOST_CROSSINGS = 5000
DEGREE = 7  # of DOP853's interpolant


class Load(NamedTuple):
    """What acts along a coordinate as a function of one variable: t, x or u with a number.

    laws: one more than edges; narrow: the width of a law that is no polynomial.
    """

    on: int
    kind: str
    number: int
    edges: tuple[float, ...]
    laws: tuple[Law, ...]
    narrow: float = math.inf


class Moving(Protocol):
    """What moves: from where, how it answers to forces along its coordinates, and those that always act."""

    @property
    def start(self) -> tuple[Vector, Vector]: ...
    @property
    def accelerations(self) -> Accelerations: ...
    @property
    def forces(self) -> Callable[[Vector], Vector]: ...


class Laborious(Exception):
    """More steps than a test has time for."""


class Chatters(Exception):
    """Either side of an edge drives back to the other from this instant on."""

    def __init__(self, at: float) -> None:
        super().__init__(f"chatters at t = {at!r}")
        self.at = at


def monomials() -> Vector:
    """The rows x, x (1 - x), x² (1 - x), ... of the interpolant as coefficients of 1, x, x² ..."""
    rows, now = [], np.array([1.0])
    for k in range(DEGREE):
        now = np.polynomial.polynomial.polymul(now, [0.0, 1.0] if k % 2 == 0 else [1.0, -1.0])
        rows.append(np.pad(now, (0, DEGREE + 1 - len(now))))
    return np.array(rows)


ROWS = monomials()
BERNSTEIN = np.array([[comb(k, i) / comb(DEGREE, i) for i in range(DEGREE + 1)] for k in range(DEGREE + 1)])


def first_root(p: Vector, from_zero: bool) -> float | None:
    """The first root in (0, 1] of a polynomial; from_zero: it starts at a root, which does not count."""
    if from_zero:
        p = np.append(p[1:], 0.0)
    bounds = BERNSTEIN @ p
    if bounds.min() > 0.0 or bounds.max() < 0.0:
        return None
    roots = np.polynomial.polynomial.polyroots(np.trim_zeros(p, "b")) if np.any(p[1:]) else np.zeros(0)
    inside = [r.real for r in np.asarray(roots, dtype=complex) if r.imag == 0.0 and 0.0 < r.real <= 1.0]
    return min(inside, default=None)


class Motion:
    """One motion: its state y = (x, u, work), and the law each load is at."""

    def __init__(self, machine: Moving, loads: Sequence[Load], rtol: float) -> None:
        x, u = machine.start
        self.accelerations, self.forces = machine.accelerations, machine.forces
        self.loads, self.n, self.rtol = loads, len(x), rtol
        self.t, self.y = 0.0, np.concatenate([x, u, [0.0]])
        self.at = [bisect.bisect_right(load.edges, self.variable(load, 0.0, self.y)) for load in loads]
        self.crossed: tuple[int, int] | None = None  # the load whose edge the motion stands on, and that edge
        self.crossings = self.steps = 0
        self.largest = np.maximum(np.abs(self.y), 1e-3)

    def variable(self, load: Load, t: float, y: Vector) -> float:
        return t if load.kind == "t" else float(y[load.number + (self.n if load.kind == "u" else 0)])

    def slope(self, t: float, y: Vector) -> Vector:
        x, u = y[: self.n], y[self.n : 2 * self.n]
        Q = self.forces(x)
        for load, at in zip(self.loads, self.at, strict=True):
            Q[load.on] += load.laws[at](self.variable(load, t, y))
        return np.concatenate([u, self.accelerations(t, x, u, Q), [Q @ u]])

    def rate_of(self, load: Load) -> float:
        """How fast the load's variable changes."""
        if load.kind == "t":
            return 1.0
        return float(self.slope(self.t, self.y)[load.number + (self.n if load.kind == "u" else 0)])

    def run(self, times: Sequence[float]) -> Vector:
        """The states at ascending times."""
        found = []
        for end in times:
            while self.t < end:
                self.to_next(end)
            found.append(self.y.copy())
        return np.array(found)

    def to_next(self, end: float) -> None:
        """On to the next edge, or the end."""
        for load, at in zip(self.loads, self.at, strict=True):
            if load.kind == "t" and at < len(load.edges):
                end = min(end, load.edges[at])
        solver = self.solver(end)
        while solver.status == "running":
            solver.max_step = self.longest(solver)
            before, y = solver.t, solver.y.copy()
            self.steps += 1
            if self.steps > MOST_STEPS:
                raise Laborious
            solver.step()
            if solver.status == "failed":
                raise RuntimeError("DOP853 gave up")
            found = self.first_crossing(solver.dense_output())
            self.largest = np.maximum(self.largest, np.abs(solver.y))
            if found is not None:
                number, edge, s = found
                self.land(before, y, before + s * (solver.t - before), number, edge)
                return
            self.crossed = None
            self.t, self.y = solver.t, solver.y.copy()
        self.pass_times()

    def solver(self, end: float) -> Any:
        scale = np.maximum(self.largest, 1e-3)
        return DOP853(self.slope, self.t, self.y, end, rtol=self.rtol, atol=self.rtol * scale * 0.1)

    def longest(self, solver: Any) -> float:
        """A step within which what is narrow does not change by much."""
        longest = math.inf
        slope = self.slope(solver.t, solver.y)
        for load, at in zip(self.loads, self.at, strict=True):
            if 0 < at < len(load.edges):
                width = min(load.narrow / 3, load.edges[at] - load.edges[at - 1])
                rate, bend = 1.0, 0.0
                if load.kind != "t":
                    k = load.number + (self.n if load.kind == "u" else 0)
                    rate = abs(slope[k])
                    bend = math.sqrt(width * abs(slope[self.n + load.number])) if load.kind == "x" else 0.0
                longest = min(longest, width / max(rate, bend, 1e-300))
        return max(longest, 1e-14)

    def first_crossing(self, dense: Any) -> tuple[int, int, float] | None:
        """Load, edge and place in the step of the first edge that the interpolant meets."""
        first: tuple[int, int, float] | None = None
        for number, (load, at) in enumerate(zip(self.loads, self.at, strict=True)):
            if load.kind == "t":
                continue
            k = load.number + (self.n if load.kind == "u" else 0)
            p = dense.F[:, k] @ ROWS
            for edge in (at - 1, at):
                if not 0 <= edge < len(load.edges):
                    continue
                p[0] = dense.y_old[k] - load.edges[edge]
                s = first_root(p, self.crossed == (number, edge))
                if s is not None and (first is None or s < first[2]):
                    first = number, edge, s
        return first

    def land(self, t: float, y: Vector, at: float, number: int, edge: int) -> None:
        """Step exactly onto the edge, and to the other side's law. The others' edges at the same place come next."""
        load = self.loads[number]
        for _ in range(3):
            self.t, self.y = t, y
            if at > t:
                solver = self.solver(at)
                solver.max_step = self.longest(solver)
                while solver.status == "running":
                    solver.step()
                self.t, self.y = at, solver.y.copy()
            rate = self.rate_of(load)
            off = (self.variable(load, self.t, self.y) - load.edges[edge]) / rate if rate else 0.0
            if not abs(off) > 1e-16 * abs(at):
                break
            at -= off
        up = self.at[number] == edge
        side = 1.0 if up else -1.0
        self.at[number] = edge + 1 if up else edge
        if self.rate_of(load) * side < 0.0:
            raise Chatters(self.t)
        self.crossed = number, edge
        self.crossings += 1
        if self.crossings > MOST_CROSSINGS:
            raise Chatters(self.t)

    def pass_times(self) -> None:
        """The laws from this instant on."""
        for number, load in enumerate(self.loads):
            if load.kind == "t":
                self.at[number] = bisect.bisect_right(load.edges, self.t)
        self.crossed = None
