"""Compute the poses and rates of all bodies at given MuJoCo coordinates: at their zero, or in a keyframe.

S_B   attitude of a body against that at the zero: R_WB at the coordinates, times R_WB^T at the zero
S_C = S_P Rot(a, q - q0)         a hinge, a along the world's axes at the zero
S_C = S_P R_C0 R(q) R_C0^T       a ball, whose coordinates are a quaternion in the axes of the body
S_C = R(q) R_C0^T                a free body
sigma_C = sigma_P + S_C a q'     and likewise with the axes of a ball; of a free body in its own axes
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import rotation_about
from heuncli.scene.importers.attitudes import add_vectors
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.frames import BodyFrames, exact_rotation_from_quaternion, to_vec
from heuncli.scene.importers.mjcf.tree import FREE, GROUND, JointTree, TreeJoint


class BodyPose(NamedTuple):
    """S: attitude against that at the zero
    p: the origin [m]
    sigma: angular velocity [rad/s]
    v: velocity of the origin [m/s]
    """

    S: Any
    p: Any
    sigma: Any
    v: Any


AT_REST = BodyPose(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def compute_poses(c: CompiledModel, frames: BodyFrames, tree: JointTree, q: Any, qd: Any) -> dict[str, BodyPose]:
    """Compute the pose of each body of the spec, by its name."""
    pose_by_body = {GROUND: AT_REST}
    for step in tree.steps:
        pose_by_body[step.child] = _compute_child_pose(c, frames, step, pose_by_body[step.parent], q, qd)
    return pose_by_body


def joint_places(c: CompiledModel, frames: BodyFrames, step: TreeJoint) -> tuple[Vec, Vec]:
    """Return the place of a joint in its parent and in its child body, in axes parallel to the world's at zero [m].

    Bodies of the spec that represent the same body of MuJoCo share its origin.
    """
    model, body = c.model, step.body
    point = ZERO if step.joint is None else frames.transform_direction(body, model.jnt_pos[step.joint])
    first = step.joint is None or step.joint == int(model.body_jntadr[body])
    if not first:
        return point, point
    return add_vectors(frames.transform_point(int(model.body_parentid[body]), model.body_pos[body]), point), point


def _compute_child_pose(
    c: CompiledModel, frames: BodyFrames, step: TreeJoint, parent: BodyPose, q: Any, qd: Any
) -> BodyPose:
    model, R_C0 = c.model, np.array(frames.attitudes[step.body])
    parent_point, point = (np.array(place) for place in joint_places(c, frames, step))
    S, sigma, slid, speed = parent.S, parent.sigma, np.zeros(3), np.zeros(3)
    if step.joint is not None:
        q_index, rate_index = int(model.jnt_qposadr[step.joint]), int(model.jnt_dofadr[step.joint])
        axis = np.array(frames.transform_direction(step.body, model.jnt_axis[step.joint]))
        displacement = float(q[q_index]) - float(model.qpos0[q_index])
        if step.kind == FREE:
            S = np.array(exact_rotation_from_quaternion(q[q_index + 3 : q_index + 7])) @ R_C0.T
            return BodyPose(
                S,
                np.array(q[q_index : q_index + 3]),
                S @ R_C0 @ qd[rate_index + 3 : rate_index + 6],
                qd[rate_index : rate_index + 3],
            )
        if step.kind == "ball":
            S = parent.S @ R_C0 @ np.array(exact_rotation_from_quaternion(q[q_index : q_index + 4])) @ R_C0.T
            sigma = parent.sigma + S @ R_C0 @ qd[rate_index : rate_index + 3]
        elif step.kind == "pin":
            S = parent.S @ np.array(rotation_about(to_vec(axis), displacement))
            sigma = parent.sigma + S @ axis * qd[rate_index]
        else:
            slid, speed = S @ axis * displacement, S @ axis * qd[rate_index] + np.cross(sigma, S @ axis * displacement)
    p = parent.p + parent.S @ parent_point + slid - S @ point
    v = parent.v + np.cross(parent.sigma, parent.S @ parent_point) + speed - np.cross(sigma, S @ point)
    return BodyPose(S, p, sigma, v)
