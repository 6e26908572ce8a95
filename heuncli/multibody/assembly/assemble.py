"""Compute poses and rates at the start that satisfy all joints (manual/format.md, "Where bodies start")."""

from __future__ import annotations

from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import JointCondition, joint_conditions
from heuncli.multibody.assembly.displaced_bodies import describe_displaced_bodies
from heuncli.multibody.assembly.gaps import mean_arm
from heuncli.multibody.assembly.poses import PoseAssembly
from heuncli.multibody.assembly.rates import RateAssembly
from heuncli.multibody.assembly.start_choices import (
    describe_resting_centres,
    find_pose_choices,
    find_rate_choices,
    format_choices,
)
from heuncli.multibody.assembly.walk import AssemblyPoses, PlacementTree
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.stages import NO_CACHE, Stages
from heuncli.scene.shapes.rotations import cross_rows


@record
class StartPoses:
    """The poses at the start, and how they were found; the fields are described at PoseAssembly."""

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
        from heuncli.multibody.assembly.slack_ropes import assemble_with_ropes  # few scenes have them

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
