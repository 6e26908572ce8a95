"""Velocities at the start that fit the joints: held ones fixed, the others at rest or moved along.

    F u = hold,  T (σ_b − σ_a) = turn        what each joint asks of the rates (rows.py)
Outward as the poses, each body in turn: the least change of σ from rest, then the least of the velocity of its pivot
(the centre of mass; the origin where the velocity is held). Islands that stay open: least Σσ² over the left-out ones,
then least Σv². Then accelerations must exist for them: J a = −γ − g̈_t.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.errors import rates_do_not_fit, singular_pose, too_many
from heuncli.multibody.assembly.islands import TOGETHER, AssemblyIsland, Islands, settle
from heuncli.multibody.assembly.row_reduction import ReducedIsland, least, solve
from heuncli.multibody.assembly.rows import Rows, acceleration_rows, missing, rate_rows
from heuncli.multibody.assembly.walk import AssemblyPoses, spanning
from heuncli.multibody.mechanism.model import GROUND, Directed, Mechanism
from heuncli.results.results import Array

CHECKED = 2000  # joints of an island up to which this is checked beforehand; beyond, the motion shows it


@record
class Rates:
    """Rates while they are assembled: v and w are written to. The last row is the ground.

    v (n+1, 3) velocity of the pivots, w (n+1, 3) angular velocity, s (n+1, 3) pivots, all world. shifts, turns: who
    may.
    """

    v: Array
    w: Array
    s: Array
    shifts: list[bool]
    turns: list[bool]

    def scale(self, size: float) -> float:
        """The scene's speed [m/s]."""
        return float(np.max(np.abs(self.v)) + size * (np.max(np.abs(self.w)) + tolerances.AT_REST))

    @property
    def are_zero(self) -> bool:
        """Whether nothing moves."""
        return not (self.v.any() or self.w.any())


def start_rates(mechanism: Mechanism, poses: AssemblyPoses) -> Rates:
    """Rates as held, else at rest."""
    n = len(mechanism.bodies)
    v, w, s = np.zeros((n + 1, 3)), np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
    for i, b in enumerate(mechanism.bodies):
        if b.angular_velocity is not None:
            w[i] = _world(b.angular_velocity, poses.R[i])
        if b.velocity is not None:
            v[i] = _world(b.velocity, poses.R[i])
            s[i] = poses.x[i]
        else:
            s[i] = poses.x[i] + poses.R[i] @ b.center
    return Rates(
        v, w, s,
        [b.velocity is None for b in mechanism.bodies] + [False],
        [b.angular_velocity is None for b in mechanism.bodies] + [False],
    )  # fmt: skip


def _world(given: Directed, R: Array) -> Array:
    return R @ given.vector if given.in_body else given.vector


class Moving:
    """The rates of a mechanism in poses that fit, on their way from rest to where all joints are met; it is written to.

    rates: where they are; tree: how the walk reaches them. fitted: bodies fitted in an island.
    """

    def __init__(
        self, mechanism: Mechanism, found: Sequence[JointCondition], poses: AssemblyPoses, size: float
    ) -> None:
        self.mechanism = mechanism
        self.found = found
        self.poses = poses
        self.size = size
        self.rates = start_rates(mechanism, poses)
        bodies = mechanism.bodies
        held = [b.velocity is not None for b in bodies]
        turns = [b.angular_velocity is not None for b in bodies]
        self.tree = spanning(mechanism, [(d.a, d.b, d.rate) for d in found], held, turns)
        fixed = [h and t for h, t in zip(held, turns, strict=True)]
        self.islands = Islands(self.tree, found, [True] * len(found), fixed)
        self.fitted: set[int] = set()

    @cached_property
    def rows(self) -> list[Rows]:
        """What each joint asks."""
        return [rate_rows(d, self.poses.x, self.poses.R, self.rates.s) for d in self.found]

    def at_rest(self) -> bool:
        """Whether nothing is given a motion, or a start of one."""
        given = any(any(d.spin) or any(d.slip) or any(d.stretch) for d in self.found)
        return not given and self.rates.are_zero

    def fit(self) -> None:
        """Meet all joints. Raises SolveError: rates-do-not-fit."""
        if self.at_rest():
            return
        for body in self.tree.order:
            self._follow(body)
        if stuck := settle(self.tree, self.islands, self._open, self._fit, self._walk_on):
            raise self._refusal(stuck)

    def _follow(self, body: int) -> None:
        """Set the rates of a body by the joint it hangs on."""
        k = self.tree.via[body]
        if k < 0:
            return
        d, row, r = self.found[k], self.rows[k], self.rates
        sign = 1.0 if body == d.b else -1.0
        if r.turns[body] and len(row.T):
            r.w[body] += sign * (row.T.T @ missing(d, row, r.v, r.w)[1])
        if r.shifts[body] and len(row.F):
            r.v[body] += sign * (row.F.T @ missing(d, row, r.v, r.w)[0])

    def _walk_on(self, body: int) -> None:
        self._rest(body)
        self._follow(body)

    def _rest(self, body: int) -> None:
        if self.rates.turns[body]:
            self.rates.w[body] = 0.0
        if self.rates.shifts[body]:
            self.rates.v[body] = 0.0

    def _lacking(self) -> tuple[Array, Array]:
        """What each joint lacks [m/s], [rad/s]."""
        lack = [missing(d, row, self.rates.v, self.rates.w) for d, row in zip(self.found, self.rows, strict=True)]
        return np.array([_norm(hold) for hold, _ in lack]), np.array([_norm(turn) for _, turn in lack])

    @cached_property
    def driven(self) -> float:
        """The speed [m/s] that the drives' accelerations give over the scene's size.

        A law that turns back at the start, as cos(w t) does, has a rate of 0 there that is rounding of such speeds.
        """
        most = max(
            (max(abs(d.slip[1]), abs(d.stretch[1]), self.size * abs(d.spin[1])) for d in self.found), default=0.0
        )
        return math.sqrt(self.size * most)

    def _limit(self) -> float:
        return tolerances.OPEN_RATE * (self.rates.scale(self.size) + self.driven)

    def _open(self) -> list[int]:
        speed, spin = self._lacking()
        return [int(k) for k in np.flatnonzero(np.maximum(speed, self.size * spin) > self._limit())]

    def _fit(self, island: AssemblyIsland, afresh: bool) -> None:
        r = self.rates
        if len(island.members) > TOGETHER:
            raise too_many(self.mechanism, island, "velocities")
        for body in island.members:
            self._rest(body)
        joints = [k for k in island.via if k >= 0] + island.closures
        rows = {k: _lacking_rows(self.found[k], self.rows[k], r) for k in joints}
        free = [(r.turns[i], r.shifts[i]) for i in island.members]
        z, lack = least(ReducedIsland(island, self.found, rows, free, self.size), np.zeros(6 * len(free)))
        for i, body in enumerate(island.members):
            r.w[body] += z[6 * i : 6 * i + 3]
            r.v[body] += self.size * z[6 * i + 3 : 6 * i + 6]
        if self.size * _norm(lack) <= self._limit():
            self.fitted.update(island.members)
        elif self.islands.moving(island.above) == GROUND:
            raise self._refusal(joints)
        else:
            self.islands.widened(island.closures[0])  # what it hangs on may have to move, too

    def _refusal(self, joints: Sequence[int]) -> Exception:
        return rates_do_not_fit(self.mechanism, *self._lacking(), self.size, joints)

    def check(self) -> None:
        """Accelerations must exist for the rates, in every loop. Raises SolveError: singular-pose."""
        if self.at_rest():
            return
        n = len(self.mechanism.bodies)
        r, x, R = self.rates, self.poses.x, self.poses.R
        tree = spanning(self.mechanism, [(d.a, d.b, d.rate) for d in self.found], [False] * n, [False] * n)
        islands = Islands(tree, self.found, [True] * len(self.found), [False] * n)
        for group in islands.all():
            island = islands.island(group)
            joints = [k for k in island.via if k >= 0] + island.closures
            rows = {k: acceleration_rows(self.found[k], self.rows[k], x, R, r.v, r.w) for k in joints}
            asked = max(max(_norm(row.hold), self.size * _norm(row.turn)) for row in rows.values())
            if asked == 0.0 or len(joints) > CHECKED:
                continue
            reduced = ReducedIsland(island, self.found, rows, [(True, True)] * len(island.members), self.size)
            rounding = tolerances.NO_ACCELERATION * r.scale(self.size) ** 2 / self.size
            if self.size * _norm(solve(reduced.measured()[1], reduced.e)[2]) > tolerances.SOLVABLE * asked + rounding:
                raise singular_pose(self.mechanism, island.closures[0], joints)


def _lacking_rows(d: JointCondition, row: Rows, r: Rates) -> Rows:
    hold, turn = missing(d, row, r.v, r.w)
    return replace(row, hold=hold, turn=turn)


def _norm(a: Array) -> float:
    return float(np.sqrt(a @ a))
