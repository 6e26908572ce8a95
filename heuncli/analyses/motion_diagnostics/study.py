"""Diagnose what in a scene's motion is difficult for numerical methods, and give a verdict.

Impure: integration reads the clock.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from heuncli.analyses.motion_diagnostics.conditions import find_largest_conditions, find_singular_events
from heuncli.analyses.motion_diagnostics.growth import find_out_of_plane_growth, growing
from heuncli.analyses.motion_diagnostics.motion_events import (
    MotionSearch,
    distinct_events,
    find_attitude_events,
    find_dead_centres,
)
from heuncli.analyses.motion_diagnostics.results import Event, Probe
from heuncli.analyses.motion_diagnostics.stiffness import find_stiffness
from heuncli.analyses.motion_diagnostics.verdict import iter_other_troubles, iter_troubles
from heuncli.base.records import replace
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import attach_locations
from heuncli.study.workflow import solve

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
    growth, no_growth = growing(motion)
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
