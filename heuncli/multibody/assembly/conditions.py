"""The conditions that each joint sets on poses and rates at the start.

Every kind is one way to hold the `to` point and one way to turn, both in the axes of the body `from`. A held angle, a
held travel and drives only make the two stricter, so that no later step of the assembly depends on kinds of joints.

Only for a drive's prescribed coordinate does the assembly evaluate an expression in time.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Drive
from heuncli.scene.shapes.rotations import perpendicular_pair, rotation_between, rotation_matrix_about

# Drives


class CoordinateJet(NamedTuple):
    """A coordinate, its rate and its acceleration."""

    value: float
    rate: float
    acceleration: float


def drive_jet(expression: Expression, t: float) -> CoordinateJet:
    """Evaluate the expression and its first and second derivative at t."""
    return CoordinateJet(*expression.derivatives(t))


# Conditions

Hold = Literal["none", "point", "line", "plane", "distance", "curve"]
Turn = Literal["free", "axis", "square", "alike", "all"]

SAME_AXES = np.eye(3)
NO_BEND = np.zeros(3)


class JointConstraint(NamedTuple):
    """The constraints of a joint on the point and on the rotation of `to`: for poses, or for rates."""

    hold: Hold
    turn: Turn

    @property
    def is_strong(self) -> bool:
        """Whether a body may be placed by this joint alone (all but line, plane and rod)."""
        return self.hold == "point" or self.turn != "free"


@record
class JointCondition:
    """The conditions of one joint at the start; a, b, p, q, axis and to_axis as in Joint, p moved on by a known travel.

    normals: two unit vectors (2, 3) perpendicular to axis, axes of a, where they are needed
    relative: R_a^T R_b where the constraint is `all`
    length: of a `distance` [m]
    spin, slip, stretch: (rate, acceleration) of the angle about the axis [rad/s], of the travel along it [m/s] and of
    the length, where `rate` constrains them
    path: that the `to` point is on, from p on, while its place on it is unknown; once it is known, axis is the tangent
    and bend (3,) [1/m] the curvature there
    """

    joint: int
    a: int
    b: int
    p: Array
    q: Array
    axis: Array
    to_axis: Array
    normals: Array
    pose: JointConstraint
    rate: JointConstraint
    relative: Array
    length: float
    spin: tuple[float, float]
    slip: tuple[float, float]
    stretch: tuple[float, float]
    path: Path | None = None
    bend: Array = NO_BEND


def joint_conditions(mechanism: Mechanism, t0: float) -> list[JointCondition]:
    """Return one condition per joint, in their order. Raises SolveError where a held value contradicts a drive."""
    problems: list[Problem] = []
    conditions = [_joint_condition(mechanism, k, joint, t0, problems) for k, joint in enumerate(mechanism.joints)]
    if problems:
        raise SolveError(*problems)
    return conditions


def _joint_condition(mechanism: Mechanism, k: int, joint: Joint, t0: float, problems: list[Problem]) -> JointCondition:
    drive = joint.drive
    driven = {drive.quantity: drive_jet(drive.value, t0)} if drive else {}
    problems += [
        _not_computable_problem(drive, t0) for jet in driven.values() if drive and not all(map(math.isfinite, jet))
    ]
    zero_free = drive.quantity if drive and drive.zero_assembled else None
    angle, spin = _initial_coordinate(
        joint,
        driven.get("angle"),
        ("angle", "rad", joint.angle),
        ("rate", "rad/s", joint.rate),
        joint.to_axis_given or zero_free == "angle",
        problems,
    )
    travel, slip = _initial_coordinate(
        joint,
        driven.get("travel"),
        ("travel", "m", joint.travel),
        ("speed", "m/s", joint.speed),
        zero_free == "travel",
        problems,
    )
    length, stretch = joint.length, (0.0, 0.0)
    if jet := driven.get("length"):
        length = length if drive and drive.from_start else jet.value
        stretch = jet.rate, jet.acceleration
    if length is not None and length <= 0.0:
        message = f"joint {joint.name} (rod): its length is {length:.6g} m at the start"
        hint = "give a length above zero; for zero length use a ball"
        problems.append(Problem("no-length", message, hint=hint, entry_path=f"joints.{joint.name}"))

    kind = JOINTS[joint.kind]
    hold, turn = kind.hold.gap_type, kind.turn.condition
    relative, p = SAME_AXES, joint.p
    normals = np.array(perpendicular_pair(joint.axis)) if hold == "line" or turn == "axis" else SAME_AXES[:2]
    pose, rate = JointConstraint(hold, turn), JointConstraint(hold, turn)
    if turn == "all":
        relative = _relative_rotation(mechanism, joint)
    if turn == "axis" and angle is not None:
        pose, relative = JointConstraint(pose.hold, "all"), rotation_matrix_about(joint.axis, angle)
    if turn == "axis" and spin is not None:
        rate = JointConstraint(rate.hold, "all")
    if hold == "line" and travel is not None:
        pose, p = JointConstraint("point", pose.turn), joint.p + travel * joint.axis
    if hold == "line" and slip is not None:
        rate = JointConstraint("point", rate.turn)
    if hold == "curve" and slip is not None:
        rate = JointConstraint("point", rate.turn)
    if hold == "distance" and length is None:  # as assembled: no condition on the pose, its length is kept then
        pose = JointConstraint("none", "free")
    condition = JointCondition(
        k, joint.a, joint.b, p, joint.q, joint.axis, joint.to_axis, normals,
        pose, rate, relative, length or 0.0, spin or (0.0, 0.0), slip or (0.0, 0.0), stretch, joint.path,
    )  # fmt: skip
    return (
        condition if joint.path is None or travel is None else condition_on_path(condition, joint.path, travel, "point")
    )


def condition_on_path(d: JointCondition, path: Path, s: float, hold: Hold) -> JointCondition:
    """Return the condition of a joint along a path at parameter s: to stay there ("point") or on the tangent
    ("line").
    """
    r, slope, bend = path.evaluate(s)
    square = float(slope @ slope)
    size = math.sqrt(square)
    axis = slope / size
    rate = JointConstraint("line", d.rate.turn) if d.rate.hold == "curve" else d.rate
    return replace(
        d, p=d.p + r, axis=axis, normals=np.array(perpendicular_pair(axis)), bend=bend / square, path=None,
        pose=JointConstraint(hold, d.pose.turn), rate=rate, slip=(d.slip[0] * size, d.slip[1] * size),
    )  # fmt: skip


def condition_on_tangent(d: JointCondition, x: Array, R: Array) -> JointCondition:
    """Return a joint's condition in a pose: along a path, to stay on the tangent at the nearest point; otherwise
    unchanged.
    """
    if d.path is None:
        return d
    D = R[d.a].T @ (x[d.b] + R[d.b] @ d.q - x[d.a]) - d.p
    return condition_on_path(d, d.path, float(d.path.find_nearest(D)), "line")


def _not_computable_problem(drive: Drive, t0: float) -> Problem:
    message = f"drive {drive.name}: {drive.quantity} '{drive.value.source}' or a derivative cannot be computed"
    hint = "a drive needs finite rates and accelerations: start it smoothly, e.g. with t**2 or a table"
    return Problem("not-computable", f"{message} at t = {t0:g} s", drive.value.location, hint)


InitialValue = tuple[str, str, float | None]  # what, its unit, the initial value


def _initial_coordinate(
    joint: Joint,
    jet: CoordinateJet | None,
    value: InitialValue,
    rate: InitialValue,
    zero_free: bool,
    problems: list[Problem],
) -> tuple[float | None, tuple[float, float] | None]:
    """Return a coordinate's value at the start, and its (rate, acceleration), from drive and initial value; None where
    free.

    zero_free: the coordinate is counted from the assembled start, so that its value there is zero and constrains
    nothing
    """
    held = value[2]
    if zero_free:
        values = (v for v in (held, jet and jet.value) if v is not None)
        problems += [_not_zero_problem(joint, value, v) for v in values if abs(v) > tolerances.SAME_VALUE]
        held = None
    elif jet and joint.drive is not None and not joint.drive.from_start:
        problems += _compare(joint, value, jet.value)
        held = jet.value
    if jet:
        problems += _compare(joint, rate, jet.rate)
        return held, (jet.rate, jet.acceleration)
    return held, None if rate[2] is None else (rate[2], 0.0)


def _relative_rotation(mechanism: Mechanism, joint: Joint) -> Array:
    """Return R_a^T R_b that a slide or weld keeps: from the given attitudes, or else such that the axes agree."""
    Ra, Rb = (np.eye(3) if i == GROUND else mechanism.bodies[i].rotation for i in (joint.a, joint.b))
    if Ra is not None and Rb is not None:
        return Ra.T @ Rb
    return rotation_between(joint.to_axis, joint.axis) if joint.to_axis_given else SAME_AXES


def _compare(joint: Joint, initial: InitialValue, drive_value: float) -> list[Problem]:
    what, unit, held = initial
    if held is None or joint.drive is None:
        return []
    gap = held - drive_value
    if what == "angle":  # counts full turns, but one attitude is one attitude
        gap = math.remainder(gap, math.tau)
    if abs(gap) <= tolerances.SAME_VALUE * max(1.0, abs(drive_value)):
        return []
    message = (
        f"joint {joint.name}: initial {what} {held:.6g} {unit} contradicts drive {joint.drive.name}, "
        f"which requires {drive_value:.6g} {unit} at the start"
    )
    return [Problem("held-conflict", message, hint=f"leave out the initial {what}; the drive sets it",
                    entry_path=f"joints.{joint.name}")]  # fmt: skip


def _not_zero_problem(joint: Joint, initial: InitialValue, value: float) -> Problem:
    what, unit, _ = initial
    return Problem(
        "held-conflict",
        f"joint {joint.name}: {what} {value:.6g} {unit} at the start, where it is zero by definition",
        hint="set it to zero, or leave out to_axis and zero: assembled",
        entry_path=f"joints.{joint.name}",
    )


def mean_arm(mechanism: Mechanism) -> float:
    """Mean distance of the joints' points from the centres of mass of their bodies [m]; 1 where that is zero."""
    arms = [
        point - mechanism.bodies[body].center
        for j in mechanism.joints
        for body, point in ((j.a, j.p), (j.b, j.q))
        if body != GROUND
    ]
    mean = float(np.mean(np.sqrt(np.sum(np.square(arms), axis=-1)))) if arms else 0.0
    return mean if mean > 0.0 else 1.0
