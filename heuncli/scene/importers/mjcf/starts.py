"""Where bodies start whose pose no drive and no law decides: free ones, those on balls, those that a loop places."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.attitudes import digits, kept
from heuncli.scene.importers.mjcf.closings import Closings
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.frames import BodyFrames, vec
from heuncli.scene.importers.mjcf.holding import HeldJoints
from heuncli.scene.importers.mjcf.poses import BodyPose, poses
from heuncli.scene.importers.mjcf.tree import COORDINATE, FREE, GROUND, JointTree

DRAWN = 1e-15  # of a turn against the drawing: rounding


class StartKeys(NamedTuple):
    """Keys of a body, as a spec has them, and remarks beside them."""

    keys: dict[str, Any]
    notes: dict[str, str]


def starts_of(
    c: Compiled, tree: JointTree, closings: Closings, held: HeldJoints, frames: BodyFrames, q: Any, qd: Any
) -> dict[str, StartKeys]:
    """The starts of those bodies that need one: a ball's attitude is held, what a loop places begins near its pose.

    What floats starts where it is, with its rates; but if an equality holds it, that places it: in any pose of the
    joints that are held.
    """
    starts: dict[str, StartKeys] = {}
    moved = {*held.joints, *(coupling.slave for coupling in held.followed)}
    all_poses = poses(c, frames, tree, q, qd)
    drawn = poses(c, frames, tree, c.model.qpos0, np.zeros(int(c.model.nv)))
    tied = _tied(tree, closings)
    for step in tree.steps:
        pose = all_poses[step.child]
        if step.kind == FREE and step.child not in tied:
            keys = {"position": kept(vec(pose.p)), **_attitude(pose), **_rates(pose, "velocity", "angular_velocity")}
        elif step.kind == "ball" and not closings.carried:
            keys = {**_attitude(pose), **_rates(pose, "angular_velocity")}
        elif step.kind in {"ball", FREE} or (step.kind in COORDINATE and step.joint not in moved):
            starts[step.child] = _near(pose, drawn[step.child], step.kind in {FREE, "slide"})
            continue
        else:
            continue
        starts[step.child] = StartKeys(keys, {})
    return starts


def _tied(tree: JointTree, closings: Closings) -> set[str]:
    """The bodies that float on a freejoint and that an equality ties to what does not float with them."""
    root = {GROUND: GROUND}
    for step in tree.steps:
        root[step.child] = step.child if step.kind == FREE else root[step.parent]
    ends = [[root[str(joint.keys[end]).partition(".")[0]] for end in ("from", "to")] for joint in closings.joints]
    return {one for pair in ends if pair[0] != pair[1] for one in pair}


def _near(pose: BodyPose, drawn: BodyPose, shifts: bool) -> StartKeys:
    """The pose from which the assembly starts to look; nothing where that is the drawing, and joints place it there.

    shifts: a slide, or no joint at all, leaves open where it is; a spec without `near` would begin at the origin.
    """
    attitude = _attitude(pose)
    way = float(np.abs(np.asarray(pose.p) - np.asarray(drawn.p)).max())
    if not (shifts or attitude or way > DRAWN * float(np.abs(drawn.p).max(initial=1.0))):
        return StartKeys({}, {})
    rates = bool(np.any(pose.v) or np.any(pose.sigma))
    notes = {"near": "its rates follow from what holds it, else it starts at rest"} if rates else {}
    return StartKeys({"near": {"position": kept(vec(pose.p)), **attitude}}, notes)


def _attitude(pose: BodyPose) -> dict[str, Any]:
    S = np.asarray(pose.S)
    if np.abs(S - np.eye(3)).max() <= DRAWN:
        return {}
    rows = tuple(tuple(digits(float(x), 1.0) for x in row) for row in S)
    return {"orientation": {"matrix": rows}}


def _rates(pose: BodyPose, *names: str) -> dict[str, Any]:
    values = {"velocity": pose.v, "angular_velocity": pose.sigma}
    return {name: kept(vec(values[name])) for name in names if np.any(values[name])}
