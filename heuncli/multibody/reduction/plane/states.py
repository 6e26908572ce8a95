"""States of a flat scene in its plane and of the scene itself, one from the other.

A coordinate of the scene is the same in the plane, or a combination of the two shifts there, or keeps its start value.
A body whose turns are all free has turned by phi about the normal since the start, (cos phi/2, n sin phi/2) q(0), with
phi the sum of the turns on its path: so the sign of its quaternion is that of the scene's own motion.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.reduction.plane.view import View
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.tables import vectors
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import about_axis, quaternion_product

Pairs = list[tuple[int, int, float]]  # place in the scene's state, in the flat one's, factor


@record
class PlaneTurn:
    """A turn of the plane's tree: of which body, the place of its parent, the sign of its axis, where it stands.

    start: its value at the start; program: of its drive, else None.
    """

    body: int
    parent: int
    sign: float
    q: int
    u: int
    start: float
    program: tuple[int, int] | None


@record
class FreeTurns:
    """The b bodies of the scene whose turns are all free: their places, where attitudes and angular velocities stand.

    body (b,); attitude_at (b, 4); rate_at (b, 3): places in the state; start (b, 4): quaternions.
    """

    body: Indices
    attitude_at: Indices
    rate_at: Indices
    start: Array


class States:
    """The maps between the states y of a scene and y' of the flat one: y = constant + A y', but for balls."""

    def __init__(self, seen: View, flat: PreparedScene) -> None:
        full, self.small = seen.scene.layout, flat.layout
        self.n = seen.n
        self.n_state = full.n_state
        self.turns = _turns(self.small)
        self.balls = _free_turns(full)
        self.body_count = len(full.bodies)
        pairs = [*_scalars(seen, flat), *_others(full, self.small)]
        self.own = np.array([own for own, _, _ in pairs], dtype=int)
        self.of = np.array([of for _, of, _ in pairs], dtype=int)
        self.factor = np.array([factor for _, _, factor in pairs])
        self.constant = _constant(full, self.small, pairs)

    def embed(self, times: Array, states: Array) -> Array:
        """States of the scene, (n_t, n), from those of the flat one."""
        found = np.broadcast_to(self.constant, (len(times), self.n_state)).copy()
        np.add.at(found.T, self.own, (self.factor * states[:, self.of]).T)
        balls = self.balls
        if not len(balls.body):
            return found
        phi, rate = self._turned(times, states)[:, balls.body]
        turns = quaternion_product(about_axis(self.n, phi), balls.start[:, None])
        found[:, balls.attitude_at] = turns.transpose(1, 0, 2)
        found[:, balls.rate_at] = (rate[..., None] * self.n).transpose(1, 0, 2)
        return found

    def _turned(self, times: Array, states: Array) -> Array:
        """Angles that the bodies of the flat scene have turned by since the start, and rates, (2, bodies + 1, n_t).

        The last is the ground.
        """
        by = np.zeros((self.body_count, 2, len(times)))
        free = [turn for turn in self.turns if turn.q >= 0]
        own, sign = [turn.body for turn in free], np.array([turn.sign for turn in free])
        start = np.array([turn.start for turn in free])
        by[own, 0] = (sign * (states[:, [turn.q for turn in free]] - start)).T
        by[own, 1] = (sign * states[:, [turn.u for turn in free]]).T
        for turn in self.turns:
            if turn.q < 0 and turn.program is not None:
                q, u = self._of_turn(turn, times, states)
                by[turn.body] = turn.sign * (q - turn.start), turn.sign * u
        turned = [np.zeros((2, len(times)))] * (self.body_count + 1)
        for turn in self.turns:
            turned[turn.body] = turned[turn.parent] + by[turn.body]
        return np.array(turned).swapaxes(0, 1)

    def restrict(self, t: float, state: Array) -> Array:
        """The state of the flat scene, (n',), from one of the scene."""
        found = np.zeros(self.small.n_state)
        np.add.at(found, self.of, self.factor * (state - self.constant)[self.own])
        phi, rate = [0.0] * (self.body_count + 1), [0.0] * (self.body_count + 1)
        balls = self._turned_freely(state)
        for turn in self.turns:
            i, up = turn.body, turn.parent
            if i in balls:
                phi[i], rate[i] = balls[i]
                if turn.q >= 0:
                    found[turn.q] = turn.start + turn.sign * (phi[i] - phi[up])
                    found[turn.u] = turn.sign * (rate[i] - rate[up])
            else:
                q, u = self._of_turn(turn, np.array([t]), found[None])
                phi[i] = phi[up] + turn.sign * float(q[0] - turn.start)
                rate[i] = rate[up] + turn.sign * float(u[0])
        return found

    def _turned_freely(self, state: Array) -> dict[int, tuple[float, float]]:
        """Of each body whose turns are all free its angle and rate about the normal, in a state of the scene."""
        balls = self.balls
        angles = angles_about(self.n, state[balls.attitude_at], balls.start)
        rates = [float(self.n @ omega) for omega in state[balls.rate_at]]
        return dict(zip(balls.body.tolist(), zip(angles, rates, strict=True), strict=True))

    def _of_turn(self, turn: PlaneTurn, times: Array, states: Array) -> tuple[Array, Array]:
        """Angle and rate of a turn: of the states, or as its drive prescribes."""
        if turn.q >= 0:
            return states[:, turn.q], states[:, turn.u]
        if turn.program is None:
            return np.full(len(times), turn.start), np.zeros(len(times))
        given = np.array([self.small.pack.derivatives(*turn.program, t) for t in times.tolist()]).reshape(-1, 3)
        return given[:, 0], given[:, 1]


def angles_about(n: Array, attitudes: Array, starts: Array) -> list[float]:
    """The angles about n, within two turns, that take quaternions (b, 4) to others, their signs with them."""
    turns = quaternion_product(attitudes, starts * np.array([1.0, -1.0, -1.0, -1.0]))
    sines = np.array([n @ turn for turn in turns[:, 1:]])
    return [2.0 * angle for angle in np.arctan2(sines, turns[:, 0]).tolist()]


def _free_turns(full: Layout) -> FreeTurns:
    """What of the scene's state is of bodies whose turns are all free."""
    body = np.flatnonzero(full.bodies["ball"])
    attitude_at = full.bodies["attitude_at"][body, None] + np.arange(4)
    return FreeTurns(body, attitude_at, full.bodies["rate_at"][body, None] + np.arange(3), full.y0[attitude_at])


def _turns(small: Layout) -> list[PlaneTurn]:
    """One of each body, tree order; of a body that turns with its parent one that stands nowhere."""
    found = []
    starts = small.starts
    for i, body in enumerate(small.bodies):
        turn = PlaneTurn(i, int(body["parent"]), 1.0, -1, -1, 0.0, None)
        for k in range(body["first_freedom"], body["end_freedom"]):
            row, freedom = small.tables["freedoms"][k], small.freedoms[k]
            if row["kind"] != kernel.SHIFT:
                sign = float(np.sign(row["direction"]["z"]))
                start = starts[freedom.joint].angle if freedom.joint >= 0 else 0.0
                program = (int(row["program"]["start"]), int(row["program"]["count"])) if row["driven"] else None
                turn = PlaneTurn(i, int(body["parent"]), sign, freedom.q, freedom.u, start, program)
        found.append(turn)
    return found


def _directions(scene: PreparedScene) -> Array:
    """The directions of a scene's scalar freedoms at the start, (n, 3)."""
    layout, R = scene.layout, scene.start.rotation
    found = vectors(layout.tables["freedoms"]["direction"])
    for body, hang in zip(layout.bodies, layout.spanning.hangs, strict=True):
        for k in range(body["first_freedom"], body["end_freedom"]):
            of = hang.body if layout.tables["freedoms"]["kind"][k] == kernel.TURN_IN_BODY else hang.parent
            if of != GROUND:
                found[k] = R[of] @ found[k]
    return found


def _scalars(seen: View, flat: PreparedScene) -> Pairs:
    """Which coordinates and rates of the scene's state are which of the flat one's, times a factor.

    The factor is the cosine between the two freedoms' directions, which are fixed in the same body; along a path it is
    1, as the coordinate is the path's own.
    """
    full, small = seen.scene.layout, flat.layout
    own, of = _directions(seen.scene) @ seen.E.T, _directions(flat)
    shifts, flat_shifts = (layout.tables["freedoms"]["kind"] == kernel.SHIFT for layout in (full, small))
    runs, flat_runs = (layout.tables["freedoms"]["pieces"] > 0 for layout in (full, small))
    found = []
    for body, there in zip(full.bodies, small.bodies, strict=True):
        for k in range(body["first_freedom"], body["end_freedom"]):
            for j in range(there["first_freedom"], there["end_freedom"]):
                a, b = full.freedoms[k], small.freedoms[j]
                factor = _cosine(float(own[k] @ of[j])) if shifts[k] == flat_shifts[j] else 0.0
                if runs[k]:  # along a path
                    factor = float(flat_runs[j])
                if factor != 0.0 and a.q >= 0 and b.q >= 0:
                    found += [(a.q, b.q, factor), (a.u, b.u, factor)]
    return found


def _cosine(c: float) -> float:
    """A cosine, without the rounding of directions that are the same, opposite or square."""
    whole = float(round(c))
    return whole if abs(c - whole) <= 8.0 * tolerances.EPS else c


def _others(full: Layout, small: Layout) -> Pairs:
    """Pairs of places, full and small, with factor 1: of the counted angles of cut pins, and of the work."""
    found = [(at, small.counters[joint], 1.0) for joint, at in full.counters.items() if joint in small.counters]
    return found + ([(full.work_at, small.work_at, 1.0)] if full.work_at >= 0 else [])


def _constant(full: Layout, small: Layout, pairs: Pairs) -> Array:
    """What the scene's numbers are beside those of the flat one: heights, and what keeps its start value; no rates."""
    found = full.y0.copy()
    for own, of, factor in pairs:
        found[own] -= factor * small.y0[of]
    found[np.abs(found) <= 64.0 * tolerances.EPS * np.abs(full.y0)] = 0.0
    found[[freedom.u for freedom in full.freedoms if freedom.u >= 0]] = 0.0
    return found
