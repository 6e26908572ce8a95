"""Diagnose what in a scene's motion is difficult for numerical methods, and give a verdict.

Impure: integration reads the clock.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.motion_diagnostics.growth import find_integrated_growth, find_out_of_plane_growth
from heuncli.analyses.motion_diagnostics.motion_events import (
    MotionSearch,
    distinct_events,
    find_attitude_events,
    find_dead_centres,
)
from heuncli.analyses.motion_diagnostics.results import (
    DEAD_CENTRE,
    GIMBAL,
    HALF_TURN,
    NO_MASS,
    SINGULAR,
    Event,
    LargestCondition,
    Probe,
)
from heuncli.analyses.motion_diagnostics.stiffness import find_stiffness
from heuncli.analyses.motion_diagnostics.twists import ConditionNumbers, compute_conditions
from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.base.spelling import format_count, list_some
from heuncli.loads.equilibrium.coordinates import Coordinates, make_coordinates
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import attach_locations
from heuncli.study.workflow import solve

MAX_FREEDOMS = 400  # largest size of matrices that are formed
MAX_NUMBERS = 20_000_000  # numbers in these matrices at a time
MAX_INSTANTS = 400  # at most, at which the conditions are computed


def find_largest_conditions(motion: MotionSearch) -> tuple[LargestCondition | None, LargestCondition | None, str]:
    """Return the largest conditions of the mass matrix and of the closures, or the reason why they are missing."""
    layout = motion.layout
    layout_coordinates, n = make_coordinates(layout), layout.velocity_count
    if not layout_coordinates.count:
        return None, None, "0 degrees of freedom"
    if n > MAX_FREEDOMS:
        return None, None, f"{n} degrees of freedom, more than {MAX_FREEDOMS}: full matrices are not formed"
    instant_limit = max(1, MAX_NUMBERS // (6 * n * len(layout.place) + n * n + n * len(layout.rows)))
    times = motion.times[:: -(-len(motion.times) // min(MAX_INSTANTS, max(instant_limit, 4)))]
    recovered = motion.recover(times)
    numbers = compute_conditions(layout, layout_coordinates, recovered)
    if not numbers.lightest_motion.any():
        return None, None, "0 degrees of freedom"
    k, m = int(np.argmax(numbers.mass)), int(np.argmax(numbers.closure))
    mass = LargestCondition(float(numbers.mass[k]), float(times[k]), find_lightest(layout_coordinates, numbers, k))
    closure = LargestCondition(float(numbers.closure[m]), float(times[m])) if layout.rows else None
    return mass, closure, ""


def find_lightest(layout_coordinates: Coordinates, numbers: ConditionNumbers, k: int) -> str:
    """Return the joint or body that moves most in the motion with the least inertia."""
    return layout_coordinates.find_owner(int(np.argmax(np.abs(numbers.lightest_motion[k]))))[0]


def find_singular_events(motion: MotionSearch) -> list[Event]:
    """Return singular poses that the motion passes or begins in, and bodies without inertia about an axis."""
    study = motion.study
    loops = study.setup.scene.mechanism.owner_path(motion.layout.rows[0]) if motion.layout.rows else ""
    singular_text = (
        "closed loops are stretched, folded or flat: their constraints lose rank, several motions are possible"
    )
    events = [Event(t, SINGULAR, loops, singular_text) for t in study.history.singular]
    events += [
        Event(float(motion.times[0]), SINGULAR, loops, note)
        for note in study.setup.model["notes"]
        if note.startswith("the start is a singular position")
    ]
    for spin in study.setup.scene.idle_spins:
        name = study.setup.scene.mechanism.bodies[spin.body].name
        message = f"{name} has no inertia about its own axis: the full mass matrix is singular"
        events.append(Event(float(motion.times[0]), NO_MASS, f"bodies.{name}", message))
    return events


MAX_LISTED_TIMES = 3  # listed in a sentence


def iter_troubles(result: Probe) -> Iterator[str]:
    """Yield what is difficult for heun's default method."""
    if result.status:
        yield result.status
    yield from iter_horizons(result)
    if result.implicit_method is None:
        yield from iter_stiffness(result)
    singular_events = [event for event in result.events if event.kind == SINGULAR]
    if singular_events:
        yield (
            f"singular positions: loop constraints lose rank at t = {format_instants(singular_events)} s; "
            "several motions are possible there"
        )
    closure = result.closure
    if closure is not None and closure.value * tolerances.NEARLY_SINGULAR > 1.0 and not singular_events:
        yield (
            f"nearly singular closed loops at t = {closure.time:.4g} s, condition number {closure.value:.1g}: "
            "reactions there lose accuracy by this factor"
        )
    out_of_plane = result.out_of_plane
    if out_of_plane is not None and out_of_plane.exponential and out_of_plane.rate > 0.0:
        yield (
            "unstable out of plane: an out-of-plane disturbance grows by a factor e every "
            f"{1.0 / out_of_plane.rate:.3g} s; heun solves the planar motion, which no "
            "real machine keeps for long"
        )


def iter_stiffness(result: Probe) -> Iterator[str]:
    """Yield a sentence if stability limits the steps of the explicit default."""
    stiffness = result.stiffness
    if stiffness is not None and stiffness.ratio > 1.0:
        alternative = (
            f"{result.implicit_method}, used in this run, has" if result.implicit_method else "an implicit method has"
        )
        yield (
            f"stiff: rates up to {max(stiffness.decay, stiffness.oscillation):.3g} 1/s limit DOP853 to steps of "
            f"{get_stable_step(result, 'DOP853'):.2g} s, {stiffness.ratio:.2g} times shorter "
            "than accuracy requires, "
            f"shortest at t = {stiffness.time:.4g} s; {alternative} no such limit"
        )


def iter_horizons(result: Probe) -> Iterator[str]:
    """Yield sentences on the horizon of the run, and of double precision."""
    growth = result.growth
    rate = ""
    if growth is not None and growth.rate > 0.0:
        rate = f": disturbances grow by a factor e every {1.0 / growth.rate:.3g} s"
    if growth is not None and growth.horizon is not None:
        yield f"chaos: no run in double precision is reliable past t = {growth.horizon:.4g} s{rate}"
    if result.run_horizon is not None:
        yield f"this run is not reliable past t = {result.run_horizon:.4g} s"


def iter_other_troubles(result: Probe) -> Iterator[str]:
    """Yield what is difficult for other methods, including explicit ones if the run uses an implicit one."""
    if result.implicit_method is not None:
        yield from iter_stiffness(result)
    by_kind = {kind: [e for e in result.events if e.kind == kind] for kind in (HALF_TURN, GIMBAL, DEAD_CENTRE, NO_MASS)}
    further_counts = {kind: sum(n for k, _, n in result.further_events if k == kind) for kind in by_kind}
    if turns := by_kind[HALF_TURN]:
        n = len(turns) + further_counts[HALF_TURN]
        yield (
            f"global Rodrigues parameters (DOP853-rodrigues) fail at {format_count(n, 'half revolution')}: "
            f"{format_bodies(turns)}"
        )
    if locks := by_kind[GIMBAL]:
        yield f"Euler angles at or near gimbal lock: {format_bodies(locks)}"
    if centres := by_kind[DEAD_CENTRE]:
        n = len(centres) + further_counts[DEAD_CENTRE]
        joints = list_some(list(dict.fromkeys(e.where.removeprefix("joints.") for e in centres)))
        yield (
            f"{format_count(n, 'dead centre')} of {joints}, which cannot drive the mechanism there; at t = "
            f"{format_instants(centres)} s"
        )
    if by_kind[NO_MASS] or (result.mass is not None and math.isinf(result.mass.value)):
        yield "the full mass matrix is singular: methods that factorise it fail; heun's recursion does not"
    if result.stiffness is not None and result.stiffness.ratio <= 1.0:
        yield from iter_limited_methods(result)


def iter_limited_methods(result: Probe) -> Iterator[str]:
    """Yield a sentence on explicit methods whose steps stability limits, though not the default's."""
    assert result.stiffness is not None
    names = [s.method for s in result.stiffness.steps if s.accuracy > s.stability]
    if names:
        yield f"stability, not accuracy, limits the steps of {list_some(names)}"


def get_stable_step(result: Probe, name: str) -> float:
    """Return the stable step of a method [s]."""
    assert result.stiffness is not None
    return next((s.stability for s in result.stiffness.steps if s.method == name), math.nan)


def format_bodies(events: list[Event]) -> str:
    """List bodies with their first instants."""
    first: dict[str, list[Event]] = {}
    for event in events:
        first.setdefault(event.where.removeprefix("bodies."), []).append(event)
    return "; ".join(f"{name} at t = {format_instants(body_events)} s" for name, body_events in first.items())


def format_instants(events: list[Event]) -> str:
    """List the first instants of events."""
    times = list(dict.fromkeys(f"{event.time:.6g}" for event in events))
    return ", ".join(times[:MAX_LISTED_TIMES]) + (" ..." if len(times) > MAX_LISTED_TIMES else "")


MAX_LISTED_EVENTS = 100  # listed events of one kind and place


def probe(spec: Spec, options: Options) -> Probe:
    """Probe the motion of a spec, or its state. Raises what solving it raises."""
    with attach_locations(spec):
        return make_probe(spec, options)


def make_probe(spec: Spec, options: Options) -> Probe:
    """Probe a spec. Errors name bodies, joints and sections, but not their location in the file."""
    study = solve(spec, replace(options, requested_reports=frozenset({"motion"})))
    motion = MotionSearch(study)
    attitude_events, attitude_results = find_attitude_events(motion)
    centres, skipped_loops = find_dead_centres(motion)
    mass, closure, no_condition = find_largest_conditions(motion)
    stiffness, no_stiffness = find_stiffness(motion)
    growth, no_growth = find_integrated_growth(motion)
    out_of_plane, no_out_of_plane = find_out_of_plane_growth(motion)
    listed, further_events = limit_events(
        distinct_events([*attitude_events, *centres, *find_singular_events(motion)], motion.span)
    )
    checked_run, results = study.history.checked_run, study.results
    reasons = {
        "stiffness": no_stiffness, "growth_rate": no_growth, "condition": no_condition, "out_of_plane": no_out_of_plane,
        "dead centres": "; ".join(skipped_loops),
    }  # fmt: skip
    result = Probe(
        title=spec.title,
        duration=motion.span,
        model=dict(results.model),
        run_horizon=checked_run.horizon if checked_run is not None else None,
        error=float(study.history.estimate["motion"]),
        status=str(results.status["message"]) if results.status["code"] != "completed" else "",
        events=tuple(listed),
        attitudes=tuple(attitude_results),
        mass=mass,
        closure=closure,
        stiffness=stiffness,
        growth=growth,
        out_of_plane=out_of_plane,
        reasons={key: text for key, text in reasons.items() if text},
        further_events=tuple(further_events),
    )
    return replace(result, trouble=tuple(iter_troubles(result)), others=tuple(iter_other_troubles(result)))


def limit_events(events: Sequence[Event]) -> tuple[list[Event], list[tuple[str, str, int]]]:
    """Return the first MAX_LISTED_EVENTS events of each kind and place, and how many more there are."""
    counts: Counter[tuple[str, str]] = Counter()
    listed = []
    for event in events:
        counts[event.kind, event.where] += 1
        if counts[event.kind, event.where] <= MAX_LISTED_EVENTS:
            listed.append(event)
    return listed, [(*key, count - MAX_LISTED_EVENTS) for key, count in counts.items() if count > MAX_LISTED_EVENTS]
