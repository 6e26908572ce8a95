"""The events of a motion: changes of conditions on time and coordinates, and on numbers of the results.

The kernel meets the first kind (motion/integration/check/changes.py). The second kind is searched for after the run
(watched_numbers.py). A motion that ends where such a number passes its limit is solved twice: once as a whole, or as
far as it goes, and once up to that instant.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from dataclasses import replace as replace_fields

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.motion.integration.check.changes import ConditionChanges
from heuncli.results.results import Block, Results, Status
from heuncli.results.results_schema import EVENTS, SHARES
from heuncli.scene.file_format.models import ResultCondition, Spec, WatchedCondition
from heuncli.scene.file_format.names import name_sticking_event
from heuncli.study.compose.recovery import recover
from heuncli.study.compose.results import compose, find_impulses
from heuncli.study.model.setup import Setup
from heuncli.study.queries.study import Study
from heuncli.study.queries.watched_numbers import describe_reasons, find_result_changes
from heuncli.study.solve.history import History, resample

Solve = Callable[[Spec], Study]  # solves a spec that differs only in its instants or conditions

MAX_DIGITS = 6  # digits of an instant in sentences


def add_events(study: Study, setup: Setup, solve: Solve) -> Study:
    """Return the study with its events. A motion that ends on a result is solved again up to that instant.

    setup: with all results that the conditions need
    """
    changes_by_name = {changes.name: changes for changes in study.history.changes}
    conditions = study.spec.analysis.conditions
    for condition in conditions:
        if isinstance(condition, ResultCondition):
            changes_by_name[condition.name] = find_result_changes(study, setup, condition)
    first = min(
        (
            t
            for c in conditions
            if isinstance(c, ResultCondition) and (t := find_end_time(c, changes_by_name)) is not None
        ),
        default=None,
    )
    if first is not None and first < study.results.time[-1]:
        return solve_until_event(
            study, changes_by_name, first, solve, describe_reasons(study, setup, changes_by_name, first)
        )
    return add_event_blocks(
        replace(study, changes=changes_by_name),
        describe_reasons(study, setup, changes_by_name, float(study.history.times[-1])),
    )


def find_end_time(condition: WatchedCondition, changes_by_name: Mapping[str, ConditionChanges]) -> float | None:
    """Return the instant at which a condition ends the motion, or None.

    Conditions that entries bring with them, such as a wheel that lifts, also end it at the start; a condition in
    `until` has to become true.
    """
    changes = changes_by_name[condition.name]
    if changes.begins and condition.ends and isinstance(condition, ResultCondition) and condition.why:
        return 0.0
    became = changes.times[changes.values]
    return float(became[0]) if condition.ends and len(became) else None


def solve_until_event(
    study: Study, changes_by_name: Mapping[str, ConditionChanges], t: float, solve: Solve, why: Mapping[str, str]
) -> Study:
    """Return the motion of a study up to the instant t at which its ending condition becomes true.

    changes_by_name: all changes of the study; why: from `describe_reasons`

    If an impact, a stick or a jump happens at t, the results show the values after it: the run continues for a moment.
    """
    analysis = study.spec.analysis
    times_before, moment_after = [x for x in analysis.times if x < t] + [t], find_moment_after(study.history, t)
    run_to = times_before if moment_after is None else [*times_before, moment_after]
    shorter = solve(study.spec._replace(analysis=analysis._replace(times=tuple(run_to), conditions=())))
    if moment_after is not None:
        shorter = truncate_study(shorter, find_jump(shorter.history, t))
    last = float(shorter.results.time[-1])
    changes = {name: changes.select_possible_until(t, last) for name, changes in changes_by_name.items()}
    return add_event_blocks(replace(shorter, spec=study.spec, changes=changes), why)


def find_jump(history: History, t: float) -> float:
    """Return the jump of a motion at an instant, up to rounding; the instant itself if there is none."""
    jumps = np.array(history.jumps)
    near = jumps[np.abs(jumps - t) <= tolerances.SIDE_BY_SIDE * t]
    return float(near[np.argmin(np.abs(near - t))]) if len(near) else t


def find_moment_after(history: History, t: float) -> float | None:
    """Return an instant after a jump at t, before anything else happens; None if nothing jumps there."""
    assert history.checked_run is not None
    near = tolerances.SIDE_BY_SIDE * t
    if not any(abs(jump - t) <= near for jump in history.jumps):
        return None
    marks = np.concatenate([history.checked_run.run.ends, history.jumps, history.times])
    behind = marks[marks > t + near]
    return float(0.5 * (t + behind.min())) if len(behind) else None


def truncate_study(study: Study, t: float) -> Study:
    """Return a study with its instants before t, and t itself, without the later ones."""
    history, setup, options = study.history, study.setup, study.options
    assert history.checked_run is not None
    times = np.append(history.times[history.times < t * (1.0 - tolerances.SIDE_BY_SIDE)], t)
    by_cause = SHARES in options.reports
    solutions, run = resample(setup.runner, history, times, by_cause=by_cause), history.checked_run.run
    impulses = tuple(impulse for impulse in run.impulse_events if impulse.time <= t)
    run = replace(run, times=times, states=setup.runner.resample(run, times), impulse_events=impulses)
    history = replace(
        history,
        times=times,
        find_solutions=solutions.select,
        checked_run=replace(history.checked_run, run=run, evaluate=solutions.select),
        impulses=impulses,
        jumps=tuple(x for x in history.jumps if x <= t),
        singular=tuple(x for x in history.singular if x <= t),
    )
    recovery = recover(setup, solutions, options.least_norm)
    impulse_results = find_impulses(setup, history, options.least_norm, by_cause)
    results = compose(setup, history, recovery, options.reports, impulse_results)
    results.work["seconds"] = dict(study.results.work["seconds"])
    return replace(study, history=history, result_recovery=recovery, results=results, impulse_results=impulse_results)


def solve_before_failure(spec: Spec, solve: Solve, error: SolveError) -> Study:
    """Return the motion if it ends on a result before the instant at which it would fail; otherwise raise the error."""
    assert error.reached is not None
    for share in tolerances.BEFORE_FAILURE:
        last = error.reached * (1.0 - share)
        times = (*(x for x in spec.analysis.times if x < last), last)
        if len(times) < 2:
            break
        with contextlib.suppress(SolveError):
            study = solve(spec._replace(analysis=spec.analysis._replace(times=times)))
            if any(find_end_time(c, study.changes) is not None for c in spec.analysis.conditions):
                return replace(study, spec=spec)
            break
    raise error


# Events in the results


def add_event_blocks(study: Study, why: Mapping[str, str]) -> Study:
    """Return the study with the events in its results, and a sentence on how the motion ended; why: from
    `describe_reasons`.
    """
    results, conditions = study.results, study.spec.analysis.conditions
    if EVENTS in study.options.reports:
        events = {c.name: make_event_block(c.text, study.changes[c.name]) for c in conditions}
        for name, stop in study.spec.latches.items():
            if name in study.changes:
                events[name] = make_event_block(f"{stop.joint}.{stop.quantity} held", study.changes[name])
        layout = study.setup.runner.layout
        for path in dict.fromkeys(layout.contacts[i].name for i in layout.friction_contacts):
            name = name_sticking_event(path.rpartition(".")[2])
            if name in study.changes:
                events[name] = make_event_block(f"{path} sticks", study.changes[name])
        results = replace_fields(results, events=events)
    for last in conditions:
        changes = study.changes[last.name]
        if last.name in why:
            results = add_reason(results, last, changes, why[last.name])
        elif last.ends:
            results = add_ending(results, last, changes)
    return replace(study, results=results)


def make_event_block(condition: str, changes: ConditionChanges) -> Block:
    """Return the block of one event in the results; condition: in words."""
    return {
        "condition": condition, "begins": changes.begins, "time": changes.times, "error": changes.error,
        "to": changes.values.tolist(),
    }  # fmt: skip


def add_ending(results: Results, condition: WatchedCondition, changes: ConditionChanges) -> Results:
    """Return the results with a sentence on the condition that was to end the motion."""
    began = "; it is true at the start, which does not count" if changes.begins else ""
    became = np.flatnonzero(changes.values)
    if len(became):
        k = int(became[0])
        time_text = format_instant(float(changes.times[k]), float(changes.error[k]))
        message = f"end condition {condition.text} met at t = {time_text} s{began}"
        status: Status = {"code": results.status["code"], "message": message}
    else:
        message = f"the end condition, {condition.text}, did not become true{began}"
        status = {"code": results.status["code"], "message": f"{results.status['message']}; {message}"}
    return replace_fields(results, status=status, model=results.model | {"until": [message]})


def add_reason(results: Results, condition: WatchedCondition, changes: ConditionChanges, why: str) -> Results:
    """Return the results with a sentence on a condition that an entry brings with it, if it ever is true."""
    became = np.flatnonzero(changes.values)
    if changes.begins:
        sentence = f"at the start {why}"
    elif len(became):
        k = int(became[0])
        sentence = f"at t = {format_instant(float(changes.times[k]), float(changes.error[k]))} s {why}"
    else:
        return results
    if condition.ends:
        status: Status = {"code": "stopped", "message": sentence}
        warned = (f"stopped before the end: {sentence}",) if changes.begins else ()
        ended = replace_fields(results, status=status, model=results.model | {"until": [sentence]})
        return replace_fields(ended, warnings=(*results.warnings, *warned))
    return replace_fields(results, warnings=(*results.warnings, sentence))


def format_instant(t: float, error: float) -> str:
    """Format an instant with the digits that its error leaves."""
    if not error < t:
        return f"{t:.1g}?"
    digits = MAX_DIGITS if error <= 0.0 else min(MAX_DIGITS, max(1, math.floor(math.log10(t / error))))
    return f"{t:.{digits}g}"
