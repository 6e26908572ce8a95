"""Where bodies start whose pose no drive and no law decides: free ones, those on balls, those that a loop places."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.conversion.attitudes import digits, kept
from heuncli.conversion.mjcf.closings import Closings
from heuncli.conversion.mjcf.compiled import Compiled
from heuncli.conversion.mjcf.frames import vec
from heuncli.conversion.mjcf.poses import BodyPose
from heuncli.conversion.mjcf.tree import COORDINATE, FREE, JointTree
from heuncli.named_tuples import NamedTuple

DRAWN = 1e-15  # of a turn against the drawing: rounding


class StartKeys(NamedTuple):
    """Keys of a body, as a spec has them, and remarks beside them."""

    keys: dict[str, Any]
    notes: dict[str, str]


def starts_of(
    c: Compiled, tree: JointTree, closings: Closings, held: tuple[int, ...], all_poses: dict[str, BodyPose]
) -> dict[str, StartKeys]:
    """The starts of those bodies that need one: a ball's attitude is held, what a loop places begins near its pose."""
    starts: dict[str, StartKeys] = {}
    followers = {coupling.slave for coupling in closings.couplings}
    for step in tree.steps:
        pose = all_poses[step.child]
        if step.kind == FREE:
            keys = {"position": kept(vec(pose.p)), **_attitude(pose), **_rates(pose, "velocity", "angular_velocity")}
        elif step.kind == "ball":
            keys = {**_attitude(pose), **_rates(pose, "angular_velocity")}
            if closings.carried:
                keys = {"near": near} if (near := _near(pose)) else {}
        elif step.kind in COORDINATE and step.joint not in held and step.joint not in followers:
            keys = {"near": near} if (near := _near(pose)) else {}
        else:
            continue
        starts[step.child] = StartKeys(keys, {})
    return starts


def _near(pose: BodyPose) -> dict[str, Any]:
    """The pose from which the assembly starts to look; nothing where that is the drawing."""
    attitude = _attitude(pose)
    return {"position": kept(vec(pose.p)), **attitude} if attitude else {}


def _attitude(pose: BodyPose) -> dict[str, Any]:
    S = np.asarray(pose.S)
    if np.abs(S - np.eye(3)).max() <= DRAWN:
        return {}
    rows = tuple(tuple(digits(float(x), 1.0) for x in row) for row in S)
    return {"orientation": {"matrix": rows}}


def _rates(pose: BodyPose, *names: str) -> dict[str, Any]:
    values = {"velocity": pose.v, "angular_velocity": pose.sigma}
    return {name: kept(vec(values[name])) for name in names if np.any(values[name])}
