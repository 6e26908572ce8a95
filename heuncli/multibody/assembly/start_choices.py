"""Sentences on the start values that were chosen for the user (`heun model` lists them)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.assembly.rates import Moving, Rates
from heuncli.multibody.assembly.walk import AssemblyPoses, Tree
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import to_vector

LISTED = 8  # bodies listed one by one; more of the same are listed together

FORMS = {
    "position": "position {} m",
    "orientation": "orientation turned by {} deg",
    "velocity": "velocity of the centre {} m/s",
    "angular velocity": "angular velocity {} rad/s",
}
FITTED, FROM_JOINT = "fitted to the joints", "from joint"


class StartChoice(NamedTuple):
    """One start value: whose, which, how it came about; its value in the unit of FORMS where it is not the default.

    size: what the value's components are measured by, to leave out the dust of rounding.
    """

    body: str
    what: str
    how: str
    joint: str = ""
    value: Array | None = None
    size: float = 1.0


def chosen(choices: Iterable[StartChoice]) -> tuple[str, ...]:
    """One sentence a body and origin; where many bodies share one, they are listed together."""
    groups: dict[tuple[str, str], list[StartChoice]] = defaultdict(list)
    for c in choices:
        groups[c.what, c.how].append(c)
    single: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    together: list[str] = []
    for (what, how), members in groups.items():
        if len(members) > LISTED:
            names = ", ".join(c.body for c in members[:3])
            origin = "from the joints that lead to them" if how == FROM_JOINT else how
            together.append(f"{names} and {len(members) - 3:,} more: {what} {origin}")
            continue
        for c in members:
            text = what if c.value is None else FORMS[what].format(_vector(c.value, c.size))
            single[c.body, how, c.joint].append(text)
    sentences = []
    for (body, how, joint), said in single.items():
        if how in (FITTED, FROM_JOINT):
            sentences.append(f"{body}: {', '.join(said)}, {how} {joint}".rstrip())
        else:
            sentences.append(f"{body}: {' and '.join(said)} {how}")
    return (*sentences, *together)


def pose_choices(
    mechanism: Mechanism, drawn: AssemblyPoses, poses: AssemblyPoses, tree: Tree, fitted: set[int], size: float
) -> list[StartChoice]:
    """The positions and orientations that were left out."""
    moved = np.max(np.abs(poses.x - drawn.x), axis=1) > tolerances.UNMOVED * size
    turned = np.max(np.abs(poses.R - drawn.R), axis=(1, 2)) > tolerances.UNMOVED
    found = []
    for i, body in enumerate(mechanism.bodies):
        how, joint = _origin(mechanism, tree, i, fitted)
        if body.position is None:
            if moved[i]:
                found.append(StartChoice(body.name, "position", how, joint, poses.x[i], size))
            else:
                found.append(StartChoice(body.name, "position", _default(body.near_position)))
        if body.rotation is None:
            if turned[i]:
                turn = np.degrees(to_vector(poses.R[i] @ drawn.R[i].T))
                found.append(StartChoice(body.name, "orientation", how, joint, turn))
            else:
                found.append(StartChoice(body.name, "orientation", _default(body.near_rotation)))
    return found


def rate_choices(mechanism: Mechanism, rates: Rates, tree: Tree, fitted: set[int], size: float) -> list[StartChoice]:
    """The velocities (of the centre of mass) and angular velocities that were left out."""
    scale = float(np.max(np.abs(rates.v)) + size * np.max(np.abs(rates.w)))
    moving = np.max(np.abs(rates.v), axis=1) > tolerances.UNMOVED * scale
    turning = np.max(np.abs(rates.w), axis=1) * size > tolerances.UNMOVED * scale
    found = []
    for i, body in enumerate(mechanism.bodies):
        how, joint = _origin(mechanism, tree, i, fitted)
        if body.velocity is None:
            how_chosen = (how, joint, rates.v[i], scale) if moving[i] else ("zero",)
            found.append(StartChoice(body.name, "velocity", *how_chosen))
        if body.angular_velocity is None:
            how_chosen = (how, joint, rates.w[i], scale / size) if turning[i] else ("zero",)
            found.append(StartChoice(body.name, "angular velocity", *how_chosen))
    return found


def resting_centres(mechanism: Mechanism, moving: Moving) -> tuple[str, ...]:
    """Sentences on bodies that are given an angular velocity and no velocity: their centres rest, not their origins.

    Where a joint holds a point of the body, that decides, and nothing is told.
    """
    found = []
    for i, body in enumerate(mechanism.bodies):
        if body.angular_velocity is None or body.velocity is not None or i in moving.fitted:
            continue
        arm = moving.poses.R[i] @ body.center
        origin = np.cross(arm, moving.rates.w[i])  # past the centre
        joint = moving.tree.via[i]
        F = moving.rows[joint].F if joint >= 0 else np.zeros((0, 3))
        chosen_part = origin - F.T @ (F @ origin)
        if np.abs(chosen_part).max() > tolerances.UNMOVED * moving.size * np.abs(moving.rates.w[i]).max():
            where = f" as far as joint {mechanism.joints[joint].name} lets it" if joint >= 0 else ""
            velocity = _vector(moving.rates.v[i] + origin, float(np.abs(origin).max()))
            found.append(
                f"{body.name} has an angular_velocity and no velocity: its centre of mass starts at rest{where}, "
                f"its origin at {velocity} m/s"
            )
    return tuple(found)


def _origin(mechanism: Mechanism, tree: Tree, body: int, fitted: set[int]) -> tuple[str, str]:
    if body in fitted or tree.via[body] < 0:
        return FITTED, ""
    return FROM_JOINT, mechanism.joints[tree.via[body]].name


def _default(near: Array | None) -> str:
    return "as drawn" if near is None else "as near says"


def _vector(a: Array, size: float) -> str:
    return "(" + ", ".join(f"{v:.6g}" for v in np.where(np.abs(a) < tolerances.DUST * size, 0.0, a).tolist()) + ")"
