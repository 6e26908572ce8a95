"""Screws: a thread between what turns and what slides along the same axis.

    travel = lead / (2 pi) angle                       in the coordinates of the joints, less where they started
    f = e,  m = lead / (2 pi) n                        per unit of thrust ON what slides, along its travel
The thread's two flanks both carry, so that thrust and torque may have either sign. What rubs on them, at the mean
radius r, is mu times what presses square to the flank, against the sliding along it. Of the slope lambda, of
tan(lambda) = |lead| / (2 pi r), and of N, what the condition presses with along the axis (its multiplier), it is
    mu r |N|              about the axis               mu tan(lambda) |N|              along it
since both share the cosine of lambda. With tan(rho) = mu that is the square thread's law, exactly:
    M / F = r (tan(lambda) +- mu) / (1 -+ mu tan(lambda)) = r tan(lambda +- rho)
Shigley, Mechanical Engineering Design, power screws, (8-1), (8-2). A flank that is inclined by beta presses with
1 / cos(beta) more (scene/file_format/resolve_couplings.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.multibody.mechanism.couplings import Coordinate, CoupledRow
from heuncli.multibody.mechanism.gearing import GearMember, line_on, members, mesh_parts
from heuncli.multibody.mechanism.model import Body, Joint, ThreadLoad
from heuncli.scene.file_format import couplings as c
from heuncli.scene.shapes.rotations import cross


def screw_row(given: c.Screw, joints: Sequence[Joint], bodies: Sequence[Body], of: tuple[int, int]) -> CoupledRow:
    """The condition of a thread; of: the joint that turns and the one that slides, or a cylinder twice.

    Raises Finding.
    """
    by = given.lead / math.tau
    if of[0] == of[1]:
        joint = joints[of[0]]
        if joint.kind != "cylinder":
            raise Finding("screw-joints", f"joint {joint.name} is a {joint.kind}",
                          "a thread is in a cylinder, or between a pin and a slide: of: [spindle, nut]")  # fmt: skip
        counted = [Coordinate(of[0], "travel", 1.0), Coordinate(of[0], "angle", -by)]
        return CoupledRow(mesh_parts(joint.a, joint.b, joint.a, joint.p, joint.axis, -by * joint.axis, counted))
    carrier, spindle, nut = spindle_and_nut(joints, bodies, of)
    skew = cross(spindle.axis, nut.axis)
    if float(skew @ skew) > tolerances.TYPED_AXES**2:
        raise Finding("screw-joints", "the nut does not slide along the axis of the spindle", "correct the axes")
    counted = [Coordinate(x.joint, x.quantity, x.ratio * nut.sign) for x in nut.coordinates]
    counted += [Coordinate(x.joint, x.quantity, -by * x.ratio * spindle.sign) for x in spindle.coordinates]
    f, m = nut.sign * nut.axis, by * spindle.sign * spindle.axis
    if spindle.along is not None:  # a spindle that slides takes its thread with it
        counted.append(Coordinate(spindle.along.joint, "travel", -float(f @ spindle.axis) * spindle.along.ratio))
    return CoupledRow(mesh_parts(spindle.body, nut.body, carrier, spindle.point, f, m, counted))


def spindle_and_nut(
    joints: Sequence[Joint], bodies: Sequence[Body], of: tuple[int, int]
) -> tuple[int, GearMember, GearMember]:
    """The carrier of both, what turns in it, and what slides. Raises Finding."""
    carrier, first, second = members(joints, bodies, of)
    if first.turns == second.turns:
        raise Finding("screw-joints", "of the two joints one has to turn and the other to slide",
                      "name a pin and a slide; two that turn are a gear, two that slide a ratio")  # fmt: skip
    return (carrier, first, second) if first.turns else (carrier, second, first)


def friction_of(
    name: str,
    coupling: int,
    given: c.Screw,
    rubs: c.ThreadFriction,
    joints: Sequence[Joint],
    bodies: Sequence[Body],
    of: tuple[int, int],
) -> ThreadLoad:
    """What rubs in a thread, ON the spindle, or in a cylinder ON its `to`; of: as of its condition, which there is.

    The thread holds the sliding of b as seen from a at `rise` times its turning about the axis: the force along the
    axis is rise / r^2 times the torque, which is against the turning.
    """
    by, torque = given.lead / math.tau, rubs.coefficient * rubs.radius
    if of[0] == of[1]:
        joint = joints[of[0]]
        a, b, q, axis, rise = joint.a, joint.b, joint.q, joint.axis, by
    else:
        _, spindle, nut = spindle_and_nut(joints, bodies, of)
        a, b = nut.body, spindle.body
        turning, sliding = (joints[member.coordinates[0].joint] for member in (spindle, nut))
        q, axis = line_on(turning, bodies, b)[0], line_on(sliding, bodies, a)[1]
        rise = -by * spindle.sign * nut.sign * float(spindle.axis @ nut.axis)
    return ThreadLoad(name, coupling, a, b, q, axis, torque, rise / rubs.radius**2, rubs.speed)
