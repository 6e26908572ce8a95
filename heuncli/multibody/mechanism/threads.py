"""Screws: a thread between a body that turns and one that slides along the same axis.

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
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.multibody.mechanism.couplings import Coordinate, CoupledRow
from heuncli.multibody.mechanism.gearing import GearMember, find_gears, joint_line, mesh_parts
from heuncli.multibody.mechanism.model import Body, Joint, ThreadLoad
from heuncli.scene.file_format import couplings as c
from heuncli.scene.shapes.rotations import cross_vectors


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
    return ThreadLoad(name, coupling, a, b, q, axis, torque, rise / friction.radius**2, friction.speed)
