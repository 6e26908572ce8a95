"""Find velocities at the start that fit the joints: held ones are fixed, the others rest or move along.

    F u = hold,  T (σ_b − σ_a) = turn        the conditions of each joint on the rates (rows.py)

Outward as for the poses, each body in turn: the least change of σ from rest, then the least of the velocity of its
pivot (the centre of mass; the origin where the velocity is held). Islands that stay open: least Σσ² over the ones not
given, then least Σv². Then accelerations must exist for them: J a = −γ − g̈_t.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import solve_with_null_space
from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.islands import (
    MAX_BODIES,
    AssemblyIsland,
    Islands,
    rates_do_not_fit,
    settle_islands,
    singular_pose,
    too_many,
)
from heuncli.multibody.assembly.reduced_islands import ReducedIsland, least_motion
from heuncli.multibody.assembly.rows import Rows, acceleration_rows, rate_residuals, rate_rows
from heuncli.multibody.assembly.walk import AssemblyPoses, find_placement_tree
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Directed, Mechanism
from heuncli.results.results import Array

# joints of an island up to which this is checked here; in larger ones the motion will show it
MAX_CHECKED_JOINTS = 2000


@record
class Rates:
    """Rates while they are assembled; v and w are written to. The last row is the ground.

    v (n+1, 3): velocity of the pivots
    w (n+1, 3): angular velocity
    s (n+1, 3): pivots; all in world axes
    shifts, turns: which bodies may shift, and turn
    """

    v: Array
    w: Array
    s: Array
    shifts: list[bool]
    turns: list[bool]

    def scale(self, size: float) -> float:
        """Compute the scene's speed [m/s]."""
        return float(np.max(np.abs(self.v)) + size * (np.max(np.abs(self.w)) + tolerances.AT_REST))

    @property
    def are_zero(self) -> bool:
        """Whether nothing moves."""
        return not (self.v.any() or self.w.any())


def start_rates(mechanism: Mechanism, poses: AssemblyPoses) -> Rates:
    """Return the held rates, zero elsewhere."""
    n = len(mechanism.bodies)
    v, w, s = np.zeros((n + 1, 3)), np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
    for i, b in enumerate(mechanism.bodies):
        if b.angular_velocity is not None:
            w[i] = _world_vector(b.angular_velocity, poses.R[i])
        if b.velocity is not None:
            v[i] = _world_vector(b.velocity, poses.R[i])
            s[i] = poses.x[i]
        else:
            s[i] = poses.x[i] + poses.R[i] @ b.center
    return Rates(
        v, w, s,
        [b.velocity is None for b in mechanism.bodies] + [False],
        [b.angular_velocity is None for b in mechanism.bodies] + [False],
    )  # fmt: skip


def _world_vector(directed: Directed, R: Array) -> Array:
    return R @ directed.vector if directed.in_body else directed.vector


class RateAssembly:
    """The rates of a mechanism in fitting poses, while they go from rest to where all joints are satisfied. Mutable.

    rates: the present ones
    tree: how the walk reaches the bodies
    fitted: bodies fitted in an island
    """

    def __init__(
        self, mechanism: Mechanism, conditions: Sequence[JointCondition], poses: AssemblyPoses, size: float
    ) -> None:
        self.mechanism = mechanism
        self.conditions = conditions
        self.poses = poses
        self.size = size
        self.rates = start_rates(mechanism, poses)
        bodies = mechanism.bodies
        has_velocity = [b.velocity is not None for b in bodies]
        has_angular_velocity = [b.angular_velocity is not None for b in bodies]
        self.tree = find_placement_tree(
            mechanism, [(d.a, d.b, d.rate) for d in conditions], has_velocity, has_angular_velocity
        )
        fixed = [
            velocity_held and rotation_held
            for velocity_held, rotation_held in zip(has_velocity, has_angular_velocity, strict=True)
        ]
        self.islands = Islands(self.tree, conditions, [True] * len(conditions), fixed)
        self.fitted: set[int] = set()

    @cached_property
    def rows(self) -> list[Rows]:
        """The rate conditions of each joint."""
        return [rate_rows(d, self.poses.x, self.poses.R, self.rates.s) for d in self.conditions]

    def is_at_rest(self) -> bool:
        """Return whether no motion, and no acceleration from rest, is prescribed."""
        is_prescribed = any(any(d.spin) or any(d.slip) or any(d.stretch) for d in self.conditions)
        return not is_prescribed and self.rates.are_zero

    def fit(self) -> None:
        """Satisfy all joints. Raises SolveError: rates-do-not-fit."""
        if self.is_at_rest():
            return
        for body in self.tree.order:
            self._follow_joint(body)
        if stuck := settle_islands(self.tree, self.islands, self._find_open_joints, self._fit, self._place_again):
            raise self._fit_error(stuck)

    def _follow_joint(self, body: int) -> None:
        """Set the rates of a body by the joint to its parent."""
        k = self.tree.tree_joint[body]
        if k < 0:
            return
        d, row, r = self.conditions[k], self.rows[k], self.rates
        sign = 1.0 if body == d.b else -1.0
        if r.turns[body] and len(row.T):
            r.w[body] += sign * (row.T.T @ rate_residuals(d, row, r.v, r.w)[1])
        if r.shifts[body] and len(row.F):
            r.v[body] += sign * (row.F.T @ rate_residuals(d, row, r.v, r.w)[0])

    def _place_again(self, body: int) -> None:
        self._reset_body(body)
        self._follow_joint(body)

    def _reset_body(self, body: int) -> None:
        if self.rates.turns[body]:
            self.rates.w[body] = 0.0
        if self.rates.shifts[body]:
            self.rates.v[body] = 0.0

    def _residuals(self) -> tuple[Array, Array]:
        """Compute the residual of each joint [m/s], [rad/s]."""
        residuals = [
            rate_residuals(d, row, self.rates.v, self.rates.w)
            for d, row in zip(self.conditions, self.rows, strict=True)
        ]
        return np.array([_norm(hold) for hold, _ in residuals]), np.array([_norm(turn) for _, turn in residuals])

    @cached_property
    def drive_speed(self) -> float:
        """The speed [m/s] that the drives' accelerations reach over the scene's size.

        A law that reverses at the start, as cos(w t) does, has a rate of 0 there up to the rounding of such speeds.
        """
        acceleration = max(
            (max(abs(d.slip[1]), abs(d.stretch[1]), self.size * abs(d.spin[1])) for d in self.conditions), default=0.0
        )
        return math.sqrt(self.size * acceleration)

    def _limit(self) -> float:
        return tolerances.OPEN_RATE * (self.rates.scale(self.size) + self.drive_speed)

    def _find_open_joints(self) -> list[int]:
        speed, spin = self._residuals()
        return [int(k) for k in np.flatnonzero(np.maximum(speed, self.size * spin) > self._limit())]

    def _fit(self, island: AssemblyIsland, afresh: bool) -> None:
        r = self.rates
        if len(island.members) > MAX_BODIES:
            raise too_many(self.mechanism, island, "velocities")
        for body in island.members:
            self._reset_body(body)
        joints = [k for k in island.tree_joints if k >= 0] + island.closures
        rows = {k: _residual_rows(self.conditions[k], self.rows[k], r) for k in joints}
        free = [(r.turns[i], r.shifts[i]) for i in island.members]
        z, lack = least_motion(ReducedIsland(island, self.conditions, rows, free, self.size), np.zeros(6 * len(free)))
        for i, body in enumerate(island.members):
            r.w[body] += z[6 * i : 6 * i + 3]
            r.v[body] += self.size * z[6 * i + 3 : 6 * i + 6]
        if self.size * _norm(lack) <= self._limit():
            self.fitted.update(island.members)
        elif self.islands.moving_body(island.parent) == GROUND:
            raise self._fit_error(joints)
        else:
            self.islands.widen(island.closures[0])  # the bodies that carry it may have to move, too

    def _fit_error(self, joints: Sequence[int]) -> Exception:
        return rates_do_not_fit(self.mechanism, *self._residuals(), self.size, joints)

    def require_accelerations(self) -> None:
        """Check that accelerations exist for the rates, in every loop. Raises SolveError: singular-pose."""
        if self.is_at_rest():
            return
        n = len(self.mechanism.bodies)
        r, x, R = self.rates, self.poses.x, self.poses.R
        tree = find_placement_tree(
            self.mechanism, [(d.a, d.b, d.rate) for d in self.conditions], [False] * n, [False] * n
        )
        islands = Islands(tree, self.conditions, [True] * len(self.conditions), [False] * n)
        for group in islands.find_looped_groups():
            island = islands.get_island(group)
            joints = [k for k in island.tree_joints if k >= 0] + island.closures
            rows = {k: acceleration_rows(self.conditions[k], self.rows[k], x, R, r.v, r.w) for k in joints}
            required = max(max(_norm(row.hold), self.size * _norm(row.turn)) for row in rows.values())
            if required == 0.0 or len(joints) > MAX_CHECKED_JOINTS:
                continue
            reduced = ReducedIsland(island, self.conditions, rows, [(True, True)] * len(island.members), self.size)
            rounding = tolerances.NO_ACCELERATION * r.scale(self.size) ** 2 / self.size
            if (
                self.size * _norm(solve_with_null_space(reduced.orthonormalize()[1], reduced.e)[2])
                > tolerances.SOLVABLE * required + rounding
            ):
                raise singular_pose(self.mechanism, island.closures[0], joints)


def _residual_rows(d: JointCondition, row: Rows, r: Rates) -> Rows:
    hold, turn = rate_residuals(d, row, r.v, r.w)
    return replace(row, hold=hold, turn=turn)


def _norm(a: Array) -> float:
    return float(np.sqrt(a @ a))
