"""Describe in sentences how a run ended and what its reader is warned of; find where smoothed friction is not yet full.

Friction is its size times tanh(rate / speed). Where the rate is below a few times `speed`, loads and accelerations are
those of a machine with less friction: a start from rest shows the acceleration without friction.

Bodies that the loads of a state accelerate may miss a cylinder or a support. This is checked only where everything
stands still, or where drives alone turn at constant rates and nothing moves against the bodies they carry.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.balance import find_inertia_scale
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.motion.integration.contacts.shared_impulses import format_sharing_warning
from heuncli.motion.integration.diagnosis.guide_departures import format_slant_warnings
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, Load, ThreadLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, JointBlock, Status
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import History

MAX_TIMES = 5  # instants that a sentence lists


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
    """Collect the warnings at the instants of `recovery`.

    joints: their block in the results
    residual: of d'Alembert's principle, relative to the largest force
    """
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
        *recovery.describe_singular_poses(),
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
    """Return whether the rope of a coupling pushes at the single instant, before or after any of its sheaves."""
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


MAX_NAMED = 3  # bodies or loads that a warning names
# blocks that depend on friction at an instant: loads and accelerations, but no position, velocity or energy
KINDS = frozenset({"joints", "foundation", "sections", "stops", "couplings", "system_vector"})
ACCELERATIONS = ("acceleration",)


class PartialFriction(NamedTuple):
    """Friction below its full value at an instant: its name, its rate and its `speed`."""

    name: str
    rate: float
    speed: float

    @property
    def share(self) -> float:
        """The share of its full value, 0 to 1."""
        return math.tanh(abs(self.rate) / self.speed)


def compute_full_friction_rate() -> float:
    """Return the rate from which on friction is full, in multiples of its `speed`."""
    return math.atanh(1.0 - tolerances.FRICTION_LACKS)


def has_smoothed_friction(mechanism: Mechanism) -> bool:
    """Return whether a scene has friction that is smoothed."""
    return any(is_smoothed(load) for load in mechanism.loads)


def is_smoothed(load: Load) -> bool:
    """Return whether a load is friction that is smoothed: it has a size of its own and does not stick."""
    return load.row.is_friction and not (isinstance(load, JointLoad | ThreadLoad) and load.static > 0.0)


def depends_on_friction(path: str) -> bool:
    """Return whether a number, by its path, depends on the friction at the same instant."""
    words = path.split(".")
    if words[0] in KINDS:
        return words[-1] not in ("point", "normal", "first_axis", "s", "side") and words[:2] != ["foundation", "axis"]
    return any(word.endswith(ACCELERATIONS) for word in words[1:])


def list_partial_friction(mechanism: Mechanism, solutions: Evaluation) -> dict[float, list[PartialFriction]]:
    """Return the friction that is below its full value, by instant; instants without any are left out."""
    found: dict[float, list[PartialFriction]] = {}
    for load, own in mechanism.iter_load_rows():
        if not isinstance(load, JointLoad | ThreadLoad) or not is_smoothed(load):
            continue
        rates: Array = np.abs(solutions.loads[:, own]["rate"]).max(axis=1)
        for k in np.flatnonzero(rates < compute_full_friction_rate() * load.speed).tolist():
            partial = PartialFriction(load.name, float(rates[k]), load.speed)
            found.setdefault(float(solutions.times[k]), []).append(partial)
    return found


class PartialSamples(NamedTuple):
    """The samples at which smoothed friction is below its full value: how many, the first instant, and what is so
    there.
    """

    sample_count: int
    first_time: float
    first: tuple[PartialFriction, ...]

    def add_later(self, later: PartialSamples | None) -> PartialSamples:
        """Add the samples of a later part of the run."""
        return self if later is None else self._replace(sample_count=self.sample_count + later.sample_count)

    def describe(self, total_count: int) -> str:
        """Describe them in a sentence; total_count: of all samples."""
        which = f"{self.sample_count} of {total_count} samples, first at t = {self.first_time:.6g} s"
        return f"loads and accelerations at {which}, do not include full friction: {describe_partial(self.first)}"


def find_partial_samples(mechanism: Mechanism, solutions: Evaluation) -> PartialSamples | None:
    """Find the samples at which smoothed friction is below its full value; None if there are none."""
    found = list_partial_friction(mechanism, solutions) if has_smoothed_friction(mechanism) else {}
    if not found:
        return None
    first = min(found)
    return PartialSamples(len(found), first, tuple(found[first]))


def describe_partial(partial: Sequence[PartialFriction]) -> str:
    """Say which friction is below its full value, and by how much."""
    texts = [f"{own.name} is at {100.0 * own.share:.3g} % of its full value" for own in partial[:MAX_NAMED]]
    more = f" and {len(partial) - MAX_NAMED} more" if len(partial) > MAX_NAMED else ""
    rate = compute_full_friction_rate()
    return f"smoothed friction {', '.join(texts)}{more}: the rate is below {rate:.3g} times its `speed`"


def make_partial_note(partial_by_time: dict[float, list[PartialFriction]]) -> str:
    """Explain the mark next to numbers, with the names of the friction."""
    names = dict.fromkeys(own.name for partial in partial_by_time.values() for own in partial)
    some = ", ".join(list(names)[:MAX_NAMED]) + (" ..." if len(names) > MAX_NAMED else "")
    rate = f"{compute_full_friction_rate():.3g}"
    return f"smoothed friction ({some}) is below its full value here: rate below {rate} times its `speed`"


UNITS = {"angle": "rad/s²", "travel": "m/s²"}
HINT = "not at rest; analysis: {type: rest} finds the rest position"


def describe_accelerations(recovery: Recovery) -> list[str]:
    """Describe in a sentence that the loads of a state set it in motion; empty if they do not.

    recovery: at the state's one instant
    """
    setup = recovery.setup
    if setup.spec.analysis.type != "state" or not setup.model["freedoms"]:
        return []
    mechanism, states = setup.scene.mechanism, recovery.states
    t = float(recovery.solutions.times[0])
    jets = [law.value.derivatives(t) for law in mechanism.laws]
    if any(second != 0.0 for _, _, second in jets):
        return []
    speed = np.abs(states.v_centre[0]).max() / setup.scene.layout.size + np.abs(states.omega[0]).max()
    if any(rate != 0.0 for _, rate, _ in jets):
        found = list_accelerated_coordinates(recovery)
    else:
        found = list_accelerated_bodies(recovery) if speed <= tolerances.AT_REST else []
    if not found:
        return []
    more = f" and {len(found) - MAX_NAMED} more" if len(found) > MAX_NAMED else ""
    return [f"{', '.join(found[:MAX_NAMED])}{more}: {HINT}"]


def list_accelerated_bodies(recovery: Recovery) -> list[str]:
    """List the bodies that are accelerated from rest, the fastest first, with the acceleration that is larger.

    It is that of the centre of mass, or the angular one.
    """
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    mass = mechanism.scale_masses
    radius = np.sqrt(np.array([np.trace(b.inertia) for b in mechanism.bodies]) / mass)
    shift, turn = (np.sqrt(np.sum(a[0] ** 2, axis=1)) for a in (states.a_centre, states.alpha))
    fastest = np.maximum(shift, turn * radius)
    is_accelerated = fastest > tolerances.STARTS_MOVING * find_load_scale(recovery) / mass
    return [
        f"{mechanism.bodies[i].name} " + (f"{shift[i]:.3g} m/s²" if shift[i] >= turn[i] * radius[i]
                                          else f"{turn[i]:.3g} rad/s²")
        for i in np.argsort(-fastest, kind="stable").tolist()
        if is_accelerated[i]
    ]  # fmt: skip


def list_accelerated_coordinates(recovery: Recovery) -> list[str]:
    """List the coordinates that are accelerated where only drives move, at constant rates."""
    layout = recovery.setup.scene.layout
    freedom_rows = recovery.solutions.freedoms[0]
    size = layout.size
    free_freedoms = [(f, row) for f, row in zip(layout.freedoms, freedom_rows, strict=True) if f.q >= 0]
    levers = [size if f.quantity == "angle" else 1.0 for f, _ in free_freedoms]
    if layout.bodies["ball"].any() or any(f.joint < 0 or f.quantity not in UNITS for f, _ in free_freedoms):
        return []  # a body that is free in space has no rate relative to a drive
    if any(
        abs(row["u"]) * lever > tolerances.AT_REST * size for (_, row), lever in zip(free_freedoms, levers, strict=True)
    ):
        return []
    masses = layout.mechanism.scale_masses
    least = tolerances.STARTS_MOVING * float((find_load_scale(recovery) / masses).max())
    found = [
        (abs(row["udot"]) * lever, f, abs(row["udot"])) for (f, row), lever in zip(free_freedoms, levers, strict=True)
    ]
    return [
        f"{layout.mechanism.joints[f.joint].name}.{f.quantity} {a:.3g} {UNITS[f.quantity]}"
        for size_rate, f, a in sorted(found, key=lambda one: -one[0])
        if size_rate > least
    ]


def find_load_scale(recovery: Recovery) -> Array:
    """Find the largest load on each body, including its weight and inertia loads, (n,) [N].

    Moments are divided by the scene's size.
    """
    setup = recovery.setup
    largest: Array = find_inertia_scale(setup.scene.mechanism, recovery.states)[0]
    for action in recovery.actions:
        for end, F, M in action.iter_ends():
            if end.body != GROUND:
                size = max(float(np.abs(F[0]).max()), float(np.abs(M[0]).max()) / setup.scene.layout.size)
                largest[end.body] = max(largest[end.body], size)
    return largest
