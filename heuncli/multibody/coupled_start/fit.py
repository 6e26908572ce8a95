"""Fit poses and rates to couplings: the least change of the bodies' turns from the start that the joints alone give.

    C y = e                 what is held, and the closure rows of joints; then, as far as these leave it, couplings
    least sum of |turn|^2, then least sum of |shift|^2, of all bodies that are tied together

y is the step of the freedoms. For rates one step is exact. For poses, steps of at most 0.3 rad go on until all rows are
closed, then steps that take the change so far into the sums; each is closed again and kept only if it lowers them.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import solve_with_null_space
from heuncli.base.records import record
from heuncli.multibody.coupled_start.freedoms import FreedomMotion, Freedoms, Rows, held_poses, held_rates
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.response import MeasuredState
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import vector_from_rotation

TURN = 0.3  # largest turn of one step [rad]
STEPS = 200
POLISH = 20
HALVINGS = 10


@record
class StartRows:
    """The closure rows that a start has to satisfy: of the joints, of the couplings' poses, and of the couplings'
    rates.
    """

    joints: Indices
    poses: Indices
    rates: Indices


class CoupledFit:
    """The fit of a laid-out scene to a start that satisfies its couplings; state: the present one."""

    def __init__(self, scene: PreparedScene, t: float, start_rows: StartRows, bodies: Iterable[int]) -> None:
        """bodies: tree indices of those whose changes count; all of them may move until others are released."""
        self.scene, self.start_rows, self.t = scene, start_rows, t
        self.size, self.state = scene.layout.size, scene.layout.y0.copy()
        places = sorted(bodies)
        self.release_bodies(places)
        self.bodies = [scene.layout.spanning.links[i].body for i in places]
        self.centres = np.array([body.center for body in scene.mechanism.bodies])
        self.arms = self.centres[self.bodies]
        weight = scene.layout.tables["closures"]["weight"][: len(scene.layout.rows)]
        self.weight = weight / self.size  # of gaps, and of their rates

    def release_bodies(self, bodies: Iterable[int]) -> None:
        """Let the freedoms of these bodies (tree indices) change, and no others."""
        self.freedoms = Freedoms(self.scene.layout, self.t, bodies)

    def measure_present(self) -> tuple[MeasuredState, Assembly]:
        """Measure the present state; return the measurement and the start that it represents."""
        measured = self.freedoms.measure(self.state)
        return measured, self.freedoms.make_assembly(measured, self.scene.start)

    def start_at(self, state: Array) -> Assembly:
        """Return the start that another state represents."""
        return self.freedoms.make_assembly(self.freedoms.measure(state), self.scene.start)

    def length_factors(self, rows: Indices) -> Array:
        """Factors that turn gaps and rates of rows into lengths [m per unit]."""
        return np.asarray(self.weight[rows] * self.size)

    def largest_gap(self) -> float:
        """Return the largest gap of all rows and held values, by the size, or rad."""
        return self._largest_gap(*self.measure_present())

    def scene_speed(self) -> float:
        """Return the scene's speed [m/s], to which rates of joints are compared."""
        _, start = self.measure_present()
        v = start.velocity + np.cross(start.angular_velocity, np.einsum("nij,nj->ni", start.rotation, self.centres))
        spin = float(np.max(np.abs(start.angular_velocity))) + tolerances.AT_REST
        return float(np.max(np.abs(v))) + self.size * spin

    # Rates

    def fit_rates(self) -> Array:
        """Change the rates; return the residuals of the couplings' rows [m/s], (rows,) of `start_rows.rates`."""
        spread, hard, soft = self._rate_conditions()
        step, _ = _least_step(spread, hard, soft, None)
        self.state = self.freedoms.apply_rate_step(self.state, step)
        rows = self.start_rows.rates
        return np.asarray(self.freedoms.measure(self.state).rates[rows] * self.length_factors(rows))

    def could_stay(self, body: int) -> bool:
        """Return whether other rates that satisfy all rows leave a body (spec's order) unchanged; called before the
        rates are fitted.
        """
        spread, hard, soft = self._rate_conditions()
        k, half = self.bodies.index(body), len(spread) // 2
        body_rows = np.concatenate([spread[3 * k : 3 * k + 3], spread[half + 3 * k : half + 3 * k + 3]])
        _, R = np.linalg.qr(spread)
        J = np.linalg.solve(R.T, np.concatenate([hard[0], soft[0], body_rows]).T).T
        e = np.concatenate([hard[1], soft[1], np.zeros(len(body_rows))])
        residual = solve_with_null_space(J, e)[2]
        return bool(np.abs(residual).max(initial=0.0) <= tolerances.RANK * np.abs(e).max(initial=0.0))

    def _rate_conditions(self) -> tuple[Array, Rows, Rows]:
        """Return what the freedoms move, the rows of joints and held values, and the rows of couplings, at the state's
        rates.
        """
        measured, start = self.measure_present()
        motion = self.freedoms.measure_motion(self.state)
        hard = [
            self._weighted_rows(motion, measured.rates, self.start_rows.joints),
            *held_rates(self.scene, start, motion),
        ]
        return (
            self._body_motions(motion, start),
            _concatenate_rows(hard),
            self._weighted_rows(motion, measured.rates, self.start_rows.rates),
        )

    # Poses

    def fit_poses(self) -> Array:
        """Change the coordinates until all rows are closed; return the remaining gaps of `start_rows.poses` [m]."""
        measured, start = self.measure_present()
        gap = self._largest_gap(measured, start)
        for _ in range(STEPS):
            if gap <= tolerances.CLOSED:
                break
            step, before = self._pose_step(measured, start, None), self.state
            for _ in range(HALVINGS):
                self.state = self.freedoms.apply_step(before, step)
                measured, start = self.measure_present()
                if (new := self._largest_gap(measured, start)) < gap:
                    break
                step = 0.5 * step
            else:
                self.state = before
                break
            gap = new
        rows = self.start_rows.poses
        measured, _ = self.measure_present()
        return np.asarray(measured.gaps[rows] * self.length_factors(rows))

    def polish(self, limit: float) -> None:
        """Lower the sums of squares of all turns and shifts since the start, with all rows closed to the limit (by
        size).
        """
        for _ in range(POLISH):
            measured, start = self.measure_present()
            before, sums = self.state, self._sums(start)
            step = self._pose_step(measured, start, self._change_since_start(start))
            if not np.any(np.abs(step) > tolerances.POLISHED):
                return
            self.state = self.freedoms.apply_step(before, step)
            left = self.fit_poses()
            measured, start = self.measure_present()
            if (
                self._largest_gap(measured, start) > limit
                or not self._sums(start) < sums
                or not np.all(np.isfinite(left))
            ):
                self.state = before
                return

    def _pose_step(self, measured: MeasuredState, start: Assembly, change: Array | None) -> Array:
        motion = self.freedoms.measure_motion(self.state)
        held = list(held_poses(self.scene, start, motion))
        hard = _concatenate_rows([self._weighted_rows(motion, measured.gaps, self.start_rows.joints), *held])
        soft = self._weighted_rows(motion, measured.gaps, self.start_rows.poses)
        step, turn = _least_step(self._body_motions(motion, start), hard, soft, change)
        return step * min(1.0, TURN / turn) if turn > 0.0 else step

    def _largest_gap(self, measured: MeasuredState, start: Assembly) -> float:
        """Return the largest gap of all rows and held values, by the size, or rad."""
        rows = np.concatenate([self.start_rows.joints, self.start_rows.poses])
        still = np.zeros((len(start.position), 3, 0))
        nothing = FreedomMotion(still, still, np.zeros((len(measured.gaps), 0)), start.position)
        held = [lack for _, lack in held_poses(self.scene, start, nothing)]
        return float(np.max(np.abs(np.concatenate([measured.gaps[rows] * self.weight[rows], *held])), initial=0.0))

    def _change_since_start(self, present: Assembly) -> Array:
        """Turns, and shifts of the centres (by the size), since the start, (6 m,) of the m bodies that may change."""
        start, own = self.scene.start, self.bodies
        turns = [vector_from_rotation(present.rotation[i] @ start.rotation[i].T) for i in own]
        arms = np.einsum("nij,nj->ni", present.rotation[own] - start.rotation[own], self.arms)
        shifts = present.position[own] - start.position[own] + arms
        return np.concatenate([np.ravel(turns), shifts.ravel() / self.size])

    def _sums(self, present: Assembly) -> tuple[float, float]:
        turns, shifts = np.split(self._change_since_start(present), 2)
        return round(float(turns @ turns), 12), float(shifts @ shifts)

    def _body_motions(self, motion: FreedomMotion, present: Assembly) -> Array:
        """Turns of these bodies, and shifts of their centres (by the size), for each freedom, (6 m, n)."""
        n, turns = len(self.freedoms.answers), motion.turns[self.bodies]
        arms = np.einsum("nij,nj->ni", present.rotation[self.bodies], self.arms)
        centres = motion.v[self.bodies] + np.cross(turns, arms[:, :, None], axis=1)
        return np.concatenate([turns.reshape(3 * len(turns), n), centres.reshape(3 * len(turns), n) / self.size])

    def _weighted_rows(self, motion: FreedomMotion, lack: Array, which: Indices) -> Rows:
        weight = self.weight[which]
        return motion.rows[which] * weight[:, None], -lack[which] * weight


def _concatenate_rows(rows: list[Rows]) -> Rows:
    return np.concatenate([J for J, _ in rows]), np.concatenate([e for _, e in rows])


def _least_step(B: Array, hard: Rows, soft: Rows, change: Array | None) -> tuple[Array, float]:
    """Find the step of least turns, then least shifts, and its largest turn; change: turns and shifts made so far."""
    Q, R = np.linalg.qr(B)
    v, N = np.zeros(Q.shape[1]), np.eye(Q.shape[1])
    for J, e in (hard, soft):
        A = np.linalg.solve(R.T, J.T).T
        step, null, _ = solve_with_null_space(A @ N, e - A @ v)
        v, N = v + N @ step, N @ null
    so_far = np.zeros(len(B)) if change is None else change
    half = len(B) // 2
    for part in (slice(0, half), slice(half, None)):
        step, null, _ = solve_with_null_space(Q[part] @ N, -so_far[part] - Q[part] @ v)
        v, N = v + N @ step, N @ null
    turns = (Q[:half] @ v).reshape(-1, 3)
    return np.linalg.solve(R, v), float(np.sqrt(np.max(np.sum(turns * turns, axis=1), initial=0.0)))
