"""Gears: where two wheels, or a wheel and a rack, roll on each other, and along which line their teeth press.

    v_1 = v_2 at the pitch point P,   omega_1 n_1 x rho_1 = omega_2 n_2 x rho_2,   rho_k = P - C_k
    f = t - tan(beta) w              per unit of tangential force, ON the second gear
    h = tan(alpha_n) / cos(beta)     what the flanks push apart with, beside it, whichever of them carries
All in the axes of the carrier, in which both turn or slide. t: the way of the first gear's teeth as its coordinate
grows; w: along the common line of the pitch cylinders or cones; beta: helix, right-handed on the first gear that turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import Coordinate, CoupledRow, CouplingPart
from heuncli.multibody.mechanism.model import GROUND, Body, Joint
from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as c
from heuncli.scene.shapes.rotations import cross

MISFIT = "gear-axes"


@record
class GearMember:
    """A wheel (turns) or rack (slides) in its carrier, whose axes all of this is in.

    point: on its axis; axis: about or along which it moves by the sum of the coordinates, each times its sign; along:
    its travel along its axis, where it has one.
    """

    body: int
    turns: bool
    point: Array
    axis: Array
    coordinates: tuple[Coordinate, ...]
    along: Coordinate | None

    @property
    def sign(self) -> float:
        """Of its own joint's coordinate."""
        return self.coordinates[0].ratio

    def way(self, P: Array) -> Array:
        """How its point at P moves for a motion of 1: a velocity a rate [m], or its direction."""
        return cross(self.axis, P - self.point) if self.turns else self.axis

    def arm(self, P: Array) -> Array:
        """From its axis to P."""
        D = P - self.point
        return D - (D @ self.axis) * self.axis


@record
class GearMesh:
    """Two members that mesh: carrier; pitch point P; w along the common line of their pitch surfaces."""

    carrier: int
    first: GearMember
    second: GearMember
    P: Array
    w: Array


def gear_row(
    given: c.Gear,
    joints: Sequence[Joint],
    bodies: Sequence[Body],
    of: tuple[int, int],
    at: tuple[int, Array] | None,
) -> CoupledRow:
    """The condition of a pair of gears; of: their joints; at: a body and its point. Raises Finding."""
    carrier, first, second = members(joints, bodies, of)
    if at is not None and at[0] != carrier:
        raise Finding(MISFIT, "the pitch point is not one of the body that carries both gears",
                      f"name a point of {_name(bodies, carrier)}")  # fmt: skip
    mesh = mesh_of(given, carrier, first, second, None if at is None else at[1])
    f, h = line_of_action(given, mesh)
    counted = [Coordinate(x.joint, x.quantity, -float(f @ first.way(mesh.P)) * x.ratio) for x in first.coordinates]
    counted += [Coordinate(x.joint, x.quantity, float(f @ second.way(mesh.P)) * x.ratio) for x in second.coordinates]
    if given.helix:
        for member, sign in ((first, -1.0), (second, 1.0)):
            if member.along is not None:
                push = sign * float(f @ member.axis) * member.along.ratio
                counted.append(Coordinate(member.along.joint, "travel", push))
    return CoupledRow(mesh_parts(first.body, second.body, carrier, mesh.P, f, np.zeros(3), counted, h))


def mesh_parts(
    a: int,
    b: int,
    carrier: int,
    P: Array,
    f: Array,
    m: Array,
    counted: Sequence[Coordinate],
    apart: Array | None = None,
    on_a: Array | None = None,
) -> tuple[CouplingPart, ...]:
    """A load fixed in the carrier, and its coordinates, two to a part."""
    parts = [
        CouplingPart("mesh", a, b, P, e=f, g=m, c=carrier, coordinates=tuple(counted[:2]),
                     apart=np.zeros(3) if apart is None else apart, on_a=on_a)
    ]  # fmt: skip
    for i in range(2, len(counted), 2):  # no load of their own
        parts.append(CouplingPart("mesh", carrier, carrier, P, c=carrier, coordinates=tuple(counted[i : i + 2])))
    return tuple(parts)


# Who turns in what


def members(joints: Sequence[Joint], bodies: Sequence[Body], of: tuple[int, int]) -> tuple[int, GearMember, GearMember]:
    """The carrier and the two gears of two joints. Raises Finding."""
    first, second = (joints[k] for k in of)
    shared = {first.a, first.b} & {second.a, second.b}
    if len(shared) == 2:
        raise Finding("gear-carrier", f"joints {first.name} and {second.name} are between the same two bodies",
                      "gears turn in two joints on one carrier")  # fmt: skip
    if shared:
        carrier = shared.pop()
        return carrier, member(joints, bodies, of[0], carrier), member(joints, bodies, of[1], carrier)
    for arm, joint in enumerate(joints):
        for k, other in (of, of[::-1]):
            ends = _ends(joint, joints[k], joints[other])
            if ends is None or joint.kind != "pin":
                continue
            base, carrier = ends
            own = coaxial(joints, bodies, k, arm, base, carrier)
            if own is not None:
                mate = member(joints, bodies, other, carrier)
                return (carrier, own, mate) if k == of[0] else (carrier, mate, own)
    raise Finding(
        "gear-carrier", f"joints {first.name} and {second.name} share no body that carries both gears",
        "gears turn in joints on one carrier; one may stand beside it in a pin on the axis of the carrier's own",
    )  # fmt: skip


def _ends(arm: Joint, beside: Joint, on: Joint) -> tuple[int, int] | None:
    """The body that an arm shares with the joint beside it, and the one with the joint that it carries."""
    base = {arm.a, arm.b} & {beside.a, beside.b}
    carrier = ({arm.a, arm.b} & {on.a, on.b}) - base
    return (base.pop(), carrier.pop()) if len(base) == 1 and len(carrier) == 1 else None


def member(joints: Sequence[Joint], bodies: Sequence[Body], k: int, carrier: int) -> GearMember:
    """What a joint on the carrier lets turn, or slide. Raises Finding."""
    joint = joints[k]
    if joint.kind not in ("pin", "slide", "cylinder"):
        raise Finding(
            "gear-joints", f"joint {joint.name} is a {joint.kind}", "gears turn in pins or cylinders, racks slide"
        )
    body, sign = (joint.b, 1.0) if joint.a == carrier else (joint.a, -1.0)
    point, axis = line_on(joint, bodies, carrier)
    turns = joint.kind != "slide"
    along = Coordinate(k, "travel", sign) if joint.kind == "cylinder" else None
    return GearMember(body, turns, point, axis, (Coordinate(k, "angle" if turns else "travel", sign),), along)


def line_on(joint: Joint, bodies: Sequence[Body], body: int) -> tuple[Array, Array]:
    """A joint's point and axis on one of its two bodies, in its axes."""
    if joint.a == body:
        return joint.p, joint.axis
    Ra, Rb = (np.eye(3) if i == GROUND else bodies[i].rotation for i in (joint.a, joint.b))
    if joint.kind == "slide" and Ra is not None and Rb is not None:  # keeps the attitudes that are given
        return joint.q, Rb.T @ Ra @ joint.axis
    return joint.q, joint.to_axis


def coaxial(
    joints: Sequence[Joint], bodies: Sequence[Body], k: int, arm: int, base: int, carrier: int
) -> GearMember | None:
    """A gear that turns on the base, about the axis about which the carrier does; None where the two differ."""
    own = member(joints, bodies, k, base)
    point, axis = line_on(joints[arm], bodies, base)
    D, same = point - own.point, float(own.axis @ axis)
    off = D - (D @ own.axis) * own.axis
    size = max(float(np.max(np.abs(point))), float(np.max(np.abs(own.point))), 1e-30)
    if (
        _length(cross(own.axis, axis)) > tolerances.TYPED_AXES
        or float(np.max(np.abs(off))) > tolerances.TYPED_POINT * size
        or not own.turns
    ):
        return None
    at, along = line_on(joints[arm], bodies, carrier)
    same = math.copysign(1.0, same)
    turned = -same * (1.0 if joints[arm].a == base else -1.0)  # of the carrier on the base, about the gear's axis
    D = own.point - point
    return GearMember(
        own.body, True, at + (D @ axis) * along, same * along, (*own.coordinates, Coordinate(arm, "angle", turned)),
        own.along,
    )  # fmt: skip


# Where they roll on each other


def mesh_of(given: c.Gear, carrier: int, first: GearMember, second: GearMember, at: Array | None) -> GearMesh:
    """The pitch point of two members. Raises Finding where axes, ratio and point contradict each other."""
    if not (first.turns or second.turns):
        raise Finding(MISFIT, "both joints slide: there is nothing that rolls", "for two travels take type: ratio")
    if at is None and given.ratio is None and given.teeth is None:
        raise Finding(MISFIT, "neither ratio nor teeth nor the pitch point is given", "give one of ratio, teeth, at")
    make = _rack
    if first.turns and second.turns:
        make = _parallel if _length(cross(first.axis, second.axis)) <= tolerances.TYPED_AXES else _bevel
    mesh = make(given, carrier, first, second, at)
    for wheel in (first, second):
        if wheel.turns and _length(inward(wheel, mesh)) <= tolerances.TYPED_POINT * _length(wheel.point - mesh.P):
            raise Finding(MISFIT, "the pitch point lies on the axis of a gear, or the pitch cone of one is flat: which "
                          "way its teeth push it is not known", "correct axes, ratio or pitch point")  # fmt: skip
    return mesh


def _ratio(given: c.Gear, first: GearMember, second: GearMember, external: float) -> float:
    """The first motion by the second, each about its own axis; external: the sign of teeth that are outside."""
    if given.teeth is not None:
        one, other = given.teeth
        return external * other / one * (-1.0 if given.internal else 1.0)
    assert given.ratio is not None
    found = given.ratio * first.sign * second.sign
    if given.internal and found * external > 0.0:
        raise Finding(MISFIT, f"a ratio of {given.ratio:g} is that of external gears here, and internal is given",
                      "change the sign of the ratio, or leave out internal")  # fmt: skip
    return found


def _parallel(given: c.Gear, carrier: int, first: GearMember, second: GearMember, at: Array | None) -> GearMesh:
    same = math.copysign(1.0, float(first.axis @ second.axis))
    d = second.arm(first.point) * -1.0
    distance = _length(d)
    size = max(float(np.max(np.abs(first.point))), float(np.max(np.abs(second.point))))
    if distance <= tolerances.TYPED_POINT * size:
        raise Finding(MISFIT, "both gears turn about the same axis", "gears on one axis are tied by type: ratio")
    if given.ratio is None and given.teeth is None:
        assert at is not None
        return _from_point(carrier, first, second, at, first.axis)
    i = _ratio(given, first, second, -same) * same
    if abs(i - 1.0) < tolerances.TYPED_AXES:
        raise Finding(MISFIT, "of a ratio of 1 in the same sense there is no pitch point", "take type: belt or ratio")
    P = first.point + d / (1.0 - i)
    if at is not None:
        off = first.arm(at) - d / (1.0 - i)
        _require_at(P, off, distance)
        P = P + ((at - P) @ first.axis) * first.axis
    return GearMesh(carrier, first, second, P, first.axis)


def _bevel(given: c.Gear, carrier: int, first: GearMember, second: GearMember, at: Array | None) -> GearMesh:
    apex = _meeting(first, second)
    if given.ratio is None and given.teeth is None:
        assert at is not None
        return _from_point(carrier, first, second, at, _unit(at - apex))
    sides = [float((m.point - apex) @ m.axis) for m in (first, second)]
    if given.teeth is not None and not all(sides):
        raise Finding(MISFIT, "a joint's point is where the two axes meet: on which side its gear is, is not known",
                      "move the joint's point to its gear, or give ratio and at")  # fmt: skip
    external = -math.copysign(1.0, sides[0] * sides[1])
    i = _ratio(given, first, second, external)
    g = _unit(i * first.axis - second.axis)
    along = float(g @ first.axis)
    if at is None and (sides[0] == 0.0 or abs(along) < tolerances.TYPED_AXES):
        raise Finding(MISFIT, "where on the pitch cone the teeth meet is not known", "give the pitch point: at")
    if at is None:
        P = apex + sides[0] / along * g
    else:
        D = at - apex
        _require_at(apex + (D @ g) * g, D - (D @ g) * g, _length(D))
        P = apex + (D @ g) * g
    return GearMesh(carrier, first, second, P, g)


def _rack(given: c.Gear, carrier: int, first: GearMember, second: GearMember, at: Array | None) -> GearMesh:
    wheel, rack = (first, second) if first.turns else (second, first)
    if abs(float(wheel.axis @ rack.axis)) > tolerances.TYPED_AXES:
        raise Finding(MISFIT, "the rack does not slide at right angles to the axis of its wheel", "correct the axes")
    if given.teeth is not None:
        raise Finding(MISFIT, "teeth tell no ratio of a rack", "give the ratio, in rad/m, or the pitch point: at")
    if given.ratio is None:
        assert at is not None
        return _from_point(carrier, first, second, at, wheel.axis)
    by = given.ratio * first.sign * second.sign  # of the wheel's rate by the rack's speed, or the other way round
    P = wheel.point + cross(rack.axis, wheel.axis) * (1.0 / by if wheel is first else by)
    if at is not None:
        _require_at(P, wheel.arm(at) - (P - wheel.point), _length(P - wheel.point))
        P = P + ((at - P) @ wheel.axis) * wheel.axis
    return GearMesh(carrier, first, second, P, wheel.axis)


def _from_point(carrier: int, first: GearMember, second: GearMember, P: Array, w: Array) -> GearMesh:
    """The mesh at a point that is given: there both have to move the same way."""
    one, other = first.way(P), second.way(P)
    sizes = _length(one) * _length(other)
    across = cross(one, other)
    if sizes == 0.0 or _length(across) > tolerances.TYPED_POINT * sizes:
        raise Finding(MISFIT, "at the pitch point the two gears do not move in the same direction",
                      "it lies in the plane of both axes, on the line through both centres")  # fmt: skip
    return GearMesh(carrier, first, second, P, w)


def _require_at(P: Array, off: Array, size: float) -> None:
    if _length(off) > tolerances.TYPED_POINT * size:
        where = ", ".join(f"{x:.6g}" for x in P)
        raise Finding(MISFIT, f"the pitch point given is {_length(off):.3g} m from where axes and ratio "
                      f"put it, at ({where})", "leave out at, or the ratio; or move an axis")  # fmt: skip


def _meeting(first: GearMember, second: GearMember) -> Array:
    """Where two axes meet. Raises Finding where they pass."""
    n = cross(first.axis, second.axis)
    D = second.point - first.point
    gap, size = abs(float(n @ D)) / _length(n), _length(D)
    if gap > tolerances.TYPED_POINT * size:
        raise Finding(MISFIT, f"the axes are neither parallel nor do they meet: they pass at {gap:.3g} m",
                      "tie gears with crossed axes, as worms, by type: ratio, without their tooth force")  # fmt: skip
    return np.asarray(first.point + float(cross(D, second.axis) @ n) / float(n @ n) * first.axis)


# What they press with


def line_of_action(given: c.Gear, mesh: GearMesh) -> tuple[Array, Array]:
    """Per unit of tangential force ON the second gear: the load that works, and what pushes it away from the first."""
    first, second, P = mesh.first, mesh.second, mesh.P
    wheel = first if first.turns else second
    t = _unit(wheel.way(P))
    w = mesh.w * math.copysign(1.0, float(mesh.w @ wheel.axis))
    f = t - math.tan(given.helix) * w
    forward = float(t @ first.way(P)) * first.sign
    f = math.copysign(1.0, forward) * f
    return f, math.tan(given.pressure_angle) / math.cos(given.helix) * away(mesh)


def away(mesh: GearMesh) -> Array:
    """The direction, a unit vector, in which flanks push the second gear: out of the first one's teeth."""
    if not mesh.second.turns:
        return -_unit(inward(mesh.first, mesh))
    if not mesh.first.turns:
        return _unit(inward(mesh.second, mesh))
    one, other = inward(mesh.first, mesh), inward(mesh.second, mesh)
    radii = [_length(wheel.arm(mesh.P)) for wheel in (mesh.first, mesh.second)]
    ring = one @ other > 0.0 and radii[0] < radii[1]  # the second one is: its teeth are inside
    return -_unit(one) if ring else _unit(other)


def inward(wheel: GearMember, mesh: GearMesh) -> Array:
    """From the pitch point to the axis of a wheel, across the line along which the teeth touch."""
    arm = -wheel.arm(mesh.P)
    return np.asarray(arm - (arm @ mesh.w) * mesh.w)


def _length(a: Array) -> float:
    return math.sqrt(float(a @ a))


def _unit(a: Array) -> Array:
    return np.asarray(a / _length(a))


def _name(bodies: Sequence[Body], body: int) -> str:
    return "ground" if body == GROUND else bodies[body].name
