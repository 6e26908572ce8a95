"""The actions on the bodies: what applied loads, joints and drives exert, one list that all sums and balances read.

An action is a force and a moment ON one body; unless it comes from outside, another body feels the opposite (action
and reaction), each at its own end. World axes, moments about the position of the end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import (
    GROUND,
    BushingLoad,
    Joint,
    JointLoad,
    Load,
    Mechanism,
    PairLoad,
    PointLoad,
    RopeLoad,
    Spread,
    ThreadLoad,
)
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class ActionEnd:
    """Where an action enters a body; the moment is about `position` (n_t, 3), world.

    point: where that is in the body's axes (3,), None where it moves over the body. apart: the position is that of the
    other body's point, at a distance equal to the closure's gap, the rod's length or a bushing's shift.
    """

    body: int
    position: Array
    point: Array | None
    apart: bool = False


@record
class DistributedForce:
    """A part of a distributed load: its force (n_t, 3), world, and how it is spread along the body."""

    spread: Spread
    force: Array


@record
class Action:
    """Force [N] and moment [N m] ON the body of `to`, (n_t, 3); the opposite ON that of `from_`, None: from outside.

    name: of the load, of the joint (its constraint alone, unless drive and stops are included on purpose), of the drive
    or of the stop. spread: the parts of a distributed load, whose resultant the force and the moment are. opposite: the
    moment ON the body of `from_`, where its end is so far apart that it is not the opposite.
    """

    kind: Literal["load", "joint", "drive", "stop", "coupling"]
    name: str
    to: ActionEnd
    from_: ActionEnd | None
    force: Array
    moment: Array
    spread: tuple[DistributedForce, ...] = ()
    opposite: Array | None = None

    @property
    def opposite_moment(self) -> Array:
        """Moment ON the body of `from_` about its own end."""
        return -self.moment if self.opposite is None else self.opposite

    def on_bodies(self) -> Iterator[tuple[ActionEnd, Array, Array]]:
        """Each end with the force and moment ON the body there, about its position."""
        yield self.to, self.force, self.moment
        if self.from_ is not None:
            yield self.from_, -self.force, self.opposite_moment

    def on_ground(self) -> tuple[Array, Array, Array] | None:
        """Force and moment ON the ground and the position that the moment is about; None where it acts elsewhere.

        Of what acts between two places of the ground, as a strand of a rope, both together.
        """
        if self.from_ is not None and self.to.body == self.from_.body == GROUND:
            lever = cross_rows(self.to.position - self.from_.position, self.force)
            return np.zeros_like(self.force), self.moment + self.opposite_moment + lever, self.to.position
        if self.to.body == GROUND:
            return self.force, self.moment, self.to.position
        if self.from_ is not None and self.from_.body == GROUND:
            return -self.force, self.opposite_moment, self.from_.position
        return None


@record
class AppliedLoad:
    """An applied load at the asked instants: its action, value, length [m], rate and power [W] (n_t,).

    value: the force or moment of a load between two bodies, the magnitude of one from outside, of a distributed one
    that of its resultant; length and rate: of the line between its points, or of the turning or sliding of its joint,
    the magnitude where that has no one axis (of which a turn spring's angle is the length, other loads have none).
    strain: of a bushing its shift and its turn, (n_t, 2, 3) [m], [rad], in its own axes.
    """

    load: Load
    action: Action
    value: Array
    length: Array
    rate: Array
    power: Array
    strain: Array | None = None


def applied_loads(mechanism: Mechanism, states: BodyStates, recovered: Recovered) -> list[AppliedLoad]:
    """The applied loads in the order of the spec, without ropes; of a joint's load the parts of its several motions.

    A load in a joint acts where the joint does, to the last bit: both pass a cut at one instant.
    """
    loads: list[AppliedLoad] = []
    first: tuple[PointLoad, LoadRows] | None = None  # of a distributed load's two parts
    for load, own in mechanism.load_rows():
        if isinstance(load, RopeLoad):
            continue  # its coupling tells what it exerts
        joint = mechanism.joints[load.joint] if isinstance(load, JointLoad) else None
        rows = recovered.loads[:, own]
        if isinstance(load, PointLoad) and load.spread is not None:
            if first is not None:
                loads.append(distributed((first, (load, rows))))
            first = (load, rows) if first is None else None
            continue
        force, moment = rows["force"].sum(axis=1), rows["moment"].sum(axis=1)
        on_to = rows["at"][:, 0] if joint is None else states.point_position(joint.b, joint.q)
        to, from_ = _ends(mechanism, load, joint, on_to, rows["from_at"][:, 0])
        action = Action("load", load.name, to, from_, force, moment)
        value, span, rate = (rows[name][:, 0] for name in ("value", "span", "rate"))
        strain = rows["strain"] if isinstance(load, BushingLoad) else None
        loads.append(AppliedLoad(load, action, value, span, rate, rows["power"].sum(axis=1), strain))
    return loads


LoadRows = np.ndarray[tuple[int, ...], np.dtype[np.void]]  # of the kernel's answers


def distributed(parts: Sequence[tuple[PointLoad, LoadRows]]) -> AppliedLoad:
    """A distributed load of its two parts: its resultant, about the middle between theirs."""
    load = parts[0][0]
    on = [row["at"][:, 0] for _, row in parts]
    forces = [row["force"][:, 0] for _, row in parts]
    middle, force = 0.5 * (on[0] + on[1]), forces[0] + forces[1]
    moment = cross_rows(0.5 * (on[0] - on[1]), forces[0] - forces[1])
    spreads = [part.spread for part, _ in parts if part.spread is not None]
    end = ActionEnd(load.body, middle, 0.5 * (spreads[0].center + spreads[1].center))
    along = tuple(DistributedForce(spread, own) for spread, own in zip(spreads, forces, strict=True))
    action = Action("load", load.name, end, None, force, moment, along)
    none = np.zeros(len(force))
    power = sum((row["power"].sum(axis=1) for _, row in parts), none)
    return AppliedLoad(load, action, np.sqrt(np.sum(force * force, axis=1)), none, none, power)


def _ends(
    mechanism: Mechanism, load: Load, joint: Joint | None, on_to: Array, on_from: Array
) -> tuple[ActionEnd, ActionEnd | None]:
    """Where a load acts; on_to, on_from: the positions of its points, world."""
    if isinstance(load, PointLoad):
        point = load.point if load.point is not None else mechanism.bodies[load.body].center
        return ActionEnd(load.body, on_to, point), None
    if isinstance(load, PairLoad):
        return ActionEnd(load.b, on_to, load.q), ActionEnd(load.a, on_from, load.p)
    if isinstance(load, BushingLoad):
        return ActionEnd(load.b, on_to, load.q), ActionEnd(load.a, on_to, load.p, apart=True)
    if isinstance(load, ThreadLoad):
        return ActionEnd(load.b, on_to, load.q), ActionEnd(load.a, on_to, None, apart=True)
    assert joint is not None
    return _joint_ends(joint, on_to)


def _joint_ends(joint: Joint, position: Array) -> tuple[ActionEnd, ActionEnd]:
    """The ends of what acts in a joint, at its `to` point."""
    point = None if JOINTS[joint.kind].wanders else joint.p
    apart = True
    return ActionEnd(joint.b, position, joint.q), ActionEnd(joint.a, position, point, apart)


def joint_actions(joints: Sequence[JointLoads]) -> list[Action]:
    """What the joints' constraints exert, each followed by its drive (a rod's force is its drive's) and its stops."""
    actions: list[Action] = []
    for load in joints:
        actions.append(joint_action(load, load.force, load.moment))
        drive = load.joint.drive
        if drive is not None and not JOINTS[load.joint.kind].keeps_distance:
            ends = _joint_ends(load.joint, load.point)
            actions.append(Action("drive", drive.name, *ends, load.drive_force, load.drive_moment))
        for own in load.stops:
            actions.append(Action("stop", own.stop.name, *_joint_ends(load.joint, load.point), own.force, own.moment))
    return actions


def whole_joint_actions(joints: Sequence[JointLoads]) -> list[Action]:
    """What the joints exert with their drives and stops, one action a joint."""
    return [joint_action(load, *load.whole) for load in joints]


def joint_action(load: JointLoads, force: Array, moment: Array) -> Action:
    """The action of a force and a moment about the `to` point in a joint, ON `to`."""
    return Action("joint", load.joint.name, *_joint_ends(load.joint, load.point), force, moment)
