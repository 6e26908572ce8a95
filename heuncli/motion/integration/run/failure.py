"""Explain why a run cannot continue where the kernel's loop has ended. Imported only on the way to an error."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.diagnosis.ambiguous_laws import find_jammed_after
from heuncli.motion.integration.diagnosis.domains import FARTHEST, evaluate_coordinates, find_without_value
from heuncli.motion.integration.diagnosis.fast_motions import describe_largest_load, find_growing
from heuncli.motion.integration.diagnosis.guide_departures import Moving, find_left_paths
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.kernel_loop import CHATTERING, HALF_TURN
from heuncli.motion.integration.run.progress import RunProgress
from heuncli.motion.integration.run.request import KERNEL_ERRORS, ClosuresLost
from heuncli.multibody.mechanism.loads import BushingLoad
from heuncli.scene.expressions.programs import Expression


class RunFailure:
    """The state in which a run has failed, evaluated once for all checks."""

    def __init__(self, progress: RunProgress) -> None:
        self.progress, self.t, self.scene = progress, progress.t, progress.scene
        self.mechanism = progress.scene.layout.mechanism

    @cached_property
    def evaluation(self) -> Evaluation:
        """The results at that state."""
        return self.scene.evaluate(np.array([self.t]), self.progress.state[None, :])

    @cached_property
    def coordinates(self) -> Moving:
        """The coordinates that expressions use at that state."""
        return evaluate_coordinates(self.scene.layout, self.evaluation, 0)


def make_failure_error(progress: RunProgress, code: int) -> SolveError:
    """Make the error of a run that the kernel's loop ended with a code."""
    t, scene, loop = progress.t, progress.scene, progress.kernel.loop
    if code == CHATTERING:
        return SolveError(make_chattering_problem(t, *scene.layout.pack.branches[loop.changed_branch]))
    if code == HALF_TURN:
        from heuncli.motion.integration.diagnosis.ambiguous_laws import (
            make_half_turn_error,  # the global chart alone has them
        )

        is_unreduced = progress.integrated_scene.layout is scene.layout
        return make_half_turn_error(
            progress.integrated_scene, loop.half_turn, t, progress.integrated_state, is_unreduced=is_unreduced
        )
    name, message, hint = KERNEL_ERRORS[code]
    run_failure = RunFailure(progress)
    if name == "closure-lost":
        if (
            problems := find_left_paths_at(run_failure)
            or find_turned_bushings(run_failure)
            or find_lost_loads(run_failure)
        ):
            return SolveError(*problems)
        problem = Problem(name, f"at t = {t:.9g} s: {message}", hint=hint)
        return ClosuresLost(problem, passed_states=progress.passed_states, failure_time=t, last=progress.last)
    return make_no_acceleration_error(run_failure, name, message, hint)


def find_left_paths_at(run_failure: RunFailure) -> list[Problem]:
    """Return the problems of points that have run off their paths there, and of cams that have turned off their lifts.

    No closed chain has to be inspected for them, though one that depends on them is lost with them.
    """
    mechanism = run_failure.mechanism
    on_cams = any(coupling.entry.type == "cam" for coupling in mechanism.couplings)
    if not on_cams and all(joint.path is None for joint in mechanism.joints):
        return []
    return find_left_paths(
        mechanism, run_failure.t, run_failure.progress.last * 2.0**-FARTHEST, run_failure.coordinates
    )


def find_lost_loads(run_failure: RunFailure) -> list[Problem]:
    """Return the problems of loads without a value there while couplings are held, whose rows then have no solution."""
    if not run_failure.mechanism.couplings:
        return []
    return find_without_value(run_failure.mechanism, run_failure.t, run_failure.progress.last, run_failure.coordinates)


def make_no_acceleration_error(run_failure: RunFailure, name: str, message: str, hint: str) -> SolveError:
    """Return the error of an expression without a value there, else of one that grows without bound, else that of the
    code.
    """
    progress, t, scene, mechanism = run_failure.progress, run_failure.t, run_failure.scene, run_failure.mechanism
    problems = find_wound_ropes(run_failure)
    problems = problems or find_without_value(mechanism, t, progress.last, run_failure.coordinates)
    if not problems and mechanism.joint_friction:
        problems = find_jammed_after(mechanism, progress.integrated_scene.workspace, t)
    problems = problems or find_turned_bushings(run_failure)
    problems = problems or find_growing(scene, t, progress.state, progress.passed_states)
    if problems:
        return SolveError(*problems)
    hint = "; ".join(filter(None, [hint, describe_largest_load(mechanism, run_failure.evaluation)]))
    hangs = scene.layout.spanning.links
    massless_bodies = sorted(
        {f"bodies.{mechanism.bodies[hangs[i].body].name}" for i in scene.layout.tables["artificial_inertias"]["body"]}
    )
    if massless_bodies and name == "step-collapsed":
        hint += f", or closed loops release the rotation of bodies without inertia: {', '.join(massless_bodies)}"
    return SolveError(Problem(name, f"at t = {t:.9g} s: {message}", hint=hint))


def find_wound_ropes(run_failure: RunFailure) -> list[Problem]:
    """Return the ropes whose strands have been wound up there, which ends the run whatever fails."""
    if not any(coupling.entry.type == "rope" for coupling in run_failure.mechanism.couplings):
        return []
    from heuncli.motion.integration.diagnosis.guide_departures import find_wound_up

    return find_wound_up(run_failure.scene.layout, run_failure.evaluation)


def find_turned_bushings(run_failure: RunFailure) -> list[Problem]:
    """Return the bushings that end the run by the jump of their moment, whatever fails there."""
    if not any(isinstance(load, BushingLoad) for load in run_failure.mechanism.loads):
        return []
    from heuncli.motion.integration.diagnosis.ambiguous_laws import find_half_turned

    return find_half_turned(run_failure.mechanism, run_failure.evaluation, 0)


def make_chattering_problem(t: float, expression: Expression, branch: int) -> Problem:
    """Make the problem of a branch that changes back as soon as it changed: the motion would have to stay in
    between.
    """
    message = (
        f"at t = {t:.9g} s '{expression.held_branches[branch]}' in '{expression.source.strip()}' chatters: "
        "it changes back as soon as it has changed, because each side drives the motion to the other"
    )
    hint = "for sticking use a smooth law: tanh(rate/0.001) instead of sign(rate), or a force of type friction"
    return Problem("chattering", message, expression.location, hint)
