"""The fit of an island: poses that close its loops, as near as possible to where they started.

    (0) drawn nearly closed: (2) from the poses as drawn, then least Σθ² + Σ(d/l)² from there; then (3), unless that
        leads much farther than the nearest; or drawn so but for held coordinates: followed to these from the drawing.
        Else, from the poses as walked:
    (1) with `near`: what near says is fixed, the others meet it as well as they can; then it is let go
    (2) close: least |e − C y|² + μ (Σθ² + 0.01 Σd²/L²) step by step (Levenberg-Marquardt), turns at most 0.3 rad;
        where that stalls with a gap (links in line have no slope), again with small fixed pseudo-random turns
    (3) polish: least Σθ² from the start of (2), then least Σd², among the poses that are closed
θ turns of left-out attitudes, d shifts of left-out pivots, L the scene's size, l the island's own; y, C, e as in
row_reduction.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.continuation import stages
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.multibody.assembly.row_reduction import ReducedIsland, least, rank_of
from heuncli.multibody.assembly.rows import Rows, pose_rows
from heuncli.multibody.assembly.walk import AssemblyPoses, place
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import from_vector, to_vector

SHIFT = 1e-2  # weight of (d/L)² against θ²: shifts are cheap; cheaper ones (1e-6) run hundreds of L off to save a turn
TURN = 0.3  # largest turn of one step [rad]
KICKS = (1, 2, 3, 4)  # times KICK
KICK = 0.05  # [rad]
LEAST_DAMPING = 1e-3  # times gap²: less would not be felt, and would have to be raised again step by step
BETTER = 0.999  # of the least gap so far: a kick that leaves more of it found nothing better
STEPS = 200
POLISH = 60  # steps; more only creep, where long shifts save ever smaller turns


class Fit:
    """One island in its poses, which it changes."""

    def __init__(
        self,
        poses: AssemblyPoses,
        island: AssemblyIsland,
        found: Sequence[JointCondition],
        depth: Sequence[int],
        size: float,
        planar: bool,
    ) -> None:
        self.poses = poses
        self.island = island
        self.found = found
        self.depth = depth
        self.size = size
        self.planar = planar
        self.joints = [k for k in island.via if k >= 0] + island.closures
        self.bodies = sorted({i for k in self.joints for i in (found[k].a, found[k].b)} | set(island.members))

    def free(self) -> list[tuple[bool, bool]]:
        """Whether each member may turn, and shift."""
        return [(self.poses.turns[i], self.poses.shifts[i]) for i in self.island.members]

    def pivots(self) -> Array:
        """Where the pivots of the island's bodies are, world, (n+1, 3)."""
        p = self.poses
        s = np.zeros(p.x.shape)
        s[self.bodies] = p.x[self.bodies] + np.einsum("nij,nj->ni", p.R[self.bodies], p.pivot[self.bodies])
        return s

    def rows(self) -> dict[int, Rows]:
        """The rows of all its joints."""
        s = self.pivots()
        return {k: pose_rows(self.found[k], self.poses.x, self.poses.R, s) for k in self.joints}

    def reduced(self, rows: dict[int, Rows]) -> ReducedIsland:
        """Its rows in the freedoms its tree leaves."""
        return ReducedIsland(self.island, self.found, rows, self.free(), self.size)

    def gap(self, rows: dict[int, Rows]) -> float:
        """Root of the sum of squares of all gaps, lengths by L."""
        return math.sqrt(sum(float(r.hold @ r.hold) / self.size**2 + float(r.turn @ r.turn) for r in rows.values()))

    def near(self, drawn: tuple[Array, Array], lever: float) -> bool:
        """Whether no joint is open by much, and no body far from its drawing; lengths by the lever."""
        rows = self.rows().values()
        gap = max(max(_norm(r.hold) / lever, _norm(r.turn)) for r in rows)
        way = float(np.max(np.abs(self._moved(drawn) * _counted(len(self.island.members), self.size / lever))))
        return max(gap, way) <= tolerances.NEAR_DRAWING

    def lever(self) -> float:
        """Mean distance of its joints' points from the pivots they turn about [m]; the scene's size where all meet."""
        ends = [
            (i, at)
            for k in self.joints
            for i, at in ((self.found[k].a, self.found[k].p), (self.found[k].b, self.found[k].q))
        ]
        arms = [_norm(at - self.poses.pivot[i]) for i, at in ends if i in self.island.members]
        return float(np.mean(arms)) or self.size

    def saved(self) -> tuple[Array, Array]:
        """The members' poses, to be put back."""
        return self.poses.x[self.island.members].copy(), self.poses.R[self.island.members].copy()

    def restore(self, saved: tuple[Array, Array]) -> None:
        """Put them back."""
        self.poses.x[self.island.members], self.poses.R[self.island.members] = saved

    def apply(self, z: Array) -> None:
        """Turn and shift the members, and close the joints of the tree again."""
        for i, (body, k) in enumerate(zip(self.island.members, self.island.via, strict=True)):
            turn, shift = z[6 * i : 6 * i + 3], z[6 * i + 3 : 6 * i + 6]
            if self.poses.turns[body]:
                self.poses.turn(body, from_vector(turn) @ self.poses.R[body])
            if self.poses.shifts[body]:
                self.poses.x[body] += self.size * shift
            if k >= 0:
                place(self.poses, self.found[k], body)

    def close(self, limit: float) -> bool:
        """Step (2) without kicks: whether the gap came below limit (of L)."""
        rows = self.rows()
        gap, damping = self.gap(rows), 1.0
        for _ in range(STEPS):
            if gap <= tolerances.CLOSED:
                break
            r = self.reduced(rows)
            if gap > limit and _norm(r.C.T @ r.e) <= tolerances.NO_SLOPE * _norm(r.C) * _norm(r.e):
                break
            before = self.saved()
            z = _limited(_damped(r, damping * gap * gap))
            for attempt in range(12 if gap > limit else 1):
                self.apply(z)
                new_rows = self.rows()
                new_gap = self.gap(new_rows)
                if new_gap < gap:
                    break
                self.restore(before)
                z = z / 3.0
                if attempt % 3 == 2:
                    damping *= 64.0
                    z = _limited(_damped(r, damping * gap * gap))
            else:
                break
            rows, gap, damping = new_rows, new_gap, max(damping / 4.0, LEAST_DAMPING)
        return gap <= limit

    def settle(self, limit: float, kicks: Sequence[int] = KICKS) -> tuple[bool, int]:
        """Step (2): whether it closed, and which kick it took (0: none). If not: where the gap is least."""
        start = self.saved()
        if self.close(limit):
            return True, 0
        best, least_gap = self.saved(), self.gap(self.rows())
        for kick in kicks:
            self.restore(start)
            self.apply(self._kick(KICK * kick))
            if self.close(limit):
                return True, kick
            gap = self.gap(self.rows())
            if gap < BETTER * least_gap:
                best, least_gap = self.saved(), gap
        self.restore(best)
        return False, 0

    def _kick(self, angle: float) -> Array:
        """A turn of each member about a direction that only its depth in the tree tells: no name, no order."""
        z = np.zeros(6 * len(self.island.members))
        for i, body in enumerate(self.island.members):
            # two irrational steps spread the directions over the sphere
            height = 1.0 - 2.0 * math.fmod(0.7548776662466927 * (self.depth[body] + 0.5), 1.0)
            around = math.tau * math.fmod(0.5698402909980532 * (self.depth[body] + 0.5), 1.0)
            across = math.sqrt(1.0 - height * height)
            u = (across * math.cos(around), across * math.sin(around), height)
            z[6 * i : 6 * i + 3] = (0.0, 0.0, math.copysign(angle, height)) if self.planar else np.multiply(angle, u)
        return z

    def meet(self, near: Sequence[tuple[bool, bool]], limit: float) -> None:
        """Step (1): near (turns, shifts of each member) stays, the others meet it as well as they can."""
        if not any(map(any, near)):
            return
        p = self.poses
        turns, shifts, pivot = list(p.turns), list(p.shifts), p.pivot.copy()
        for body, (attitude, position) in zip(self.island.members, near, strict=True):
            turns[body] = turns[body] and not attitude
            if position:
                shifts[body] = False
                pivot[body] = 0.0
        self.poses = AssemblyPoses(p.x, p.R, pivot, shifts, turns)
        self.settle(limit, KICKS[:1])
        self.poses = p

    def near_drawing(self, drawn: tuple[Array, Array], limit: float) -> tuple[bool, int]:
        """Step (0): whether it closed near the drawing, and which kick it took. If not, the poses are anyhow.

        The walk moves the last body of a loop by all that the drawing lacks; where that is little, each gives a bit.
        """
        lever = self.lever()
        together = self.size / lever
        self.restore(drawn)
        if not self.near(drawn, lever):
            return False, 0
        closed, kick = self.settle(limit)
        if not closed:
            return False, 0
        self.polish(drawn, limit, together)
        nearest, way = self.saved(), self._sums(drawn, together)[0]
        if not self.near(drawn, lever):
            return False, 0
        self.polish(drawn, limit)
        if self._sums(drawn, together)[0] > tolerances.FARTHER**2 * way:
            self.restore(nearest)
        return True, kick

    def follow(self, drawn: tuple[Array, Array], asked: Mapping[int, tuple[bool, bool]], limit: float) -> bool:
        """Whether it closes as drawn but for the coordinates asked for, and all the way to these (continuation.py)."""
        self.restore(drawn)
        last, lever, here = self.found, self.lever(), {k: asked[k] for k in self.joints if k in asked}
        followed = False
        for i, step in enumerate(stages(last, here, self.poses, lever)):
            self.found = step
            followed = (i > 0 or self.near(drawn, lever)) and self.close(limit)
            if not followed:
                break
        self.found = last
        if followed:
            self.polish(drawn, limit)
        return followed

    def polish(self, start: tuple[Array, Array], limit: float, together: float = 0.0) -> None:
        """Step (3): start are the poses before (2). together: as in (0), a shift by L counts so many times a turn."""
        last, factor, length = np.zeros(0), 1.0, math.inf
        for _ in range(POLISH):
            z = least(self.reduced(self.rows()), self._moved(start), together)[0]
            if _norm(z) < tolerances.POLISHED or (_norm(z) < tolerances.SUMS_BLIND and _norm(z) > 0.5 * length):
                return
            if last.size:  # the bend of the closed poses makes steps too long or too short, by what the last one tells
                factor = min(max(factor / max(1.0 - float(z @ last) / float(last @ last), 0.2), 1e-3), 4.0)
            before, sums = self.saved(), self._sums(start, together)
            last, length = z, _norm(z)
            blind = length < tolerances.SUMS_BLIND
            for _ in range(10):
                self.apply(_limited(factor * z))
                if self.close(limit) and (blind or _lower(self._sums(start, together), sums)):
                    break
                self.restore(before)
                factor *= 0.5
            else:
                return

    def _moved(self, start: tuple[Array, Array]) -> Array:
        """Turns and shifts (by L) from the start, (6m,); zero where they may not."""
        p, members = self.poses, self.island.members
        z = np.zeros((len(members), 2, 3))
        for i, body in enumerate(members):
            turned = p.R[body] - start[1][i]
            if p.turns[body]:
                z[i, 0] = to_vector(p.R[body] @ start[1][i].T)
            if p.shifts[body]:
                z[i, 1] = (p.x[body] - start[0][i] + turned @ p.pivot[body]) / self.size
        return z.ravel()

    def _sums(self, start: tuple[Array, Array], together: float) -> tuple[float, float]:
        """Σθ² and Σ(d/L)²; together: their sum, and nothing after it."""
        turns, shifts = np.sum(np.square(self._moved(start).reshape(-1, 2, 3)), axis=(0, 2)).tolist()
        return (turns + together**2 * shifts, 0.0) if together else (turns, shifts)


def _lower(new: tuple[float, float], old: tuple[float, float]) -> bool:
    """Whether the turns became less, or stayed and the shifts became less (to rounding)."""
    slack = tolerances.SAME_SUM
    if new[0] < old[0] * (1.0 - slack):
        return True
    return new[0] <= old[0] * (1.0 + slack) + slack**2 and new[1] <= old[1] * (1.0 + slack) + slack**2


def _counted(members: int, shift: float) -> Array:
    """Weights of turns, 1, and shifts of some members, (6m,)."""
    return np.array([1.0, 1.0, 1.0, shift, shift, shift] * members)


def _damped(r: ReducedIsland, mu: float) -> Array:
    """z of least |e − C y|² + μ (Σθ² + SHIFT Σ(d/L)²), (6m,)."""
    Q, A = r.measured(math.sqrt(SHIFT))
    v = -(Q.T @ (r.t * _counted(len(r.steps), SHIFT)))
    U, S, V = np.linalg.svd(A, full_matrices=False)
    U, S, V = U[:, : (rank := rank_of(S))], S[:rank], V[:rank]
    v = v + V.T @ (S / (S * S + mu) * (U.T @ (r.e - A @ v)))
    z: Array = r.t + Q @ v
    return z


def _limited(z: Array) -> Array:
    """z, shortened where a turn is larger than one step may be."""
    turns = z.reshape(-1, 6)[:, :3]
    largest = math.sqrt(float(np.max(np.sum(turns * turns, axis=1), initial=0.0)))
    return z * (TURN / largest) if largest > TURN else z


def _norm(a: Array) -> float:
    flat = a.ravel(order="K")
    return math.sqrt(float(flat @ flat))
