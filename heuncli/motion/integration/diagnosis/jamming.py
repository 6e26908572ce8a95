"""Where friction by what a joint carries has not one answer: which, when, why. Imported only on the way to an error."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.errors import Problem
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import JointLoad, Mechanism, ThreadLoad
from heuncli.multibody.response import Workspace

SAID = {  # code, what was found, what to do next
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


def jammed(mechanism: Mechanism, found: int, row: int, t: float) -> Problem:
    """The problem of what the kernel found of a row of its table of loads."""
    load = next(load for load, rows in mechanism.load_rows() if row in range(rows.start, rows.stop))
    code, said, hint = SAID[found]
    if isinstance(load, ThreadLoad):
        hint = "a drive of the spindle or more inertia on it, as its motor's; a smaller coefficient, or a steeper lead"
        said = said.replace("the joint", "its flanks")
        return Problem(code, f"at t = {t:.9g} s the thread couplings.{load.name} rubs, and {said}", hint=hint)
    assert isinstance(load, JointLoad), load
    joint = mechanism.joints[load.joint].name
    return Problem(code, f"at t = {t:.9g} s forces.{load.name} rubs in joints.{joint}, and {said}", hint=hint)


def jammed_at(mechanism: Mechanism, recovered: Recovered, instant: int) -> list[Problem]:
    """The problems of such friction at one of the instants."""
    found = recovered.loads["span"][instant]
    rubbing = [r for load, rows in mechanism.load_rows() if load in mechanism.rubbing for r in [rows.start]]
    t = float(recovered.times[instant])
    return [jammed(mechanism, int(found[row]), row, t) for row in rubbing if found[row] != kernel.FOUND]


def jammed_beyond(mechanism: Mechanism, workspace: Workspace, t: float) -> list[Problem]:
    """The problem of such friction that was met last, beyond the instant that a run has reached."""
    found, row, at = workspace.jammed
    return [jammed(mechanism, found, row, at)] if found != kernel.FOUND and at >= t else []


def rubs_openly(mechanism: Mechanism, loads: Sequence[JointLoad | ThreadLoad], t: float) -> Problem:
    """The problem of friction by what nobody can tell."""
    listed = ", ".join(mechanism.rubs_in(load) for load in loads)
    message = f"at t = {t:.9g} s friction hangs on what redundant joints leave open: {listed}"
    hint = "joints that hold less, as heun run proposes without that friction; or friction of a given size"
    return Problem("friction-open", message, hint=hint)
