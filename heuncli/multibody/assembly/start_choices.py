"""Sentences on the start values that heun has chosen (`heun model` lists them)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.assembly.rates import RateAssembly, Rates
from heuncli.multibody.assembly.walk import AssemblyPoses, PlacementTree
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import vector_from_rotation

MAX_LISTED = 8  # bodies listed one by one; more of the same are listed together

FORMS = {
    "position": "position {} m",
    "orientation": "orientation rotated by {} deg",
    "velocity": "velocity of the centre of mass {} m/s",
    "angular velocity": "angular velocity {} rad/s",
}
FITTED, FROM_JOINT = "adjusted to satisfy the joints", "from joint"


class StartChoice(NamedTuple):
    """One start value: body, quantity, how it was chosen, and its value in the unit of FORMS where it is not the
    default.

    size: the scale below which components of the value are rounding
    """

    body: str
    what: str
    how: str
    joint: str = ""
    value: Array | None = None
    size: float = 1.0


def format_choices(choices: Iterable[StartChoice]) -> tuple[str, ...]:
    """Return one sentence per body and origin; if many bodies share one, they are listed together."""
    groups: dict[tuple[str, str], list[StartChoice]] = defaultdict(list)
    for c in choices:
        groups[c.what, c.how].append(c)
    single: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    group_sentences: list[str] = []
    for (what, how), members in groups.items():
        if len(members) > MAX_LISTED:
            names = ", ".join(c.body for c in members[:3])
            origin = "from the joints that connect them" if how == FROM_JOINT else how
            group_sentences.append(f"{names} and {len(members) - 3:,} more: {what} {origin}")
            continue
        for c in members:
            text = what if c.value is None else FORMS[what].format(_format_vector(c.value, c.size))
            single[c.body, how, c.joint].append(text)
    sentences = []
    for (body, how, joint), texts in single.items():
        if how in (FITTED, FROM_JOINT):
            sentences.append(f"{body}: {', '.join(texts)}, {how} {joint}".rstrip())
        else:
            sentences.append(f"{body}: {' and '.join(texts)} {how}")
    return (*sentences, *group_sentences)


def find_pose_choices(
    mechanism: Mechanism,
    drawn_poses: AssemblyPoses,
    poses: AssemblyPoses,
    tree: PlacementTree,
    fitted_bodies: set[int],
    size: float,
) -> list[StartChoice]:
    """Return the choices of positions and orientations that were not given."""
    is_moved = np.max(np.abs(poses.x - drawn_poses.x), axis=1) > tolerances.UNMOVED * size
    is_turned = np.max(np.abs(poses.R - drawn_poses.R), axis=(1, 2)) > tolerances.UNMOVED
    choices = []
    for i, body in enumerate(mechanism.bodies):
        how, joint = _choice_origin(mechanism, tree, i, fitted_bodies)
        if body.position is None:
            if is_moved[i]:
                choices.append(StartChoice(body.name, "position", how, joint, poses.x[i], size))
            else:
                choices.append(StartChoice(body.name, "position", _default_origin(body.near_position)))
        if body.rotation is None:
            if is_turned[i]:
                turn = np.degrees(vector_from_rotation(poses.R[i] @ drawn_poses.R[i].T))
                choices.append(StartChoice(body.name, "orientation", how, joint, turn))
            else:
                choices.append(StartChoice(body.name, "orientation", _default_origin(body.near_rotation)))
    return choices


def find_rate_choices(
    mechanism: Mechanism, rates: Rates, tree: PlacementTree, fitted_bodies: set[int], size: float
) -> list[StartChoice]:
    """Return the choices of velocities (of the centre of mass) and angular velocities that were not given."""
    scale = float(np.max(np.abs(rates.v)) + size * np.max(np.abs(rates.w)))
    is_moving = np.max(np.abs(rates.v), axis=1) > tolerances.UNMOVED * scale
    is_turning = np.max(np.abs(rates.w), axis=1) * size > tolerances.UNMOVED * scale
    choices = []
    for i, body in enumerate(mechanism.bodies):
        how, joint = _choice_origin(mechanism, tree, i, fitted_bodies)
        if body.velocity is None:
            how_chosen = (how, joint, rates.v[i], scale) if is_moving[i] else ("zero",)
            choices.append(StartChoice(body.name, "velocity", *how_chosen))
        if body.angular_velocity is None:
            how_chosen = (how, joint, rates.w[i], scale / size) if is_turning[i] else ("zero",)
            choices.append(StartChoice(body.name, "angular velocity", *how_chosen))
    return choices


def describe_resting_centres(mechanism: Mechanism, assembly: RateAssembly) -> tuple[str, ...]:
    """Return sentences on bodies with an angular velocity but no velocity: their centres rest, not their origins.

    Where a joint holds a point of the body, that decides, and there is no sentence.
    """
    sentences = []
    for i, body in enumerate(mechanism.bodies):
        if body.angular_velocity is None or body.velocity is not None or i in assembly.fitted:
            continue
        arm = assembly.poses.R[i] @ body.center
        origin = np.cross(arm, assembly.rates.w[i])  # past the centre
        joint = assembly.tree.tree_joint[i]
        F = assembly.rows[joint].F if joint >= 0 else np.zeros((0, 3))
        chosen_part = origin - F.T @ (F @ origin)
        if np.abs(chosen_part).max() > tolerances.UNMOVED * assembly.size * np.abs(assembly.rates.w[i]).max():
            where = f" as far as joint {mechanism.joints[joint].name} allows" if joint >= 0 else ""
            velocity = _format_vector(assembly.rates.v[i] + origin, float(np.abs(origin).max()))
            sentences.append(
                f"{body.name} has an angular_velocity but no velocity: its centre of mass starts at rest{where}, "
                f"its origin at {velocity} m/s"
            )
    return tuple(sentences)


def _choice_origin(mechanism: Mechanism, tree: PlacementTree, body: int, fitted_bodies: set[int]) -> tuple[str, str]:
    if body in fitted_bodies or tree.tree_joint[body] < 0:
        return FITTED, ""
    return FROM_JOINT, mechanism.joints[tree.tree_joint[body]].name


def _default_origin(near_value: Array | None) -> str:
    return "of the world frame (default)" if near_value is None else "from `near`"


def _format_vector(a: Array, size: float) -> str:
    return (
        "("
        + ", ".join(f"{v:.6g}" for v in np.where(np.abs(a) < tolerances.PRINTED_COMPONENT * size, 0.0, a).tolist())
        + ")"
    )
