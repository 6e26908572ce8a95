"""Give start poses to the bodies whose pose no drive and no law sets: free ones, those on balls, those placed by a
loop.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.attitudes import round_number, round_vector
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.frames import BodyFrames, to_vec
from heuncli.scene.importers.mjcf.holding import HeldJoints
from heuncli.scene.importers.mjcf.loop_closures import LoopClosures
from heuncli.scene.importers.mjcf.poses import BodyPose, compute_poses
from heuncli.scene.importers.mjcf.tree import COORDINATE_KEYS, FREE, GROUND, JointTree

DRAWN_TOLERANCE = 1e-15  # rotation against the drawn pose that is only rounding


class StartKeys(NamedTuple):
    """The start keys of a body, as in a spec, and remarks on them."""

    keys: dict[str, Any]
    notes: dict[str, str]


def find_starts(
    c: CompiledModel,
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
    all_poses = compute_poses(c, frames, tree, q, qd)
    drawn = compute_poses(c, frames, tree, c.model.qpos0, np.zeros(int(c.model.nv)))
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
    """Make the pose near which the assembly starts; empty if that is the drawn pose and joints place the body there.

    can_shift: a slide, or no joint at all, leaves the position open. Without `near` a spec would start at the origin.
    """
    attitude = _attitude_keys(pose)
    distance = float(np.abs(np.asarray(pose.p) - np.asarray(drawn_pose.p)).max())
    if not (can_shift or attitude or distance > DRAWN_TOLERANCE * float(np.abs(drawn_pose.p).max(initial=1.0))):
        return StartKeys({}, {})
    rates = bool(np.any(pose.v) or np.any(pose.sigma))
    notes = (
        {"near": "its start velocities follow from its constraints; without constraints it starts at rest"}
        if rates
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
