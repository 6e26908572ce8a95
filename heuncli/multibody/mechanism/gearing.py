"""Gears: where two wheels, or a wheel and a rack, roll on each other, and the line of action of their teeth.

    v_1 = v_2 at the pitch point P,   omega_1 n_1 x rho_1 = omega_2 n_2 x rho_2,   rho_k = P - C_k
    f = t - tan(beta) w              per unit of tangential force, ON the second gear
    h = tan(alpha_n) / cos(beta)     the separating force of the flanks in addition, whichever of them carries

All in the axes of the carrier, in which both turn or slide. t: direction in which the first gear's teeth move as its
coordinate grows; w: along the common line of the pitch cylinders or cones; beta: helix angle, right-handed on the first
gear that turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import Coordinate, CoupledRow, CouplingPart
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Body, Joint
from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as c
from heuncli.scene.shapes.rotations import cross_vectors

MISFIT = "gear-axes"


@record
class GearMember:
    """A wheel (turns) or rack (slides) in its carrier; vectors in the carrier's axes.

    point: on its axis
    axis: about or along which it moves by the sum of the coordinates, each times its sign
    travel: the travel along its axis, where it has one
    """

    body: int
    turns: bool
    point: Array
    axis: Array
    coordinates: tuple[Coordinate, ...]
    travel: Coordinate | None

    @property
    def sign(self) -> float:
        """Sign of its own joint's coordinate."""
        return self.coordinates[0].ratio

    def unit_velocity(self, P: Array) -> Array:
        """Velocity of its point at P for a rate of 1: per unit of angular velocity [m], or a direction."""
        return cross_vectors(self.axis, P - self.point) if self.turns else self.axis

    def arm(self, P: Array) -> Array:
        """Vector from its axis to P."""
        D = P - self.point
        return D - (D @ self.axis) * self.axis


@record
class GearMesh:
    """Two gears that mesh: carrier; pitch point P; w along the common line of their pitch surfaces."""

    carrier: int
    first: GearMember
    second: GearMember
    P: Array
    w: Array


def gear_row(
    entry: c.Gear,
    joints: Sequence[Joint],
    bodies: Sequence[Body],
    joint_pair: tuple[int, int],
    pitch_point: tuple[int, Array] | None,
) -> CoupledRow:
    """Make the condition of a pair of gears; pitch_point: a body and its point. Raises Finding."""
    carrier, first, second = find_gears(joints, bodies, joint_pair)
    if pitch_point is not None and pitch_point[0] != carrier:
        raise Finding(MISFIT, "the pitch point is not on the body that carries both gears",
                      f"name a point of {_body_name(bodies, carrier)}")  # fmt: skip
    mesh = find_mesh(entry, carrier, first, second, None if pitch_point is None else pitch_point[1])
    f, h = line_of_action(entry, mesh)
    coordinates = [
        Coordinate(x.joint, x.quantity, -float(f @ first.unit_velocity(mesh.P)) * x.ratio) for x in first.coordinates
    ]
    coordinates += [
        Coordinate(x.joint, x.quantity, float(f @ second.unit_velocity(mesh.P)) * x.ratio) for x in second.coordinates
    ]
    if entry.helix:
        for member, sign in ((first, -1.0), (second, 1.0)):
            if member.travel is not None:
                push = sign * float(f @ member.axis) * member.travel.ratio
                coordinates.append(Coordinate(member.travel.joint, "travel", push))
    return CoupledRow(mesh_parts(first.body, second.body, carrier, mesh.P, f, np.zeros(3), coordinates, h))


def mesh_parts(
    a: int,
    b: int,
    carrier: int,
    P: Array,
    f: Array,
    m: Array,
    coordinates: Sequence[Coordinate],
    separating_force: Array | None = None,
    on_a: Array | None = None,
) -> tuple[CouplingPart, ...]:
    """Make the parts of a load fixed in the carrier, with its coordinates, two to a part."""
    parts = [
        CouplingPart("mesh", a, b, P, e=f, g=m, c=carrier, coordinates=tuple(coordinates[:2]),
                     separating_force=np.zeros(3) if separating_force is None else separating_force, on_a=on_a)
    ]  # fmt: skip
    for i in range(2, len(coordinates), 2):  # no load of their own
        parts.append(CouplingPart("mesh", carrier, carrier, P, c=carrier, coordinates=tuple(coordinates[i : i + 2])))
    return tuple(parts)


# Gears and their carrier


def find_gears(
    joints: Sequence[Joint], bodies: Sequence[Body], joint_pair: tuple[int, int]
) -> tuple[int, GearMember, GearMember]:
    """Find the carrier and the two gears of two joints. Raises Finding."""
    first, second = (joints[k] for k in joint_pair)
    shared = {first.a, first.b} & {second.a, second.b}
    if len(shared) == 2:
        raise Finding("gear-carrier", f"joints {first.name} and {second.name} connect the same two bodies",
                      "give two bodies as gears, each with a joint to the same carrier")  # fmt: skip
    if shared:
        carrier = shared.pop()
        return (
            carrier,
            make_gear(joints, bodies, joint_pair[0], carrier),
            make_gear(joints, bodies, joint_pair[1], carrier),
        )
    for arm, joint in enumerate(joints):
        for k, other in (joint_pair, joint_pair[::-1]):
            ends = _arm_bodies(joint, joints[k], joints[other])
            if ends is None or joint.kind != "pin":
                continue
            base, carrier = ends
            gear = find_coaxial_gear(joints, bodies, k, arm, base, carrier)
            if gear is not None:
                mate = make_gear(joints, bodies, other, carrier)
                return (carrier, gear, mate) if k == joint_pair[0] else (carrier, mate, gear)
    raise Finding(
        "gear-carrier", f"joints {first.name} and {second.name} have no common body that carries both gears",
        "gears need joints on one carrier; one gear may instead be in another pin on the axis of the carrier's own pin",
    )  # fmt: skip


def _arm_bodies(arm: Joint, base_joint: Joint, carried_joint: Joint) -> tuple[int, int] | None:
    """Return the body that an arm shares with the joint next to it, and the one it shares with the joint that it
    carries.
    """
    base = {arm.a, arm.b} & {base_joint.a, base_joint.b}
    carrier = ({arm.a, arm.b} & {carried_joint.a, carried_joint.b}) - base
    return (base.pop(), carrier.pop()) if len(base) == 1 and len(carrier) == 1 else None


def make_gear(joints: Sequence[Joint], bodies: Sequence[Body], k: int, carrier: int) -> GearMember:
    """Make the gear that a joint on the carrier lets turn or slide. Raises Finding."""
    joint = joints[k]
    if joint.kind not in ("pin", "slide", "cylinder"):
        raise Finding(
            "gear-joints", f"joint {joint.name} is a {joint.kind}", "gears need pins or cylinders, racks need slides"
        )
    body, sign = (joint.b, 1.0) if joint.a == carrier else (joint.a, -1.0)
    point, axis = joint_line(joint, bodies, carrier)
    turns = joint.kind != "slide"
    travel = Coordinate(k, "travel", sign) if joint.kind == "cylinder" else None
    return GearMember(body, turns, point, axis, (Coordinate(k, "angle" if turns else "travel", sign),), travel)


def joint_line(joint: Joint, bodies: Sequence[Body], body: int) -> tuple[Array, Array]:
    """Return a joint's point and axis on one of its two bodies, in its axes."""
    if joint.a == body:
        return joint.p, joint.axis
    Ra, Rb = (np.eye(3) if i == GROUND else bodies[i].rotation for i in (joint.a, joint.b))
    if joint.kind == "slide" and Ra is not None and Rb is not None:  # keeps the attitudes that are given
        return joint.q, Rb.T @ Ra @ joint.axis
    return joint.q, joint.to_axis


def find_coaxial_gear(
    joints: Sequence[Joint], bodies: Sequence[Body], k: int, arm: int, base: int, carrier: int
) -> GearMember | None:
    """Return a gear that turns on the base about the same axis as the carrier; None where the axes differ."""
    gear = make_gear(joints, bodies, k, base)
    point, axis = joint_line(joints[arm], bodies, base)
    D, same = point - gear.point, float(gear.axis @ axis)
    offset = D - (D @ gear.axis) * gear.axis
    size = max(float(np.max(np.abs(point))), float(np.max(np.abs(gear.point))), 1e-30)
    if (
        _length(cross_vectors(gear.axis, axis)) > tolerances.TYPED_AXES
        or float(np.max(np.abs(offset))) > tolerances.TYPED_POINT * size
        or not gear.turns
    ):
        return None
    carrier_point, carrier_axis = joint_line(joints[arm], bodies, carrier)
    same = math.copysign(1.0, same)
    factor = -same * (1.0 if joints[arm].a == base else -1.0)  # of the carrier on the base, about the gear's axis
    D = gear.point - point
    return GearMember(
        gear.body,
        True,
        carrier_point + (D @ axis) * carrier_axis,
        same * carrier_axis,
        (*gear.coordinates, Coordinate(arm, "angle", factor)),
        gear.travel,
    )


# The pitch point


def find_mesh(
    entry: c.Gear, carrier: int, first: GearMember, second: GearMember, pitch_point: Array | None
) -> GearMesh:
    """Find the pitch point of two gears. Raises Finding where axes, ratio and point contradict each other."""
    if not (first.turns or second.turns):
        raise Finding(MISFIT, "both joints slide: nothing rolls", "for two travels use type: ratio")
    if pitch_point is None and entry.ratio is None and entry.teeth is None:
        raise Finding(MISFIT, "ratio, teeth and pitch point are all missing", "give one of ratio, teeth, at")
    make = _mesh_rack
    if first.turns and second.turns:
        make = (
            _mesh_parallel if _length(cross_vectors(first.axis, second.axis)) <= tolerances.TYPED_AXES else _mesh_bevel
        )
    mesh = make(entry, carrier, first, second, pitch_point)
    for wheel in (first, second):
        if wheel.turns and _length(arm_to_axis(wheel, mesh)) <= tolerances.TYPED_POINT * _length(wheel.point - mesh.P):
            raise Finding(MISFIT, "the pitch point is on the axis of a gear, or one pitch cone is flat: the "
                          "direction of the tooth force is unknown", "correct axes, ratio or pitch point")  # fmt: skip
    return mesh


def _motion_ratio(entry: c.Gear, first: GearMember, second: GearMember, external: float) -> float:
    """Ratio of the first motion to the second, each about its own axis; external: the sign for external teeth."""
    if entry.teeth is not None:
        one, other = entry.teeth
        return external * other / one * (-1.0 if entry.internal else 1.0)
    assert entry.ratio is not None
    ratio = entry.ratio * first.sign * second.sign
    if entry.internal and ratio * external > 0.0:
        raise Finding(MISFIT, f"a ratio of {entry.ratio:g} means external gears here, but internal is given",
                      "change the sign of the ratio, or leave out internal")  # fmt: skip
    return ratio


def _mesh_parallel(
    entry: c.Gear, carrier: int, first: GearMember, second: GearMember, pitch_point: Array | None
) -> GearMesh:
    same = math.copysign(1.0, float(first.axis @ second.axis))
    d = second.arm(first.point) * -1.0
    distance = _length(d)
    size = max(float(np.max(np.abs(first.point))), float(np.max(np.abs(second.point))))
    if distance <= tolerances.TYPED_POINT * size:
        raise Finding(MISFIT, "both gears turn about the same axis", "for gears on one axis use type: ratio")
    if entry.ratio is None and entry.teeth is None:
        assert pitch_point is not None
        return _mesh_at_point(carrier, first, second, pitch_point, first.axis)
    i = _motion_ratio(entry, first, second, -same) * same
    if abs(i - 1.0) < tolerances.TYPED_AXES:
        raise Finding(
            MISFIT,
            "a ratio of 1 with both rotating in the same direction has no pitch point",
            "use type: belt or ratio",
        )
    P = first.point + d / (1.0 - i)
    if pitch_point is not None:
        offset = first.arm(pitch_point) - d / (1.0 - i)
        _require_pitch_point(P, offset, distance)
        P = P + ((pitch_point - P) @ first.axis) * first.axis
    return GearMesh(carrier, first, second, P, first.axis)


def _mesh_bevel(
    entry: c.Gear, carrier: int, first: GearMember, second: GearMember, pitch_point: Array | None
) -> GearMesh:
    apex = _find_apex(first, second)
    if entry.ratio is None and entry.teeth is None:
        assert pitch_point is not None
        return _mesh_at_point(carrier, first, second, pitch_point, _unit(pitch_point - apex))
    sides = [float((m.point - apex) @ m.axis) for m in (first, second)]
    if entry.teeth is not None and not all(sides):
        raise Finding(MISFIT, "a joint's point is where the two axes meet, so the side of its gear is unknown",
                      "move the joint's point to its gear, or give ratio and at")  # fmt: skip
    external = -math.copysign(1.0, sides[0] * sides[1])
    i = _motion_ratio(entry, first, second, external)
    g = _unit(i * first.axis - second.axis)
    along = float(g @ first.axis)
    if pitch_point is None and (sides[0] == 0.0 or abs(along) < tolerances.TYPED_AXES):
        raise Finding(MISFIT, "it is unknown where on the pitch cone the teeth meet", "give the pitch point: at")
    if pitch_point is None:
        P = apex + sides[0] / along * g
    else:
        D = pitch_point - apex
        _require_pitch_point(apex + (D @ g) * g, D - (D @ g) * g, _length(D))
        P = apex + (D @ g) * g
    return GearMesh(carrier, first, second, P, g)


def _mesh_rack(
    entry: c.Gear, carrier: int, first: GearMember, second: GearMember, pitch_point: Array | None
) -> GearMesh:
    wheel, rack = (first, second) if first.turns else (second, first)
    if abs(float(wheel.axis @ rack.axis)) > tolerances.TYPED_AXES:
        raise Finding(MISFIT, "the rack does not slide perpendicular to the axis of its gear", "correct the axes")
    if entry.teeth is not None:
        raise Finding(
            MISFIT,
            "the number of teeth does not define the ratio of a rack",
            "give the ratio, in rad/m, or the pitch point: at",
        )
    if entry.ratio is None:
        assert pitch_point is not None
        return _mesh_at_point(carrier, first, second, pitch_point, wheel.axis)
    ratio = entry.ratio * first.sign * second.sign  # of the wheel's rate by the rack's speed, or the other way round
    P = wheel.point + cross_vectors(rack.axis, wheel.axis) * (1.0 / ratio if wheel is first else ratio)
    if pitch_point is not None:
        _require_pitch_point(P, wheel.arm(pitch_point) - (P - wheel.point), _length(P - wheel.point))
        P = P + ((pitch_point - P) @ wheel.axis) * wheel.axis
    return GearMesh(carrier, first, second, P, wheel.axis)


def _mesh_at_point(carrier: int, first: GearMember, second: GearMember, P: Array, w: Array) -> GearMesh:
    """Make the mesh at a given pitch point, where both gears must move in the same direction."""
    one, other = first.unit_velocity(P), second.unit_velocity(P)
    sizes = _length(one) * _length(other)
    across = cross_vectors(one, other)
    if sizes == 0.0 or _length(across) > tolerances.TYPED_POINT * sizes:
        raise Finding(MISFIT, "at the pitch point the two gears do not move in the same direction",
                      "it lies in the plane of both axes, on the line through both centres")  # fmt: skip
    return GearMesh(carrier, first, second, P, w)


def _require_pitch_point(P: Array, offset: Array, size: float) -> None:
    if _length(offset) > tolerances.TYPED_POINT * size:
        where = ", ".join(f"{x:.6g}" for x in P)
        raise Finding(MISFIT, f"the given pitch point is {_length(offset):.3g} m from the one that axes and "
                      f"ratio require, ({where})", "leave out `at` or the ratio, or move an axis")  # fmt: skip


def _find_apex(first: GearMember, second: GearMember) -> Array:
    """Find the point where two axes meet. Raises Finding if they do not."""
    n = cross_vectors(first.axis, second.axis)
    D = second.point - first.point
    gap, size = abs(float(n @ D)) / _length(n), _length(D)
    if gap > tolerances.TYPED_POINT * size:
        raise Finding(MISFIT, f"the axes are neither parallel nor intersecting: their distance is {gap:.3g} m",
                      "for gears with crossed axes, such as worm gears, use type: ratio (no tooth force)")  # fmt: skip
    return np.asarray(first.point + float(cross_vectors(D, second.axis) @ n) / float(n @ n) * first.axis)


# The line of action


def line_of_action(entry: c.Gear, mesh: GearMesh) -> tuple[Array, Array]:
    """Per unit of tangential force ON the second gear: the load that does work, and the separating force."""
    first, second, P = mesh.first, mesh.second, mesh.P
    wheel = first if first.turns else second
    t = _unit(wheel.unit_velocity(P))
    w = mesh.w * math.copysign(1.0, float(mesh.w @ wheel.axis))
    f = t - math.tan(entry.helix) * w
    forward = float(t @ first.unit_velocity(P)) * first.sign
    f = math.copysign(1.0, forward) * f
    return f, math.tan(entry.pressure_angle) / math.cos(entry.helix) * separating_direction(mesh)


def separating_direction(mesh: GearMesh) -> Array:
    """Unit vector in which the flanks push the second gear: out of the first one's teeth."""
    if not mesh.second.turns:
        return -_unit(arm_to_axis(mesh.first, mesh))
    if not mesh.first.turns:
        return _unit(arm_to_axis(mesh.second, mesh))
    one, other = arm_to_axis(mesh.first, mesh), arm_to_axis(mesh.second, mesh)
    radii = [_length(wheel.arm(mesh.P)) for wheel in (mesh.first, mesh.second)]
    ring = one @ other > 0.0 and radii[0] < radii[1]  # the second one is: its teeth are inside
    return -_unit(one) if ring else _unit(other)


def arm_to_axis(wheel: GearMember, mesh: GearMesh) -> Array:
    """Vector from the pitch point to the axis of a wheel, perpendicular to the line along which the teeth touch."""
    arm = -wheel.arm(mesh.P)
    return np.asarray(arm - (arm @ mesh.w) * mesh.w)


def _length(a: Array) -> float:
    return math.sqrt(float(a @ a))


def _unit(a: Array) -> Array:
    return np.asarray(a / _length(a))


def _body_name(bodies: Sequence[Body], body: int) -> str:
    return "ground" if body == GROUND else bodies[body].name
