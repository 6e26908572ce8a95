"""How a run ended, and what its reader is warned of, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.motion.integration.contacts.shared_impulses import sharing_warning
from heuncli.motion.integration.diagnosis.off_sheaves import slanting
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, JointBlock, Status
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

MOST_TIMES = 5  # that a sentence lists


def status(history: History, mechanism: Mechanism) -> Status:
    """Whether the run came to its end."""
    if history.checked is None:
        return {"code": "completed", "message": "one instant, nothing integrated"}
    run = history.checked.run
    if run.stopped is not None:
        why = f"at t = {run.times[-1]:.6g} s {would_let_go(mechanism, run.stopped)}"
        return {"code": "stopped", "message": why}
    return {"code": "completed", "message": f"{run.steps} steps to t = {run.times[-1]:.6g} s"}


def warnings(
    setup: Setup, history: History, recovery: Recovery, joints: Mapping[str, JointBlock], residual: float
) -> tuple[str, ...]:
    """Everything worth a warning at the instants of `recovery`; joints: their block, residual: d'Alembert's."""
    singular = []
    if recovery.verdicts and recovery.decided is not None:
        singular = recovery.decided.singular(recovery.recovered.times, recovery.generic)
    return (
        *unbalanced(residual),
        *(warning for cuts in setup.cuts for warning in cuts.warnings),
        *sharing_warning([(jump.told_time, jump.shared) for jump in history.blows], setup.spec.analysis.impacts),
        *(of_the_motion(setup, history) if history.checked is not None else of_ropes(setup, recovery, joints)),
        *singular,
        *slanting(setup.scene.layout, recovery.recovered),
    )


def beside_singular_poses(unknown: Array) -> list[str]:
    """A sentence where rounding reaches numbers at some instants."""
    if not len(unknown):
        return []
    at = ", ".join(f"{t:.6g}" for t in unknown[:MOST_TIMES]) + (" ..." if len(unknown) > MOST_TIMES else "")
    return [f"beside a singular pose at t = {at} s: rounding reaches some numbers there, which are not told"]


def left_out(unknown: Sequence[float]) -> list[str]:
    """A sentence where a search for extremes came upon such instants."""
    if not unknown:
        return []
    low, high = min(unknown), max(unknown)
    to = f" to {high:.6g}" if f"{low:.6g}" != f"{high:.6g}" else ""
    return [f"extremes are searched without what rounding reaches beside singular poses at t = {low:.6g}{to} s"]


def unbalanced(residual: float) -> list[str]:
    """A sentence where the numbers do not fulfil d'Alembert's principle."""
    wrong = f"the forces balance to {residual:.1g} of the largest only: the loads are not to be trusted"
    return [wrong] if residual > tolerances.UNBALANCED else []


def of_the_motion(setup: Setup, history: History) -> list[str]:
    """A tolerance that was missed, singular poses, an early end.

    Given steps keep to no tolerance; they are held to one that was asked for beside them.
    """
    assert history.checked is not None
    checked, tolerance = history.checked, history.tolerance
    lines = []
    held = setup.step is None or setup.spec.analysis.tolerance_given
    if (worst := checked.motion) > tolerance and held:
        missed = f"the tolerance {tolerance:.3g} was not reached"
        lines.append(f"{missed}: the motion is estimated to {worst:.2g} of the scene's size")
    if history.singular:
        at = ", ".join(f"{t:.6g}" for t in history.singular[:MOST_TIMES])
        at += " ..." if len(history.singular) > MOST_TIMES else ""
        goes = "this one goes on smoothly" if checked.horizon is None else "rounding decides which is followed"
        lines.append(f"passes through a singular pose at t = {at} s: another motion branches off there, {goes}")
    if checked.run.undecided:
        steps = "one step" if checked.run.undecided == 1 else f"{checked.run.undecided} steps"
        lines.append(f"of {steps} it could not be decided what loads do between their stages")
    if checked.run.stopped is not None:
        lines.append(f"stopped before the end: {status(history, setup.scene.mechanism)['message']}")
    return lines


def would_let_go(mechanism: Mechanism, name: str) -> str:
    """What of a rope, or a cam, ends a run."""
    kinds = {coupling.name: coupling.given.type for coupling in mechanism.couplings}
    if kinds.get(name) == "cam":
        return f"contact lost: the follower of cam {name} lifts off (with restitution it would fly, and strike again)"
    if any(joint.name == name and joint.one_sided for joint in mechanism.joints):
        return f"contact lost: the point of joint {name} lifts off its path (with restitution it would fly, and strike)"
    return f"the {kinds.get(name, 'rod')} {name} would have to push (tension_only)"


def pushes(rope: CouplingLoads) -> bool:
    """Whether the rope of a coupling pushes at the one instant, before or behind any of its sheaves."""
    return any(
        row.tension_only and force[0] > 0.0 for row, force in zip(rope.coupling.rows, rope.multipliers, strict=False)
    )


def of_ropes(setup: Setup, recovery: Recovery, joints: Mapping[str, JointBlock]) -> list[str]:
    """Ropes that would have to push, and followers that would lift off, at the one instant of a state."""
    mechanism = setup.scene.mechanism
    rods = [
        j.name for j in mechanism.joints if j.tension_only and j.name in joints and joints[j.name]["tension"][0] < 0.0
    ]
    layout = setup.scene.layout
    pulled = recovery.recovered.rows["multiplier"][0] > 0.0
    rods += [j.name for k, j in enumerate(mechanism.joints) if j.one_sided and pulled[layout.rows.index(k)]]
    ropes = [own.coupling.name for own in recovery.couplings if own.coupling.given.type == "rope" and pushes(own)]
    cams = [own for own in recovery.couplings if own.carries == "contact" and own.coupling.rows[0].tension_only]
    return [would_let_go(mechanism, name) for name in (*rods, *ropes)] + [
        f"the follower of cam {own.coupling.name} lifts off: the cam would have to pull"
        for own in cams
        if own.carried[0] < 0.0
    ]
