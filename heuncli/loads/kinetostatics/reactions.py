"""Joint reactions: force and moment of each joint's constraint, ON `to` by `from`, about the `to` point.

For a joint of the tree they follow from the balance of the branch beyond it; for a cut joint from its multipliers,
sum of lambda (f, m), and of one whose shafts turn alike its moment, wherever it is.
Components along free directions are zero by definition of the joint. The rounding that the sweep leaves there is not
hidden: it enters the balance residual of the bodies.

Loads by their causes are found by the same sums: their arrays have an axis of causes before that of the instants,
(n_c, n_t, 3), while places and directions are those of the instants, (n_t, 3).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from typing import Protocol

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.multibody.mechanism.model import Joint, Stop
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.starts import joint_frame
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows

IN_PLANE, ACROSS = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


class Named(Protocol):
    """Arrays by the names of fields: a table, or a mapping."""

    def __getitem__(self, name: str, /) -> Array: ...


@record
class StopLoad:
    """What a stop exerts ON `to`: value (n_t,) along its coordinate, as force and moment about the `to` point.

    unit (n_t, 6): force and moment of 1 N or 1 N m, nothing where it is not touched.
    """

    stop: Stop
    value: Array
    unit: Array

    def at(self, which: slice) -> StopLoad:
        """At some of the instants."""
        return StopLoad(self.stop, self.value[which], self.unit[which])

    @property
    def force(self) -> Array:
        """(n_t, 3) [N]."""
        return self.value[..., None] * self.unit[..., :3]

    @property
    def moment(self) -> Array:
        """(n_t, 3) [N m]."""
        return self.value[..., None] * self.unit[..., 3:]


class JointPoints:
    """The `to` points of joints, found all together when one is asked for."""

    def __init__(self, joints: Sequence[Joint], states: BodyStates) -> None:
        self.joints, self.states = joints, states

    @cached_property
    def positions(self) -> list[Array]:
        """World positions, (n_t, 3) each."""
        return self.states.point_positions([joint.b for joint in self.joints], [joint.q for joint in self.joints])

    def on_path(self, joint: Joint, centre: Array) -> Array:
        """Where a roller touches the path beside which its centre runs, world axes, (n_t, 3)."""
        from heuncli.scene.expressions.beside import left  # few joints are

        assert joint.path is not None
        n = left(self.states.direction(joint.a, joint.path.normal), self.states.ways[:, joint.way])
        return centre - joint.path.radius * n


@record
class JointLoads:
    """Of one joint: ON `to`, world axes, moment about the `to` point `point`; (n_t, 3) [N], [N m].

    points: of all joints, number: which of them this one's is.
    drive (n_t,): the driving torque or force ON `to` about or along `axis` (n_t, 3), not contained in force and moment
    but for a rod, whose force is the drive's. None where there is no drive or no axis. stops: beside force and moment.
    """

    joint: Joint
    points: JointPoints
    number: int
    force: Array
    moment: Array
    axis: Array | None
    drive: Array | None
    tension: Array | None  # of a rod, (n_t,); None between the limits of a stop, which carry all there is
    stops: tuple[StopLoad, ...] = ()

    def at(self, which: slice, points: JointPoints) -> JointLoads:
        """At some of the instants, where the points are these."""
        axis, drive, tension = (None if x is None else x[which] for x in (self.axis, self.drive, self.tension))
        stops = tuple(own.at(which) for own in self.stops)
        force, moment = self.force[which], self.moment[which]
        return JointLoads(self.joint, points, self.number, force, moment, axis, drive, tension, stops)

    @property
    def point(self) -> Array:
        """Where the `to` point is, (n_t, 3)."""
        return self.points.positions[self.number]

    @property
    def torque(self) -> Array | None:
        """Of shafts that turn alike what `to` gets about either of them, (..., n_t); None of other joints."""
        if not JOINTS[self.joint.kind].turns_alike or self.axis is None:
            return None
        return np.asarray(np.sum(self.moment * self.axis, axis=-1))

    @property
    def drive_force(self) -> Array:
        """The drive's force ON `to` beside `force`, (n_t, 3)."""
        along = self.drive is not None and self.joint.drive is not None and self.joint.drive.quantity == "travel"
        return self.drive[..., None] * self.axis if along else np.zeros_like(self.force)  # type: ignore[index,operator]

    @property
    def drive_moment(self) -> Array:
        """The drive's couple ON `to` beside `moment`, (n_t, 3)."""
        about = self.drive is not None and self.joint.drive is not None and self.joint.drive.quantity == "angle"
        return self.drive[..., None] * self.axis if about else np.zeros_like(self.moment)  # type: ignore[index,operator]

    @property
    def whole(self) -> tuple[Array, Array]:
        """Force and moment ON `to` about its point, those of the drive and of stops included."""
        force, moment = self.force, self.moment
        if self.drive is not None and not JOINTS[self.joint.kind].keeps_distance:
            force, moment = force + self.drive_force, moment + self.drive_moment
        for own in self.stops:
            force, moment = force + own.force, moment + own.moment
        return force, moment

    def parts(self, states: BodyStates, wrenches: Array) -> tuple[Array, Array]:
        """Of wrenches (n_t, 6, k) in the joint what its constraint carries, and what is left to its drive and stops."""
        if JOINTS[self.joint.kind].keeps_distance:
            none = np.zeros_like(wrenches)
            return (none, wrenches) if self.stops else (wrenches, none)
        force, moment = np.moveaxis(wrenches[:, :3], 2, 0), np.moveaxis(wrenches[:, 3:], 2, 0)
        own = np.concatenate(constrained_part(self.joint, states, force, moment), axis=2)
        constraint = np.moveaxis(own, 0, 2)
        return constraint, wrenches - constraint


class Answers(Protocol):
    """The kernel's answers, or some causes' shares in them: fields of tables by name."""

    @property
    def bodies(self) -> Named:
        """joint_moment, joint_force (..., n_t, n_b, 3), tree order."""

    @property
    def freedoms(self) -> Named:
        """drive (..., n_t, n_f)."""

    @property
    def rows(self) -> Named:
        """multiplier (..., n_t, rows); f, m (n_t, rows, 3), closed (n_t, rows)."""

    @property
    def loads(self) -> Named:
        """value (..., n_t, loads); in a blow of none."""

    @property
    def parts(self) -> Named:
        """Of the rows that are sums: f, m, Q, on_a, on_b (n_t, parts, 3)."""


def joint_loads(
    layout: Layout, recovered: Answers, states: BodyStates, only: Collection[str] | None = None
) -> list[JointLoads]:
    """Reactions of all joints, in the order of the spec; only: of those of some names."""
    hang_of = {h.joint: (i, h) for i, h in enumerate(layout.spanning.hangs) if h.joint >= 0}
    driven = {freedom.joint: n for n, freedom in enumerate(layout.freedoms) if freedom.q < 0}
    forces, moments = recovered.bodies["joint_force"], recovered.bodies["joint_moment"]
    joints = [(k, joint) for k, joint in enumerate(layout.mechanism.joints) if only is None or joint.name in only]
    points = JointPoints([joint for _, joint in joints], states)
    loads: list[JointLoads] = []
    for k, joint in joints:
        kind = JOINTS[joint.kind]
        axis = states.direction(joint.a, joint.axis) if kind.has_axis else None
        if kind.follows_path and joint.drive is not None:
            axis = along_path(joint, states)
        drive = tension = None
        if k in hang_of:
            i, h = hang_of[k]
            force, moment = forces[..., i, :], moments[..., i, :]
            if h.reverse:
                arm = states.point_position(joint.a, joint.p) - points.positions[len(loads)]
                force, moment = -force, -moment - cross_rows(arm, force)
            if kind.turns_alike:  # the tree has a ball there, and all the moment is the row's
                moment = _of_joint(layout, k, recovered.rows, "m")
            if k in driven:
                drive = recovered.freedoms["drive"][..., driven[k]]
                if kind.follows_path:  # the kernel's is that of the coordinate, which counts r' along the path
                    drive = drive / np.sqrt(np.sum(states.ways[:, joint.way] ** 2, axis=1))
        else:
            force, moment = (_of_joint(layout, k, recovered.rows, of) for of in ("f", "m"))
            own = rows_of(layout, k)
            if kind.keeps_distance and own:
                push = recovered.rows["multiplier"][..., own[0]]
                drive, tension = (push if joint.drive is not None else None), -push
        force, moment = constrained_part(joint, states, force, moment)
        if layout.mechanism.planar:
            force, moment = in_plane(force, moment)
        stops = stop_loads(layout, k, recovered.rows)
        loads.append(JointLoads(joint, points, len(loads), force, moment, axis, drive, tension, stops))
    return loads


def at_instants(loads: Sequence[JointLoads], which: slice, states: BodyStates) -> list[JointLoads]:
    """Reactions of joints at some of their instants; states: the bodies' at these."""
    points = JointPoints([load.joint for load in loads], states)
    return [load.at(which, points) for load in loads]


def rows_of(layout: Layout, joint: int) -> list[int]:
    """The closure rows of a cut joint's own constraint, not of stops."""
    stops = {contact.row for contact in layout.contacts if not contact.is_rope}
    return [r for r, owner in enumerate(layout.rows) if owner == joint and r not in stops]


def stop_loads(layout: Layout, joint: int, rows: Named) -> tuple[StopLoad, ...]:
    """What the stops of a joint exert; of the two limits of one at most one is touched."""
    found = []
    for stop in layout.mechanism.stops:
        if stop.joint != joint:
            continue
        own = [contact.row for contact in layout.contacts if contact.name == stop.name and not contact.is_rope]
        units = np.concatenate([rows["f"][..., own, :], rows["m"][..., own, :]], axis=-1)
        unit = np.max(rows["closed"][..., own, None], axis=-2) * units[..., 0, :]  # of both limits it is the same
        values = rows["multiplier"][..., own]
        if (
            layout.mechanism.joints[joint].path is not None
        ):  # a unit of the row is of the coordinate, whatever it counts
            sizes = np.sqrt(np.sum(units * units, axis=-1))
            values, unit = values * sizes, unit / sizes[..., :1]
        found.append(StopLoad(stop, values.sum(axis=-1), unit))
    return tuple(found)


def _of_joint(layout: Layout, joint: int, rows: Named, of: str) -> Array:
    """The sum over the closure rows of a cut joint, of their forces "f" or of their moments "m"."""
    total = np.zeros((*rows["multiplier"].shape[:-1], 3))
    for r in rows_of(layout, joint):
        total = total + rows["multiplier"][..., r, None] * rows[of][..., r, :]
    return total


def in_plane(force: Array, moment: Array) -> tuple[Array, Array]:
    """The parts that exist in a scene declared planar: force in x, y, moment in z; (..., 3)."""
    return force * IN_PLANE, moment * ACROSS


def along_path(joint: Joint, states: BodyStates) -> Array:
    """The unit vector along the path where the joint's point is on it, (n_t, 3)."""
    way = states.ways[:, joint.way]
    return np.asarray(way / np.sqrt(np.sum(way * way, axis=1))[:, None])


def constraint_map(joint: Joint, states: BodyStates) -> Array:
    """The map of a wrench in the joint to what of it its constraint carries, (n_t, 6, 6)."""
    wrenches = np.broadcast_to(np.eye(6)[:, None, :], (6, len(states.x), 6))
    force, moment = constrained_part(joint, states, wrenches[..., :3], wrenches[..., 3:])
    return np.moveaxis(np.concatenate([force, moment], axis=2), 0, 2)


def constrained_part(joint: Joint, states: BodyStates, force: Array, moment: Array) -> tuple[Array, Array]:
    """Force and moment without their components in the joint's free directions (drives are reported apart)."""
    kind = JOINTS[joint.kind]
    if kind.ball:
        moment = np.zeros_like(moment)
    elif len(kind.turns) == 2:
        n = cross_rows(states.direction(joint.a, joint.axis), states.direction(joint.b, joint.to_axis))
        n = n / np.sqrt(np.sum(n * n, axis=1))[:, None]
        moment = np.sum(moment * n, axis=-1)[..., None] * n
    elif kind.turns_alike:
        n = states.direction(joint.a, joint.axis) + states.direction(joint.b, joint.to_axis)
        moment = np.sum(moment * n, axis=-1)[..., None] * n / np.sum(n * n, axis=1)[:, None]
    elif kind.turns:
        n = states.direction(joint.a, joint_frame(joint, kind.turns[0]))
        moment = moment - np.sum(moment * n, axis=-1)[..., None] * n
    for d in kind.shifts:
        n = along_path(joint, states) if kind.follows_path else states.direction(joint.a, joint_frame(joint, d))
        force = force - np.sum(force * n, axis=-1)[..., None] * n
    return force, moment
