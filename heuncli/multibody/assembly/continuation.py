"""A loop drawn closed whose held or driven coordinates ask for another pose, turned there from the drawing.

A loop mostly closes in several ways, and that which needs the fewest turns may lie on the other side of a dead centre.
Its coordinates therefore go to where they are held in small steps, as the machine would be cranked, closed at each.
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
from heuncli.scene.shapes.rotations import about

STEP = 0.1  # [rad], or of the lever: shorter than what separates the two ways to close but beside a dead centre
MOST_STEPS = 64


def given(mechanism: Mechanism, found: Sequence[JointCondition]) -> dict[int, tuple[bool, bool]]:
    """The joints of which a coordinate is asked for: whether an angle, and whether a travel or length."""
    kinds = [JOINTS[j.kind] for j in mechanism.joints]
    asked = {
        k: (
            d.pose.turn == "all" != kind.turn.asks,
            d.pose.hold == "distance" or (d.pose.hold == "point" != kind.hold.asks and not kind.follows_path),
        )
        for k, (d, kind) in enumerate(zip(found, kinds, strict=True))
    }
    return {k: which for k, which in asked.items() if any(which)}


def stages(
    found: Sequence[JointCondition], asked: Mapping[int, tuple[bool, bool]], drawn: AssemblyPoses, lever: float
) -> Iterator[list[JointCondition]]:
    """The conditions with the coordinates as drawn, then nearer and nearer to where they are asked; last as asked.

    asked: of which joints, as `given` says. Nothing where all are as drawn, or too far for small steps.
    """
    ways = {k: _way(found[k], which, drawn) for k, which in asked.items()}
    count = math.ceil(
        max((max(abs(angle), abs(length) / lever) for angle, length in ways.values()), default=0.0) / STEP
    )
    if not 1 <= count <= MOST_STEPS:
        return
    for i in range(count + 1):
        before = list(found)
        for k, (angle, length) in ways.items():
            left = (count - i) / count
            before[k] = _before(found[k], left * angle, left * length)
        yield before


def _way(d: JointCondition, which: tuple[bool, bool], drawn: AssemblyPoses) -> tuple[float, float]:
    """Angle [rad] and length [m] by which the coordinates of a joint are beyond what is asked, as drawn."""
    Ra, Rb = drawn.R[d.a], drawn.R[d.b]
    D = Ra.T @ (drawn.x[d.b] + Rb @ d.q - drawn.x[d.a]) - d.p
    angle = _angle(d.axis, Ra.T @ Rb @ d.relative.T) if which[0] else 0.0
    if not which[1]:
        return angle, 0.0
    return angle, float(np.sqrt(D @ D)) - d.length if d.pose.hold == "distance" else float(d.axis @ D)


def _before(d: JointCondition, angle: float, length: float) -> JointCondition:
    """The condition with its coordinates so far from what is asked."""
    relative = about(d.axis, angle) @ d.relative if angle else d.relative
    if d.pose.hold == "distance":
        return replace(d, relative=relative, length=d.length + length)
    return replace(d, relative=relative, p=d.p + length * d.axis)


def _angle(axis: Array, E: Array) -> float:
    """How far E turns about the axis, -π to π."""
    sin = axis @ np.array([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
    return math.atan2(float(sin), float(np.trace(E) - axis @ E @ axis))
