"""Belts and chains: two strands along the lines that touch both pulleys, in the axes of what carries these.

    nu . x = (r_1 - r_2) / D, crossed (r_1 + r_2) / D       nu: from the centre to a strand, x: to the other
    T_1 = T_0 + lambda / 2,  T_2 = T_0 - lambda / 2         the first strand comes tight when the first pulley drives on
As long as the belt is and without slip. Its own mass, and with it what flies off at speed, is left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import Coordinate, CoupledRow
from heuncli.multibody.mechanism.gearing import GearMember, line_on, members, mesh_parts
from heuncli.multibody.mechanism.model import Body, Joint, PairLoad
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import couplings as c
from heuncli.scene.shapes.rotations import cross


@record
class BeltStrand:
    """One strand: where it touches the first and the second pulley, and the direction from the one to the other."""

    begin: Array
    end: Array
    direction: Array


def belt_row(given: c.Belt, joints: Sequence[Joint], bodies: Sequence[Body], of: tuple[int, int]) -> CoupledRow:
    """The condition of a belt. Raises Finding."""
    carrier, first, second = members(joints, bodies, of)
    tight, slack = strands(given, first, second)
    P = second.point - (second.point - first.point) @ first.axis * first.axis  # in the plane of the first pulley
    f = 0.5 * (slack.direction - tight.direction)
    m = 0.5 * (cross(slack.end - P, slack.direction) - cross(tight.end - P, tight.direction))

    def work(member: GearMember) -> float:
        return float(f @ member.way(P) + m @ member.axis)

    counted = [Coordinate(x.joint, x.quantity, -work(first) * x.ratio) for x in first.coordinates]
    counted += [Coordinate(x.joint, x.quantity, work(second) * x.ratio) for x in second.coordinates]
    return CoupledRow(mesh_parts(first.body, second.body, carrier, P, f, m, counted, on_a=first.point))


def pretension_of(
    name: str, given: c.Belt, joints: Sequence[Joint], bodies: Sequence[Body], of: tuple[int, int]
) -> PairLoad:
    """The pull of both strands at rest: along the line of centres, for what turns a pulley cancels."""
    _, first, second = members(joints, bodies, of)
    tight, slack = strands(given, first, second)
    d = first.arm(second.point)
    pull = given.pretension * float((tight.direction + slack.direction) @ d) / math.sqrt(float(d @ d))
    p, _ = line_on(joints[of[0]], bodies, first.body)
    q, along = line_on(joints[of[1]], bodies, second.body)
    off = float((first.point - second.point) @ second.axis)
    return PairLoad(name, first.body, p, second.body, q + off * along, Expression.of(-pull), 0.0, 0.0, 0.0)


def strands(given: c.Belt, first: GearMember, second: GearMember) -> tuple[BeltStrand, BeltStrand]:
    """The strand that comes tight when the first pulley drives on, and the other one. Raises Finding."""
    n = first.axis
    skew = cross(n, second.axis)
    if not (first.turns and second.turns) or float(skew @ skew) > tolerances.TYPED_AXES**2:
        raise Finding(
            "belt-axes", "the two pulleys do not turn about parallel axes", "a belt runs over two pins or cylinders"
        )
    r1, r2 = given.radii
    d = first.arm(second.point)
    D = math.sqrt(float(d @ d))
    reach = (r1 + r2 if given.crossed else abs(r1 - r2)) / D if D > 0.0 else math.inf
    if reach >= 1.0:
        raise Finding("belt-axes", f"the axes stand {D:.6g} m apart, too near for radii of {r1:.6g} m and {r2:.6g} m",
                      "move the axes apart, or make the pulleys smaller")  # fmt: skip
    x = d / D
    y = cross(n, x)
    along = (r1 + r2 if given.crossed else r1 - r2) / D
    across = math.sqrt(1.0 - along * along)
    found = []
    for side in (1.0, -1.0):  # n x nu of the first side points away from the second pulley: it draws that strand in
        nu = along * x + side * across * y
        begin, end = first.point + r1 * nu, first.point + d + (-r2 if given.crossed else r2) * nu
        found.append(BeltStrand(begin, end, (end - begin) / math.sqrt(float((end - begin) @ (end - begin)))))
    return (found[0], found[1]) if first.sign > 0.0 else (found[1], found[0])
