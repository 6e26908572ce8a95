"""Poses and rates that meet couplings: the least change of the bodies' turns from what the joints alone ask for.

    C y = e                 what is held, and the closure rows of joints; then, as far as these leave it, couplings
    least sum of |turn|^2, then least sum of |shift|^2, of all bodies that are tied together
y the step of the freedoms. Of rates one step is exact. Of poses steps of at most 0.3 rad go on until all rows are
closed, then steps that take the change so far into the sums, each closed again and kept only if it lowers them.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.multibody.assembly.row_reduction import solve
from heuncli.multibody.coupled_start.freedoms import FreedomMotion, Freedoms
from heuncli.multibody.coupled_start.held import Rows, held_poses, held_rates
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.response import MeasuredState
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import to_vector

TURN = 0.3  # largest turn of one step [rad]
STEPS = 200
POLISH = 20
HALVINGS = 10


@record
class AskedRows:
    """The closure rows that a start has to meet: of the joints, and of couplings, whose poses and whose rates count."""

    joints: Indices
    poses: Indices
    rates: Indices


class CoupledFit:
    """A laid-out scene on the way to a start that meets its couplings; state: where it is."""

    def __init__(self, scene: PreparedScene, t: float, asked: AskedRows, bodies: Iterable[int]) -> None:
        """bodies: places in the tree of those whose changes count; all of them may move until others are released."""
        self.scene, self.asked, self.t = scene, asked, t
        self.size, self.state = scene.layout.size, scene.layout.y0.copy()
        places = sorted(bodies)
        self.release(places)
        self.bodies = [scene.layout.spanning.hangs[i].body for i in places]
        self.centres = np.array([body.center for body in scene.mechanism.bodies])
        self.arms = self.centres[self.bodies]
        weight = scene.layout.tables["closures"]["weight"][: len(scene.layout.rows)]
        self.weight = weight / self.size  # of gaps, and of their rates

    def release(self, places: Iterable[int]) -> None:
        """Let the freedoms of these bodies (places in the tree) change, and no others."""
        self.freedoms = Freedoms(self.scene.layout, self.t, places)

    def now(self) -> tuple[MeasuredState, Assembly]:
        """What is measured at the state, and the start that it is."""
        told = self.freedoms.measured(self.state)
        return told, self.freedoms.assembly(told, self.scene.start)

    def at(self, state: Array) -> Assembly:
        """The start that another state is."""
        return self.freedoms.assembly(self.freedoms.measured(state), self.scene.start)

    def lengths(self, rows: Indices) -> Array:
        """By which gaps and rates of rows are lengths [m per unit]."""
        return np.asarray(self.weight[rows] * self.size)

    def gap(self) -> float:
        """The largest gap of all that is asked and held, by the size, or rad."""
        return self._gap(*self.now())

    def speed(self) -> float:
        """The scene's speed [m/s], as rates of joints are measured by."""
        _, now = self.now()
        v = now.velocity + np.cross(now.angular_velocity, np.einsum("nij,nj->ni", now.rotation, self.centres))
        spin = float(np.max(np.abs(now.angular_velocity))) + tolerances.AT_REST
        return float(np.max(np.abs(v))) + self.size * spin

    # Rates

    def fit_rates(self) -> Array:
        """Change the rates; what is left of the couplings' rows [m/s], (rows,) of `asked.rates`."""
        spread, hard, soft = self._asked_of_rates()
        step, _ = _least(spread, hard, soft, None)
        self.state = self.freedoms.hurried(self.state, step)
        own = self.asked.rates
        return np.asarray(self.freedoms.measured(self.state).rates[own] * self.lengths(own))

    def could_stay(self, body: int) -> bool:
        """Whether other rates that meet all rows leave a body (spec's order) as it was; before the rates are fitted."""
        spread, hard, soft = self._asked_of_rates()
        k, half = self.bodies.index(body), len(spread) // 2
        own = np.concatenate([spread[3 * k : 3 * k + 3], spread[half + 3 * k : half + 3 * k + 3]])
        _, R = np.linalg.qr(spread)
        J = np.linalg.solve(R.T, np.concatenate([hard[0], soft[0], own]).T).T
        e = np.concatenate([hard[1], soft[1], np.zeros(len(own))])
        left = solve(J, e)[2]
        return bool(np.abs(left).max(initial=0.0) <= tolerances.RANK * np.abs(e).max(initial=0.0))

    def _asked_of_rates(self) -> tuple[Array, Rows, Rows]:
        """What the freedoms move; rows of joints and of what is held; rows of couplings, at the rates of the state."""
        told, now = self.now()
        motion = self.freedoms.motion(self.state)
        hard = [self._rows(motion, told.rates, self.asked.joints), *held_rates(self.scene, now, motion)]
        return self._spread(motion, now), _joined(hard), self._rows(motion, told.rates, self.asked.rates)

    # Poses

    def fit_poses(self) -> Array:
        """Change the coordinates until all rows are closed; what is left of the gaps of `asked.poses` [m]."""
        told, now = self.now()
        gap = self._gap(told, now)
        for _ in range(STEPS):
            if gap <= tolerances.CLOSED:
                break
            step, before = self._step(told, now, None), self.state
            for _ in range(HALVINGS):
                self.state = self.freedoms.moved(before, step)
                told, now = self.now()
                if (new := self._gap(told, now)) < gap:
                    break
                step = 0.5 * step
            else:
                self.state = before
                break
            gap = new
        own = self.asked.poses
        told, _ = self.now()
        return np.asarray(told.gaps[own] * self.lengths(own))

    def polish(self, limit: float) -> None:
        """Lower the sums of squares of all turns and shifts since the start, all rows closed to the limit (by size)."""
        for _ in range(POLISH):
            told, now = self.now()
            before, sums = self.state, self._sums(now)
            step = self._step(told, now, self._change(now))
            if not np.any(np.abs(step) > tolerances.POLISHED):
                return
            self.state = self.freedoms.moved(before, step)
            left = self.fit_poses()
            told, now = self.now()
            if self._gap(told, now) > limit or not self._sums(now) < sums or not np.all(np.isfinite(left)):
                self.state = before
                return

    def _step(self, told: MeasuredState, now: Assembly, change: Array | None) -> Array:
        motion = self.freedoms.motion(self.state)
        held = list(held_poses(self.scene, now, motion))
        hard = _joined([self._rows(motion, told.gaps, self.asked.joints), *held])
        soft = self._rows(motion, told.gaps, self.asked.poses)
        step, turn = _least(self._spread(motion, now), hard, soft, change)
        return step * min(1.0, TURN / turn) if turn > 0.0 else step

    def _gap(self, told: MeasuredState, now: Assembly) -> float:
        """The largest gap of all that is asked and held, by the size, or rad."""
        rows = np.concatenate([self.asked.joints, self.asked.poses])
        still = np.zeros((len(now.position), 3, 0))
        nothing = FreedomMotion(still, still, np.zeros((len(told.gaps), 0)), now.position)
        held = [lack for _, lack in held_poses(self.scene, now, nothing)]
        return float(np.max(np.abs(np.concatenate([told.gaps[rows] * self.weight[rows], *held])), initial=0.0))

    def _change(self, now: Assembly) -> Array:
        """Turns, and shifts of the centres (by the size), since the start, (6 m,) of the m bodies that may change."""
        start, own = self.scene.start, self.bodies
        turns = [to_vector(now.rotation[i] @ start.rotation[i].T) for i in own]
        arms = np.einsum("nij,nj->ni", now.rotation[own] - start.rotation[own], self.arms)
        shifts = now.position[own] - start.position[own] + arms
        return np.concatenate([np.ravel(turns), shifts.ravel() / self.size])

    def _sums(self, now: Assembly) -> tuple[float, float]:
        turns, shifts = np.split(self._change(now), 2)
        return round(float(turns @ turns), 12), float(shifts @ shifts)

    def _spread(self, motion: FreedomMotion, now: Assembly) -> Array:
        """What the freedoms turn these bodies by, and shift their centres by (by the size), (6 m, n)."""
        n, turns = len(self.freedoms.answers), motion.turns[self.bodies]
        arms = np.einsum("nij,nj->ni", now.rotation[self.bodies], self.arms)
        centres = motion.v[self.bodies] + np.cross(turns, arms[:, :, None], axis=1)
        return np.concatenate([turns.reshape(3 * len(turns), n), centres.reshape(3 * len(turns), n) / self.size])

    def _rows(self, motion: FreedomMotion, lack: Array, which: Indices) -> Rows:
        weight = self.weight[which]
        return motion.rows[which] * weight[:, None], -lack[which] * weight


def _joined(rows: list[Rows]) -> Rows:
    return np.concatenate([J for J, _ in rows]), np.concatenate([e for _, e in rows])


def _least(B: Array, hard: Rows, soft: Rows, change: Array | None) -> tuple[Array, float]:
    """The step of least turns, then least shifts, and its largest turn; change: what has been turned and shifted."""
    Q, R = np.linalg.qr(B)
    v, N = np.zeros(Q.shape[1]), np.eye(Q.shape[1])
    for J, e in (hard, soft):
        A = np.linalg.solve(R.T, J.T).T
        step, null, _ = solve(A @ N, e - A @ v)
        v, N = v + N @ step, N @ null
    so_far = np.zeros(len(B)) if change is None else change
    half = len(B) // 2
    for part in (slice(0, half), slice(half, None)):
        step, null, _ = solve(Q[part] @ N, -so_far[part] - Q[part] @ v)
        v, N = v + N @ step, N @ null
    turns = (Q[:half] @ v).reshape(-1, 3)
    return np.linalg.solve(R, v), float(np.sqrt(np.max(np.sum(turns * turns, axis=1), initial=0.0)))
