"""Displacements as the coordinates of the joints see them: angles and travels, and turns and shifts of what is freer.

    pin, slide, cylinder     J.angle, J.travel
    line                     J.travel, and the turns J.x, J.y, J.z
    ball, universal          J.x, J.y, J.z       turn of `to` against `from` about the world's axes [rad]
    plane                    the same, and J.dx, J.dy, J.dz    shift of the `to` point against `from` [m]
    a body that no joint carries                 B.x ... B.dz  of the body and its centre
What a joint holds does not occur; of closed chains all joints are told, whichever of them the tree was cut at.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.motion.linearisation.linearise import Linearised
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.results.results import Array

AXES = ("x", "y", "z")
IN_PLANE = ("z", "dx", "dy")  # what is left in a scene that is declared planar


def coordinates(layout: Layout, found: Linearised) -> dict[str, Array]:
    """Of each coordinate what the undriven freedoms make of it, (n,)."""
    mechanism = layout.mechanism
    rows: dict[str, Array] = {}
    for joint in mechanism.joints:
        rows |= {f"{joint.name}.{name}": row for name, row in of_joint(layout, found, joint).items()}
    for k, hang in enumerate(layout.spanning.hangs):
        if hang.joint < 0:
            body = mechanism.bodies[hang.body].name
            rows |= dict(zip((f"{body}.{a}" for a in AXES), found.twists[k, :3], strict=True))
            rows |= dict(zip((f"{body}.d{a}" for a in AXES), found.twists[k, 3:], strict=True))
    if mechanism.planar:
        rows = {name: row for name, row in rows.items() if len(end := name.split(".")[1]) > 2 or end in IN_PLANE}
    return rows


def of_joint(layout: Layout, found: Linearised, joint: Joint) -> dict[str, Array]:
    """The coordinates of one joint."""
    kind = JOINTS[joint.kind]
    if kind.keeps_distance or kind.is_rigid:
        return {}
    to, end = twist(layout, found, joint.b, joint.q, None)
    carrier, _ = twist(layout, found, joint.a, joint.p, end)
    turn, shift = to[:3] - carrier[:3], to[3:] - carrier[3:]
    axis = joint.axis if joint.a == GROUND else found.attitudes[layout.place[joint.a]] @ joint.axis
    rows: dict[str, Array] = {}
    if "angle" in kind.coordinates:
        rows["angle"] = axis @ turn
    elif kind.ball_in_tree or kind.turns:
        rows |= dict(zip(AXES, turn, strict=True))
    if joint.path is not None:
        rows["travel"] = along_path(layout, joint, found, shift)
    elif len(kind.shifts) == 1:
        rows["travel"] = axis @ shift
    elif kind.shifts:
        rows |= dict(zip((f"d{a}" for a in AXES), shift, strict=True))
    return rows


def along_path(layout: Layout, joint: Joint, found: Linearised, shift: Array) -> Array:
    """Of the parameter of a path: a freedom of the tree, or r' . shift / |r'|^2, where it was cut."""
    k = next(k for k, own in enumerate(layout.mechanism.joints) if own.name == joint.name)
    if k in layout.counters:
        assert joint.path is not None
        slope = joint.path.at(float(found.state[layout.counters[k]]))[1]
        way = slope if joint.a == GROUND else found.attitudes[layout.place[joint.a]] @ slope
        return np.asarray(way @ shift / (slope @ slope))
    own = next(f for f in layout.freedoms if (f.joint, f.quantity) == (k, "travel"))
    places = places_of_rates(layout)
    return np.where(places[places >= 0] == own.u, 1.0, 0.0)


def twist(layout: Layout, found: Linearised, body: int, point: Array, at: Array | None) -> tuple[Array, Array]:
    """Turn and shift (6, n) of a body's point, or as its body carries a place of the world; and that place."""
    n = found.twists.shape[2]
    if body == GROUND:
        return np.zeros((6, n)), point if at is None else at
    k = layout.place[body]
    own = layout.mechanism.bodies[body]
    place = found.centres[k] + found.attitudes[k] @ (point - own.center) if at is None else at
    turn, shift = found.twists[k, :3], found.twists[k, 3:]
    return np.concatenate([turn, shift + np.cross(turn, place - found.centres[k], axis=0)]), place
