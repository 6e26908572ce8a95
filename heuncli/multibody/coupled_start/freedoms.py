"""The freedoms that a start may still change, and how bodies and closure rows move with each.

Rates are linear in the rates of the freedoms: the effect of one of them is measured with all others at rest, the driven
ones too; the effect of the driven ones is the rest that remains when none moves.

Besides the closure rows, given poses and velocities of bodies and coordinates of joints are held:

    J y = lack                     y the step of the freedoms, turns in rad, lengths by the scene's size

Driven coordinates are not among the freedoms. Given values are satisfied as assembled, and stay so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.model import Assembly, Directed, Joint
from heuncli.multibody.response import MeasuredState, make_unsettled_workspace, measure_state
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.prepare import IdleSpin, PreparedScene
from heuncli.multibody.tree.starts import axial_angle, body_state
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows, quaternion_from_vector, quaternion_product, vector_from_rotation

# Freedoms


@record
class FreedomMotion:
    """The motion due to each of n freedoms alone at rate 1, world axes.

    turns (n_b, 3, n): rotations of the bodies, in the spec's order
    v (n_b, 3, n): velocities of their origins
    rows (rows, n): rates of the gaps
    x (n_b, 3): positions of the origins
    """

    turns: Array
    v: Array
    rows: Array
    x: Array

    def point_velocities(self, body: int, place: Array) -> Array:
        """Velocities of the body's point at a world position, (3, n); zero for the ground."""
        if body < 0:
            return np.zeros((3, self.turns.shape[2]))
        arm = place - self.x[body]
        return np.asarray(self.v[body] + np.cross(self.turns[body], arm[:, None], axis=0))

    def body_rotations(self, body: int) -> Array:
        """Rotation rates of the body, (3, n); zero for the ground."""
        return self.turns[body] if body >= 0 else np.zeros(self.turns.shape[1:])


class Freedoms:
    """The freedoms of some trees on the ground, and the kernel that measures them; answers: their indices."""

    def __init__(self, layout: Layout, t: float, bodies: Iterable[int]) -> None:
        """bodies: tree indices, with all bodies that hang on them."""
        self.layout, self.t = layout, t
        self.workspace = make_unsettled_workspace(layout)
        rate_at = rate_indices(layout).astype(np.intp)
        indices = [n for i in sorted(bodies) for n in _freedom_range(layout, i) if rate_at[n] >= 0]
        self.answers: Indices = np.array(indices, dtype=int)
        self.rate_at: Indices = np.array(rate_at[self.answers], dtype=np.intp)
        self.all_rates: Indices = np.array(rate_at[rate_at >= 0], dtype=np.intp)

    def measure(self, state: Array) -> MeasuredState:
        """Measure position and motion of all bodies at a state."""
        return measure_state(self.workspace, self.layout, self.t, state)

    def body_motion(self, measured: MeasuredState) -> tuple[Array, Array, Array, Array]:
        """Return position and velocity of the bodies' origins, attitude and angular velocity, in the spec's order."""
        bodies = measured.bodies[self.layout.order]
        arm = np.einsum("nij,nj->ni", bodies["R"], self.layout.body_offsets["origin"])
        return (
            bodies["r"] + arm,
            bodies["v"] + cross_rows(bodies["omega"], arm),
            bodies["R"].copy(),
            bodies["omega"].copy(),
        )

    def make_assembly(self, measured: MeasuredState, start: Assembly) -> Assembly:
        """Return the start as measured."""
        x, v, R, omega = self.body_motion(measured)
        return replace(start, position=x, rotation=R, velocity=v, angular_velocity=omega)

    def measure_motion(self, state: Array) -> FreedomMotion:
        """Measure what each freedom moves at a state."""
        still = np.array(state)
        still[self.all_rates] = 0.0
        x, v0, _, omega0 = self.body_motion(rest := self.measure(still))
        turns, v = (np.zeros((len(x), 3, len(self.answers))) for _ in range(2))
        rows = np.zeros((len(self.layout.rows), len(self.answers)))
        for k, place in enumerate(self.rate_at):
            still[place] = 1.0
            _, v1, _, omega1 = self.body_motion(measured := self.measure(still))
            still[place] = 0.0
            turns[:, :, k], v[:, :, k], rows[:, k] = omega1 - omega0, v1 - v0, measured.rates - rest.rates
        return FreedomMotion(turns, v, rows, x)

    def apply_step(self, state: Array, step: Array) -> Array:
        """Return the state with its coordinates moved by a step (n,); turns of a ball about the world's axes."""
        full_step = np.zeros(self.layout.velocity_count)
        full_step[self.answers] = step
        new = np.array(state)
        for body in self.layout.bodies[self.layout.bodies["ball"] == 1]:
            place, turn = body["attitude_at"], full_step[body["velocity_at"] : body["velocity_at"] + 3]
            if turn.any():
                new[place : place + 4] = quaternion_product(quaternion_from_vector(turn), new[place : place + 4])
        for freedom in self.layout.tables["freedoms"]:
            if not freedom["driven"]:
                new[freedom["q_at"]] += full_step[freedom["velocity_at"]]
        return new

    def apply_rate_step(self, state: Array, step: Array) -> Array:
        """Return the state with its rates changed by a step (n,)."""
        new = np.array(state)
        new[self.rate_at] += step
        return new


def _freedom_range(layout: Layout, i: int) -> range:
    body = layout.bodies[i]
    count = 3 * int(body["ball"]) + int(body["end_freedom"] - body["first_freedom"])
    return range(int(body["velocity_at"]), int(body["velocity_at"]) + count)


def find_coupled_bodies(layout: Layout, rows: Iterable[int]) -> list[int]:
    """Find the bodies (tree indices) of all trees on the ground that some closure rows tie together, directly or
    through others.
    """
    parents = layout.bodies["parent"]
    root = list(range(len(parents)))
    for i, parent in enumerate(parents.tolist()):
        if parent >= 0:
            root[i] = root[parent]
    group = {r: r for r in root}

    def find_root(i: int) -> int:
        while group[i] != i:
            i = group[i]
        return i

    paths = [row_roots(layout, r, root) for r in range(len(layout.rows))]
    for first, *others in filter(None, paths):
        for other in others:
            group[find_root(other)] = find_root(first)
    wanted = {find_root(i) for r in rows for i in paths[r]}
    return [i for i in range(len(parents)) if find_root(root[i]) in wanted]


def row_roots(layout: Layout, r: int, root: Sequence[int]) -> list[int]:
    """Return the bodies on the ground from which a closure row's paths start, by the root of each body."""
    row = layout.tables["closures"][r]
    return list(dict.fromkeys(root[i] for i in layout.indices[row["path"] : row["path"] + row["path_count"]]))


# Held values

Rows = tuple[Array, Array]  # (k, n) and what they lack (k,)


def held_poses(scene: PreparedScene, present: Assembly, motion: FreedomMotion) -> Iterator[Rows]:
    """Yield the rows that hold poses; present: where the bodies have moved to from the scene's start."""
    size, start = scene.layout.size, scene.start
    for i, body in enumerate(scene.mechanism.bodies):
        if body.rotation is not None:
            yield motion.turns[i], -vector_from_rotation(present.rotation[i] @ start.rotation[i].T)
        if body.position is not None:
            yield motion.v[i] / size, (start.position[i] - present.position[i]) / size
    for joint in scene.mechanism.joints:
        turning, sliding = _joint_rows(joint, present, motion, size)
        if joint.angle is not None:
            yield turning, np.array([-_turn_since_start(joint, start, present)])
        if joint.travel is not None:
            yield sliding, np.array([_travel(joint, start) - _travel(joint, present)]) / size


def held_rates(scene: PreparedScene, present: Assembly, motion: FreedomMotion) -> Iterator[Rows]:
    """Yield the rows that hold rates; present: the start with its present rates."""
    size = scene.layout.size
    for i, body in enumerate(scene.mechanism.bodies):
        if body.angular_velocity is not None:
            projection = _determined_projection(i, scene.idle_spins, present.rotation[i])
            yield (
                projection @ motion.turns[i],
                projection @ (_world_vector(body.angular_velocity, present.rotation[i]) - present.angular_velocity[i]),
            )
        if body.velocity is not None:
            yield motion.v[i] / size, (_world_vector(body.velocity, present.rotation[i]) - present.velocity[i]) / size
    for joint in scene.mechanism.joints:
        turning, sliding = _joint_rows(joint, present, motion, size)
        if joint.rate is not None:
            yield turning, np.array([joint.rate - _joint_rates(joint, present)[0]])
        if joint.speed is not None:
            yield sliding, np.array([joint.speed - _joint_rates(joint, present)[1]]) / size


def _joint_rows(joint: Joint, present: Assembly, motion: FreedomMotion, size: float) -> Rows:
    """Return how the freedoms turn a joint about its axis, and shift it along (by the size), (1, n) each."""
    xb, Rb, _, _ = body_state(present, joint.b)
    n, Q = body_state(present, joint.a)[1] @ joint.axis, xb + Rb @ joint.q
    turning = n @ (motion.body_rotations(joint.b) - motion.body_rotations(joint.a))
    sliding = (
        _travel_direction(joint, present)
        @ (motion.point_velocities(joint.b, Q) - motion.point_velocities(joint.a, Q))
        / size
    )
    return turning[None, :], sliding[None, :]


def _travel_direction(joint: Joint, present: Assembly) -> Array:
    """Return the gradient of the travel as the `to` point shifts in `from`, world axes (3,): the axis; for a path
    r'/r'^2.
    """
    R = body_state(present, joint.a)[1]
    if joint.path is None:
        return np.asarray(R @ joint.axis)
    slope = joint.path.evaluate(_travel(joint, present))[1]
    return np.asarray(R @ slope / float(slope @ slope))


def _joint_rates(joint: Joint, present: Assembly) -> tuple[float, float]:
    """Return the rate about a joint's axis, and the speed along it."""
    xa, Ra, va, wa = body_state(present, joint.a)
    xb, Rb, vb, wb = body_state(present, joint.b)
    Q = xb + Rb @ joint.q
    v = vb + np.cross(wb, Q - xb) - va - np.cross(wa, Q - xa)
    return float((Ra @ joint.axis) @ (wb - wa)), float(_travel_direction(joint, present) @ v)


def _turn_since_start(joint: Joint, start: Assembly, present: Assembly) -> float:
    """Angle by which a joint has turned about its axis since the start, in (-pi, pi]."""
    before, after = (
        body_state(assembly, joint.a)[1].T @ body_state(assembly, joint.b)[1] for assembly in (start, present)
    )
    return axial_angle(after @ before.T, joint.axis)


def _travel(joint: Joint, assembly: Assembly) -> float:
    """Return the travel of a joint; along a path on the branch that is held."""
    xa, Ra, _, _ = body_state(assembly, joint.a)
    xb, Rb, _, _ = body_state(assembly, joint.b)
    place = Ra.T @ (xb + Rb @ joint.q - xa) - joint.p
    if joint.path is None:
        return float(joint.axis @ place)
    return (
        float(joint.path.find_nearest(place)) if joint.travel is None else joint.path.find_nearby(place, joint.travel)
    )


def _world_vector(directed: Directed, R: Array) -> Array:
    return R @ directed.vector if directed.in_body else directed.vector


def _determined_projection(body: int, idle_spins: tuple[IdleSpin, ...], R: Array) -> Array:
    """Return the matrix that projects an angular velocity onto its determined part, (3, 3)."""
    axes = next((spin.axes @ R.T for spin in idle_spins if spin.body == body), np.zeros((0, 3)))
    return np.eye(3) - axes.T @ axes
