"""The scene in which drives hold nothing: a driven coordinate is one of Lagrange's coordinates like any other.

It keeps the tree, the reference attitudes and the inertias of the scene that it is made of, so that a state of the one
is a state of the other: what is driven there is a number of the state here.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.run.runner import Runner, ready
from heuncli.multibody.mechanism.model import GROUND, Joint, JointLoad, Load, Mechanism, PairLoad, PointLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, arranged
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression

NONE: Mapping[str, float] = MappingProxyType({})


@record
class FreedScene:
    """A scene without drives; of: the one that it is made of, whose drives act."""

    scene: PreparedScene
    runner: Runner
    of: PreparedScene

    @property
    def layout(self) -> Layout:
        """How it is laid out."""
        return self.scene.layout

    @property
    def driven(self) -> dict[str, str]:
        """The driven coordinates, and the joint of each."""
        joints = (joint for joint in self.of.mechanism.joints if joint.drive is not None)
        return {f"{joint.name}.{joint.drive.quantity}": joint.name for joint in joints if joint.drive is not None}

    def holding(self, holding: Array) -> Array:
        """Which contacts are closed here, (contacts,), of those there; rods whose driven length is let go are open."""
        given = {key: float(value) for key, value in zip(contacts_of(self.of.layout), holding, strict=True)}
        return np.array([given.get(key, 0.0) for key in contacts_of(self.layout)])

    def states(self, there: Recovered) -> Array:
        """The states here, (n_t, n), at instants at which the other scene was answered."""
        own, given = self.layout, self.of.layout
        states = np.zeros((len(there.times), own.n_state))
        free = own.tables["freedoms"]
        states[:, free["q_at"]] = there.freedoms["q"]
        states[:, free["u_at"]] = there.freedoms["u"]
        for here, other in zip(own.bodies, given.bodies, strict=True):
            if here["ball"]:
                for name, count in (("attitude_at", 4), ("rate_at", 3)):
                    a, b = int(here[name]), int(other[name])
                    states[:, a : a + count] = there.states[:, b : b + count]
        for joint, at in own.counters.items():
            states[:, at] = there.states[:, given.counters[joint]]
        return states


def freed(of: PreparedScene, efforts: Mapping[str, float] = NONE) -> FreedScene:
    """A scene with its drives let go; efforts: what is put on in their place, by the driven coordinates' names."""
    mechanism = replace(of.mechanism, joints=tuple(map(let_go, of.mechanism.joints)))
    loads = (load for name, value in efforts.items() if value for load in effort(mechanism, name, value))
    mechanism = replace(mechanism, loads=(*mechanism.loads, *loads))
    scene = arranged(mechanism, of.start, spanning=of.layout.spanning, size=of.layout.size, starts=of.layout.starts)
    scene, runner = ready(scene)
    return FreedScene(scene, runner, of)


def let_go(joint: Joint) -> Joint:
    """A joint without its drive: a rod whose length was driven is a rope that hangs slack."""
    if joint.drive is None:
        return joint
    if JOINTS[joint.kind].keeps_distance:
        return replace(joint, drive=None, tension_only=True, restitution=0.0)
    return replace(joint, drive=None)


def effort(mechanism: Mechanism, coordinate: str, value: float) -> tuple[Load, ...]:
    """The constant torque [N m] or thrust [N] of a drive along its coordinate, on `to`, and opposite on `from`."""
    joint_name, _, quantity = coordinate.rpartition(".")
    k = next(i for i, joint in enumerate(mechanism.joints) if joint.name == joint_name)
    joint, name = mechanism.joints[k], f"drive of {coordinate}"
    if quantity == "length":
        return (PairLoad(name, joint.a, joint.p, joint.b, joint.q, Expression.of(value), 0.0, 0.0, 0.0),)
    if JOINTS[joint.kind].coordinates == (quantity,):
        return (JointLoad(name, "torque", k, Expression.of(value)),)
    # a cylinder slides along the axis that both bodies have
    ends = ((joint.b, joint.q, joint.to_axis, value), (joint.a, joint.p, joint.axis, -value))
    return tuple(
        PointLoad(name, "force", body, point, (x, y, z), True)
        for body, point, axis, along in ends
        if body != GROUND
        for x, y, z in [[Expression.of(float(component)) for component in along * axis]]
    )


def contacts_of(layout: Layout) -> list[tuple[str, bool, int | None]]:
    """What tells the contacts apart, then the places at which latches hold."""
    contacts = [(contact.name, contact.is_rope, contact.sense) for contact in layout.contacts]
    return [*contacts, *((layout.contacts[i].name, False, None) for i in layout.latches)]
