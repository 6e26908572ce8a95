"""Poses and rates at the start that fit all joints (manual/format.md, "Where bodies start")."""

from __future__ import annotations

from heuncli.assembly.conditions import JointCondition, conditions_of
from heuncli.assembly.displaced_bodies import moved
from heuncli.assembly.gaps import size_of
from heuncli.assembly.poses import Placing
from heuncli.assembly.rates import Moving
from heuncli.assembly.start_choices import chosen, pose_choices, rate_choices
from heuncli.mechanism.model import Assembly, Mechanism
from heuncli.records import replace
from heuncli.shapes.rotations import cross_rows


def assemble(mechanism: Mechanism, t0: float = 0.0) -> Assembly:
    """Poses and rates at t0: what is held, and for the rest the nearest to the drawing that fits.

    Raises SolveError: does-not-fit, held-conflict, rates-do-not-fit, singular-pose.
    """
    found, size = conditions_of(mechanism, t0), size_of(mechanism)
    if mechanism.stops or any(joint.restitution is not None for joint in mechanism.joints):
        from heuncli.assembly.slack_ropes import assembled  # few scenes have them

        return assembled(mechanism, found, size, lambda asking: _assembled(mechanism, asking, size))
    return _assembled(mechanism, found, size)


def _assembled(mechanism: Mechanism, found: list[JointCondition], size: float) -> Assembly:
    placing = Placing(mechanism, found, size)
    placing.fit()
    moving = Moving(mechanism, found, placing.poses, size)
    moving.fit()
    moving.check()

    n = len(mechanism.bodies)
    x, r = placing.poses.x, moving.rates
    start = Assembly(
        position=x[:n],
        rotation=placing.poses.R[:n],
        velocity=r.v[:n] + cross_rows(r.w[:n], x[:n] - r.s[:n]),
        angular_velocity=r.w[:n],
        chosen=(),
        gap=placing.gap,
    )
    folds = [f"the loop at joint {name} started in line: folded in a fixed way" for name in placing.folded]
    choices = pose_choices(mechanism, placing.drawn, placing.poses, placing.tree, placing.fitted, size)
    choices += rate_choices(mechanism, r, moving.tree, moving.fitted, size)
    return replace(
        start,
        chosen=(*folds, *chosen(choices)),
        moved=moved(mechanism, found, placing.drawn, start, size),
    )
