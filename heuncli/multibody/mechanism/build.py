"""Build the mechanism from the spec: names become numbers, tuples arrays, shapes mass properties; nothing is solved
here.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from heuncli.base.joint_kinds import TYPES, JointKind
from heuncli.base.records import replace
from heuncli.multibody.mechanism.couplings import Coupling, unit_vector
from heuncli.multibody.mechanism.loads import (
    GROUND,
    BushingLoad,
    JointLoad,
    Load,
    PairLoad,
    PointLoad,
    TriangularDistribution,
)
from heuncli.multibody.mechanism.model import Blow, Body, Directed, Elastic, Joint, Mechanism, NamedPoint, Stop
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression, is_point_name
from heuncli.scene.file_format import loads
from heuncli.scene.file_format import models as m
from heuncli.scene.shapes.inertia import split_pseudo_inertia

if TYPE_CHECKING:
    from heuncli.scene.shapes.composite_solid import CompositeSolid


def make_forms(spec: m.Spec, stages: Stages = NO_CACHE) -> dict[str, CompositeSolid]:
    """Make the composite solids of bodies with shapes, each in a stage of its own."""
    shapes = {name: b.shapes for name, b in spec.bodies.items() if b.shapes is not None}
    if not shapes:
        return {}
    from heuncli.scene.shapes.composite_solid import make_composite_solid  # 8 ms that only they are worth

    return {name: stages.run(make_composite_solid, body_shapes, key=name) for name, body_shapes in shapes.items()}


def build(spec: m.Spec, forms: dict[str, CompositeSolid], stages: Stages = NO_CACHE) -> Mechanism:
    """Build the mechanism of a validated spec; forms: of the bodies that are built from shapes.

    stages: each body and each joint is a stage of its own
    """
    index = {name: i for i, name in enumerate(spec.bodies)} | {"ground": GROUND}
    joints = {name: (k, TYPES[j.kind]) for k, (name, j) in enumerate(spec.joints.items())}
    drives = {drive.joint: drive for drive in spec.drives.values()}
    planar = spec.space == "planar"
    bodies = tuple(stages.run(build_body, b, forms.get(name), key=name) for name, b in spec.bodies.items())
    last = max(spec.analysis.times, default=0.0)
    built_joints = tuple(
        attach_drive(stages.run(build_joint, j, index[j.a], index[j.b], planar, key=name), drives.get(name), last)
        for name, j in spec.joints.items()
    )
    built_joints = number_paths(built_joints)
    loads = tuple(part for name, f in spec.forces.items() for part in build_load_parts(name, f, index, joints))
    conditions = tuple(c for c in spec.analysis.conditions if isinstance(c, m.Condition))
    conditions += tuple(b.when for b in spec.impulses.values() if b.when is not None)
    conditions += tuple(c for s in spec.latches.values() if s.latch is not None for c in s.latch.conditions)
    values = [*(e for load in loads for e in load.values), *(c.value for c in conditions)]
    points = find_named_points(spec, values, index)
    stops = tuple(build_stop(s, joints[s.joint][0]) for s in (*spec.stops.values(), *spec.latches.values()))
    if planar:
        determined = {stop.joint for stop in stops} | find_used_joints(loads, values, joints)
        watched_bodies = {point.body for point in points.values()}
        determined |= {joints[joint][0] for joint in find_coupled_joints(spec)}
        watched_bodies |= {index[end.body] for wheel in spec.rolling.values() for end in (wheel.wheel, wheel.on)}
        determined |= {k for k, j in enumerate(built_joints) if not watched_bodies.isdisjoint((j.a, j.b))}
        built_joints = tuple(to_spun_pin(j, bodies) if k not in determined else j for k, j in enumerate(built_joints))
    couplings: tuple[Coupling, ...] = ()
    if spec.couplings:
        from heuncli.multibody.mechanism.build_couplings import (  # few scenes have them
            build_coupling_loads,
            build_couplings,
        )

        number = {name: k for name, (k, _) in joints.items()}
        couplings = build_couplings(spec, built_joints, bodies, number)
        loads += build_coupling_loads(spec, built_joints, bodies, number)
    return Mechanism(
        title=spec.title,
        planar=planar,
        gravity=np.array(spec.gravity),
        bodies=bodies,
        joints=built_joints,
        loads=loads,
        impulses=tuple(build_impulse(b, index) for b in spec.impulses.values()),
        stops=stops,
        conditions=conditions,
        points=points,
        couplings=couplings,
        impacts=spec.analysis.impacts,
    )


def to_array(value: m.Vec | loads.Matrix | None) -> Array | None:
    """Return an array, or None where the value is not given."""
    return None if value is None else np.array(value, dtype=float)


def make_directed(value: m.FramedVector[m.Vec] | None) -> Directed | None:
    """Return a vector with its frame, or None."""
    return None if value is None else Directed(np.array(value.vector), value.in_body)


def build_body(b: m.Body[m.Vec, loads.Matrix], shape: CompositeSolid | None) -> Body:
    """Build a body, with its mass properties as given or from its shapes."""
    if shape is not None:
        mass, center, inertia = split_pseudo_inertia(shape.whole_inertia())
    else:
        mass, center, inertia = b.mass, np.array(b.center), np.array(b.inertia)
    return Body(
        name=b.name, mass=mass, center=center, inertia=inertia,
        points={name: np.array(p) for name, p in b.points.items()},
        position=to_array(b.position), rotation=to_array(b.rotation), velocity=make_directed(b.velocity),
        angular_velocity=make_directed(b.angular_velocity), near_position=to_array(b.near_position),
        near_rotation=to_array(b.near_rotation),
    )  # fmt: skip


def integrate_rate_drive(drive: m.Drive, last: float) -> m.Drive:
    """Return a drive by the value of its coordinate; a drive by rate is integrated, for a run up to `last` [s]."""
    if not drive.by_rate:
        return drive
    from heuncli.scene.expressions.integrals import integrate_rate  # few scenes have them

    return replace(drive, value=integrate_rate(drive.value, last), by_rate=False, from_start=True)


def attach_drive(joint: Joint, drive: m.Drive | None, last: float) -> Joint:
    """Attach a drive to its joint; last: the end of the run [s]."""
    return joint if drive is None else replace(joint, drive=integrate_rate_drive(drive, last))


def build_joint(j: m.Joint[str, m.Vec], a: int, b: int, planar: bool) -> Joint:
    """Build a joint between two bodies, without its drive; in a planar scene as its planar kind."""
    axis = unit_vector(j.axis if j.path is None else m.X)  # along a path the direction is the path's own
    return Joint(
        name=j.name, kind=(TYPES[j.kind].planar if planar else None) or j.kind,
        a=a, p=np.array(j.p), b=b, q=np.array(j.q),
        axis=axis, to_axis=unit_vector(j.to_axis) if j.to_axis_given else axis, to_axis_given=j.to_axis_given,
        angle=j.angle, rate=j.rate, travel=j.travel, speed=j.speed, length=j.length, tension_only=j.tension_only,
        stiffness=(np.array(j.stiffness[0]), np.array(j.stiffness[1])) if j.stiffness is not None else None,
        drive=None, restitution=j.restitution, bearing=j.bearing,
        p_name=j.p_name, q_name=j.q_name, path=j.path, one_sided=j.one_sided,
        bearings=j.bearings,
    )  # fmt: skip


def number_paths(joints: tuple[Joint, ...]) -> tuple[Joint, ...]:
    """Number the joints that run along paths."""
    count = itertools.count()
    return tuple(joint if joint.path is None else replace(joint, path_index=next(count)) for joint in joints)


def find_coupled_joints(spec: m.Spec) -> set[str]:
    """Return the joints whose coordinates are coupled."""
    ropes = [coupling for coupling in spec.couplings.values() if coupling.type == "rope"]
    gripped = frozenset[str]().union(*(rope.gripped_bodies for rope in ropes))
    found = {name for name, joint in spec.joints.items() if not gripped.isdisjoint((joint.a, joint.b))}
    return found | {joint for coupling in spec.couplings.values() for joint in coupling.joints}


def find_used_joints(
    loads: tuple[Load, ...], values: Sequence[Expression], joints: dict[str, tuple[int, JointKind]]
) -> set[int]:
    """Return the joints in which loads act, or whose coordinates appear in values."""
    acting = {load.joint for load in loads if isinstance(load, JointLoad)}
    return acting | {joints[name][0] for e in values for name, _ in e.uses if name in joints}


def find_named_points(spec: m.Spec, values: Sequence[Expression], index: dict[str, int]) -> dict[str, NamedPoint]:
    """Return the points that appear in values, by their names there."""
    found = {}
    for name in dict.fromkeys(name for e in values for name, _ in e.uses if is_point_name(name)):
        _, body, point = name.split(".")
        owner = spec.ground.points if body == "ground" else spec.bodies[body].points
        found[name] = NamedPoint(index[body], np.array(owner[point]), np.eye(3), np.zeros(3))
    return found


def to_spun_pin(joint: Joint, bodies: tuple[Body, ...]) -> Joint:
    """Turn a pin at the centre of a point mass into a "spun pin" if nothing determines or uses its angle.

    A body without mass must be held in rotation anyway: its pins keep their angle.
    """
    given = (joint.angle, joint.rate, joint.drive)
    if joint.kind != "pin" or joint.to_axis_given or any(value is not None for value in given):
        return joint
    for end, point in ((joint.a, joint.p), (joint.b, joint.q)):
        if end == GROUND or bodies[end].mass <= 0.0:
            continue
        if bodies[end].inertia[2, 2] <= 0.0 and np.array_equal(point, bodies[end].center):
            return replace(joint, kind="spun pin")
    return joint


def build_load_parts(
    name: str, f: m.Force, index: dict[str, int], joints: dict[str, tuple[int, JointKind]]
) -> tuple[Load, ...]:
    """Build an applied load; a distributed one as two parts, each growing towards one of its ends."""
    if not isinstance(f, loads.Distributed):
        return (build_load(name, f, index, joints),)
    start, end = np.array(f.from_), np.array(f.to)
    spreads = (f.vector, TriangularDistribution(start, end)), (f.to_vector, TriangularDistribution(end, start))
    return tuple(
        PointLoad(name, "force", index[f.body], spread.center, vector, f.frame == "body", spread)
        for vector, spread in spreads
    )


def build_load(name: str, f: m.Force, index: dict[str, int], joints: dict[str, tuple[int, JointKind]]) -> Load:
    """Build an applied load that is not distributed."""
    match f:
        case loads.PointForce():
            return PointLoad(name, "force", index[f.on.body], np.array(f.on.point), f.vector, f.frame == "body")
        case loads.Couple():
            point = np.array(f.on.point) if f.on is not None else None
            return PointLoad(name, "couple", index[f.body], point, f.vector, f.frame == "body")
        case loads.Actuator() | loads.Spring():
            a, b = f.from_, f.to
            ends = index[a.body], np.array(a.point), index[b.body], np.array(b.point)
            if isinstance(f, loads.Actuator):
                return PairLoad(name, f.type, *ends, f.value)
            if f.force is not None:
                return PairLoad(name, "actuator", *ends, f.force)
            return PairLoad(name, "spring", *ends, None, f.stiffness, f.length, f.damping)
        case loads.Bushing():
            return build_bushing(name, f, index)
        case loads.Torque():
            return JointLoad(name, f.type, joints[f.joint][0], f.value)
        case loads.TurnSpring():
            k = joints[f.joint][0]
            if f.torque is not None:
                return JointLoad(name, "torque", k, f.torque)
            return JointLoad(name, "turn_spring", k, None, f.damping, stiffness=f.stiffness, angle=f.angle)
        case loads.Damper():
            # the coefficient is that of the one motion; a joint of both gives that of the sliding apart
            k, kind = joints[f.joint]
            if f.law is not None:
                return JointLoad(name, "torque", k, f.law)
            sliding = f.coefficient if kind.motions == ("sliding",) else f.sliding or 0.0
            return JointLoad(name, "damper", k, None, f.coefficient, sliding, 1.0)
        case loads.Friction():
            return build_friction(name, f, joints[f.joint][0])
        case loads.Distributed():
            raise TypeError("a distributed load is two loads")


def build_bushing(name: str, f: loads.Bushing, index: dict[str, int]) -> BushingLoad:
    """Build a bushing: six springs and dampers."""

    def elastic_arrays(elastic: loads.Elastic[m.Vec, loads.Matrix]) -> Elastic:
        return Elastic(
            np.array(elastic.stiffness), np.array(elastic.damping), np.array(elastic.preload), elastic.extra_load
        )

    a, b = f.from_, f.to
    return BushingLoad(
        name, index[a.body], np.array(a.point), index[b.body], np.array(b.point), np.array(f.rotation),
        np.array(f.to_rotation), elastic_arrays(f.shift), elastic_arrays(f.turn), np.array(f.coupling),
        np.array(f.coupling_damping),
    )  # fmt: skip


def build_friction(name: str, f: loads.Friction, joint: int) -> JointLoad:
    """Build friction of a given size, or in proportion to the joint's own load."""
    speed = 1.0 if f.speed is None else f.speed
    if f.coefficient is None:
        value = f.torque if f.torque is not None else f.force
        assert value is not None
        of_turning, of_sliding = float(f.torque is not None), float(f.force is not None)
        static = 1.0 if f.static is None or not value.constant else f.static / value.constant
        static = static if f.speed is None else 0.0
        return JointLoad(name, "friction", joint, value, of_turning, of_sliding, speed, static=static)
    static = f.coefficient if f.static is None else f.static
    static = static if f.speed is None else 0.0
    if f.radius is not None:
        turning, static = f.coefficient * f.radius, static * f.radius
        return JointLoad(name, "friction", joint, None, turning, 0.0, speed, presses="whole", static=static)
    presses: Literal["across", "ends"] = "across" if f.length is None else "ends"
    numbers = {"reach": f.length or 0.0, "static": static}
    return JointLoad(name, "friction", joint, None, 0.0, f.coefficient, speed, presses=presses, **numbers)


def build_impulse(b: m.AppliedImpulse[str, m.Vec], index: dict[str, int]) -> Blow:
    """Build an impulse or impulsive couple."""
    return Blow(
        b.name, index[b.body], to_array(b.point), np.array(b.vector), b.in_body, b.time, b.kind, b.when, b.every
    )  # fmt: skip


def build_stop(s: m.Stop[str], joint: int) -> Stop:
    """Build a stop or a latch of a joint's coordinate."""
    return Stop(s.name, joint, s.quantity, s.low, s.high, s.restitution, s.latch)
