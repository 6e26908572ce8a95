"""Spec -> Mechanism: the user's words become plain SI arrays; nothing is solved here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from heuncli.joint_kinds import TYPES, Kind
from heuncli.mechanism.model import (
    GROUND,
    Blow,
    Body,
    Condition,
    Directed,
    Drive,
    Joint,
    JointLoad,
    Load,
    Mechanism,
    PairLoad,
    PointLoad,
    Spread,
    Stop,
)
from heuncli.records import replace
from heuncli.results import Array
from heuncli.shapes.inertia import properties
from heuncli.spec import models as m

if TYPE_CHECKING:
    from heuncli.shapes.forms import Form

INFINITE = np.full(3, np.inf)


def forms_of(spec: m.Spec) -> dict[str, Form]:
    """The forms of the bodies that are built from shapes."""
    shapes = {name: b.shapes for name, b in spec.bodies.items() if b.shapes is not None}
    if not shapes:
        return {}
    from heuncli.shapes.forms import form  # 8 ms that only they are worth

    return {name: form(of) for name, of in shapes.items()}


def build(spec: m.Spec, forms: dict[str, Form]) -> Mechanism:
    """The mechanism of a validated spec (spec.models.Spec)."""
    index = {name: i for i, name in enumerate(spec.bodies)} | {"ground": GROUND}
    joints = {name: (k, TYPES[j.type]) for k, (name, j) in enumerate(spec.joints.items())}
    drives = {d.joint: (name, d) for name, d in spec.drives.items()}
    planar = spec.space == "planar"
    bodies = tuple(body(name, b, forms.get(name)) for name, b in spec.bodies.items())
    last = max(spec.analysis.times, default=0.0)
    made = tuple(joint(name, j, index, drives.get(name), planar, last) for name, j in spec.joints.items())
    loads = tuple(part for name, f in spec.forces.items() for part in parts_of(name, f, index, joints))
    conditions = tuple(Condition(c.name, c.value, c.ends) for c in spec.analysis.conditions if c.value is not None)
    if planar:
        told = {joints[stop.joint][0] for stop in spec.stops.values()} | coordinates_used(loads, joints)
        told |= {joints[name][0] for condition in conditions for name, _ in condition.value.uses}
        made = tuple(spun(j, bodies) if k not in told else j for k, j in enumerate(made))
    return Mechanism(
        title=spec.title,
        planar=planar,
        gravity=np.array(spec.gravity),
        bodies=bodies,
        joints=made,
        loads=loads,
        blows=tuple(blow(name, i, index) for name, i in spec.impulses.items()),
        stops=tuple(
            Stop(name, joints[s.joint][0], s.quantity, s.low, s.high, s.restitution) for name, s in spec.stops.items()
        ),
        conditions=conditions,
    )


def vectors(points: Mapping[str, m.Vec]) -> dict[str, Array]:
    """Named points as arrays."""
    return {name: np.array(p) for name, p in points.items()}


def optional(value: m.Vec | m.Matrix | None) -> Array | None:
    """An array, or None for what was left out."""
    return None if value is None else np.array(value, dtype=float)


def directed(value: m.Directed | None) -> Directed | None:
    """A vector with its frame, or None."""
    return None if value is None else Directed(np.array(value.vector), value.frame == "body")


def unit(vector: m.Vec) -> Array:
    """The direction of a vector that the spec layer found not to be zero."""
    v = np.array(vector, dtype=float)
    v = v / np.abs(v).max()
    along: Array = v / np.sqrt(v @ v)
    return along


def body(name: str, b: m.Body, shape: Form | None) -> Body:
    """One body, its mass properties given or those of its shapes."""
    if shape is not None:
        mass, center, inertia = properties(shape.whole())
    else:
        assert b.mass is not None  # as center and inertia, of what is not built from shapes
        mass, center, inertia = b.mass, np.array(b.center), np.array(b.inertia)
    return Body(
        name=name, mass=mass, center=center, inertia=inertia, points=vectors(b.points),
        position=optional(b.position), rotation=optional(b.rotation), velocity=directed(b.velocity),
        angular_velocity=directed(b.angular_velocity),
        near_position=optional(b.near.position) if b.near is not None else None,
        near_rotation=optional(b.near.rotation) if b.near is not None else None,
    )  # fmt: skip


def drive_of(name: str, d: m.Drive, last: float) -> Drive:
    """A drive; of one by its rate the integral, for a run up to `last`, is the value."""
    value = d.value
    if d.by_rate:
        from heuncli.expressions.integrals import integral  # few scenes have them

        value = integral(value, last)
    return Drive(name, d.quantity, value, d.zero == "assembled", d.by_rate)


def joint(
    name: str, j: m.Joint, index: dict[str, int], driven: tuple[str, m.Drive] | None, planar: bool, last: float
) -> Joint:
    """One joint with its drive, as what it is in the plane where that was declared; last: the end of the run [s]."""
    given = j.axis if j.axis is not None else j.normal
    axis = unit(given) if given is not None else np.array([0.0, 0.0, 1.0])
    initial = j.initial
    drive = None
    if driven is not None:
        drive = drive_of(driven[0], driven[1], last)
    stiffness = None
    if j.stiffness is not None:
        parts = (j.stiffness.force, j.stiffness.moment)
        stiffness = tuple(INFINITE if part is None else np.array(part) for part in parts)
    return Joint(
        name=name, kind=(TYPES[j.type].planar if planar else None) or j.type,
        a=index[j.from_.body], p=np.array(j.from_.point), b=index[j.to.body], q=np.array(j.to.point),
        axis=axis, to_axis=unit(j.to_axis) if j.to_axis is not None else axis, to_axis_given=j.to_axis is not None,
        angle=initial.angle if initial else None, rate=initial.rate if initial else None,
        travel=initial.travel if initial else None, speed=initial.speed if initial else None,
        length=j.length, tension_only=j.tension_only, stiffness=stiffness, drive=drive,  # type: ignore[arg-type]
        restitution=j.restitution,
    )  # fmt: skip


def coordinates_used(loads: tuple[Load, ...], joints: dict[str, tuple[int, Kind]]) -> set[int]:
    """The joints in which loads act, or whose coordinates they name."""
    acting = {load.joint for load in loads if isinstance(load, JointLoad)}
    return acting | {joints[name][0] for load in loads for e in load.values for name, _ in e.uses}


def spun(joint: Joint, bodies: tuple[Body, ...]) -> Joint:
    """A pin of the plane; at the centre of a body without inertia one whose angle nothing determines or asks for."""
    given = (joint.angle, joint.rate, joint.drive)
    if joint.kind != "pin" or joint.to_axis_given or any(value is not None for value in given):
        return joint
    for end, point in ((joint.a, joint.p), (joint.b, joint.q)):
        if end != GROUND and bodies[end].inertia[2, 2] <= 0.0 and np.array_equal(point, bodies[end].center):
            return replace(joint, kind="spun pin")
    return joint


def parts_of(name: str, f: m.Force, index: dict[str, int], joints: dict[str, tuple[int, Kind]]) -> tuple[Load, ...]:
    """An applied load: of a distributed one the parts that grow towards its one end and its other."""
    if not isinstance(f, m.Distributed):
        return (load(name, f, index, joints),)
    start, end = np.array(f.from_), np.array(f.to)
    spreads = (f.vector, Spread(start, end)), (f.to_vector, Spread(end, start))
    return tuple(
        PointLoad(name, "force", index[f.body], spread.center, vector, f.frame == "body", spread)
        for vector, spread in spreads
    )


def load(name: str, f: m.Force, index: dict[str, int], joints: dict[str, tuple[int, Kind]]) -> Load:
    """One applied load that is not distributed."""
    match f:
        case m.PointForce():
            return PointLoad(name, "force", index[f.on.body], np.array(f.on.point), f.vector, f.frame == "body")
        case m.Couple():
            point = np.array(f.on.point) if f.on is not None else None
            return PointLoad(name, "couple", index[f.body], point, f.vector, f.frame == "body")
        case m.Actuator() | m.Spring():
            a, b = f.from_, f.to
            spring = (None, f.stiffness, f.length, f.damping) if isinstance(f, m.Spring) else (f.value, 0.0, 0.0, 0.0)
            return PairLoad(name, index[a.body], np.array(a.point), index[b.body], np.array(b.point), *spring)
        case m.Torque():
            return JointLoad(name, "torque", joints[f.joint][0], f.value)
        case m.TurnSpring():
            k = joints[f.joint][0]
            return JointLoad(name, "turn_spring", k, None, f.damping, stiffness=f.stiffness, angle=f.angle)
        case m.Damper():
            # the coefficient is that of the one motion; a joint of both gives that of the sliding apart
            k, kind = joints[f.joint]
            sliding = f.coefficient if kind.motions == ("sliding",) else f.sliding or 0.0
            return JointLoad(name, "damper", k, None, f.coefficient, sliding, 1.0)
        case m.Friction():
            return JointLoad(name, "friction", joints[f.joint][0], None, f.torque or 0.0, f.force or 0.0, f.speed)
        case m.Distributed():
            raise TypeError("a distributed load is two loads")


def blow(name: str, i: m.Impulse, index: dict[str, int]) -> Blow:
    """One impulse or impulsive couple."""
    point = np.array(i.on.point) if i.on is not None else None
    return Blow(name, index[i.body], point, np.array(i.vector), i.frame == "body", i.time, i.type)
