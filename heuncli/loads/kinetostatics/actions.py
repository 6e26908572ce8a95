"""The actions on the bodies: what applied loads, joints and drives exert, in one list for all sums and balances.

An action is a force and a moment ON one body. Unless it comes from outside, another body feels the opposite (action and
reaction), each at its own end. World axes, moments about the position of the end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import (
    GROUND,
    BushingLoad,
    JointLoad,
    Load,
    PairLoad,
    PointLoad,
    RopeLoad,
    ThreadLoad,
    TriangularDistribution,
)
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class ActionEnd:
    """Where an action enters a body; the moment is about `position` (n_t, 3), world.

    point: the same in the body's axes (3,), None where it moves over the body
    is_offset: the position is that of the other body's point, at a distance equal to the closure's gap, the rod's
    length or a bushing's shift
    """

    body: int
    position: Array
    point: Array | None
    is_offset: bool = False


@record
class DistributedForce:
    """A part of a distributed load: its force (n_t, 3), world, and its distribution along the body."""

    spread: TriangularDistribution
    force: Array


@record
class Action:
    """Force [N] and moment [N m] ON the body of `to_end`, (n_t, 3); the opposite ON that of `from_end`, None: from
    outside.

    name: of the load, of the joint (its constraint alone, unless drive and stops are included on purpose), of the drive
    or of the stop
    spread: the parts of a distributed load, whose resultant the force and the moment are
    opposite: the moment ON the body of `from_end`, where its end is so far away that it is not simply the opposite
    """

    kind: Literal["load", "joint", "drive", "stop", "coupling"]
    name: str
    to_end: ActionEnd
    from_end: ActionEnd | None
    force: Array
    moment: Array
    spread: tuple[DistributedForce, ...] = ()
    opposite: Array | None = None

    @property
    def opposite_moment(self) -> Array:
        """Moment ON the body of `from_end` about its own end."""
        return -self.moment if self.opposite is None else self.opposite

    def iter_ends(self) -> Iterator[tuple[ActionEnd, Array, Array]]:
        """Yield each end with the force and moment ON the body there, about its position."""
        yield self.to_end, self.force, self.moment
        if self.from_end is not None:
            yield self.from_end, -self.force, self.opposite_moment

    def ground_load(self) -> tuple[Array, Array, Array] | None:
        """Return force and moment ON the ground and the position that the moment is about; None where it acts
        elsewhere.

        An action between two points of the ground, such as a strand of a rope, gives both together.
        """
        if self.from_end is not None and self.to_end.body == self.from_end.body == GROUND:
            lever = cross_rows(self.to_end.position - self.from_end.position, self.force)
            return np.zeros_like(self.force), self.moment + self.opposite_moment + lever, self.to_end.position
        if self.to_end.body == GROUND:
            return self.force, self.moment, self.to_end.position
        if self.from_end is not None and self.from_end.body == GROUND:
            return -self.force, self.opposite_moment, self.from_end.position
        return None


@record
class AppliedLoad:
    """An applied load at the requested instants: its action, value, length [m], rate and power [W] (n_t,).

    value: force or moment of a load between two bodies, magnitude of one from outside, of a distributed one that of its
    resultant
    length, rate: of the line between its points, or of the rotation or travel of its joint, the magnitude where that
    has no single axis (a turn spring's angle counts as the length, other loads of that kind have none)
    strain: shift and rotation of a bushing, (n_t, 2, 3) [m], [rad], in its own axes
    reserve: how much more a friction that sticks could take, (n_t,); 0 while it slips, None for other loads
    """

    load: Load
    action: Action
    value: Array
    length: Array
    rate: Array
    power: Array
    strain: Array | None = None
    reserve: Array | None = None


def collect_applied_loads(mechanism: Mechanism, states: BodyStates, evaluation: Evaluation) -> list[AppliedLoad]:
    """Collect the applied loads in the order of the spec, without ropes; a joint's load may have parts for several
    motions.

    A load in a joint acts exactly where the joint does, so that both cross a cut at the same instant.
    """
    loads: list[AppliedLoad] = []
    sticking = {friction.load.name: friction.load_row for friction in mechanism.iter_sticking()}
    first_part: tuple[PointLoad, LoadRows] | None = None  # of a distributed load's two parts
    for load, load_rows in mechanism.iter_load_rows():
        if isinstance(load, RopeLoad):
            continue  # its coupling reports its load
        joint = mechanism.joints[load.joint] if isinstance(load, JointLoad) else None
        rows = evaluation.loads[:, load_rows]
        if isinstance(load, PointLoad) and load.spread is not None:
            if first_part is not None:
                loads.append(combine_distributed((first_part, (load, rows))))
            first_part = (load, rows) if first_part is None else None
            continue
        force, moment = rows["force"].sum(axis=1), rows["moment"].sum(axis=1)
        to_position = rows["at"][:, 0] if joint is None else states.point_position(joint.b, joint.q)
        to_end, from_end = _find_load_ends(mechanism, load, joint, to_position, rows["from_at"][:, 0])
        action = Action("load", load.name, to_end, from_end, force, moment)
        own = sticking.get(load.name, load_rows.start) - load_rows.start
        value, span, rate = (rows[name][:, own] for name in ("value", "span", "rate"))
        strain = rows["strain"] if isinstance(load, BushingLoad) else None
        reserve = rows["reserve"][:, own] if load.name in sticking else None
        loads.append(AppliedLoad(load, action, value, span, rate, rows["power"].sum(axis=1), strain, reserve))
    return loads


LoadRows = np.ndarray[tuple[int, ...], np.dtype[np.void]]  # rows of the kernel's table of loads


def combine_distributed(parts: Sequence[tuple[PointLoad, LoadRows]]) -> AppliedLoad:
    """Combine the two parts of a distributed load: its resultant, about the midpoint between theirs."""
    load = parts[0][0]
    positions = [row["at"][:, 0] for _, row in parts]
    forces = [row["force"][:, 0] for _, row in parts]
    middle, force = 0.5 * (positions[0] + positions[1]), forces[0] + forces[1]
    moment = cross_rows(0.5 * (positions[0] - positions[1]), forces[0] - forces[1])
    spreads = [part.spread for part, _ in parts if part.spread is not None]
    end = ActionEnd(load.body, middle, 0.5 * (spreads[0].center + spreads[1].center))
    distributed_forces = tuple(DistributedForce(spread, own) for spread, own in zip(spreads, forces, strict=True))
    action = Action("load", load.name, end, None, force, moment, distributed_forces)
    zeros = np.zeros(len(force))
    power = sum((row["power"].sum(axis=1) for _, row in parts), zeros)
    return AppliedLoad(load, action, np.sqrt(np.sum(force * force, axis=1)), zeros, zeros, power)


def _find_load_ends(
    mechanism: Mechanism, load: Load, joint: Joint | None, to_position: Array, from_position: Array
) -> tuple[ActionEnd, ActionEnd | None]:
    """Return where a load acts; to_position, from_position: world positions of its points."""
    if isinstance(load, PointLoad):
        point = load.point if load.point is not None else mechanism.bodies[load.body].center
        return ActionEnd(load.body, to_position, point), None
    if isinstance(load, PairLoad):
        return ActionEnd(load.b, to_position, load.q), ActionEnd(load.a, from_position, load.p)
    if isinstance(load, BushingLoad):
        return ActionEnd(load.b, to_position, load.q), ActionEnd(load.a, to_position, load.p, is_offset=True)
    if isinstance(load, ThreadLoad):
        return ActionEnd(load.b, to_position, load.q), ActionEnd(load.a, to_position, None, is_offset=True)
    assert joint is not None
    return _find_joint_ends(joint, to_position)


def _find_joint_ends(joint: Joint, position: Array) -> tuple[ActionEnd, ActionEnd]:
    """Return the ends of what acts in a joint, at its `to` point."""
    point = None if JOINTS[joint.kind].has_moving_contact else joint.p
    return ActionEnd(joint.b, position, joint.q), ActionEnd(joint.a, position, point, is_offset=True)


def list_joint_actions(joints: Sequence[JointLoads]) -> list[Action]:
    """List what the joints' constraints exert, each followed by its drive (a rod's force is its drive's) and its
    stops.
    """
    actions: list[Action] = []
    for load in joints:
        actions.append(make_joint_action(load, load.force, load.moment))
        drive = load.joint.drive
        if drive is not None and not JOINTS[load.joint.kind].keeps_distance:
            ends = _find_joint_ends(load.joint, load.point)
            actions.append(Action("drive", drive.name, *ends, load.drive_force, load.drive_moment))
        for stop_load in load.stops:
            actions.append(
                Action(
                    "stop",
                    stop_load.stop.name,
                    *_find_joint_ends(load.joint, load.point),
                    stop_load.force,
                    stop_load.moment,
                )
            )
    return actions


def list_whole_joint_actions(joints: Sequence[JointLoads]) -> list[Action]:
    """List what the joints exert with their drives and stops, one action for each joint."""
    return [make_joint_action(load, *load.total) for load in joints]


def make_joint_action(load: JointLoads, force: Array, moment: Array) -> Action:
    """Make the action of a force and a moment about the `to` point in a joint, ON `to`."""
    return Action("joint", load.joint.name, *_find_joint_ends(load.joint, load.point), force, moment)
