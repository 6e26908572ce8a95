"""The events of a motion: when conditions change, those in time and coordinates and those on numbers of the results.

The first are met by the kernel (motion/integration/check/changes.py). The others are searched for after the run: a
number of the results is taken against its limit, a vector by its magnitude, a run of cuts over its whole stretch. A
motion that ends where such a number passes its limit is solved twice: as a whole, or as far as it goes, and up to
there.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace as changed

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.motion.integration.check.changes import Changes, blows_apart
from heuncli.results.results import Array, Block, Results, Status
from heuncli.results.results_paths import find
from heuncli.results.results_schema import CUT, EVENTS, KIND_OF, MAGNITUDES, SHARES, kind_of_error, quantity
from heuncli.scene.file_format.models import ResultCondition, Spec, WatchedCondition
from heuncli.scene.file_format.resolve_couplings import at_least
from heuncli.study.ask.measure import report_of, stated_error
from heuncli.study.ask.study import Study
from heuncli.study.compose.recovery import recover
from heuncli.study.compose.results import compose, impulses_of
from heuncli.study.model.setup import Setup
from heuncli.study.search.crossings import Crossings, crossings
from heuncli.study.search.extremes import search
from heuncli.study.solve.history import History, resample

Solve = Callable[[Spec], Study]  # how a spec is solved that differs in its instants or conditions alone

SHOWN = 6  # digits of an instant in sentences
NOT_TOLD = "of the event {} instants may be missing: {} is open, or not known, at some of those looked at"
TOO_MANY = "of the event {} instants may be missing: the search was ended before all was looked at"


def with_events(study: Study, setup: Setup, solve: Solve) -> Study:
    """The study with its events; setup: of all that conditions need. What ends on a result is solved up to there."""
    found = {changes.name: changes for changes in study.history.changes}
    conditions = study.spec.analysis.conditions
    for condition in conditions:
        if isinstance(condition, ResultCondition):
            found[condition.name] = on_result(study, setup, condition)
    first = min(
        (t for c in conditions if isinstance(c, ResultCondition) and (t := ends_at(c, found)) is not None), default=None
    )
    if first is not None and first < study.results.time[-1]:
        return ended(study, found, first, solve, reasons(study, setup, found, first))
    return told(replace(study, changes=found), reasons(study, setup, found, float(study.history.times[-1])))


def ends_at(condition: WatchedCondition, found: Mapping[str, Changes]) -> float | None:
    """The instant at which a condition ends the motion, if it does.

    What entries bring with them, such as a wheel that lifts, ends it at the start, too: what is asked for in `until`
    has to become true.
    """
    changes = found[condition.name]
    if changes.begins and condition.ends and isinstance(condition, ResultCondition) and condition.why:
        return 0.0
    became = changes.times[changes.to]
    return float(became[0]) if condition.ends and len(became) else None


def ended(study: Study, found: Mapping[str, Changes], t: float, solve: Solve, why: Mapping[str, str]) -> Study:
    """The motion of a study up to the instant t at which its last condition becomes true; found: all its changes.

    why: as of `reasons`.

    Where something strikes, rests or jumps there, what holds behind it is told: the run goes on for a moment.
    """
    analysis = study.spec.analysis
    asked, later = [x for x in analysis.times if x < t] + [t], moment_behind(study.history, t)
    run_to = asked if later is None else [*asked, later]
    shorter = solve(study.spec._replace(analysis=analysis._replace(times=tuple(run_to), conditions=())))
    if later is not None:
        shorter = up_to(shorter, jump_at(shorter.history, t))
    last = float(shorter.results.time[-1])
    changes = {name: changes.known_by(t, last) for name, changes in found.items()}
    return told(replace(shorter, spec=study.spec, changes=changes), why)


def jump_at(history: History, t: float) -> float:
    """The jump of a motion that is at an instant but for rounding; the instant itself where none is."""
    jumps = np.array(history.jumps)
    near = jumps[np.abs(jumps - t) <= tolerances.SIDE_BY_SIDE * t]
    return float(near[np.argmin(np.abs(near - t))]) if len(near) else t


def moment_behind(history: History, t: float) -> float | None:
    """An instant behind a jump at t, before anything else happens; None where nothing jumps there."""
    assert history.checked is not None
    near = tolerances.SIDE_BY_SIDE * t
    if not any(abs(jump - t) <= near for jump in history.jumps):
        return None
    marks = np.concatenate([history.checked.run.ends, history.jumps, history.times])
    behind = marks[marks > t + near]
    return float(0.5 * (t + behind.min())) if len(behind) else None


def up_to(study: Study, t: float) -> Study:
    """What a study tells before its last instants, those from t on, and at t."""
    history, setup, options = study.history, study.setup, study.options
    assert history.checked is not None
    times = np.append(history.times[history.times < t * (1.0 - tolerances.SIDE_BY_SIDE)], t)
    by_cause = SHARES in options.reports
    own, run = resample(setup.runner, history, times, by_cause=by_cause), history.checked.run
    kept = tuple(blow for blow in run.blows if blow.time <= t)
    run = replace(run, times=times, states=setup.runner.resample(run, times), blows=kept)
    history = replace(
        history, times=times, answers=own.at, checked=replace(history.checked, run=run, answers=own.at), blows=kept,
        jumps=tuple(x for x in history.jumps if x <= t), singular=tuple(x for x in history.singular if x <= t),
    )  # fmt: skip
    recovery = recover(setup, own, options.least_norm)
    struck = impulses_of(setup, history, options.least_norm, by_cause)
    results = compose(setup, history, recovery, options.reports, struck)
    results.work["seconds"] = dict(study.results.work["seconds"])
    return replace(study, history=history, composed=recovery, results=results, struck=struck)


def before_failure(spec: Spec, solve: Solve, error: SolveError) -> Study:
    """The motion that ends on a result before the instant at which it would fail; else raises the error."""
    assert error.reached is not None
    for share in tolerances.BEFORE_FAILURE:
        last = error.reached * (1.0 - share)
        times = (*(x for x in spec.analysis.times if x < last), last)
        if len(times) < 2:
            break
        with contextlib.suppress(SolveError):
            study = solve(spec._replace(analysis=spec.analysis._replace(times=times)))
            if any(ends_at(c, study.changes) is not None for c in spec.analysis.conditions):
                return replace(study, spec=spec)
            break
    raise error


# Conditions on numbers of the results


class WatchedNumber(NamedTuple):
    """A number of the results against its limit: above zero where the condition is true, squared where it is even."""

    study: Study
    setup: Setup
    condition: ResultCondition
    even: bool
    along: bool

    def sample(self, times: Array) -> Array:
        """The number at instants (n,), ascending; nan where it is open."""
        most = self.study.instants_at_once
        return np.concatenate([self._part(times[i : i + most]) for i in range(0, len(times), most)])

    def column(self, times: Array) -> Array:
        """The same as the only column of a search, (n, 1)."""
        return self.sample(times)[:, None]

    def _part(self, times: Array) -> Array:
        values, condition = self.values(times), self.condition
        limit = condition.limit * abs(condition.limit) if self.even else condition.limit
        return np.asarray(values - limit if condition.above else limit - values)

    def values(self, times: Array) -> Array:
        """The number itself, or its square; of a run of cuts the end of its range that comes first to the limit."""
        wanted = report_of(self.condition.of)
        results = self.study.reports_at(times, wanted if wanted is not None else frozenset(), self.setup)
        found = find(results, self.condition.of)
        values = found.values
        if found.of_vectors:
            values = np.einsum("...k,...k->...", values, values)
        elif self.even:
            values = values * values
        if not self.along:
            return values.reshape(len(times))
        from heuncli.study.search.stretches import envelope

        return np.asarray(envelope(values)[:, int(self.condition.above)])

    def error(self, keys: Sequence[str], h: Array) -> float:
        """The error of the number; h: as sampled. What has no error of its own errs as its kind."""
        row, estimate, limit = quantity(keys), self.study.history.estimate, abs(self.condition.limit)
        largest = float(np.max(np.abs(h), initial=0.0, where=np.isfinite(h)))
        largest = limit + (math.sqrt(largest) if self.even else largest)
        kind = kind_of_error(keys[0], ".".join(keys[1:-1]), keys[-1])
        relative = float(estimate.get(KIND_OF.get(kind, kind), 0.0))  # type: ignore[arg-type]
        known = (*(self.study.magnitudes.errors.get((kind, unit), 0.0) for unit in row.units),) if row else ()
        own = stated_error(self.study, keys) if any(known) else relative * largest
        return max(float(np.nan_to_num(own)), tolerances.WRITTEN * largest)


def on_result(study: Study, setup: Setup, condition: ResultCondition) -> Changes:
    """When a number of the results comes below its limit, or above it, and back; up to the horizon."""
    times = looked_at(study)
    number, keys = watched(study, setup, condition, times)
    h = number.sample(times)
    error = number.error(keys, h)
    found = crossings(number.sample, times, h, error * (2.0 * abs(condition.limit) + error) if number.even else error)
    if found.gaps:
        study.later_warnings[NOT_TOLD.format(condition.name, condition.of)] = None
    if not found.complete:
        study.later_warnings[TOO_MANY.format(condition.name)] = None
    return Changes(condition.name, found.begins, found.times, found.up, at_jumps(study, found))


def looked_at(study: Study) -> Array:
    """The instants between which conditions are searched for, up to the horizon."""
    times, horizon = study.search_times, study.results.horizon
    return times if horizon is None else times[times < horizon]


def watched(
    study: Study, setup: Setup, condition: ResultCondition, times: Array
) -> tuple[WatchedNumber, tuple[str, ...]]:
    """The number of a condition, and the keys under which it stands in the results."""
    wanted = report_of(condition.of)
    asked = find(study.reports_at(times[:1], wanted if wanted is not None else frozenset(), setup), condition.of)
    even, along = asked.of_vectors or asked.keys[-1] in MAGNITUDES, CUT in asked.axes
    if along:
        from heuncli.study.search.stretches import stretched

        setup = stretched(setup, asked.bent)
    return WatchedNumber(study, setup, condition, even, along), asked.keys


def reasons(study: Study, setup: Setup, found: Mapping[str, Changes], last: float) -> dict[str, str]:
    """What conditions that entries bring with them mean, in words, of a motion up to an instant; found: their changes.

    Setup: of all that they need. Of what is given too small it is told by the furthest that the number comes.
    """
    words = {}
    for condition in study.spec.analysis.conditions:
        if not (isinstance(condition, ResultCondition) and condition.why):
            continue
        changes, words[condition.name] = found[condition.name], condition.why
        if condition.given is not None and (changes.begins or (changes.times[changes.to] <= last).any()):
            times = looked_at(study)
            times = np.append(times[times < last], last) if last < times[-1] else times
            number, keys = watched(study, setup, condition, times)
            error = np.array([number.error(keys, number.sample(times))])
            lacking = search(number.column, times, errors=error, sides=(1.0,)).high[0]
            words[condition.name] = condition.why.format(at_least(condition.given + float(lacking)))
    return words


def at_jumps(study: Study, found: Crossings) -> Array:
    """The errors of the instants; of a blow by when other runs have it, of other jumps that of the motion."""
    history, off = study.history, found.error.copy()
    struck = [blows_apart(history.blows, other) for other in history.beside]
    moving = history.estimate["motion"] * float(history.times[-1])
    for i in np.flatnonzero(found.jumps):
        apart = [each.get(float(found.times[i]), 0.5 * moving) for each in struck] or [0.5 * moving]
        off[i] = max(off[i], 2.0 * max(apart))
    return off


# What is told


def told(study: Study, why: Mapping[str, str]) -> Study:
    """The study with its events in the results, and a sentence on how it ended; why: as of `reasons`."""
    results, conditions = study.results, study.spec.analysis.conditions
    if EVENTS in study.options.reports:
        events = {c.name: block(c.text, study.changes[c.name]) for c in conditions}
        for name, stop in study.spec.latches.items():
            if name in study.changes:
                events[name] = block(f"{stop.joint}.{stop.quantity} held", study.changes[name])
        results = changed(results, events=events)
    for last in conditions:
        changes = study.changes[last.name]
        if last.name in why:
            results = with_reason(results, last, changes, why[last.name])
        elif last.ends:
            results = ending(results, last, changes)
    return replace(study, results=results)


def block(condition: str, changes: Changes) -> Block:
    """One event as it stands in the results; condition: in words."""
    return {
        "condition": condition, "begins": changes.begins, "time": changes.times, "error": changes.error,
        "to": changes.to.tolist(),
    }  # fmt: skip


def ending(results: Results, last: WatchedCondition, changes: Changes) -> Results:
    """The results with a sentence on the condition that was to end the motion."""
    began = "; it is true at the start, which ends nothing" if changes.begins else ""
    became = np.flatnonzero(changes.to)
    if len(became):
        k = int(became[0])
        at = instant(float(changes.times[k]), float(changes.error[k]))
        message = f"ended at t = {at} s: until {last.text}{began}"
        status: Status = {"code": results.status["code"], "message": message}
    else:
        message = f"the condition to end, {last.text}, did not become true{began}"
        status = {"code": results.status["code"], "message": f"{results.status['message']}; {message}"}
    return changed(results, status=status, model=results.model | {"until": [message]})


def with_reason(results: Results, condition: WatchedCondition, changes: Changes, why: str) -> Results:
    """The results with a sentence on a condition that an entry brings with it, if it ever is true."""
    became = np.flatnonzero(changes.to)
    if changes.begins:
        sentence = f"at the start {why}"
    elif len(became):
        k = int(became[0])
        sentence = f"at t = {instant(float(changes.times[k]), float(changes.error[k]))} s {why}"
    else:
        return results
    if condition.ends:
        status: Status = {"code": "stopped", "message": sentence}
        warned = (f"stopped before the end: {sentence}",) if changes.begins else ()
        ended = changed(results, status=status, model=results.model | {"until": [sentence]})
        return changed(ended, warnings=(*results.warnings, *warned))
    return changed(results, warnings=(*results.warnings, sentence))


def instant(t: float, error: float) -> str:
    """An instant with the digits that its error leaves."""
    if not error < t:
        return f"{t:.1g}?"
    digits = SHOWN if error <= 0.0 else min(SHOWN, max(1, math.floor(math.log10(t / error))))
    return f"{t:.{digits}g}"
