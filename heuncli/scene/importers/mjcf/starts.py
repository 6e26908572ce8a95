"""Where bodies start: which joints drives hold, the poses at given coordinates, and start poses for the rest.

Start poses are given to the bodies whose pose no drive and no law sets: free ones, those on balls, those placed by a
loop. Poses and rates follow from MuJoCo's coordinates, at their zero or in a keyframe:

S_B   attitude of a body against that at the zero: R_WB at the coordinates, times R_WB^T at the zero
S_C = S_P Rot(a, q - q0)         a hinge, a along the world's axes at the zero
S_C = S_P R_C0 R(q) R_C0^T       a ball, whose coordinates are a quaternion in the axes of the body
S_C = R(q) R_C0^T                a free body
sigma_C = sigma_P + S_C a q'     and likewise with the axes of a ball; of a free body in its own axes

q (nq,) and qd (nv,) are MuJoCo's coordinates and rates everywhere in these modules: a ball has four and three of them.

Drives hold joints so that no coordinate stays free and none is held twice. In a tree these are all hinges and slides.
Where equalities close loops, some coordinates follow from others. Then a joint is held if the equalities and the joints
chosen before it leave its rate free,

    rank [J; e_1; ...; e_k; e] > rank [J; e_1; ...; e_k]      J: rows of the equalities, e_i q' the rate of joint i

Joints that lead others come first, because the drives of the others need their parameter; then joints with an actuator.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from heuncli.base.linear_algebra import count_rank
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import rotation_about
from heuncli.scene.importers.attitudes import add_vectors, round_number, round_vector
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.loop_closures import JointEquality, LoopClosures
from heuncli.scene.importers.mjcf.tree import (
    COORDINATE_KEYS,
    FREE,
    GROUND,
    BodyFrames,
    JointTree,
    TreeJoint,
    make_exact_rotation,
    to_vec,
)

# Poses


class BodyPose(NamedTuple):
    """The pose and the motion of a body, in the world.

    S: attitude against that at the zero
    p: the origin [m]
    sigma: angular velocity [rad/s]
    v: velocity of the origin [m/s]
    """

    S: Any
    p: Any
    sigma: Any
    v: Any


AT_REST = BodyPose(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def compute_poses(compiled: CompiledModel, frames: BodyFrames, tree: JointTree, q: Any, qd: Any) -> dict[str, BodyPose]:
    """Compute the pose of each body of the spec, by its name."""
    pose_by_body = {GROUND: AT_REST}
    for step in tree.steps:
        pose_by_body[step.child] = _compute_child_pose(compiled, frames, step, pose_by_body[step.parent], q, qd)
    return pose_by_body


def find_joint_places(compiled: CompiledModel, frames: BodyFrames, step: TreeJoint) -> tuple[Vec, Vec]:
    """Return the place of a joint in its parent and in its child body, in axes parallel to the world's at zero [m].

    Bodies of the spec that represent the same body of MuJoCo share its origin.
    """
    model, body = compiled.model, step.body
    point = ZERO if step.joint is None else frames.transform_direction(body, model.jnt_pos[step.joint])
    first = step.joint is None or step.joint == int(model.body_jntadr[body])
    if not first:
        return point, point
    return add_vectors(frames.transform_point(int(model.body_parentid[body]), model.body_pos[body]), point), point


def _compute_child_pose(
    compiled: CompiledModel, frames: BodyFrames, step: TreeJoint, parent: BodyPose, q: Any, qd: Any
) -> BodyPose:
    model, R_C0 = compiled.model, np.array(frames.attitudes[step.body])
    parent_point, point = (np.array(place) for place in find_joint_places(compiled, frames, step))
    S, sigma, slid, speed = parent.S, parent.sigma, np.zeros(3), np.zeros(3)
    if step.joint is not None:
        q_index, rate_index = int(model.jnt_qposadr[step.joint]), int(model.jnt_dofadr[step.joint])
        axis = np.array(frames.transform_direction(step.body, model.jnt_axis[step.joint]))
        displacement = float(q[q_index]) - float(model.qpos0[q_index])
        if step.kind == FREE:
            S = np.array(make_exact_rotation(q[q_index + 3 : q_index + 7])) @ R_C0.T
            return BodyPose(
                S,
                np.array(q[q_index : q_index + 3]),
                S @ R_C0 @ qd[rate_index + 3 : rate_index + 6],
                qd[rate_index : rate_index + 3],
            )
        if step.kind == "ball":
            S = parent.S @ R_C0 @ np.array(make_exact_rotation(q[q_index : q_index + 4])) @ R_C0.T
            sigma = parent.sigma + S @ R_C0 @ qd[rate_index : rate_index + 3]
        elif step.kind == "pin":
            S = parent.S @ np.array(rotation_about(to_vec(axis), displacement))
            sigma = parent.sigma + S @ axis * qd[rate_index]
        else:
            slid, speed = S @ axis * displacement, S @ axis * qd[rate_index] + np.cross(sigma, S @ axis * displacement)
    p = parent.p + parent.S @ parent_point + slid - S @ point
    v = parent.v + np.cross(parent.sigma, parent.S @ parent_point) + speed - np.cross(sigma, S @ point)
    return BodyPose(S, p, sigma, v)


# Holding

# Least part of a unit rate that is independent of the others; the most independent rates are chosen first.
INDEPENDENCE_THRESHOLDS = (0.1, 1e-3, 1e-6)


class HeldJoints(NamedTuple):
    """What determines the coordinates of all joints.

    joints: numbers of the joints that drives hold, in MuJoCo's order
    couplings: the couplings that determine other joints
    """

    joints: tuple[int, ...]
    couplings: tuple[JointEquality, ...]


def choose_held_joints(compiled: CompiledModel, tree: JointTree, closures: LoopClosures, q: Any) -> HeldJoints:
    """Choose the held joints. A coupling is dropped if nothing holds its leader; its joint is then treated as any
    other.
    """
    couplings = [*closures.couplings]
    while True:
        joints = _choose_for_couplings(compiled, tree, closures, couplings, q)
        without_leader = _find_coupling_without_leader(couplings, joints)
        if without_leader is None:
            return HeldJoints(joints, tuple(couplings))
        couplings.remove(without_leader)


def _choose_for_couplings(
    compiled: CompiledModel, tree: JointTree, closures: LoopClosures, couplings: list[JointEquality], q: Any
) -> tuple[int, ...]:
    followers = {coupling.follower for coupling in couplings}
    movable = [joint for joint, step in tree.step_by_joint.items() if step.kind in COORDINATE_KEYS]
    joints = [joint for joint in movable if joint not in followers]
    if not closures.imported_equalities:
        return tuple(joints)
    leaders = {coupling.leader for coupling in couplings}
    actuated = set(_actuated_joints(compiled))
    order = sorted(joints, key=lambda joint: (joint not in leaders, joint not in actuated))
    dofs = [int(compiled.model.jnt_dofadr[joint]) for joint in order]
    imported_equalities = closures.imported_equalities | {coupling.equality for coupling in couplings}
    return tuple(sorted(order[k] for k in _iter_independent(_equality_rows(compiled, imported_equalities, q), dofs)))


def _find_coupling_without_leader(couplings: list[JointEquality], joints: tuple[int, ...]) -> JointEquality | None:
    """Find the first coupling that leads back to no held joint; None if all do."""
    determined: set[int | None] = {None, *joints}
    remaining = couplings
    while remaining:
        still_remaining = [coupling for coupling in remaining if coupling.leader not in determined]
        if len(still_remaining) == len(remaining):
            return still_remaining[0]
        determined |= {coupling.follower for coupling in remaining if coupling.leader in determined}
        remaining = still_remaining
    return None


def _actuated_joints(compiled: CompiledModel) -> Iterator[int]:
    """Yield the joints that an actuator moves."""
    kinds = [int(compiled.mujoco.mjtTrn.__members__[word]) for word in ("mjTRN_JOINT", "mjTRN_JOINTINPARENT")]
    for number in range(int(compiled.model.nu)):
        if int(compiled.model.actuator_trntype[number]) in kinds:
            yield int(compiled.model.actuator_trnid[number][0])


def _equality_rows(compiled: CompiledModel, equalities: frozenset[int], q: Any) -> Any:
    """Compute the constraint rows (rows, rates) of the equalities that the spec holds."""
    mujoco, model = compiled.mujoco, compiled.model
    data = mujoco.MjData(model)
    data.qpos[:] = q
    previous = int(model.opt.jacobian)
    model.opt.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
    try:
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_tendon(model, data)
        mujoco.mj_makeConstraint(model, data)
    finally:
        model.opt.jacobian = previous
    J = np.array(data.efc_J).reshape(-1, int(model.nv))[: int(data.ne)]
    return J[[int(number) in equalities for number in np.array(data.efc_id)[: len(J)]]]


def _iter_independent(J: Any, dofs: Iterable[int]) -> Iterator[int]:
    """Yield the indices in `dofs` of the rates that the rows and the rates before them leave free."""
    sizes = np.linalg.norm(J, axis=1)
    rows = J[sizes > 0.0] / sizes[sizes > 0.0, None]
    _, s, V = np.linalg.svd(rows, full_matrices=False) if len(rows) else (0, np.zeros(0), rows)
    base = V[: count_rank(s, INDEPENDENCE_THRESHOLDS[-1])]
    remaining = dict(enumerate(dofs))
    for threshold in INDEPENDENCE_THRESHOLDS:
        for index, dof in list(remaining.items()):
            residual = -base.T @ base[:, dof]
            residual[dof] += 1.0
            residual -= base.T @ (base @ residual)
            size = np.linalg.norm(residual)
            if size > threshold:
                yield index
                base = np.vstack([base, residual / size])
                del remaining[index]


# Starts

DRAWN_TOLERANCE = 1e-15  # rotation against the drawn pose that is only rounding


class StartKeys(NamedTuple):
    """The start keys of a body, as in a spec, and remarks on them."""

    keys: dict[str, Any]
    notes: dict[str, str]


def find_starts(
    compiled: CompiledModel,
    tree: JointTree,
    closures: LoopClosures,
    held_joints: HeldJoints,
    frames: BodyFrames,
    q: Any,
    qd: Any,
) -> dict[str, StartKeys]:
    """Find the start keys of the bodies that need them.

    The attitude of a body on a ball is given; a body that a loop places starts the assembly near its pose. A free body
    starts at its pose with its rates, unless an equality holds it: then the equality places it, in any pose of the held
    joints.
    """
    starts: dict[str, StartKeys] = {}
    driven = {*held_joints.joints, *(coupling.follower for coupling in held_joints.couplings)}
    all_poses = compute_poses(compiled, frames, tree, q, qd)
    drawn = compute_poses(compiled, frames, tree, compiled.model.qpos0, np.zeros(int(compiled.model.nv)))
    tied = _find_tied_bodies(tree, closures)
    for step in tree.steps:
        pose = all_poses[step.child]
        if step.kind == FREE and step.child not in tied:
            keys = {
                "position": round_vector(to_vec(pose.p)),
                **_attitude_keys(pose),
                **_rate_keys(pose, "velocity", "angular_velocity"),
            }
        elif step.kind == "ball" and not closures.imported_equalities:
            keys = {**_attitude_keys(pose), **_rate_keys(pose, "angular_velocity")}
        elif step.kind in {"ball", FREE} or (step.kind in COORDINATE_KEYS and step.joint not in driven):
            starts[step.child] = _make_near_start(pose, drawn[step.child], step.kind in {FREE, "slide"})
            continue
        else:
            continue
        starts[step.child] = StartKeys(keys, {})
    return starts


def _find_tied_bodies(tree: JointTree, closures: LoopClosures) -> set[str]:
    """Find the free bodies that an equality ties to a body that does not move with them."""
    root = {GROUND: GROUND}
    for step in tree.steps:
        root[step.child] = step.child if step.kind == FREE else root[step.parent]
    ends = [[root[str(joint.keys[end]).partition(".")[0]] for end in ("from", "to")] for joint in closures.joints]
    return {one for pair in ends if pair[0] != pair[1] for one in pair}


def _make_near_start(pose: BodyPose, drawn_pose: BodyPose, can_shift: bool) -> StartKeys:
    """Make the pose near which the assembly starts; empty if that is the drawn pose, joints place the body there, and
    it is at rest.

    can_shift: a slide, or no joint at all, leaves the position open. Without `near` a spec would start at the origin.
    """
    attitude = _attitude_keys(pose)
    distance = float(np.abs(np.asarray(pose.p) - np.asarray(drawn_pose.p)).max())
    has_rates = bool(np.any(pose.v) or np.any(pose.sigma))
    is_moved = distance > DRAWN_TOLERANCE * float(np.abs(drawn_pose.p).max(initial=1.0))
    if not (can_shift or attitude or is_moved or has_rates):
        return StartKeys({}, {})
    notes = (
        {"near": "its start velocities follow from its constraints; without constraints it starts at rest"}
        if has_rates
        else {}
    )
    return StartKeys({"near": {"position": round_vector(to_vec(pose.p)), **attitude}}, notes)


def _attitude_keys(pose: BodyPose) -> dict[str, Any]:
    S = np.asarray(pose.S)
    if np.abs(S - np.eye(3)).max() <= DRAWN_TOLERANCE:
        return {}
    rows = tuple(tuple(round_number(float(x), 1.0) for x in row) for row in S)
    return {"orientation": {"matrix": rows}}


def _rate_keys(pose: BodyPose, *names: str) -> dict[str, Any]:
    values = {"velocity": pose.v, "angular_velocity": pose.sigma}
    return {name: round_vector(to_vec(values[name])) for name in names if np.any(values[name])}
