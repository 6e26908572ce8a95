"""Fit an island: find poses that close its loops, as near as possible to where they started.

    (0) drawn nearly closed: (2) from the poses as drawn, then least Σθ² + Σ(d/l)² from there; then (3), unless that
        leads much farther than the nearest; or drawn so but for held coordinates: followed to these from the drawing.
        Otherwise, from the poses that the walk has found:
    (1) with `near`: what near gives is fixed, the others fit it as well as they can; then it is released
    (2) close: least |e − C y|² + μ (Σθ² + 0.01 Σd²/L²) step by step (Levenberg-Marquardt), turns at most 0.3 rad;
        where that stalls with a gap (links in line have no slope), again with small fixed pseudo-random turns, unless
        the sides of the loop prove that no pose has a smaller one (loop_bounds.py)
    (3) polish: least Σθ² from the start of (2), then least Σd², among the poses that are closed

θ turns of attitudes that are not given, d shifts of pivots that are not given, L the scene's size, l the island's own;
y, C, e as in rows.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import count_rank
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.multibody.assembly.loop_bounds import bound_least_gap
from heuncli.multibody.assembly.reduced_islands import ReducedIsland, least_motion
from heuncli.multibody.assembly.rows import Rows, pose_rows
from heuncli.multibody.assembly.walk import AssemblyPoses, iter_continuation, place_body
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector, vector_from_rotation

SHIFT = 1e-2  # weight of (d/L)² against θ²: shifts are cheap; cheaper ones (1e-6) run hundreds of L off to save a turn
TURN = 0.3  # largest turn of one step [rad]
KICKS = (1, 2, 3, 4)  # times KICK
KICK = 0.05  # [rad]
MIN_DAMPING = 1e-3  # times gap²: less would not be felt, and would have to be raised again step by step
BETTER = 0.999  # of the least gap so far: a kick that leaves a larger gap is no improvement
STEPS = 200
POLISH = 60  # steps; more only creep, where long shifts save ever smaller turns


class IslandFit:
    """The fit of one island; it changes the poses that it is given.

    last_rows: the rows where `close` has left the poses
    """

    def __init__(
        self,
        poses: AssemblyPoses,
        island: AssemblyIsland,
        conditions: Sequence[JointCondition],
        depth: Sequence[int],
        size: float,
        planar: bool,
    ) -> None:
        self.poses = poses
        self.island = island
        self.conditions = conditions
        self.depth = depth
        self.size = size
        self.planar = planar
        self.joints = [k for k in island.tree_joints if k >= 0] + island.closures
        self.last_rows: dict[int, Rows] = {}
        self.bodies = sorted({i for k in self.joints for i in (conditions[k].a, conditions[k].b)} | set(island.members))

    def free_motions(self) -> list[tuple[bool, bool]]:
        """Return whether each member may turn, and shift."""
        return [(self.poses.turns[i], self.poses.shifts[i]) for i in self.island.members]

    def pivots(self) -> Array:
        """Return the pivots of the island's bodies, world, (n+1, 3)."""
        p = self.poses
        s = np.zeros(p.x.shape)
        s[self.bodies] = p.x[self.bodies] + np.einsum("nij,nj->ni", p.R[self.bodies], p.pivot[self.bodies])
        return s

    def rows(self) -> dict[int, Rows]:
        """Return the rows of all its joints."""
        s = self.pivots()
        return {k: pose_rows(self.conditions[k], self.poses.x, self.poses.R, s) for k in self.joints}

    def reduce_rows(self, rows: dict[int, Rows]) -> ReducedIsland:
        """Reduce its rows to the freedoms that its tree leaves."""
        return ReducedIsland(self.island, self.conditions, rows, self.free_motions(), self.size)

    def bound_gap(self) -> float:
        """Return what the gap is at least, in all poses that can be reached; 0 where that is not known."""
        return bound_least_gap(self.island, self.conditions, self.poses, self.size)

    def gap(self, rows: dict[int, Rows]) -> float:
        """Compute the root of the sum of squares of all gaps, lengths by L."""
        return math.sqrt(sum(float(r.hold @ r.hold) / self.size**2 + float(r.turn @ r.turn) for r in rows.values()))

    def is_near(self, drawn_poses: tuple[Array, Array], lever: float) -> bool:
        """Return whether no joint is far open, and no body far from its drawing; lengths by the lever."""
        rows = self.rows().values()
        gap = max(max(_norm(r.hold) / lever, _norm(r.turn)) for r in rows)
        displacement = float(
            np.max(
                np.abs(self._displacements(drawn_poses) * _shift_weights(len(self.island.members), self.size / lever))
            )
        )
        return max(gap, displacement) <= tolerances.NEAR_DRAWING

    def lever(self) -> float:
        """Compute the mean distance of its joints' points from the pivots they turn about [m]; the scene's size where
        all coincide.
        """
        ends = [
            (i, point)
            for k in self.joints
            for i, point in ((self.conditions[k].a, self.conditions[k].p), (self.conditions[k].b, self.conditions[k].q))
        ]
        arms = [_norm(point - self.poses.pivot[i]) for i, point in ends if i in self.island.members]
        return float(np.mean(arms)) or self.size

    def save_poses(self) -> tuple[Array, Array]:
        """Return a copy of the members' poses."""
        return self.poses.x[self.island.members].copy(), self.poses.R[self.island.members].copy()

    def restore_poses(self, poses: tuple[Array, Array]) -> None:
        """Restore the members' poses."""
        self.poses.x[self.island.members], self.poses.R[self.island.members] = poses

    def apply(self, z: Array) -> None:
        """Turn and shift the members, and close the joints of the tree again."""
        for i, (body, k) in enumerate(zip(self.island.members, self.island.tree_joints, strict=True)):
            turn, shift = z[6 * i : 6 * i + 3], z[6 * i + 3 : 6 * i + 6]
            if self.poses.turns[body]:
                self.poses.set_attitude(body, rotation_from_vector(turn) @ self.poses.R[body])
            if self.poses.shifts[body]:
                self.poses.x[body] += self.size * shift
            if k >= 0:
                place_body(self.poses, self.conditions[k], body)

    def close(self, limit: float) -> bool:
        """Step (2) without kicks: return whether the gap came below limit (of L)."""
        rows = self.rows()
        gap, damping = self.gap(rows), 1.0
        for _ in range(STEPS):
            if gap <= tolerances.CLOSED:
                break
            reduced = self.reduce_rows(rows)
            if gap > limit and _norm(reduced.C.T @ reduced.e) <= tolerances.NO_SLOPE * _norm(reduced.C) * _norm(
                reduced.e
            ):
                break
            before = self.save_poses()
            z = _limit_step(_damped_step(reduced, damping * gap * gap))
            for attempt in range(12 if gap > limit else 1):
                self.apply(z)
                new_rows = self.rows()
                new_gap = self.gap(new_rows)
                if new_gap < gap:
                    break
                self.restore_poses(before)
                z = z / 3.0
                if attempt % 3 == 2:
                    damping *= 64.0
                    z = _limit_step(_damped_step(reduced, damping * gap * gap))
            else:
                break
            rows, gap, damping = new_rows, new_gap, max(damping / 4.0, MIN_DAMPING)
        self.last_rows = rows
        return gap <= limit

    def settle(self, limit: float, kicks: Sequence[int] = KICKS) -> tuple[bool, int]:
        """Step (2): return whether it closed, and which kick it took (0: none). If not, leave it where the gap is
        smallest.
        """
        start = self.save_poses()
        if self.close(limit):
            return True, 0
        best, least_gap = self.save_poses(), self.gap(self.last_rows)
        bound = self.bound_gap()
        for kick in () if bound > limit and bound >= BETTER * least_gap else kicks:  # none could close it, or improve
            self.restore_poses(start)
            self.apply(self._kick(KICK * kick))
            if self.close(limit):
                return True, kick
            gap = self.gap(self.last_rows)
            if gap < BETTER * least_gap:
                best, least_gap = self.save_poses(), gap
        self.restore_poses(best)
        return False, 0

    def _kick(self, angle: float) -> Array:
        """Return a turn of each member about a direction that depends only on its depth in the tree: on no name and no
        order.
        """
        z = np.zeros(6 * len(self.island.members))
        for i, body in enumerate(self.island.members):
            # two irrational steps spread the directions over the sphere
            height = 1.0 - 2.0 * math.fmod(0.7548776662466927 * (self.depth[body] + 0.5), 1.0)
            around = math.tau * math.fmod(0.5698402909980532 * (self.depth[body] + 0.5), 1.0)
            across = math.sqrt(1.0 - height * height)
            u = (across * math.cos(around), across * math.sin(around), height)
            z[6 * i : 6 * i + 3] = (0.0, 0.0, math.copysign(angle, height)) if self.planar else np.multiply(angle, u)
        return z

    def fit_to_near(self, is_near_given: Sequence[tuple[bool, bool]], limit: float) -> None:
        """Step (1): keep the `near` values (turns, shifts of each member); the others fit them as well as they can."""
        if not any(map(any, is_near_given)):
            return
        p = self.poses
        turns, shifts, pivot = list(p.turns), list(p.shifts), p.pivot.copy()
        for body, (attitude, position) in zip(self.island.members, is_near_given, strict=True):
            turns[body] = turns[body] and not attitude
            if position:
                shifts[body] = False
                pivot[body] = 0.0
        self.poses = AssemblyPoses(p.x, p.R, pivot, shifts, turns)
        self.settle(limit, KICKS[:1])
        self.poses = p

    def close_near_drawing(self, drawn_poses: tuple[Array, Array], limit: float) -> tuple[bool, int]:
        """Step (0): return whether it closed near the drawing, and which kick it took. If not, the poses are undefined.

        The walk moves the last body of a loop by all that the drawing lacks; where that is little, each body moves a
        bit here.
        """
        lever = self.lever()
        shift_weight = self.size / lever
        self.restore_poses(drawn_poses)
        if not self.is_near(drawn_poses, lever):
            return False, 0
        closed, kick = self.settle(limit)
        if not closed:
            return False, 0
        self.polish(drawn_poses, limit, shift_weight)
        nearest, nearest_sum = self.save_poses(), self._sums(drawn_poses, shift_weight)[0]
        if not self.is_near(drawn_poses, lever):
            return False, 0
        self.polish(drawn_poses, limit)
        if self._sums(drawn_poses, shift_weight)[0] > tolerances.FARTHER**2 * nearest_sum:
            self.restore_poses(nearest)
        return True, kick

    def follow_coordinates(
        self, drawn_poses: tuple[Array, Array], prescribed: Mapping[int, tuple[bool, bool]], limit: float
    ) -> bool:
        """Return whether it closes as drawn apart from the prescribed coordinates, and all the way to these
        (walk.py).
        """
        self.restore_poses(drawn_poses)
        final_conditions, lever, own_prescribed = (
            self.conditions,
            self.lever(),
            {k: prescribed[k] for k in self.joints if k in prescribed},
        )
        followed = False
        for i, step in enumerate(iter_continuation(final_conditions, own_prescribed, self.poses, lever)):
            self.conditions = step
            followed = (i > 0 or self.is_near(drawn_poses, lever)) and self.close(limit)
            if not followed:
                break
        self.conditions = final_conditions
        if followed:
            self.polish(drawn_poses, limit)
        return followed

    def polish(self, start: tuple[Array, Array], limit: float, shift_weight: float = 0.0) -> None:
        """Step (3): start are the poses before (2). shift_weight: as in (0), how many times a turn a shift by L
        counts.
        """
        last, factor, length = np.zeros(0), 1.0, math.inf
        rows = self.rows()
        for _ in range(POLISH):
            z = least_motion(self.reduce_rows(rows), self._displacements(start), shift_weight)[0]
            if _norm(z) < tolerances.POLISHED or (
                _norm(z) < tolerances.SUM_OF_SQUARES_LIMIT and _norm(z) > 0.5 * length
            ):
                return
            if last.size:  # the curvature of the closed poses makes steps too long or too short, as the last one shows
                factor = min(max(factor / max(1.0 - float(z @ last) / float(last @ last), 0.2), 1e-3), 4.0)
            before, sums = self.save_poses(), self._sums(start, shift_weight)
            last, length = z, _norm(z)
            blind = length < tolerances.SUM_OF_SQUARES_LIMIT
            for _ in range(10):
                self.apply(_limit_step(factor * z))
                if self.close(limit) and (blind or _is_lower(self._sums(start, shift_weight), sums)):
                    rows = self.last_rows
                    break
                self.restore_poses(before)
                factor *= 0.5
            else:
                return

    def _displacements(self, start: tuple[Array, Array]) -> Array:
        """Compute turns and shifts (by L) from the start, (6m,); zero where a member may not turn or shift."""
        p, members = self.poses, self.island.members
        z = np.zeros((len(members), 2, 3))
        for i, body in enumerate(members):
            turned = p.R[body] - start[1][i]
            if p.turns[body]:
                z[i, 0] = vector_from_rotation(p.R[body] @ start[1][i].T)
            if p.shifts[body]:
                z[i, 1] = (p.x[body] - start[0][i] + turned @ p.pivot[body]) / self.size
        return z.ravel()

    def _sums(self, start: tuple[Array, Array], shift_weight: float) -> tuple[float, float]:
        """Compute Σθ² and Σ(d/L)²; with a shift_weight, their weighted sum, and zero."""
        turns, shifts = np.sum(np.square(self._displacements(start).reshape(-1, 2, 3)), axis=(0, 2)).tolist()
        return (turns + shift_weight**2 * shifts, 0.0) if shift_weight else (turns, shifts)


def _is_lower(new: tuple[float, float], old: tuple[float, float]) -> bool:
    """Return whether the turns became less, or stayed and the shifts became less (to rounding)."""
    slack = tolerances.SAME_SUM
    if new[0] < old[0] * (1.0 - slack):
        return True
    return new[0] <= old[0] * (1.0 + slack) + slack**2 and new[1] <= old[1] * (1.0 + slack) + slack**2


def _shift_weights(members: int, shift: float) -> Array:
    """Return the weights of turns, 1, and shifts of some members, (6m,)."""
    return np.array([1.0, 1.0, 1.0, shift, shift, shift] * members)


def _damped_step(r: ReducedIsland, mu: float) -> Array:
    """Compute z of least |e − C y|² + μ (Σθ² + SHIFT Σ(d/L)²), (6m,)."""
    Q, A = r.orthonormalize(math.sqrt(SHIFT))
    v = -(Q.T @ (r.t * _shift_weights(len(r.steps), SHIFT)))
    U, S, V = np.linalg.svd(A, full_matrices=False)
    U, S, V = U[:, : (rank := count_rank(S))], S[:rank], V[:rank]
    v = v + V.T @ (S / (S * S + mu) * (U.T @ (r.e - A @ v)))
    z: Array = r.t + Q @ v
    return z


def _limit_step(z: Array) -> Array:
    """Shorten z where a turn is larger than one step may be."""
    if float(z @ z) < 0.99 * TURN * TURN:  # of all turns and shifts together
        return z
    turns = z.reshape(-1, 6)[:, :3]
    largest = math.sqrt(float(np.max(np.sum(turns * turns, axis=1), initial=0.0)))
    return z * (TURN / largest) if largest > TURN else z


def _norm(a: Array) -> float:
    flat = a.ravel(order="K")
    return math.sqrt(float(flat @ flat))
