"""Poses and rates at the start that fit all joints (manual/format.md, "Where bodies start")."""

from __future__ import annotations

from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import JointCondition, conditions_of
from heuncli.multibody.assembly.displaced_bodies import moved
from heuncli.multibody.assembly.gaps import size_of
from heuncli.multibody.assembly.poses import Placing
from heuncli.multibody.assembly.rates import Moving
from heuncli.multibody.assembly.start_choices import chosen, pose_choices, rate_choices, resting_centres
from heuncli.multibody.assembly.walk import AssemblyPoses, Tree
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.stages import ANEW, Stages
from heuncli.scene.shapes.rotations import cross_rows


@record
class Placed:
    """Poses at the start, and how they were come by: see Placing."""

    drawn: AssemblyPoses
    poses: AssemblyPoses
    tree: Tree
    fitted: set[int]
    folded: tuple[str, ...]
    gap: float


def assemble(mechanism: Mechanism, t0: float = 0.0, stages: Stages = ANEW) -> Assembly:
    """Poses and rates at t0: what is held, and for the rest the nearest to the drawing that fits; one stage, of stages.

    Raises SolveError: does-not-fit, held-conflict, rates-do-not-fit, singular-pose.
    """
    return stages.run(assembled_at, mechanism, t0, by=lambda: assembled_at(mechanism, t0, stages))


def assembled_at(mechanism: Mechanism, t0: float, stages: Stages = ANEW) -> Assembly:
    """The same."""
    found, size = conditions_of(mechanism, t0), size_of(mechanism)
    if mechanism.stops or any(joint.restitution is not None for joint in mechanism.joints):
        from heuncli.multibody.assembly.slack_ropes import assembled  # few scenes have them

        return assembled(mechanism, found, size, lambda asking: _assembled(mechanism, asking, size, stages))
    return _assembled(mechanism, found, size, stages)


def _assembled(mechanism: Mechanism, found: list[JointCondition], size: float, stages: Stages) -> Assembly:
    placed = stages.run(_placed, mechanism, found, size)
    return stages.run(_started, mechanism, found, placed, size)


def _placed(mechanism: Mechanism, found: list[JointCondition], size: float) -> Placed:
    """The poses."""
    placing = Placing(mechanism, found, size)
    placing.fit()
    return Placed(placing.drawn, placing.poses, placing.tree, placing.fitted, tuple(placing.folded), placing.gap)


def _started(mechanism: Mechanism, found: list[JointCondition], placed: Placed, size: float) -> Assembly:
    """The rates in these poses, and what is told of both."""
    moving = Moving(mechanism, found, placed.poses, size)
    moving.fit()
    moving.check()

    n = len(mechanism.bodies)
    x, r = placed.poses.x, moving.rates
    start = Assembly(
        position=x[:n],
        rotation=placed.poses.R[:n],
        velocity=r.v[:n] + cross_rows(r.w[:n], x[:n] - r.s[:n]),
        angular_velocity=r.w[:n],
        chosen=(),
        gap=placed.gap,
    )
    folds = [f"the loop at joint {name} started in line: folded in a fixed way" for name in placed.folded]
    choices = pose_choices(mechanism, placed.drawn, placed.poses, placed.tree, placed.fitted, size)
    choices += rate_choices(mechanism, r, moving.tree, moving.fitted, size)
    return replace(
        start,
        chosen=(*folds, *chosen(choices)),
        moved=moved(mechanism, found, placed.drawn, start, size),
        started=resting_centres(mechanism, moving),
    )
