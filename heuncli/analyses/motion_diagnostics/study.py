"""Diagnose what in a scene's motion is difficult for numerical methods, and give a verdict.

Impure: integration reads the clock.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from heuncli.analyses.motion_diagnostics.dead_centres import find_dead_centres
from heuncli.analyses.motion_diagnostics.growth import find_integrated_growth, find_out_of_plane_growth
from heuncli.analyses.motion_diagnostics.motion_events import (
    MotionSearch,
    distinct_events,
    find_attitude_events,
)
from heuncli.analyses.motion_diagnostics.results import (
    NO_MASS,
    SINGULAR,
    Event,
    LargestCondition,
    Probe,
)
from heuncli.analyses.motion_diagnostics.stiffness import find_stiffness
from heuncli.analyses.motion_diagnostics.twists import ConditionNumbers, compute_conditions
from heuncli.analyses.motion_diagnostics.verdict import iter_other_troubles, iter_troubles
from heuncli.base.records import replace
from heuncli.loads.equilibrium.coordinates import Coordinates, make_coordinates
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import attach_locations
from heuncli.study.workflow import solve

MAX_FREEDOMS = 400  # largest size of matrices that are formed
MAX_NUMBERS = 20_000_000  # numbers in these matrices at a time
MIN_INSTANTS, MAX_INSTANTS = 4, 400  # at which the conditions are computed
MAX_LISTED_EVENTS = 100  # listed events of one kind and place


def find_largest_conditions(motion: MotionSearch) -> tuple[LargestCondition | None, LargestCondition | None, str]:
    """Return the largest conditions of the mass matrix and of the closures, or the reason why they are missing."""
    layout = motion.layout
    layout_coordinates, n = make_coordinates(layout), layout.velocity_count
    if not layout_coordinates.count:
        return None, None, "0 degrees of freedom"
    if n > MAX_FREEDOMS:
        return None, None, f"{n} degrees of freedom, more than {MAX_FREEDOMS}: full matrices are not formed"
    numbers_per_instant = 6 * n * len(layout.place) + n * n + n * len(layout.rows)
    instant_limit = min(MAX_INSTANTS, max(MAX_NUMBERS // numbers_per_instant, MIN_INSTANTS))
    times = motion.times[:: math.ceil(len(motion.times) / instant_limit)]
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
