"""Say why friction by a coefficient has no solution, two, or one that is not proved to be the only one."""

from __future__ import annotations

from heuncli.base.errors import Problem
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import JointLoad, ThreadLoad
from heuncli.multibody.mechanism.model import Mechanism

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


def make_jamming_problem(mechanism: Mechanism, status: int, row: int, t: float) -> Problem:
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
