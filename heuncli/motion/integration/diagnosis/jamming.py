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
        "the joint jams (no solution): 1 N of friction causes more than 1 N of further friction",
        "use a smaller coefficient or radius, a longer guide, or a load nearer to it",
    ),
    kernel.TWO: (
        "friction-not-unique",
        "two solutions exist: 1 N of friction causes more than 1 N of further friction",
        "use a smaller coefficient or radius, a longer guide, or a load nearer to it",
    ),
    kernel.UNPROVED: (
        "friction-not-unique",
        "the solution may not be unique: 1 N of friction causes nearly 1 N of further friction, or more",
        "use smaller coefficients or radii, longer guides, or a constant friction torque or force in one of the joints",
    ),
}


def make_problem(mechanism: Mechanism, status: int, row: int, t: float) -> Problem:
    """Make the problem from the status that the kernel found for a row of its table of loads."""
    load = next(load for load, rows in mechanism.iter_load_rows() if row in range(rows.start, rows.stop))
    code, reason, hint = JAMMING_MESSAGES[status]
    if isinstance(load, ThreadLoad):
        hint = (
            "drive the spindle or add inertia to it, such as its motor's; use a smaller coefficient, or a steeper lead"
        )
        reason = reason.replace("the joint jams", "it jams")
        return Problem(code, f"at t = {t:.9g} s friction in the thread couplings.{load.name}: {reason}", hint=hint)
    assert isinstance(load, JointLoad), load
    joint = mechanism.joints[load.joint].name
    return Problem(code, f"at t = {t:.9g} s friction forces.{load.name} in joints.{joint}: {reason}", hint=hint)


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
    message = f"at t = {t:.9g} s friction depends on indeterminate reactions of redundant joints: {load_names}"
    hint = "use joints with fewer constraints, as heun run proposes without that friction; or a constant friction"
    return Problem("friction-open", message, hint=hint)
