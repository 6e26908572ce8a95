"""Joint reactions: force and moment of each joint's constraint, ON `to` by `from`, about the `to` point.

For a joint of the tree they follow from the balance of the branch beyond it. For a cut joint they follow from its
multipliers, as the sum of lambda (f, m); so does the moment of a joint whose shafts turn alike, wherever it is.

Components along free directions are zero by definition of the joint. The rounding that the sweep leaves there is not
hidden: it enters the balance residual of the bodies.

Loads by cause use the same sums: their arrays have an axis of causes before that of the instants, (n_c, n_t, 3), while
places and directions are those of the instants, (n_t, 3).

In the axes of one of the joint's bodies, as a bearing that turns with it carries them:

    F_i = e_i . F,   e_i (t) the axes of the body: F' = R^T F

Indeterminacy has a direction: a component along e_i is indeterminate where a self-stress has a share along e_i. So
shares of self-stresses are rotated as the loads are, and judged afterwards. Axes of the ground are the world's.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from typing import Protocol

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint, Stop
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.starts import joint_direction
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows

# Reactions

IN_PLANE, ACROSS = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


class NamedArrays(Protocol):
    """Arrays by field name: a table, or a mapping."""

    def __getitem__(self, name: str, /) -> Array: ...


@record
class StopLoad:
    """What a stop exerts ON `to`.

    value (n_t,): along its coordinate
    unit (n_t, 6): force and moment about the `to` point for 1 N or 1 N m, zero where the stop is not touched
    """

    stop: Stop
    value: Array
    unit: Array

    def select(self, instants: slice) -> StopLoad:
        """Select some of the instants."""
        return StopLoad(self.stop, self.value[instants], self.unit[instants])

    @property
    def force(self) -> Array:
        """Force (n_t, 3) [N]."""
        return self.value[..., None] * self.unit[..., :3]

    @property
    def moment(self) -> Array:
        """Moment (n_t, 3) [N m]."""
        return self.value[..., None] * self.unit[..., 3:]


class JointPoints:
    """The `to` points of joints, computed all together when one is read."""

    def __init__(self, joints: Sequence[Joint], states: BodyStates) -> None:
        self.joints, self.states = joints, states

    @cached_property
    def positions(self) -> list[Array]:
        """World positions, (n_t, 3) each."""
        return self.states.point_positions([joint.b for joint in self.joints], [joint.q for joint in self.joints])

    def contact_point(self, joint: Joint, centre: Array) -> Array:
        """Return where a roller touches the path along which its centre runs, world axes, (n_t, 3)."""
        from heuncli.scene.expressions.roller_path import left_normal  # few joints are

        assert joint.path is not None
        n = left_normal(
            self.states.world_direction(joint.a, joint.path.normal), self.states.path_directions[:, joint.path_index]
        )
        return centre - joint.path.radius * n


@record
class JointLoads:
    """Loads of one joint ON `to`, world axes, moment about the `to` point `point`; (n_t, 3) [N], [N m].

    points: of all joints
    number: which of them is this joint's
    drive (n_t,): driving torque or force ON `to` about or along `axis` (n_t, 3), not contained in force and moment
    except for a rod, whose force is the drive's; None without a drive or axis
    stops: loads of the stops, not contained in force and moment
    """

    joint: Joint
    points: JointPoints
    number: int
    force: Array
    moment: Array
    axis: Array | None
    drive: Array | None
    tension: Array | None  # of a rod, (n_t,); None between the limits of a stop, which carry all load
    stops: tuple[StopLoad, ...] = ()

    def select(self, instants: slice, points: JointPoints) -> JointLoads:
        """Select some of the instants, with the points there."""
        axis, drive, tension = (None if x is None else x[instants] for x in (self.axis, self.drive, self.tension))
        stops = tuple(own.select(instants) for own in self.stops)
        force, moment = self.force[instants], self.moment[instants]
        return JointLoads(self.joint, points, self.number, force, moment, axis, drive, tension, stops)

    @property
    def point(self) -> Array:
        """Position of the `to` point, (n_t, 3)."""
        return self.points.positions[self.number]

    @property
    def slides(self) -> bool:
        """Whether its points may part along a line or in a plane, so that it carries no force there."""
        return bool(JOINTS[self.joint.kind].shifts)

    @property
    def torque(self) -> Array | None:
        """Of shafts that turn alike the moment ON `to` about either of them, (..., n_t); None for other joints."""
        if not JOINTS[self.joint.kind].is_constant_velocity or self.axis is None:
            return None
        return np.asarray(np.sum(self.moment * self.axis, axis=-1))

    @property
    def drive_force(self) -> Array:
        """The drive's force ON `to`, in addition to `force`, (n_t, 3)."""
        is_linear = self.drive is not None and self.joint.drive is not None and self.joint.drive.quantity == "travel"
        return self.drive[..., None] * self.axis if is_linear else np.zeros_like(self.force)  # type: ignore[index,operator]

    @property
    def drive_moment(self) -> Array:
        """The drive's couple ON `to`, in addition to `moment`, (n_t, 3)."""
        is_rotary = self.drive is not None and self.joint.drive is not None and self.joint.drive.quantity == "angle"
        return self.drive[..., None] * self.axis if is_rotary else np.zeros_like(self.moment)  # type: ignore[index,operator]

    @property
    def total(self) -> tuple[Array, Array]:
        """Force and moment ON `to` about its point, including those of the drive and of stops."""
        force, moment = self.force, self.moment
        if self.drive is not None and not JOINTS[self.joint.kind].keeps_distance:
            force, moment = force + self.drive_force, moment + self.drive_moment
        for own in self.stops:
            force, moment = force + own.force, moment + own.moment
        return force, moment

    def split_wrenches(self, states: BodyStates, wrenches: Array) -> tuple[Array, Array]:
        """Split wrenches (n_t, 6, k) in the joint into the part of its constraint and that of drive and stops."""
        if JOINTS[self.joint.kind].keeps_distance:
            zeros = np.zeros_like(wrenches)
            return (zeros, wrenches) if self.stops else (wrenches, zeros)
        force, moment = np.moveaxis(wrenches[:, :3], 2, 0), np.moveaxis(wrenches[:, 3:], 2, 0)
        carried = np.concatenate(remove_free_components(self.joint, states, force, moment), axis=2)
        constraint = np.moveaxis(carried, 0, 2)
        return constraint, wrenches - constraint


class KernelResults(Protocol):
    """The kernel's results, or the shares of some causes in them: fields of tables by name."""

    @property
    def bodies(self) -> NamedArrays:
        """joint_moment, joint_force (..., n_t, n_b, 3), tree order."""

    @property
    def freedoms(self) -> NamedArrays:
        """drive (..., n_t, n_f)."""

    @property
    def rows(self) -> NamedArrays:
        """multiplier (..., n_t, rows); f, m (n_t, rows, 3), closed (n_t, rows)."""

    @property
    def loads(self) -> NamedArrays:
        """value (..., n_t, loads); none in an impulse."""

    @property
    def parts(self) -> NamedArrays:
        """Of the rows that are sums: f, m, Q, on_a, on_b (n_t, parts, 3)."""


def find_joint_loads(
    layout: Layout, results: KernelResults, states: BodyStates, names: Collection[str] | None = None
) -> list[JointLoads]:
    """Find the reactions of all joints, or of those with the given names, in the order of the spec.

    Of a joint in the tree it is the kernel's load on the child body; if that is the joint's `from` body, it is negated
    and its moment moved to the `to` point; of a cut joint the sum of its closure rows, each times its multiplier.
    """
    tree_links = {h.joint: (i, h) for i, h in enumerate(layout.spanning.links) if h.joint >= 0}
    driven_freedoms = {freedom.joint: n for n, freedom in enumerate(layout.freedoms) if freedom.q < 0}
    forces, moments = results.bodies["joint_force"], results.bodies["joint_moment"]
    joints = [(k, joint) for k, joint in enumerate(layout.mechanism.joints) if names is None or joint.name in names]
    points = JointPoints([joint for _, joint in joints], states)
    loads: list[JointLoads] = []
    for k, joint in joints:
        kind = JOINTS[joint.kind]
        has_axis = kind.has_axis or joint.bearings is not None
        axis = states.world_direction(joint.a, joint.axis) if has_axis else None
        if kind.follows_path and joint.drive is not None:
            axis = find_path_direction(joint, states)
        drive = tension = None
        if k in tree_links:
            i, h = tree_links[k]
            force, moment = forces[..., i, :], moments[..., i, :]
            if h.reverse:
                arm = states.point_position(joint.a, joint.p) - points.positions[len(loads)]
                force, moment = -force, -moment - cross_rows(arm, force)
            if kind.is_constant_velocity:  # the tree has a ball there, and all the moment is the row's
                moment = _sum_joint_rows(layout, k, results.rows, "m")
            if k in driven_freedoms:
                drive = results.freedoms["drive"][..., driven_freedoms[k]]
                if kind.follows_path:  # the kernel's value belongs to the coordinate, which counts r' along the path
                    drive = drive / np.sqrt(np.sum(states.path_directions[:, joint.path_index] ** 2, axis=1))
        else:
            force, moment = (_sum_joint_rows(layout, k, results.rows, name) for name in ("f", "m"))
            own_rows = find_joint_rows(layout, k)
            if kind.keeps_distance and own_rows:
                push = results.rows["multiplier"][..., own_rows[0]]
                drive, tension = (push if joint.drive is not None else None), -push
        force, moment = remove_free_components(joint, states, force, moment)
        if layout.mechanism.planar:
            force, moment = project_to_plane(force, moment)
        stops = find_stop_loads(layout, k, results.rows)
        loads.append(JointLoads(joint, points, len(loads), force, moment, axis, drive, tension, stops))
    return loads


def select_instants(loads: Sequence[JointLoads], instants: slice, states: BodyStates) -> list[JointLoads]:
    """Select reactions of joints at some instants; states: the bodies' there."""
    points = JointPoints([load.joint for load in loads], states)
    return [load.select(instants, points) for load in loads]


def find_joint_rows(layout: Layout, joint: int) -> list[int]:
    """Return the closure rows of a cut joint's own constraint, without its stops."""
    stops = {contact.row for contact in layout.contacts if not contact.is_rope}
    return [r for r, owner in enumerate(layout.rows) if owner == joint and r not in stops]


def find_stop_loads(layout: Layout, joint: int, rows: NamedArrays) -> tuple[StopLoad, ...]:
    """Find what the stops of a joint exert; at most one of the two limits of a stop is touched."""
    result = []
    for stop in layout.mechanism.stops:
        if stop.joint != joint:
            continue
        own_rows = [contact.row for contact in layout.contacts if contact.name == stop.name and not contact.is_rope]
        units = np.concatenate([rows["f"][..., own_rows, :], rows["m"][..., own_rows, :]], axis=-1)
        unit = np.max(rows["closed"][..., own_rows, None], axis=-2) * units[..., 0, :]  # of both limits it is the same
        values = rows["multiplier"][..., own_rows]
        if layout.mechanism.joints[joint].path is not None:  # a unit of the row is a unit of the path's coordinate
            sizes = np.sqrt(np.sum(units * units, axis=-1))
            values, unit = values * sizes, unit / sizes[..., :1]
        result.append(StopLoad(stop, values.sum(axis=-1), unit))
    return tuple(result)


def _sum_joint_rows(layout: Layout, joint: int, rows: NamedArrays, field: str) -> Array:
    """Sum over the closure rows of a cut joint the forces "f" or the moments "m"."""
    total = np.zeros((*rows["multiplier"].shape[:-1], 3))
    for r in find_joint_rows(layout, joint):
        total = total + rows["multiplier"][..., r, None] * rows[field][..., r, :]
    return total


def project_to_plane(force: Array, moment: Array) -> tuple[Array, Array]:
    """Return the parts that exist in a scene declared planar: force in x, y, moment in z; (..., 3)."""
    return force * IN_PLANE, moment * ACROSS


def find_path_direction(joint: Joint, states: BodyStates) -> Array:
    """Return the unit vector along the path at the joint's point, (n_t, 3)."""
    direction = states.path_directions[:, joint.path_index]
    return np.asarray(direction / np.sqrt(np.sum(direction * direction, axis=1))[:, None])


def make_constraint_map(joint: Joint, states: BodyStates) -> Array:
    """Return the map of a wrench in the joint to the part that its constraint carries, (n_t, 6, 6)."""
    wrenches = np.broadcast_to(np.eye(6)[:, None, :], (6, len(states.x), 6))
    force, moment = remove_free_components(joint, states, wrenches[..., :3], wrenches[..., 3:])
    return np.moveaxis(np.concatenate([force, moment], axis=2), 0, 2)


def remove_free_components(joint: Joint, states: BodyStates, force: Array, moment: Array) -> tuple[Array, Array]:
    """Return force and moment of the constraint alone: without components along the joint's free directions.

    A drive acts along these; it is reported separately.
    """
    kind = JOINTS[joint.kind]
    if kind.is_ball:
        moment = np.zeros_like(moment)
    elif len(kind.turns) == 2:
        n = cross_rows(states.world_direction(joint.a, joint.axis), states.world_direction(joint.b, joint.to_axis))
        n = n / np.sqrt(np.sum(n * n, axis=1))[:, None]
        moment = np.sum(moment * n, axis=-1)[..., None] * n
    elif kind.is_constant_velocity:
        n = states.world_direction(joint.a, joint.axis) + states.world_direction(joint.b, joint.to_axis)
        moment = np.sum(moment * n, axis=-1)[..., None] * n / np.sum(n * n, axis=1)[:, None]
    elif kind.turns:
        n = states.world_direction(joint.a, joint_direction(joint, kind.turns[0]))
        moment = moment - np.sum(moment * n, axis=-1)[..., None] * n
    for d in kind.shifts:
        n = (
            find_path_direction(joint, states)
            if kind.follows_path
            else states.world_direction(joint.a, joint_direction(joint, d))
        )
        force = force - np.sum(force * n, axis=-1)[..., None] * n
    return force, moment


# Joint axes

JOINT_AXES = ("world", "from", "to")


def find_joint_axes(joint: Joint, states: BodyStates, axes: str) -> Array | None:
    """Return the axes in which a joint's loads are reported, as columns, (n_t, 3, 3); None: the world's."""
    body = {"from": joint.a, "to": joint.b}.get(axes, GROUND)
    return states.R[:, body] if body != GROUND else None


def rotate_to_axes(vectors: Array, R: Array | None) -> Array:
    """Return the components of vectors (..., n_t, 3) in the axes R."""
    return vectors if R is None else np.einsum("tji,...tj->...ti", R, vectors)


def rotate_shares(shares: Array, R: Array | None) -> Array:
    """Return the components in the axes R of shares of self-stresses, force and moment, (n_t, 6, k)."""
    if R is None:
        return shares
    return np.concatenate([np.einsum("tji,tjk->tik", R, part) for part in (shares[:, :3], shares[:, 3:])], axis=1)


def rotate_joint_loads(load: JointLoads, states: BodyStates, axes: str) -> JointLoads:
    """Return a joint's loads, or their shares, with force and moment in these axes."""
    R = find_joint_axes(load.joint, states, axes)
    if R is None:
        return load
    return replace(load, force=rotate_to_axes(load.force, R), moment=rotate_to_axes(load.moment, R))


def rotate_block(block: Block, R: Array | None) -> None:
    """Rotate the force and moment of a joint's block, and of their shares by cause, to these axes, in place."""
    for entry in (block, *block.get("shares", {}).values()):
        entry |= {name: rotate_to_axes(entry[name], R) for name in ("force", "moment") if name in entry}
    for bearing in block.get("bearings", {}).values():
        for entry in (bearing, *bearing.get("shares", {}).values()):
            entry["radial_force"] = rotate_to_axes(entry["radial_force"], R)
