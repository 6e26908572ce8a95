"""Map states of a flat scene in its plane to those of the scene itself, and back.

A coordinate of the scene is the same in the plane, or a combination of the two shifts there, or keeps its start value.
A body with three free rotations has turned by phi about the normal since the start, (cos phi/2, n sin phi/2) q(0), with
phi the sum of the turns on its path: so the sign of its quaternion is that of the scene's own motion.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.reduction.plane.view import PlaneView
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.tables import vector_array
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import quaternion_product, quaternions_about

Pairs = list[tuple[int, int, float]]  # place in the scene's state, in the flat one's, factor


@record
class PlaneTurn:
    """A rotation in the plane's tree: its body, the index of the parent, the sign of its axis, its indices in the
    state.

    start: its value at the start
    program: of its drive, or None
    """

    body: int
    parent: int
    sign: float
    q: int
    u: int
    start: float
    program: tuple[int, int] | None


@record
class FreeRotations:
    """The b bodies of the scene with three free rotations, with the state indices of their attitudes and angular
    velocities.

    body (b,): tree indices attitude_at (b, 4), rate_at (b, 3): indices in the state
    start (b, 4): quaternions
    """

    body: Indices
    attitude_at: Indices
    rate_at: Indices
    start: Array


class PlaneStateMap:
    """The maps between the states y of a scene and y' of the flat one: y = constant + A y', except for balls."""

    def __init__(self, plane_view: PlaneView, flat: PreparedScene) -> None:
        full, self.small = plane_view.scene.layout, flat.layout
        self.n = plane_view.n
        self.n_state = full.n_state
        self.turns = _find_turns(self.small)
        self.balls = _find_free_rotations(full)
        self.body_count = len(full.bodies)
        pairs = [*_coordinate_pairs(plane_view, flat), *_other_pairs(full, self.small)]
        self.full_indices = np.array([full_index for full_index, _, _ in pairs], dtype=int)
        self.flat_indices = np.array([flat_index for _, flat_index, _ in pairs], dtype=int)
        self.factor = np.array([factor for _, _, factor in pairs])
        self.constant = _constant_part(full, self.small, pairs)

    def embed(self, times: Array, states: Array) -> Array:
        """Map states of the flat scene to those of the scene, (n_t, n)."""
        full_states = np.broadcast_to(self.constant, (len(times), self.n_state)).copy()
        np.add.at(full_states.T, self.full_indices, (self.factor * states[:, self.flat_indices]).T)
        balls = self.balls
        if not len(balls.body):
            return full_states
        phi, rate = self._body_rotations(times, states)[:, balls.body]
        turns = quaternion_product(quaternions_about(self.n, phi), balls.start[:, None])
        full_states[:, balls.attitude_at] = turns.transpose(1, 0, 2)
        full_states[:, balls.rate_at] = (rate[..., None] * self.n).transpose(1, 0, 2)
        return full_states

    def _body_rotations(self, times: Array, states: Array) -> Array:
        """Compute the rotation angles of the flat scene's bodies since the start, and rates, (2, bodies + 1, n_t).

        The last is the ground.
        """
        increments = np.zeros((self.body_count, 2, len(times)))
        free = [turn for turn in self.turns if turn.q >= 0]
        bodies, sign = [turn.body for turn in free], np.array([turn.sign for turn in free])
        start = np.array([turn.start for turn in free])
        increments[bodies, 0] = (sign * (states[:, [turn.q for turn in free]] - start)).T
        increments[bodies, 1] = (sign * states[:, [turn.u for turn in free]]).T
        for turn in self.turns:
            if turn.q < 0 and turn.program is not None:
                q, u = self._turn_values(turn, times, states)
                increments[turn.body] = turn.sign * (q - turn.start), turn.sign * u
        rotations = [np.zeros((2, len(times)))] * (self.body_count + 1)
        for turn in self.turns:
            rotations[turn.body] = rotations[turn.parent] + increments[turn.body]
        return np.array(rotations).swapaxes(0, 1)

    def restrict(self, t: float, state: Array) -> Array:
        """Map a state of the scene to one of the flat scene, (n',)."""
        flat_state = np.zeros(self.small.n_state)
        np.add.at(flat_state, self.flat_indices, self.factor * (state - self.constant)[self.full_indices])
        phi, rate = [0.0] * (self.body_count + 1), [0.0] * (self.body_count + 1)
        balls = self._ball_rotations(state)
        for turn in self.turns:
            i, parent = turn.body, turn.parent
            if i in balls:
                phi[i], rate[i] = balls[i]
                if turn.q >= 0:
                    flat_state[turn.q] = turn.start + turn.sign * (phi[i] - phi[parent])
                    flat_state[turn.u] = turn.sign * (rate[i] - rate[parent])
            else:
                q, u = self._turn_values(turn, np.array([t]), flat_state[None])
                phi[i] = phi[parent] + turn.sign * float(q[0] - turn.start)
                rate[i] = rate[parent] + turn.sign * float(u[0])
        return flat_state

    def _ball_rotations(self, state: Array) -> dict[int, tuple[float, float]]:
        """Return, for each body with three free rotations, its angle and rate about the normal in a state of the
        scene.
        """
        balls = self.balls
        angles = angles_about(self.n, state[balls.attitude_at], balls.start)
        rates = [float(self.n @ omega) for omega in state[balls.rate_at]]
        return dict(zip(balls.body.tolist(), zip(angles, rates, strict=True), strict=True))

    def _turn_values(self, turn: PlaneTurn, times: Array, states: Array) -> tuple[Array, Array]:
        """Return angle and rate of a rotation: from the states, or as its drive prescribes."""
        if turn.q >= 0:
            return states[:, turn.q], states[:, turn.u]
        if turn.program is None:
            return np.full(len(times), turn.start), np.zeros(len(times))
        derivatives = np.array([self.small.pack.derivatives(*turn.program, t) for t in times.tolist()]).reshape(-1, 3)
        return derivatives[:, 0], derivatives[:, 1]


def angles_about(n: Array, attitudes: Array, starts: Array) -> list[float]:
    """Return the angles about n, within two turns, that take quaternions (b, 4) to others, including their signs."""
    turns = quaternion_product(attitudes, starts * np.array([1.0, -1.0, -1.0, -1.0]))
    sines = np.array([n @ turn for turn in turns[:, 1:]])
    return [2.0 * angle for angle in np.arctan2(sines, turns[:, 0]).tolist()]


def _find_free_rotations(full: Layout) -> FreeRotations:
    """Find the parts of the scene's state that belong to bodies with three free rotations."""
    body = np.flatnonzero(full.bodies["ball"])
    attitude_at = full.bodies["attitude_at"][body, None] + np.arange(4)
    return FreeRotations(body, attitude_at, full.bodies["rate_at"][body, None] + np.arange(3), full.y0[attitude_at])


def _find_turns(small: Layout) -> list[PlaneTurn]:
    """Return one rotation per body, tree order; for a body that turns with its parent one without state indices."""
    turns = []
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
        turns.append(turn)
    return turns


def _freedom_directions(scene: PreparedScene) -> Array:
    """Return the directions of a scene's scalar freedoms at the start, (n, 3)."""
    layout, R = scene.layout, scene.start.rotation
    directions = vector_array(layout.tables["freedoms"]["direction"])
    for body, link in zip(layout.bodies, layout.spanning.links, strict=True):
        for k in range(body["first_freedom"], body["end_freedom"]):
            body_index = link.body if layout.tables["freedoms"]["kind"][k] == kernel.TURN_IN_BODY else link.parent
            if body_index != GROUND:
                directions[k] = R[body_index] @ directions[k]
    return directions


def _coordinate_pairs(plane_view: PlaneView, flat: PreparedScene) -> Pairs:
    """Pair the coordinates and rates of the scene's state with those of the flat one, with a factor.

    The factor is the cosine between the two freedoms' directions, which are fixed in the same body; along a path it is
    1, as the coordinate is the path's own.
    """
    full, small = plane_view.scene.layout, flat.layout
    full_directions, flat_directions = _freedom_directions(plane_view.scene) @ plane_view.E.T, _freedom_directions(flat)
    shifts, flat_shifts = (layout.tables["freedoms"]["kind"] == kernel.SHIFT for layout in (full, small))
    runs, flat_runs = (layout.tables["freedoms"]["pieces"] > 0 for layout in (full, small))
    pairs = []
    for body, flat_body in zip(full.bodies, small.bodies, strict=True):
        for k in range(body["first_freedom"], body["end_freedom"]):
            for j in range(flat_body["first_freedom"], flat_body["end_freedom"]):
                a, b = full.freedoms[k], small.freedoms[j]
                factor = (
                    _round_cosine(float(full_directions[k] @ flat_directions[j]))
                    if shifts[k] == flat_shifts[j]
                    else 0.0
                )
                if runs[k]:  # along a path
                    factor = float(flat_runs[j])
                if factor != 0.0 and a.q >= 0 and b.q >= 0:
                    pairs += [(a.q, b.q, factor), (a.u, b.u, factor)]
    return pairs


def _round_cosine(c: float) -> float:
    """Round a cosine near -1, 0 or 1 to that value."""
    whole = float(round(c))
    return whole if abs(c - whole) <= 8.0 * tolerances.EPS else c


def _other_pairs(full: Layout, small: Layout) -> Pairs:
    """Pair state indices, full and flat, with factor 1: of the counted angles of cut pins, and of the work."""
    pairs = [(index, small.counters[joint], 1.0) for joint, index in full.counters.items() if joint in small.counters]
    return pairs + ([(full.work_at, small.work_at, 1.0)] if full.work_at >= 0 else [])


def _constant_part(full: Layout, small: Layout, pairs: Pairs) -> Array:
    """Return the scene's state less the contribution of the flat one: heights and constant coordinates; no rates."""
    constant = full.y0.copy()
    for full_index, flat_index, factor in pairs:
        constant[full_index] -= factor * small.y0[flat_index]
    constant[np.abs(constant) <= 64.0 * tolerances.EPS * np.abs(full.y0)] = 0.0
    constant[[freedom.u for freedom in full.freedoms if freedom.u >= 0]] = 0.0
    return constant
