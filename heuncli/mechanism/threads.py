"""Screws: a thread between what turns and what slides along the same axis.

    travel = lead / (2 pi) angle                       in the coordinates of the joints, less where they started
    f = e,  m = lead / (2 pi) n                        per unit of thrust ON what slides, along its travel
Without friction; the thread's two flanks both carry, so that thrust and torque may have either sign.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli import tolerances
from heuncli.errors import Finding
from heuncli.mechanism.couplings import Coordinate, CoupledRow
from heuncli.mechanism.gearing import members, mesh_parts
from heuncli.mechanism.model import Body, Joint
from heuncli.shapes.rotations import cross
from heuncli.spec import couplings as c


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
    carrier, first, second = members(joints, bodies, of)
    if first.turns == second.turns:
        raise Finding("screw-joints", "of the two joints one has to turn and the other to slide",
                      "name a pin and a slide; two that turn are a gear, two that slide a ratio")  # fmt: skip
    spindle, nut = (first, second) if first.turns else (second, first)
    skew = cross(spindle.axis, nut.axis)
    if float(skew @ skew) > tolerances.TYPED_AXES**2:
        raise Finding("screw-joints", "the nut does not slide along the axis of the spindle", "correct the axes")
    counted = [Coordinate(x.joint, x.quantity, x.ratio * nut.sign) for x in nut.coordinates]
    counted += [Coordinate(x.joint, x.quantity, -by * x.ratio * spindle.sign) for x in spindle.coordinates]
    f, m = nut.sign * nut.axis, by * spindle.sign * spindle.axis
    return CoupledRow(mesh_parts(spindle.body, nut.body, carrier, spindle.point, f, m, counted))
