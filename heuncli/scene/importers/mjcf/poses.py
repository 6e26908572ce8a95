"""Where all bodies stand and how they move at given coordinates of MuJoCo's: at its zero, or in a keyframe.

S_B   attitude of a body against that at the zero: R_WB at the coordinates, times R_WB^T at the zero
S_C = S_P Rot(a, q - q0)         a hinge, a along the world's axes at the zero
S_C = S_P R_C0 R(q) R_C0^T       a ball, whose coordinates are a quaternion in the axes of the body
S_C = R(q) R_C0^T                a free body
sigma_C = sigma_P + S_C a q'     and so with the axes of a ball; of a free body in its own axes
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.turns import about
from heuncli.scene.importers.attitudes import shifted
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.frames import BodyFrames, rotation, vec
from heuncli.scene.importers.mjcf.tree import FREE, GROUND, JointTree, TreeStep


class BodyPose(NamedTuple):
    """S: attitude against that at the zero; p: the origin [m]; sigma: angular velocity; v: velocity of the origin."""

    S: Any
    p: Any
    sigma: Any
    v: Any


AT_REST = BodyPose(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def poses(c: Compiled, frames: BodyFrames, tree: JointTree, q: Any, qd: Any) -> dict[str, BodyPose]:
    """The pose of each body of the spec, by its name."""
    made = {GROUND: AT_REST}
    for step in tree.steps:
        made[step.child] = _next(c, frames, step, made[step.parent], q, qd)
    return made


def sides(c: Compiled, frames: BodyFrames, step: TreeStep) -> tuple[Vec, Vec]:
    """The place of a joint in the bodies before and behind it, axes along the world's at the zero [m].

    Bodies that stand for the same one of MuJoCo's have their origins in common.
    """
    model, body = c.model, step.body
    point = ZERO if step.joint is None else frames.direction(body, model.jnt_pos[step.joint])
    first = step.joint is None or step.joint == int(model.body_jntadr[body])
    if not first:
        return point, point
    return shifted(frames.place(int(model.body_parentid[body]), model.body_pos[body]), point), point


def _next(c: Compiled, frames: BodyFrames, step: TreeStep, before: BodyPose, q: Any, qd: Any) -> BodyPose:
    model, R_C0 = c.model, np.array(frames.attitudes[step.body])
    before_point, point = (np.array(place) for place in sides(c, frames, step))
    S, sigma, slid, speed = before.S, before.sigma, np.zeros(3), np.zeros(3)
    if step.joint is not None:
        at, rate_at = int(model.jnt_qposadr[step.joint]), int(model.jnt_dofadr[step.joint])
        axis = np.array(frames.direction(step.body, model.jnt_axis[step.joint]))
        moved = float(q[at]) - float(model.qpos0[at])
        if step.kind == FREE:
            S = np.array(rotation(q[at + 3 : at + 7])) @ R_C0.T
            return BodyPose(
                S, np.array(q[at : at + 3]), S @ R_C0 @ qd[rate_at + 3 : rate_at + 6], qd[rate_at : rate_at + 3]
            )
        if step.kind == "ball":
            S = before.S @ R_C0 @ np.array(rotation(q[at : at + 4])) @ R_C0.T
            sigma = before.sigma + S @ R_C0 @ qd[rate_at : rate_at + 3]
        elif step.kind == "pin":
            S = before.S @ np.array(about(vec(axis), moved))
            sigma = before.sigma + S @ axis * qd[rate_at]
        else:
            slid, speed = S @ axis * moved, S @ axis * qd[rate_at] + np.cross(sigma, S @ axis * moved)
    p = before.p + before.S @ before_point + slid - S @ point
    v = before.v + np.cross(before.sigma, before.S @ before_point) + speed - np.cross(sigma, S @ point)
    return BodyPose(S, p, sigma, v)
