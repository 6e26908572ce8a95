"""Belts and chains as strands, and elastic ropes: what pulls along a line.

Belts and chains have two strands along the lines tangent to both pulleys, in the axes of their carrier:

    nu . x = (r_1 - r_2) / D, crossed (r_1 + r_2) / D       nu: from the centre to a strand, x: to the other
    T_1 = T_0 + lambda / 2,  T_2 = T_0 - lambda / 2    the first strand is the tight one when the first pulley drives

The belt is inextensible and does not slip. Its own mass, and so its centrifugal force at speed, is left out.

The pull of an elastic rope is a function of its length and its rate:

    T = k x + c e',   x = S - l0,  k = k0 L / l0,  c = c0 L / l0,  e' = S' - S l0' / l0

S: the length along which the rope runs; l0: its unloaded length, which is L at the start where a law gives it in time.

So EA = k0 L is constant while a rope is drawn in or paid out, and equal strain means equal tension. A rope that only
pulls is slack while x < 0, and does not push where the damping force exceeds the spring force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import Coordinate, CoupledRow
from heuncli.multibody.mechanism.gearing import GearMember, find_gears, joint_line, mesh_parts
from heuncli.multibody.mechanism.loads import PairLoad, RopeLoad
from heuncli.multibody.mechanism.model import Body, Joint
from heuncli.results.results import Array
from heuncli.scene.expressions.composition import (
    add_expressions,
    apply_step,
    combine_expressions,
    limit_below,
    make_variable,
    multiply_expressions,
)
from heuncli.scene.expressions.programs import LOADS, OPS, Expression
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format.couplings import Rope
from heuncli.scene.shapes.rotations import cross_vectors

# Strands


@record
class BeltStrand:
    """One strand: its tangent points on the first and the second pulley, and the direction from the one to the
    other.
    """

    begin: Array
    end: Array
    direction: Array


def belt_row(entry: c.Belt, joints: Sequence[Joint], bodies: Sequence[Body], joint_pair: tuple[int, int]) -> CoupledRow:
    """Make the condition of a belt. Raises Finding."""
    carrier, first, second = find_gears(joints, bodies, joint_pair)
    tight, slack = find_strands(entry, first, second)
    P = second.point - (second.point - first.point) @ first.axis * first.axis  # in the plane of the first pulley
    f = 0.5 * (slack.direction - tight.direction)
    m = 0.5 * (cross_vectors(slack.end - P, slack.direction) - cross_vectors(tight.end - P, tight.direction))

    def work(member: GearMember) -> float:
        return float(f @ member.unit_velocity(P) + m @ member.axis)

    coordinates = [Coordinate(x.joint, x.quantity, -work(first) * x.ratio) for x in first.coordinates]
    coordinates += [Coordinate(x.joint, x.quantity, work(second) * x.ratio) for x in second.coordinates]
    return CoupledRow(mesh_parts(first.body, second.body, carrier, P, f, m, coordinates, on_a=first.point))


def pretension_load(
    name: str, entry: c.Belt, joints: Sequence[Joint], bodies: Sequence[Body], joint_pair: tuple[int, int]
) -> PairLoad:
    """Make the pull of both strands at rest: along the line of centres, for their torques on a pulley cancel."""
    _, first, second = find_gears(joints, bodies, joint_pair)
    tight, slack = find_strands(entry, first, second)
    d = first.arm(second.point)
    pull = entry.pretension * float((tight.direction + slack.direction) @ d) / math.sqrt(float(d @ d))
    p, _ = joint_line(joints[joint_pair[0]], bodies, first.body)
    q, along = joint_line(joints[joint_pair[1]], bodies, second.body)
    offset = float((first.point - second.point) @ second.axis)
    ends = first.body, p, second.body, q + offset * along
    return PairLoad(name, "actuator", *ends, Expression.from_number(-pull))


def find_strands(entry: c.Belt, first: GearMember, second: GearMember) -> tuple[BeltStrand, BeltStrand]:
    """Return the strand that is tight when the first pulley drives, and the other one. Raises Finding."""
    n = first.axis
    skew = cross_vectors(n, second.axis)
    if not (first.turns and second.turns) or float(skew @ skew) > tolerances.TYPED_AXES**2:
        raise Finding(
            "belt-axes", "the two pulleys do not have parallel axes of rotation", "a belt needs two pins or cylinders"
        )
    r1, r2 = entry.radii
    d = first.arm(second.point)
    D = math.sqrt(float(d @ d))
    reach = (r1 + r2 if entry.crossed else abs(r1 - r2)) / D if D > 0.0 else math.inf
    if reach >= 1.0:
        raise Finding("belt-axes", f"the axes are {D:.6g} m apart, too close for radii of {r1:.6g} m and {r2:.6g} m",
                      "move the axes apart, or make the pulleys smaller")  # fmt: skip
    x = d / D
    y = cross_vectors(n, x)
    along = (r1 + r2 if entry.crossed else r1 - r2) / D
    across = math.sqrt(1.0 - along * along)
    both = []
    for side in (1.0, -1.0):  # n x nu of the first side points away from the second pulley: it draws that strand in
        nu = along * x + side * across * y
        begin, end = first.point + r1 * nu, first.point + d + (-r2 if entry.crossed else r2) * nu
        both.append(BeltStrand(begin, end, (end - begin) / math.sqrt(float((end - begin) @ (end - begin)))))
    return (both[0], both[1]) if first.sign > 0.0 else (both[1], both[0])


# Stretching


def rope_load(name: str, entry: Rope, row: CoupledRow, length: float) -> RopeLoad:
    """Make the load of an elastic rope or one of given tension, along the parts of what would be its condition.

    length: unloaded [m]
    """
    if entry.tension is not None:  # a value is a multiplier, above 0 where the rope would push
        value = multiply_expressions(Expression.from_number(-1.0), entry.tension).with_source(f"tension of rope {name}")
        return RopeLoad(name, row.parts, value, 0.0, length, None, 0.0, False)
    assert entry.stiffness is not None
    prefix = f"{LOADS}.{name}"
    free = Expression.from_number(length) if entry.law is None else entry.law
    x = combine_expressions(make_variable((prefix, "length")), free, OPS["sub"], f"stretch of rope {name}")
    pull = multiply_expressions(divide_by_length(entry.stiffness, length, entry.law), x)
    if entry.damping:
        rate = make_variable((prefix, "speed"))
        if entry.law is not None:
            strained = combine_expressions(make_variable((prefix, "length")), entry.law, OPS["div"], "1 + strain")
            rate = combine_expressions(
                rate,
                multiply_expressions(strained, make_variable((prefix, "drawn"))),
                OPS["sub"],
                "rate of the stretch",
            )
        pull = add_expressions(pull, multiply_expressions(divide_by_length(entry.damping, length, entry.law), rate))
    if entry.tension_only:
        pull = limit_below(pull, 0.0)
        if entry.damping:
            pull = multiply_expressions(apply_step(x), pull)
    value = multiply_expressions(Expression.from_number(-1.0), pull).with_source(f"tension of rope {name}")
    return RopeLoad(name, row.parts, value, entry.stiffness, length, entry.law, entry.damping, entry.tension_only)


def divide_by_length(at_length: float, length: float, law: Expression | None) -> Expression:
    """Make an expression that varies as 1 / l0 along a law, from its value at one length."""
    if law is None:
        return Expression.from_number(at_length)
    return combine_expressions(Expression.from_number(at_length * length), law, OPS["div"], "per unloaded length")
