"""Build the couplings of the spec as conditions between bodies; only this module depends on their kinds.

A screw is a thread between a body that turns and one that slides along the same axis:

    travel = lead / (2 pi) angle                       in the coordinates of the joints, relative to the start
    f = e,  m = lead / (2 pi) n                        per unit of thrust ON the sliding body, along its travel

Both flanks of the thread carry, so that thrust and torque may have either sign. The friction on them, at the mean
radius r, is mu times the normal force on the flank, against the sliding along it. With the slope lambda, tan(lambda) =
|lead| / (2 pi r), and the axial force N of the condition (its multiplier), it is

    mu r |N|              about the axis               mu tan(lambda) |N|              along it

since both share the cosine of lambda. With tan(rho) = mu that is the square thread's law, exactly:

    M / F = r (tan(lambda) +- mu) / (1 -+ mu tan(lambda)) = r tan(lambda +- rho)

Shigley, Mechanical Engineering Design, power screws, (8-1), (8-2). On a flank that is inclined by beta the normal force
is larger by 1 / cos(beta) (scene/file_format/resolve_couplings.py).

A wheel has three conditions: it touches its plane, and does not slip along its track or sideways. The first constrains
a pose, the others a speed. Multipliers are the forces ON the wheel: along the plane's normal, along its track, along
the projection of its axle on the plane. That a plane only pushes is monitored (scene/file_format/resolve_couplings.py):
the loads of more wheels than necessary are indeterminate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Literal, TypedDict

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, Problem, SpecError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import (
    CamShape,
    Coordinate,
    CoupledRow,
    Coupling,
    CouplingKind,
    CouplingPart,
    Place,
    unit_vector,
)
from heuncli.multibody.mechanism.gearing import GearMember, find_gears, gear_row, joint_line, mesh_parts
from heuncli.multibody.mechanism.loads import GROUND, Load, ThreadLoad
from heuncli.multibody.mechanism.model import Body, Joint
from heuncli.multibody.mechanism.strands import belt_row, pretension_load
from heuncli.results.results import Array
from heuncli.scene.expressions.motion_segments import MotionRows, make_piece_number
from heuncli.scene.expressions.paths import Path, make_lift_path, make_path
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format.models import End, Spec
from heuncli.scene.shapes.rotations import cross_vectors, perpendicular_pair

# Threads


def screw_row(
    entry: c.Screw, joints: Sequence[Joint], bodies: Sequence[Body], joint_pair: tuple[int, int]
) -> CoupledRow:
    """Make the condition of a thread; joint_pair: the joint that turns and the one that slides, or a cylinder twice.

    Raises Finding.
    """
    lead_per_radian = entry.lead / math.tau
    if joint_pair[0] == joint_pair[1]:
        joint = joints[joint_pair[0]]
        if joint.kind != "cylinder":
            raise Finding("screw-joints", f"joint {joint.name} is a {joint.kind}",
                          "a screw needs a cylinder, or a pin and a slide: of: [spindle, nut]")  # fmt: skip
        coordinates = [Coordinate(joint_pair[0], "travel", 1.0), Coordinate(joint_pair[0], "angle", -lead_per_radian)]
        return CoupledRow(
            mesh_parts(joint.a, joint.b, joint.a, joint.p, joint.axis, -lead_per_radian * joint.axis, coordinates)
        )
    carrier, spindle, nut = find_spindle_and_nut(joints, bodies, joint_pair)
    skew = cross_vectors(spindle.axis, nut.axis)
    if float(skew @ skew) > tolerances.TYPED_AXES**2:
        raise Finding("screw-joints", "the nut does not slide along the axis of the spindle", "correct the axes")
    coordinates = [Coordinate(x.joint, x.quantity, x.ratio * nut.sign) for x in nut.coordinates]
    coordinates += [
        Coordinate(x.joint, x.quantity, -lead_per_radian * x.ratio * spindle.sign) for x in spindle.coordinates
    ]
    f, m = nut.sign * nut.axis, lead_per_radian * spindle.sign * spindle.axis
    if spindle.travel is not None:  # a spindle that slides takes its thread with it
        coordinates.append(Coordinate(spindle.travel.joint, "travel", -float(f @ spindle.axis) * spindle.travel.ratio))
    return CoupledRow(mesh_parts(spindle.body, nut.body, carrier, spindle.point, f, m, coordinates))


def find_spindle_and_nut(
    joints: Sequence[Joint], bodies: Sequence[Body], joint_pair: tuple[int, int]
) -> tuple[int, GearMember, GearMember]:
    """Return the carrier of both, the body that turns in it, and the body that slides. Raises Finding."""
    carrier, first, second = find_gears(joints, bodies, joint_pair)
    if first.turns == second.turns:
        raise Finding("screw-joints", "one of the two joints must rotate and the other must slide",
                      "name a pin and a slide; for two pins use a gear, for two slides a ratio")  # fmt: skip
    return (carrier, first, second) if first.turns else (carrier, second, first)


def thread_friction(
    name: str,
    coupling: int,
    entry: c.Screw,
    friction: c.ThreadFriction,
    joints: Sequence[Joint],
    bodies: Sequence[Body],
    joint_pair: tuple[int, int],
) -> ThreadLoad:
    """Make the friction in a thread, ON the spindle, or in a cylinder ON its `to`; joint_pair as in `screw_row`,
    checked there.

    The thread holds the sliding of b relative to a at `rise` times its rotation about the axis: the axial force is rise
    / r^2 times the torque, which acts against the rotation.
    """
    lead_per_radian, torque = entry.lead / math.tau, friction.coefficient * friction.radius
    if joint_pair[0] == joint_pair[1]:
        joint = joints[joint_pair[0]]
        a, b, q, axis, rise = joint.a, joint.b, joint.q, joint.axis, lead_per_radian
    else:
        _, spindle, nut = find_spindle_and_nut(joints, bodies, joint_pair)
        a, b = nut.body, spindle.body
        turning, sliding = (joints[member.coordinates[0].joint] for member in (spindle, nut))
        q, axis = joint_line(turning, bodies, b)[0], joint_line(sliding, bodies, a)[1]
        rise = -lead_per_radian * spindle.sign * nut.sign * float(spindle.axis @ nut.axis)
    factor = rise / friction.radius**2
    if friction.speed is None:
        static = friction.static * friction.radius
        return ThreadLoad(name, coupling, a, b, q, axis, torque, factor, speed=1.0, static=static)
    return ThreadLoad(name, coupling, a, b, q, axis, torque, factor, friction.speed)


def thread_friction_row(
    entry: c.Screw, joints: Sequence[Joint], bodies: Sequence[Body], joint_pair: tuple[int, int]
) -> CoupledRow:
    """Make the condition that holds a thread whose friction sticks: its multiplier is the friction's torque.

    Its load is that of `thread_friction`: unit torque, and `factor` times that along the axis. So its rate is that of
    the rotation plus `factor` times that of the sliding.
    """
    assert entry.friction is not None
    factor = entry.lead / math.tau / entry.friction.radius**2
    if joint_pair[0] == joint_pair[1]:
        joint = joints[joint_pair[0]]
        coordinates = [Coordinate(joint_pair[0], "travel", factor), Coordinate(joint_pair[0], "angle", 1.0)]
        parts = mesh_parts(joint.a, joint.b, joint.a, joint.p, factor * joint.axis, joint.axis, coordinates)
        return CoupledRow(parts, length=0.0, weight=0.0)
    carrier, spindle, nut = find_spindle_and_nut(joints, bodies, joint_pair)
    sense = float(spindle.axis @ nut.axis)
    factor *= -spindle.sign * nut.sign * sense
    coordinates = [Coordinate(x.joint, x.quantity, -factor * x.ratio) for x in nut.coordinates]
    coordinates += [Coordinate(x.joint, x.quantity, sense * x.ratio) for x in spindle.coordinates]
    if spindle.travel is not None:
        coordinates.append(Coordinate(spindle.travel.joint, "travel", factor * sense * spindle.travel.ratio))
    parts = mesh_parts(spindle.body, nut.body, carrier, spindle.point, -factor * nut.axis, -nut.axis, coordinates)
    return CoupledRow(parts, length=0.0, weight=0.0)


# Wheels

# the speeds of a disc's contact, and what holds them
SPEEDS: Mapping[str, Literal["rolls", "rolls_aside"]] = MappingProxyType({"along": "rolls", "aside": "rolls_aside"})


class WheelEnds(TypedDict):
    """The fields that all parts of a wheel share."""

    a: int
    b: int
    p: Place
    q: Place
    e: Place


def disc_rows(ends: WheelEnds, axle: Array, radius: float, no_slip: Mapping[str, bool]) -> tuple[CoupledRow, ...]:
    """Make the rows of a thin disc; no_slip: the directions in which it does not slip."""
    kinds: list[CouplingKind] = ["touches", *(kind for direction, kind in SPEEDS.items() if no_slip[direction])]
    return tuple(make_row(CouplingPart(kind, g=axle, radius=radius, **ends)) for kind in kinds)


def ball_rows(ends: WheelEnds, radius: float) -> tuple[CoupledRow, ...]:
    """Make the rows of a sphere, whose lowest point touches the plane and is at rest on it."""
    touches = CouplingPart("ball_touches", g=ends["e"], radius=radius, **ends)
    rolls = (CouplingPart("ball_rolls", g=g, radius=radius, **ends) for g in perpendicular_pair(np.asarray(ends["e"])))
    return tuple(make_row(part) for part in (touches, *rolls))


def make_row(part: CouplingPart) -> CoupledRow:
    """Make the row of a single part; one that constrains a speed sets a condition on the rates at the start, none on
    the pose.
    """
    return CoupledRow((part,), None if part.constrains_speed else 0.0)


# Build couplings

SCENE_SIZE = 0.0  # weight of gaps that are angles: the scene's size


def build_couplings(
    spec: Spec, joints: Sequence[Joint], bodies: Sequence[Body], number: Mapping[str, int]
) -> tuple[Coupling, ...]:
    """Build all couplings, in the order of the spec; number: of joints by name. Raises SpecError with all misfits."""
    drawing = CoupledDrawing(spec, joints, bodies, number)
    couplings, problems = [], []
    for name, entry in spec.couplings.items():
        try:
            coupling = Coupling(name, BUILDERS[entry.type](entry, drawing), entry)
            if isinstance(entry, c.Screw) and entry.friction is not None and entry.friction.speed is None:
                one, other = drawing.joint_numbers(entry.terms)
                coupling = replace(coupling, friction_row=thread_friction_row(entry, joints, bodies, (one, other)))
            couplings.append(coupling)
        except Finding as misfit:
            path = f"{'rolling' if entry.type == 'wheel' else 'couplings'}.{name}"
            problems.append(Problem(misfit.code, misfit.message, spec.location(path), misfit.hint))
    if problems:
        raise SpecError(*problems)
    return tuple(couplings)


def build_coupling_loads(
    spec: Spec, joints: Sequence[Joint], bodies: Sequence[Body], number: Mapping[str, int]
) -> tuple[Load, ...]:
    """Build the loads that couplings have besides their conditions, under their names.

    Belts pull their pulleys together; threads have friction.
    """
    drawing = CoupledDrawing(spec, joints, bodies, number)
    loads: list[Load] = []
    for k, (name, entry) in enumerate(spec.couplings.items()):
        joint_pair = tuple(drawing.joint_numbers(entry.terms)) if isinstance(entry, c.Belt | c.Screw) else ()
        if isinstance(entry, c.Belt) and entry.pretension > 0.0:
            loads.append(pretension_load(name, entry, joints, bodies, (joint_pair[0], joint_pair[1])))
        elif isinstance(entry, c.Screw) and entry.friction is not None:
            loads.append(
                thread_friction(name, k, entry, entry.friction, joints, bodies, (joint_pair[0], joint_pair[1]))
            )
    return tuple(loads)


@record
class CoupledDrawing:
    """The joints and bodies that couplings refer to; number: of the joints by name."""

    spec: Spec
    joints: Sequence[Joint]
    bodies: Sequence[Body]
    number: Mapping[str, int]

    def joint_numbers(self, terms: Sequence[c.Term]) -> list[int]:
        """Return the joints of terms."""
        return [self.number[x.joint] for x in terms]

    def locate(self, end: End) -> tuple[int, Array]:
        """Return a body's index (GROUND for the ground) and the point in its axes."""
        names = [body.name for body in self.bodies]
        return (names.index(end.body) if end.body in names else GROUND), np.array(end.point)


def build_ratio(entry: c.Ratio, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a ratio: the sum of coordinates, each times its factor; a couple about each axis, a force along each
    guide.
    """
    parts = tuple(coordinate_part(drawing, x, x.factor) for x in entry.terms)
    turning = all(x.quantity == "angle" for x in entry.terms)
    return (CoupledRow(parts, entry.is_, SCENE_SIZE if turning else 1.0),)


def build_differential(entry: c.Differential, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a differential: first - ratio second - (1 - ratio) carrier stays constant."""
    factors = (1.0, -entry.ratio, entry.ratio - 1.0)
    parts = tuple(coordinate_part(drawing, x, factor) for x, factor in zip(entry.terms, factors, strict=True))
    return (CoupledRow(parts, None, SCENE_SIZE),)


def build_gear(entry: c.Gear, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a pair of gears: the tooth force at the pitch point."""
    one, other = drawing.joint_numbers(entry.terms)
    pitch_point = None if entry.at is None else drawing.locate(entry.at)
    return (gear_row(entry, drawing.joints, drawing.bodies, (one, other), pitch_point),)


def build_screw(entry: c.Screw, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a screw: the thrust along the axis, and the torque about it."""
    one, other = drawing.joint_numbers(entry.terms)
    return (screw_row(entry, drawing.joints, drawing.bodies, (one, other)),)


def build_belt(entry: c.Belt, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a belt: the pulls of both strands."""
    one, other = drawing.joint_numbers(entry.terms)
    return (belt_row(entry, drawing.joints, drawing.bodies, (one, other)),)


def coordinate_part(drawing: CoupledDrawing, term: c.Term, factor: float) -> CouplingPart:
    """Make the condition on a joint's coordinate: a couple for an angle, a force for a travel."""
    k = drawing.number[term.joint]
    joint = drawing.joints[k]
    if term.quantity == "travel":
        return CouplingPart("guide", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor)
    coordinates = (Coordinate(k, "angle", 1.0),)
    return CouplingPart(
        "turn", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor, coordinates=coordinates
    )  # fmt: skip


def build_cam(entry: c.Cam, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a cam: a disc and its follower."""
    k, n = drawing.number[entry.shaft], drawing.number[entry.follower]
    return cam_rows(entry, k, drawing.joints[k], n, drawing.joints[n])


def cam_rows(entry: c.Cam, k: int, shaft: Joint, n: int, follower: Joint) -> tuple[CoupledRow, ...]:
    """Make the row of a cam: the follower's coordinate equals the lift. A one-sided cam has the opposite row, which
    only pulls.
    """
    swings = JOINTS[follower.kind].coordinates[0] == "angle"
    lift = make_lift(entry)
    shape = CamShape(
        lift, swings, follower.p, entry.radius, None if entry.normal is None else unit_vector(entry.normal),
        make_piece_number(lift.knots.tolist(), lift.period, shaft.name, f"the lift of {shaft.name}")
        if isinstance(entry.lift, MotionRows) else None,
    )  # fmt: skip
    coordinates = Coordinate(k, "angle", 1.0), Coordinate(n, "angle" if swings else "travel", 1.0)
    part = CouplingPart(
        "cam", shaft.b, follower.b, shaft.p, np.array(entry.at), shaft.axis, follower.axis,
        1.0 if entry.is_two_sided else -1.0, shaft.a, coordinates, cam=shape,
    )  # fmt: skip
    return (CoupledRow((part,), 0.0, SCENE_SIZE if swings else 1.0, not entry.is_two_sided, entry.restitution),)


def make_lift(entry: c.Cam) -> Path:
    """Make the lift over the disc's angle, from a table or from segments, which are a whole revolution."""
    if isinstance(entry.lift, MotionRows):
        return make_lift_path(entry.lift, math.tau).shift_parameter(entry.phase)
    return make_path((entry.lift, 0.0, 0.0)).shift_parameter(entry.phase)


def build_wheel(entry: c.RollingWheel, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a wheel on its plane."""
    (b, q), (a, p) = drawing.locate(entry.wheel), drawing.locate(entry.on)
    ends: WheelEnds = {"a": a, "b": b, "p": p, "q": q, "e": unit_vector(entry.normal)}
    if entry.axis is None:
        return ball_rows(ends, entry.radius)
    no_slip = {"along": not entry.slides, "aside": drawing.spec.space != "planar"}  # in the plane nothing goes aside
    return disc_rows(ends, unit_vector(entry.axis), entry.radius, no_slip)


def build_rope(entry: c.Rope, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Return no rows yet: those of ropes depend on the start (multibody/tree/rope_routes.py)."""
    return ()


BUILDERS: dict[str, Callable[..., tuple[CoupledRow, ...]]] = {
    "ratio": build_ratio,
    "gear": build_gear,
    "screw": build_screw,
    "belt": build_belt,
    "differential": build_differential,
    "cam": build_cam,
    "wheel": build_wheel,
    "rope": build_rope,
}
