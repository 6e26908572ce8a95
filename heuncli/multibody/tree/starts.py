"""The joints in the assembled mechanism: coordinates, rates, reference attitudes, directions."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS, Direction
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Joint, Mechanism
from heuncli.multibody.tree.spanning import SpanningTree
from heuncli.results.results import Array
from heuncli.scene.expressions.discontinuities import find_first_not_positive
from heuncli.scene.expressions.integrals import add_start_value
from heuncli.scene.expressions.paths import Path
from heuncli.scene.shapes.rotations import (
    cross_rows,
    perpendicular_pair,
    quaternion_from_matrix,
    rotation_between,
    rotation_matrix_about,
)

# Starts

Z = np.array([0.0, 0.0, 1.0])


@record
class JointStart:
    """A joint at the start: R_ref (to axes -> from axes at angle zero), angle, rate, travel, speed.

    angle of a universal: about its first axis (`first_angle`); its coordinates are counted from the start.
    """

    R_ref: Array
    angle: float
    rate: float
    travel: float
    speed: float


@record
class PresetTree:
    """The spanning tree of a larger scene, to be used again.

    starts: of its joints; None: from the assembled start
    """

    spanning: SpanningTree
    starts: tuple[JointStart, ...] | None = None


def point_distance(start: Assembly, joint: Joint) -> float:
    """Return the distance of a joint's two points at the start [m]."""
    xa, Ra, _, _ = body_state(start, joint.a)
    xb, Rb, _, _ = body_state(start, joint.b)
    D = xb + Rb @ joint.q - xa - Ra @ joint.p
    return math.sqrt(float(D @ D))


def compute_joint_start(mechanism: Mechanism, start: Assembly, joint: Joint) -> JointStart:
    """Compute a joint's coordinates in the assembled mechanism, and its reference attitude, at which its angle is
    zero.
    """
    xa, Ra, va, wa = body_state(start, joint.a)
    xb, Rb, vb, wb = body_state(start, joint.b)
    R = Ra.T @ Rb
    kind = JOINTS[joint.kind]
    if kind.is_constant_velocity:
        require_bend(joint, R)
    if not kind.turns and "travel" not in kind.coordinates:
        return JointStart(R, 0.0, 0.0, 0.0, 0.0)
    n = joint.axis
    if joint.path is not None:
        return compute_path_start(joint, joint.path, start, R)
    D = Ra.T @ (xb + Rb @ joint.q - xa) - joint.p
    rate = float((Ra @ (Z if kind.turns == ("z",) else n)) @ (wb - wa))
    v = vb + cross_rows(wb, Rb @ joint.q) - va - cross_rows(wa, Rb @ joint.q + xb - xa)
    travel, speed = float(D @ n), float((Ra @ n) @ v)
    if "angle" not in kind.coordinates:
        return JointStart(R, first_angle(joint, R) if len(kind.turns) == 2 else 0.0, rate, travel, speed)
    reference = joint.angle
    if joint.drive is not None and joint.drive.quantity == "angle" and not joint.drive.from_start:
        reference = joint.drive.value.derivatives(0.0)[0]
    if joint.to_axis_given or (joint.drive is not None and joint.drive.zero_assembled):
        reference = reference or 0.0
        return JointStart(rotation_matrix_about(n, -reference) @ R, reference, rate, travel, speed)
    reference = reference if reference is not None else find_reference_angle(mechanism, joint)
    return JointStart(np.eye(3), unwrap_angle(axial_angle(R, n), reference), rate, travel, speed)


def compute_path_start(joint: Joint, path: Path, start: Assembly, R: Array) -> JointStart:
    """Compute the travel of a point along its path: on the branch that is held or driven to, otherwise at the nearest
    place.

    Raises SolveError where it is unknown on which of several branches.
    """
    xa, Ra, va, wa = body_state(start, joint.a)
    xb, Rb, vb, wb = body_state(start, joint.b)
    D = xb + Rb @ joint.q - xa
    place, held = Ra.T @ D - joint.p, joint.travel
    if joint.drive is not None and not joint.drive.from_start and not joint.drive.zero_assembled:
        held = joint.drive.value.derivatives(0.0)[0]
    if held is None:
        travel = float(path.find_nearest(place))
        require_one_branch(joint, path, place)
    else:
        travel = path.find_nearby(place, held)
        if math.isclose(travel, held, abs_tol=tolerances.SAME_VALUE):
            travel = held
    slope = path.evaluate(travel)[1]
    v = Ra.T @ (vb + cross_rows(wb, Rb @ joint.q) - va - cross_rows(wa, D))
    turn = float((Ra @ Z) @ (wb - wa))
    return JointStart(R, 0.0, turn, travel, float(slope @ v) / float(slope @ slope))


def require_one_branch(joint: Joint, path: Path, place: Array) -> None:
    """Raise SolveError where a path crosses or touches itself at a place on it: each branch would be another motion."""
    branches = path.find_branches(place, tolerances.SAME_PLACE * path.bounds[0])
    if len(branches) > 1:
        where = " and ".join(f"{s:.6g}" for s in branches[:3])
        message = f"joint {joint.name} starts where its path crosses itself, at travel {where}: the branch is not given"
        hint = f"initial: {{travel: {branches[0]:.6g}}} selects one"
        raise SolveError(Problem("path-branch", message, None, hint, f"joints.{joint.name}"))


def require_bend(joint: Joint, R: Array) -> None:
    """Raise SolveError where the two shafts of a constant-velocity joint start bent by a right angle or more."""
    cosine = float(joint.axis @ R @ joint.to_axis)
    if cosine <= tolerances.PARALLEL:
        bend = math.degrees(math.acos(max(cosine, -1.0)))
        message = (
            f"joint {joint.name} (cv): its two shafts start at an angle of {bend:.4g} deg; it must be below 90 deg"
        )
        hint = "axis and to_axis must point the same way along the shafts: reverse one of them, or reduce the angle"
        raise SolveError(Problem("cv-bend", message, None, hint, f"joints.{joint.name}"))


def first_angle(joint: Joint, R: Array) -> float:
    """Angle by which the second axis of a universal has turned about the first, in (-pi, pi].

    It counts from where the axes of the two bodies agree, as a pin's angle does; from the start, if the second axis
    then lies along the first.
    """
    n, second_axis, rotated_axis = joint.axis, joint.to_axis, R @ joint.to_axis
    before = second_axis - (second_axis @ n) * n
    if float(np.sqrt(before @ before)) < tolerances.PARALLEL:
        return 0.0
    return math.atan2(float(n @ cross_rows(before, rotated_axis)), float(before @ rotated_axis))


def find_reference_angle(mechanism: Mechanism, joint: Joint) -> float:
    """Return the angle near which full turns are counted if none is given: the middle between stops on both sides, else
    0.

    One limit alone has no middle: a turn more or less would put any start within it.
    """
    stops = [s for s in mechanism.stops if s.quantity == "angle" and mechanism.joints[s.joint] is joint]
    low = max((s.low for s in stops if s.low is not None), default=None)
    high = min((s.high for s in stops if s.high is not None), default=None)
    return 0.5 * (low + high) if low is not None and high is not None else 0.0


def joint_direction(joint: Joint, direction: Direction) -> Array:
    """Return a direction of the joint in `from` axes: its axis, or one of the two perpendicular to it."""
    if direction == "axis":
        return joint.axis
    if direction == "z":
        return Z
    if direction == "across":
        return cross_rows(Z, joint.axis)
    e, f = perpendicular_pair(joint.axis)
    return e if direction == "first" else f


def to_direction(joint: Joint, R_ref: Array, direction: Direction) -> Array:
    """Return a direction fixed in `to`, in its axes: the second axis, or one of `from` at the reference attitude."""
    if direction == "to_axis":
        return joint.to_axis
    return np.asarray(R_ref.T @ joint_direction(joint, direction))


def bent_direction(joint: Joint, R_ref: Array, direction: Direction) -> Array:
    """A direction of `from` rotated by the bend that turns axis onto to_axis, in `to` axes."""
    bend = rotation_between(joint.axis, R_ref @ joint.to_axis)
    return np.asarray(R_ref.T @ bend @ joint_direction(joint, direction))


def unwrap_angle(angle: float, reference: float) -> float:
    """Return the angle of the same position that is nearest to `reference`."""
    return angle + 2.0 * math.pi * round((reference - angle) / (2.0 * math.pi))


def axial_angle(R: Array, axis: Array) -> float:
    """Angle of a rotation that is one about `axis`, in (-pi, pi]."""
    q = quaternion_from_matrix(R)
    cosine, sine = float(q[0]), float(q[1:] @ axis)
    return 2.0 * (math.atan2(sine, cosine) if cosine >= 0.0 else math.atan2(-sine, -cosine))


def body_state(start: Assembly, body: int) -> tuple[Array, Array, Array, Array]:
    """Position, rotation, velocity, angular velocity of a body, or of the ground."""
    if body == GROUND:
        return np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3)
    return start.position[body], start.rotation[body], start.velocity[body], start.angular_velocity[body]


# Driven starts


def prescribe_coordinates(mechanism: Mechanism, start: Assembly) -> Mechanism:
    """Make all drives prescribe their coordinates; start: assembled at t = 0."""
    return replace(
        mechanism, joints=tuple(_prescribe_coordinate(mechanism, start, joint) for joint in mechanism.joints)
    )


def require_lengths(mechanism: Mechanism, last: float) -> None:
    """Raise SolveError [drive-length] where the length of a driven rod becomes zero within a run up to `last`."""
    problems = []
    for joint in mechanism.joints:
        drive = joint.drive
        end_time = (
            find_first_not_positive(drive.value, last) if drive is not None and drive.quantity == "length" else None
        )
        if drive is not None and end_time is not None:
            message = f"drive {drive.name}: the length of rod {joint.name} reaches 0 at t = {end_time:.4g} s"
            hint = "end the run earlier, or keep the length above 0"
            problems.append(Problem("drive-length", message, drive.value.location, hint))
    if problems:
        raise SolveError(*problems)


def _prescribe_coordinate(mechanism: Mechanism, start: Assembly, joint: Joint) -> Joint:
    drive = joint.drive
    if drive is None or not drive.adds_to_start:
        return joint
    zero = drive.zero_assembled and drive.quantity == "angle"  # a travel counts from where the points are level
    value = add_start_value(drive.value, _start_coordinate(mechanism, start, joint))
    begun_joint: Joint = replace(joint, drive=replace(drive, value=value, from_start=False, zero_assembled=zero))
    return begun_joint


def _start_coordinate(mechanism: Mechanism, start: Assembly, joint: Joint) -> float:
    """Return the driven coordinate at the start: an angle [rad], a travel or a length [m]; the held value where there
    is one.
    """
    assert joint.drive is not None
    if joint.drive.quantity == "length":
        return joint.length if joint.length is not None else point_distance(start, joint)
    start_values = compute_joint_start(mechanism, start, joint)
    held, found = (
        (joint.angle, start_values.angle) if joint.drive.quantity == "angle" else (joint.travel, start_values.travel)
    )
    # a held value is measured from the assembled start, too
    is_relative = joint.to_axis_given or joint.drive.zero_assembled
    return held if held is not None and not is_relative else found
