"""Compute poses and rates at the start that satisfy all joints (manual/format.md, "Where bodies start").

A note says which bodies had to leave their place in the drawing for the joints to close, and how far. A body has such a
place where `near` gives one, or where the scene is drawn in world coordinates: then most joints close
as drawn, and no held or driven coordinate needs another pose. Other bodies are placed, not moved.

One-sided joints have conditions of their own: slack ropes, bodies that leave their path, rods free between limits. A
rope shorter than the distance of its points as assembled without it acts as a rod; a longer one is slack and sets no
condition; one that just reaches, or whose length is not given, is taut: it keeps its rate where the held velocities
allow it. Where they do not, an impact occurs at once, or it goes slack.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import JointCondition, JointConstraint, joint_conditions, mean_arm
from heuncli.multibody.assembly.poses import PoseAssembly
from heuncli.multibody.assembly.rates import RateAssembly
from heuncli.multibody.assembly.rows import JointGaps
from heuncli.multibody.assembly.start_choices import (
    describe_resting_centres,
    find_pose_choices,
    find_rate_choices,
    format_choices,
)
from heuncli.multibody.assembly.walk import AssemblyPoses, PlacementTree
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Body, Mechanism, extent_points, scene_size
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.results.results import Array
from heuncli.scene.expressions.roller_path import left_normal
from heuncli.scene.shapes.rotations import cross_rows, vector_from_rotation

# Displaced bodies

MIN_ANGLE = 0.01  # [deg] that is mentioned


def describe_displaced_bodies(
    mechanism: Mechanism,
    conditions: Sequence[JointCondition],
    drawn_poses: AssemblyPoses,
    start: Assembly,
    lever: float,
) -> tuple[str, ...]:
    """Describe the bodies that moved by more than the errors of typed digits, the largest displacement first.

    lever: the size of the joints' levers, which gaps are compared with [m]
    """
    in_place = is_drawn_in_place(mechanism, conditions, drawn_poses, lever)
    displacements = []
    for i, body in enumerate(mechanism.bodies):
        counts = in_place or body.near_position is not None, in_place or body.near_rotation is not None
        if (
            any(counts)
            and (distance := _largest_displacement(body, drawn_poses, start, i, counts)) > tolerances.UNMOVED * lever
        ):
            displacements.append((distance, i))
    size = scene_size(mechanism, start) if displacements else 1.0
    displacements = sorted(
        ((distance, i) for distance, i in displacements if distance > tolerances.MOVED * size),
        key=lambda w: (-w[0], w[1]),
    )
    return tuple(
        _format_displacement(mechanism.bodies[i].name, distance, start.rotation[i] @ drawn_poses.R[i].T)
        for distance, i in displacements
    )


def _format_displacement(name: str, distance: float, rotation: Array) -> str:
    """Format a body's name, the displacement of the point of it that moved most, and its rotation angle."""
    angle = float(np.degrees(np.linalg.norm(vector_from_rotation(rotation))))
    return f"{name} by {distance:.2g} m" + (f" and {angle:.2g} deg" if angle >= MIN_ANGLE else "")


def is_drawn_in_place(
    mechanism: Mechanism, conditions: Sequence[JointCondition], drawn_poses: AssemblyPoses, lever: float
) -> bool:
    """Return whether the scene is drawn in world coordinates, so that a body's place in the drawing is intended.

    Bodies drawn each about its own origin fit at a joint or two by chance; in a scene drawn in place most joints do,
    apart from slips. A joint between two origins fits however the bodies are drawn and proves nothing; a robot may have
    many such.
    """
    constraining = [d for d in conditions if d.pose.hold != "none"]
    if not constraining:
        return False
    distance, angle = JointGaps(constraining, [d.pose for d in constraining])(drawn_poses.x, drawn_poses.R)
    is_open = np.maximum(distance / lever, angle) > tolerances.DRAWN_IN_PLACE
    kinds = [JOINTS[mechanism.joints[d.joint].kind] for d in constraining]
    has_prescribed = [
        d.pose != (kind.hold.gap_type, kind.turn.condition) for d, kind in zip(constraining, kinds, strict=True)
    ]
    is_significant = np.array([not _joins_origins(mechanism, d) for d in constraining])
    return not bool(np.any(is_open & np.array(has_prescribed))) and 2 * int(np.sum(is_open & is_significant)) < int(
        np.sum(is_significant)
    )


def _joins_origins(mechanism: Mechanism, condition: JointCondition) -> bool:
    joint = mechanism.joints[condition.joint]
    return not (np.any(joint.p) or np.any(joint.q))


def _largest_displacement(
    body: Body, drawn_poses: AssemblyPoses, start: Assembly, i: int, counts: tuple[bool, bool]
) -> float:
    """Return how far the point of a body that moved most is from its place in the drawing [m]; counts: its shift, its
    rotation.
    """
    rotation_change: Array = start.rotation[i] - drawn_poses.R[i]
    shift = start.position[i] - drawn_poses.x[i] + rotation_change @ body.center if counts[0] else np.zeros(3)
    if counts[1]:
        shift = shift + (np.array(extent_points(body)) - body.center) @ rotation_change.T
    return float(np.sqrt(np.max(np.sum(np.square(np.atleast_2d(shift)), axis=1))))


# Assemble


@record
class StartPoses:
    """The poses at the start, and a description of the search; the fields are described at PoseAssembly."""

    drawn_poses: AssemblyPoses
    poses: AssemblyPoses
    tree: PlacementTree
    fitted_bodies: set[int]
    folded_joints: tuple[str, ...]
    gap: float


def assemble(mechanism: Mechanism, t0: float = 0.0, stages: Stages = NO_CACHE) -> Assembly:
    """Assemble a mechanism at t0: held values stay, all others are the nearest to the drawing that fit. One stage.

    Raises SolveError: does-not-fit, held-conflict, rates-do-not-fit, singular-pose.
    """
    return stages.run(assemble_by_stages, mechanism, t0, fallback=lambda: assemble_by_stages(mechanism, t0, stages))


def assemble_by_stages(mechanism: Mechanism, t0: float, stages: Stages = NO_CACHE) -> Assembly:
    """Assemble a mechanism at t0, with the poses and the rates as stages of their own."""
    conditions, size = joint_conditions(mechanism, t0), mean_arm(mechanism)
    if mechanism.stops or any(joint.restitution is not None for joint in mechanism.joints):
        return assemble_with_ropes(
            mechanism, conditions, size, lambda asking: _assemble_conditions(mechanism, asking, size, stages)
        )
    return _assemble_conditions(mechanism, conditions, size, stages)


def _assemble_conditions(
    mechanism: Mechanism, conditions: list[JointCondition], size: float, stages: Stages
) -> Assembly:
    start_poses = stages.run(_find_poses, mechanism, conditions, size)
    return stages.run(_find_rates, mechanism, conditions, start_poses, size)


def _find_poses(mechanism: Mechanism, conditions: list[JointCondition], size: float) -> StartPoses:
    """Find the poses."""
    assembly = PoseAssembly(mechanism, conditions, size)
    assembly.fit()
    return StartPoses(
        assembly.drawn, assembly.poses, assembly.tree, assembly.fitted, tuple(assembly.folded), assembly.gap
    )


def _find_rates(
    mechanism: Mechanism, conditions: list[JointCondition], start_poses: StartPoses, size: float
) -> Assembly:
    """Find the rates in these poses, and the sentences on both."""
    assembly = RateAssembly(mechanism, conditions, start_poses.poses, size)
    assembly.fit()
    assembly.require_accelerations()

    n = len(mechanism.bodies)
    x, rates = start_poses.poses.x, assembly.rates
    start = Assembly(
        position=x[:n],
        rotation=start_poses.poses.R[:n],
        velocity=rates.v[:n] + cross_rows(rates.w[:n], x[:n] - rates.s[:n]),
        angular_velocity=rates.w[:n],
        start_choices=(),
        gap=start_poses.gap,
    )
    folds = [
        f"the loop at joint {name} starts with its links in line; the fold direction was chosen by a fixed rule"
        for name in start_poses.folded_joints
    ]
    choices = find_pose_choices(
        mechanism, start_poses.drawn_poses, start_poses.poses, start_poses.tree, start_poses.fitted_bodies, size
    )
    choices += find_rate_choices(mechanism, rates, assembly.tree, assembly.fitted, size)
    return replace(
        start,
        start_choices=(*folds, *format_choices(choices)),
        displaced_bodies=describe_displaced_bodies(mechanism, conditions, start_poses.drawn_poses, start, size),
        start_motions=describe_resting_centres(mechanism, assembly),
    )


# Slack ropes

UNCONSTRAINED = JointConstraint("none", "free")
Assemble = Callable[[list[JointCondition]], Assembly]


def find_one_sided_joints(mechanism: Mechanism) -> tuple[list[int], list[int]]:
    """Find the joints that are ropes or one-sided paths, and the rods whose length a stop limits."""
    free = sorted({stop.joint for stop in mechanism.stops if stop.quantity == "length"})
    ropes = [
        k
        for k, joint in enumerate(mechanism.joints)
        if joint.restitution is not None and joint.travel is None and k not in free
    ]
    return ropes, free


def assemble_with_ropes(
    mechanism: Mechanism, conditions: Sequence[JointCondition], size: float, assemble: Assemble
) -> Assembly:
    """Assemble the start, with ropes as taut as they are found. Raises SolveError as `assemble` does."""
    ropes, free = find_one_sided_joints(mechanism)
    present_conditions = list(conditions)
    for k in (*ropes, *free):
        present_conditions[k] = replace(conditions[k], pose=UNCONSTRAINED, rate=UNCONSTRAINED)
    start = assemble(present_conditions)
    tolerance = tolerances.OPEN_GAP * size
    short: set[int] = set()
    while stretched := {k for k in set(ropes) - short if rope_excess(mechanism, start, k) > tolerance}:
        short |= stretched
        for k in stretched:
            present_conditions[k] = replace(conditions[k], rate=UNCONSTRAINED)
        start = assemble(present_conditions)
    taut = [k for k in ropes if abs(rope_excess(mechanism, start, k)) <= tolerance]
    if not taut:
        return start
    taut_conditions = list(present_conditions)
    for k in taut:
        taut_conditions[k] = replace(present_conditions[k], rate=conditions[k].rate)
    try:
        return assemble(taut_conditions)
    except SolveError as error:
        if error.problems[0].code != "rates-do-not-fit":
            raise
        return start


def rope_excess(mechanism: Mechanism, start: Assembly, k: int) -> float:
    """Distance of a rope's points less its length [m]; 0 for a rope as long as this distance.

    For a path that pushes to its left: how far its point is to the right of it.
    """
    joint = mechanism.joints[k]
    if joint.length is None and joint.path is None:
        return 0.0
    places = [
        point if body == GROUND else start.position[body] + start.rotation[body] @ point
        for body, point in ((joint.a, joint.p), (joint.b, joint.q))
    ]
    D = places[1] - places[0]
    if joint.path is not None:
        offset = D if joint.a == GROUND else D @ start.rotation[joint.a]
        r, slope, _ = joint.path.evaluate(float(joint.path.find_nearest(offset)))
        return float((r - offset) @ left_normal(joint.path.normal, slope))
    assert joint.length is not None
    return float(np.sqrt(D @ D)) - joint.length
