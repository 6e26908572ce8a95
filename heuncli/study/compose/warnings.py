"""Describe in sentences how a run ended, and what its reader is warned of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.motion.integration.contacts.shared_impulses import format_sharing_warning
from heuncli.motion.integration.diagnosis.guide_departures import format_slant_warnings
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, JointBlock, Status
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

MAX_TIMES = 5  # that a sentence lists


def make_status(history: History, mechanism: Mechanism) -> Status:
    """Say whether the run reached its end."""
    if history.checked_run is None:
        return {"code": "completed", "message": "one instant, nothing integrated"}
    run = history.checked_run.run
    if run.pushing_rope is not None:
        reason = f"at t = {run.times[-1]:.6g} s {describe_loss(mechanism, run.pushing_rope)}"
        return {"code": "stopped", "message": reason}
    return {"code": "completed", "message": f"{run.steps} steps to t = {run.times[-1]:.6g} s"}


def collect_warnings(
    setup: Setup, history: History, recovery: Recovery, joints: Mapping[str, JointBlock], residual: float
) -> tuple[str, ...]:
    """Collect the warnings at the instants of `recovery`; joints: their block, residual: of d'Alembert's principle."""
    singular = []
    if recovery.needs_indeterminacy and recovery.decided is not None:
        singular = recovery.decided.describe_singular_poses(
            recovery.solutions.times, recovery.generic_self_stress_count
        )
    return (
        *warn_unbalanced(residual),
        *(warning for cuts in setup.cuts for warning in cuts.warnings),
        *format_sharing_warning(
            [(jump.reported_time, jump.shared_impulses) for jump in history.impulses], setup.spec.analysis.impacts
        ),
        *(
            warn_of_motion(setup, history)
            if history.checked_run is not None
            else warn_of_ropes(setup, recovery, joints)
        ),
        *singular,
        *format_slant_warnings(setup.scene.layout, recovery.solutions),
    )


def warn_near_singular(unknown: Array) -> list[str]:
    """Warn that rounding decides some numbers at some instants."""
    if not len(unknown):
        return []
    times = ", ".join(f"{t:.6g}" for t in unknown[:MAX_TIMES]) + (" ..." if len(unknown) > MAX_TIMES else "")
    positions = f"singular position{'s' * (len(unknown) > 1)}"
    return [f"{positions} at t = {times} s: numbers near it that are lost to rounding are not shown"]


def warn_left_out(unknown: Sequence[float]) -> list[str]:
    """Warn that a search for extremes left out such instants."""
    if not unknown:
        return []
    low, high = min(unknown), max(unknown)
    times = f"first t = {low:.6g} s, last t = {high:.6g} s" if f"{low:.6g}" != f"{high:.6g}" else f"t = {low:.6g} s"
    return [f"extremes exclude the numerically uncertain samples near singular positions, {times}"]


def warn_unbalanced(residual: float) -> list[str]:
    """Warn that the numbers do not fulfil d'Alembert's principle."""
    wrong = f"force balance error {residual:.1g} of the largest force: the loads are not reliable"
    return [wrong] if residual > tolerances.UNBALANCED else []


def warn_of_motion(setup: Setup, history: History) -> list[str]:
    """Warn of a missed tolerance, singular poses, an early end.

    A motion with given steps has no tolerance, unless the spec gives one as well.
    """
    assert history.checked_run is not None
    checked, tolerance = history.checked_run, history.tolerance
    lines = []
    is_required = setup.step is None or setup.spec.analysis.tolerance_given
    if (worst := checked.motion) > tolerance and is_required:
        missed = f"tolerance {tolerance:.3g} not reached"
        lines.append(f"{missed}: estimated motion error {worst:.2g} of the model size")
    if history.singular:
        times = ", ".join(f"{t:.6g}" for t in history.singular[:MAX_TIMES])
        times += " ..." if len(history.singular) > MAX_TIMES else ""
        goes = "heun follows the smooth one" if checked.horizon is None else "rounding decides which one is followed"
        positions = f"singular position{'s' * (len(history.singular) > 1)}"
        lines.append(f"{positions} at t = {times} s (two motions are possible there); {goes}")
    if checked.run.uncertain_count:
        steps = "one step" if checked.run.uncertain_count == 1 else f"{checked.run.uncertain_count} steps"
        lines.append(f"in {steps} the loads could not be checked between the stages")
    if checked.run.pushing_rope is not None:
        lines.append(f"stopped before the end: {make_status(history, setup.scene.mechanism)['message']}")
    return lines


def describe_loss(mechanism: Mechanism, name: str) -> str:
    """Say how a rope, or a cam, ends a run."""
    kinds = {coupling.name: coupling.entry.type for coupling in mechanism.couplings}
    if kinds.get(name) == "cam":
        return f"contact lost: the follower of cam {name} lifts off (with restitution it would fly and land again)"
    if any(joint.name == name and joint.one_sided for joint in mechanism.joints):
        return (
            f"contact lost: the point of joint {name} lifts off its path (with restitution it would fly and land again)"
        )
    return f"the {kinds.get(name, 'rod')} {name} would have to push (tension_only)"


def has_pushing_rope(rope: CouplingLoads) -> bool:
    """Whether the rope of a coupling pushes at the single instant, before or after any of its sheaves."""
    return any(
        row.tension_only and force[0] > 0.0 for row, force in zip(rope.coupling.rows, rope.multipliers, strict=False)
    )


def warn_of_ropes(setup: Setup, recovery: Recovery, joints: Mapping[str, JointBlock]) -> list[str]:
    """Warn of ropes that would have to push, and followers that would lift off, at the single instant of a state."""
    mechanism = setup.scene.mechanism
    rods = [
        j.name for j in mechanism.joints if j.tension_only and j.name in joints and joints[j.name]["tension"][0] < 0.0
    ]
    layout = setup.scene.layout
    pulled = recovery.solutions.rows["multiplier"][0] > 0.0
    rods += [j.name for k, j in enumerate(mechanism.joints) if j.one_sided and pulled[layout.rows.index(k)]]
    ropes = [
        own.coupling.name for own in recovery.couplings if own.coupling.entry.type == "rope" and has_pushing_rope(own)
    ]
    cams = [own for own in recovery.couplings if own.load_name == "contact" and own.coupling.rows[0].tension_only]
    return [describe_loss(mechanism, name) for name in (*rods, *ropes)] + [
        f"the follower of cam {own.coupling.name} lifts off: the cam would have to pull"
        for own in cams
        if own.carried_load[0] < 0.0
    ]
