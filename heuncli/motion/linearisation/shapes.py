"""Express displacements by joint coordinates: angles and travels, and rotations and shifts where joints leave more
free.

    pin, slide, cylinder     J.angle, J.travel
    line                     J.travel, and the rotations J.x, J.y, J.z
    ball, universal          J.x, J.y, J.z       rotation of `to` against `from` about the world's axes [rad]
    plane                    the same, and J.dx, J.dy, J.dz    shift of the `to` point against `from` [m]
    a body without a joint                   B.x ... B.dz  of the body and its centre

What a joint holds is left out. In closed chains all joints are included, wherever the tree was cut.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.results.results import Array

AXES = ("x", "y", "z")
IN_PLANE = ("z", "dx", "dy")  # what is left in a scene that is declared planar


def coordinate_rows(layout: Layout, linear: LinearisedEquations) -> dict[str, Array]:
    """Return for each coordinate its row on the undriven freedoms, (n,)."""
    mechanism = layout.mechanism
    rows: dict[str, Array] = {}
    for joint in mechanism.joints:
        rows |= {f"{joint.name}.{name}": row for name, row in joint_rows(layout, linear, joint).items()}
    for k, link in enumerate(layout.spanning.links):
        if link.joint < 0:
            body = mechanism.bodies[link.body].name
            rows |= dict(zip((f"{body}.{a}" for a in AXES), linear.twists[k, :3], strict=True))
            rows |= dict(zip((f"{body}.d{a}" for a in AXES), linear.twists[k, 3:], strict=True))
    if mechanism.planar:
        rows = {name: row for name, row in rows.items() if len(end := name.split(".")[1]) > 2 or end in IN_PLANE}
    return rows


def joint_rows(layout: Layout, linear: LinearisedEquations, joint: Joint) -> dict[str, Array]:
    """Return the rows of one joint's coordinates."""
    kind = JOINTS[joint.kind]
    if kind.keeps_distance or kind.is_rigid:
        return {}
    to_twist, end = point_twist(layout, linear, joint.b, joint.q, None)
    carrier, _ = point_twist(layout, linear, joint.a, joint.p, end)
    turn, shift = to_twist[:3] - carrier[:3], to_twist[3:] - carrier[3:]
    axis = joint.axis if joint.a == GROUND else linear.attitudes[layout.place[joint.a]] @ joint.axis
    rows: dict[str, Array] = {}
    if "angle" in kind.coordinates:
        rows["angle"] = axis @ turn
    elif kind.is_ball_in_tree or kind.turns:
        rows |= dict(zip(AXES, turn, strict=True))
    if joint.path is not None:
        rows["travel"] = path_row(layout, joint, linear, shift)
    elif len(kind.shifts) == 1:
        rows["travel"] = axis @ shift
    elif kind.shifts:
        rows |= dict(zip((f"d{a}" for a in AXES), shift, strict=True))
    return rows


def path_row(layout: Layout, joint: Joint, linear: LinearisedEquations, shift: Array) -> Array:
    """Return the row of a path's parameter: a freedom of the tree or, where it was cut, r' . shift / |r'|^2."""
    k = next(k for k, freedom in enumerate(layout.mechanism.joints) if freedom.name == joint.name)
    if k in layout.counters:
        assert joint.path is not None
        slope = joint.path.evaluate(float(linear.state[layout.counters[k]]))[1]
        direction = slope if joint.a == GROUND else linear.attitudes[layout.place[joint.a]] @ slope
        return np.asarray(direction @ shift / (slope @ slope))
    freedom = next(f for f in layout.freedoms if (f.joint, f.quantity) == (k, "travel"))
    places = rate_indices(layout)
    return np.where(places[places >= 0] == freedom.u, 1.0, 0.0)


def point_twist(
    layout: Layout, linear: LinearisedEquations, body: int, point: Array, world_place: Array | None
) -> tuple[Array, Array]:
    """Return rotation and shift (6, n) of a body's point, or of the body's material at a world position, and that
    position.
    """
    n = linear.twists.shape[2]
    if body == GROUND:
        return np.zeros((6, n)), point if world_place is None else world_place
    k = layout.place[body]
    body_data = layout.mechanism.bodies[body]
    place = linear.centres[k] + linear.attitudes[k] @ (point - body_data.center) if world_place is None else world_place
    turn, shift = linear.twists[k, :3], linear.twists[k, 3:]
    return np.concatenate([turn, shift + np.cross(turn, place - linear.centres[k], axis=0)]), place
