"""Which bodies had to leave their place in the drawing for the joints to close, and how far.

A body has such a place where `near` gives one, or where the scene is drawn in world coordinates: then most joints close
as drawn, and no held or driven coordinate needs another pose. Other bodies are placed, not moved.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.gaps import JointGaps
from heuncli.multibody.assembly.walk import AssemblyPoses
from heuncli.multibody.mechanism.model import Assembly, Body, Mechanism
from heuncli.multibody.mechanism.size import extent_points, scene_size
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import vector_from_rotation

MIN_ANGLE = 0.01  # [deg] that is mentioned


def describe_displaced_bodies(
    mechanism: Mechanism,
    conditions: Sequence[JointCondition],
    drawn_poses: AssemblyPoses,
    start: Assembly,
    lever: float,
) -> tuple[str, ...]:
    """Describe the bodies that moved by more than the errors of typed digits, the largest displacement first.

    lever: the size of the joints' levers, which gaps are compared with [m]
    """
    in_place = is_drawn_in_place(mechanism, conditions, drawn_poses, lever)
    displacements = []
    for i, body in enumerate(mechanism.bodies):
        counts = in_place or body.near_position is not None, in_place or body.near_rotation is not None
        if (
            any(counts)
            and (distance := _largest_displacement(body, drawn_poses, start, i, counts)) > tolerances.UNMOVED * lever
        ):
            displacements.append((distance, i))
    size = scene_size(mechanism, start) if displacements else 1.0
    displacements = sorted(
        ((distance, i) for distance, i in displacements if distance > tolerances.MOVED * size),
        key=lambda w: (-w[0], w[1]),
    )
    return tuple(
        _format_displacement(mechanism.bodies[i].name, distance, start.rotation[i] @ drawn_poses.R[i].T)
        for distance, i in displacements
    )


def _format_displacement(name: str, distance: float, rotation: Array) -> str:
    """Format a body's name, the displacement of the point of it that moved most, and its rotation angle."""
    angle = float(np.degrees(np.linalg.norm(vector_from_rotation(rotation))))
    return f"{name} by {distance:.2g} m" + (f" and {angle:.2g} deg" if angle >= MIN_ANGLE else "")


def is_drawn_in_place(
    mechanism: Mechanism, conditions: Sequence[JointCondition], drawn_poses: AssemblyPoses, lever: float
) -> bool:
    """Whether the scene is drawn in world coordinates, so that a body's place in the drawing is intended.

    Bodies drawn each about its own origin fit at a joint or two by chance; in a scene drawn in place most joints do,
    apart from slips. A joint between two origins fits however the bodies are drawn and proves nothing; a robot may have
    many such.
    """
    constraining = [d for d in conditions if d.pose.hold != "none"]
    if not constraining:
        return False
    distance, angle = JointGaps(constraining, [d.pose for d in constraining])(drawn_poses.x, drawn_poses.R)
    is_open = np.maximum(distance / lever, angle) > tolerances.DRAWN_IN_PLACE
    kinds = [JOINTS[mechanism.joints[d.joint].kind] for d in constraining]
    has_prescribed = [
        d.pose != (kind.hold.gap_type, kind.turn.condition) for d, kind in zip(constraining, kinds, strict=True)
    ]
    is_significant = np.array([not _joins_origins(mechanism, d) for d in constraining])
    return not bool(np.any(is_open & np.array(has_prescribed))) and 2 * int(np.sum(is_open & is_significant)) < int(
        np.sum(is_significant)
    )


def _joins_origins(mechanism: Mechanism, condition: JointCondition) -> bool:
    joint = mechanism.joints[condition.joint]
    return not (np.any(joint.p) or np.any(joint.q))


def _largest_displacement(
    body: Body, drawn_poses: AssemblyPoses, start: Assembly, i: int, counts: tuple[bool, bool]
) -> float:
    """Return how far the point of a body that moved most is from its place in the drawing [m]; counts: its shift, its
    rotation.
    """
    rotation_change: Array = start.rotation[i] - drawn_poses.R[i]
    shift = start.position[i] - drawn_poses.x[i] + rotation_change @ body.center if counts[0] else np.zeros(3)
    if counts[1]:
        shift = shift + (np.array(extent_points(body)) - body.center) @ rotation_change.T
    return float(np.sqrt(np.max(np.sum(np.square(np.atleast_2d(shift)), axis=1))))
