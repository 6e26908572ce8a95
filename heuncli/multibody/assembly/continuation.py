"""Continuation of a loop drawn closed: turn it from the drawing to its held or driven coordinates.

A loop usually closes in several ways, and the way that needs the smallest rotations may lie beyond a dead centre. So
its coordinates move to their prescribed values in small steps, as the machine would be cranked, and it is closed at
each.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import replace
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.walk import AssemblyPoses
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_matrix_about

STEP = 0.1  # [rad], or of the lever: shorter than what separates the two ways to close but beside a dead centre
MOST_STEPS = 64


def prescribed_coordinates(mechanism: Mechanism, conditions: Sequence[JointCondition]) -> dict[int, tuple[bool, bool]]:
    """Return the joints with a prescribed coordinate: whether an angle, and whether a travel or length."""
    kinds = [JOINTS[j.kind] for j in mechanism.joints]
    prescribed = {
        k: (
            d.pose.turn == "all" != kind.turn.condition,
            d.pose.hold == "distance" or (d.pose.hold == "point" != kind.hold.gap_type and not kind.follows_path),
        )
        for k, (d, kind) in enumerate(zip(conditions, kinds, strict=True))
    }
    return {k: which for k, which in prescribed.items() if any(which)}


def iter_continuation(
    conditions: Sequence[JointCondition],
    prescribed: Mapping[int, tuple[bool, bool]],
    drawn_poses: AssemblyPoses,
    lever: float,
) -> Iterator[list[JointCondition]]:
    """Yield the conditions with the coordinates as drawn, then closer and closer to the prescribed values; last at
    these.

    prescribed: joints as in `prescribed_coordinates`

    Yields nothing if all are as drawn, or too far away for small steps.
    """
    offsets = {k: _coordinate_offset(conditions[k], which, drawn_poses) for k, which in prescribed.items()}
    count = math.ceil(
        max((max(abs(angle), abs(length) / lever) for angle, length in offsets.values()), default=0.0) / STEP
    )
    if not 1 <= count <= MOST_STEPS:
        return
    for i in range(count + 1):
        step_conditions = list(conditions)
        for k, (angle, length) in offsets.items():
            remaining = (count - i) / count
            step_conditions[k] = _shift_condition(conditions[k], remaining * angle, remaining * length)
        yield step_conditions


def _coordinate_offset(d: JointCondition, which: tuple[bool, bool], drawn_poses: AssemblyPoses) -> tuple[float, float]:
    """Return the angle [rad] and length [m] by which the coordinates of a joint exceed the prescribed ones, as
    drawn.
    """
    Ra, Rb = drawn_poses.R[d.a], drawn_poses.R[d.b]
    D = Ra.T @ (drawn_poses.x[d.b] + Rb @ d.q - drawn_poses.x[d.a]) - d.p
    angle = _angle(d.axis, Ra.T @ Rb @ d.relative.T) if which[0] else 0.0
    if not which[1]:
        return angle, 0.0
    return angle, float(np.sqrt(D @ D)) - d.length if d.pose.hold == "distance" else float(d.axis @ D)


def _shift_condition(d: JointCondition, angle: float, length: float) -> JointCondition:
    """Return the condition with its coordinates offset by an angle and a length."""
    relative = rotation_matrix_about(d.axis, angle) @ d.relative if angle else d.relative
    if d.pose.hold == "distance":
        return replace(d, relative=relative, length=d.length + length)
    return replace(d, relative=relative, p=d.p + length * d.axis)


def _angle(axis: Array, E: Array) -> float:
    """Angle by which E turns about the axis, -π to π."""
    sin = axis @ np.array([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
    return math.atan2(float(sin), float(np.trace(E) - axis @ E @ axis))
