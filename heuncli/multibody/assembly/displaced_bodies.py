"""Which bodies had to leave the place in which they are drawn for the joints to close, and how far.

A body has such a place where `near` gives one, or where the scene is drawn in world coordinates: most joints close as
it is drawn, and none asks for another pose by a held or driven coordinate. Other bodies are placed, not moved.
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
from heuncli.multibody.mechanism.size import marks, size_of_scene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import to_vector

LEAST_ANGLE = 0.01  # [deg] that is mentioned


def moved(
    mechanism: Mechanism, found: Sequence[JointCondition], drawn: AssemblyPoses, start: Assembly, lever: float
) -> tuple[str, ...]:
    """The bodies that were moved by more than typed digits are off, each with its way, the longest first.

    lever: the size of the joints' levers, by which gaps are judged [m].
    """
    in_place = drawn_in_place(mechanism, found, drawn, lever)
    ways = []
    for i, body in enumerate(mechanism.bodies):
        counts = in_place or body.near_position is not None, in_place or body.near_rotation is not None
        if any(counts) and (way := _way(body, drawn, start, i, counts)) > tolerances.UNMOVED * lever:
            ways.append((way, i))
    size = size_of_scene(mechanism, start) if ways else 1.0
    ways = sorted(((way, i) for way, i in ways if way > tolerances.MOVED * size), key=lambda w: (-w[0], w[1]))
    return tuple(_told(mechanism.bodies[i].name, way, start.rotation[i] @ drawn.R[i].T) for way, i in ways)


def _told(name: str, way: float, turned: Array) -> str:
    """A body with the way of the point of it that moved most, and how far it was turned."""
    angle = float(np.degrees(np.linalg.norm(to_vector(turned))))
    return f"{name} by {way:.2g} m" + (f" and {angle:.2g} deg" if angle >= LEAST_ANGLE else "")


def drawn_in_place(mechanism: Mechanism, found: Sequence[JointCondition], drawn: AssemblyPoses, lever: float) -> bool:
    """Whether the scene is drawn in world coordinates, so that a body's place in the drawing is meant.

    Bodies drawn each about its own origin fit at a joint or two by chance; in a scene drawn as it stands, but for a
    slip, most joints do. A joint between two origins fits however bodies are drawn, and tells nothing: a robot may have
    many such.
    """
    asking = [d for d in found if d.pose.hold != "none"]
    if not asking:
        return False
    distance, angle = JointGaps(asking, [d.pose for d in asking])(drawn.x, drawn.R)
    is_open = np.maximum(distance / lever, angle) > tolerances.DRAWN_IN_PLACE
    kinds = [JOINTS[mechanism.joints[d.joint].kind] for d in asking]
    set_apart = [d.pose != (kind.hold.asks, kind.turn.asks) for d, kind in zip(asking, kinds, strict=True)]
    tells = np.array([not _between_origins(mechanism, d) for d in asking])
    return not bool(np.any(is_open & np.array(set_apart))) and 2 * int(np.sum(is_open & tells)) < int(np.sum(tells))


def _between_origins(mechanism: Mechanism, found: JointCondition) -> bool:
    joint = mechanism.joints[found.joint]
    return not (np.any(joint.p) or np.any(joint.q))


def _way(body: Body, drawn: AssemblyPoses, start: Assembly, i: int, counts: tuple[bool, bool]) -> float:
    """How far the point of a body that moved most is from where it is drawn [m]; counts: its shift, and its turn."""
    turned: Array = start.rotation[i] - drawn.R[i]
    shift = start.position[i] - drawn.x[i] + turned @ body.center if counts[0] else np.zeros(3)
    if counts[1]:
        shift = shift + (np.array(marks(body)) - body.center) @ turned.T
    return float(np.sqrt(np.max(np.sum(np.square(np.atleast_2d(shift)), axis=1))))
