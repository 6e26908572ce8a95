"""Explain where load-dependent joint friction has no unique solution: which, when, why. Imported only on the way to an
error.
"""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.errors import Problem
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import JointLoad, Mechanism, ThreadLoad
from heuncli.multibody.response import Workspace

JAMMING_MESSAGES = {  # code, what was found, what to do next
    kernel.JAMS: (
        "friction-jams",
        "no accelerations answer it: the friction presses the joint by more than it is itself, and it jams",
        "a smaller coefficient or radius, a longer guide, or a load nearer to it",
    ),
    kernel.TWO: (
        "friction-not-unique",
        "two answers meet its law: the friction presses the joint by more than it is itself",
        "a smaller coefficient or radius, a longer guide, or a load nearer to it",
    ),
    kernel.UNPROVED: (
        "friction-not-unique",
        "what rubs presses joints by nearly as much as it is itself, or by more: one answer is not certain",
        "smaller coefficients or radii, longer guides, or friction of a given size in one of the joints",
    ),
}


def make_problem(mechanism: Mechanism, status: int, row: int, t: float) -> Problem:
    """Make the problem from the status that the kernel found for a row of its table of loads."""
    load = next(load for load, rows in mechanism.iter_load_rows() if row in range(rows.start, rows.stop))
    code, reason, hint = JAMMING_MESSAGES[status]
    if isinstance(load, ThreadLoad):
        hint = "a drive of the spindle or more inertia on it, as its motor's; a smaller coefficient, or a steeper lead"
        reason = reason.replace("the joint", "its flanks")
        return Problem(code, f"at t = {t:.9g} s the thread couplings.{load.name} rubs, and {reason}", hint=hint)
    assert isinstance(load, JointLoad), load
    joint = mechanism.joints[load.joint].name
    return Problem(code, f"at t = {t:.9g} s forces.{load.name} rubs in joints.{joint}, and {reason}", hint=hint)


def find_jammed(mechanism: Mechanism, evaluation: Evaluation, instant: int) -> list[Problem]:
    """Return the problems of such friction at one of the instants."""
    status = evaluation.loads["span"][instant]
    friction_rows = [
        r for load, rows in mechanism.iter_load_rows() if load in mechanism.joint_friction for r in [rows.start]
    ]
    t = float(evaluation.times[instant])
    return [make_problem(mechanism, int(status[row]), row, t) for row in friction_rows if status[row] != kernel.FOUND]


def find_jammed_after(mechanism: Mechanism, workspace: Workspace, t: float) -> list[Problem]:
    """Return the problem of such friction that was met last, after the instant that a run has reached."""
    status, row, when = workspace.friction_failure
    return [make_problem(mechanism, status, row, when)] if status != kernel.FOUND and when >= t else []


def indeterminate_friction_problem(mechanism: Mechanism, loads: Sequence[JointLoad | ThreadLoad], t: float) -> Problem:
    """Make the problem of friction that depends on indeterminate reactions of redundant joints."""
    load_names = ", ".join(mechanism.describe_friction(load) for load in loads)
    message = f"at t = {t:.9g} s friction hangs on what redundant joints leave open: {load_names}"
    hint = "joints that hold less, as heun run proposes without that friction; or friction of a given size"
    return Problem("friction-open", message, hint=hint)
