"""From a validated spec to its results: the program of `heun run` and of `heun model` as lists of their stages.

    Spec -> Setup                 model/     what is solved, by which method, and why
    Setup -> History              solve/     what happens, and how well it is known
    History -> Results            compose/   the answers at some instants as blocks of results
    between the instants          search/    extremes, crossings of zero
    Study                         ask/       the solved scene: measures, expectations, events

Each folder imports those above it in this list alone, and the workflow all of them. The way of one number, from the
kernel's answer to the cell of a table, stands in compose/blocks.py. Impure: looks at the clock.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from heuncli.base.errors import SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import replace
from heuncli.multibody.stages import ANEW, Stages
from heuncli.results.results import Block
from heuncli.results.results_schema import SHARES
from heuncli.scene.file_format.models import ResultCondition, Spec, Stop
from heuncli.study.ask.study import Study
from heuncli.study.compose.recovery import recover
from heuncli.study.compose.results import compose, impulses_of
from heuncli.study.model.error_places import placed
from heuncli.study.model.memory_estimate import require_room
from heuncli.study.model.method_choice import anew
from heuncli.study.model.options import Options, as_asked
from heuncli.study.model.selection import needed_by
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.solve.history import integrate

if TYPE_CHECKING:
    from heuncli.motion.integration.methods.method import Method


def solve(spec: Spec, options: Options | None = None, stages: Stages = ANEW) -> Study:
    """The scene solved as its analysis asks; stages: what of its set-up is not made anew.

    Raises SpecError, LimitError, and SolveError whose problems have their places in the spec.
    """
    options = options or Options()
    deadline = time.monotonic() + options.time_limit if options.time_limit is not None else None
    with placed(spec):
        try:
            return solved(spec, options, deadline, stages)
        except SolveError as error:
            on_result = any(c.ends and isinstance(c, ResultCondition) for c in spec.analysis.conditions)
            if error.reached is None or not on_result:
                raise
            from heuncli.study.ask.events import before_failure  # few scenes end so

            return before_failure(spec, by(options, deadline), error)


def by(options: Options, deadline: float | None) -> Callable[[Spec], Study]:
    """What solves the spec with other instants or conditions, by the same options and the same deadline."""
    return lambda spec: solved(spec, options, deadline)


def solved(spec: Spec, options: Options, deadline: float | None, stages: Stages = ANEW) -> Study:
    """The scene solved up to its last instant; deadline: of time.monotonic() [s].

    Raises what `solve` does; SolveError also where a motion fails behind the event that was to end it.
    """
    begun = time.perf_counter()
    conditions = spec.analysis.conditions
    spec = as_asked(spec, options)
    setup = asked_set_up(spec, options, stages)
    if options.room is not None:
        require_room(setup, options.room, in_parts=options.in_parts)
    built = time.perf_counter()
    by_cause = SHARES in options.reports
    history = integrate(setup, spec.analysis.tolerance, deadline, by_cause=by_cause, room=options.room)
    # conditions on results may need more of them than is told: `whole` has it all, `setup` what was asked for
    whole, setup = setup, replace(setup, asked=options.asked) if conditions else setup
    moved = time.perf_counter()
    parts = None
    if options.in_parts:
        from heuncli.study.compose.parts import composed_in_parts  # what is only exported

        parts = composed_in_parts(setup, history, options.reports, options.least_norm)
    recovery = (
        recover(setup, history.recovered, options.least_norm, history.compared) if parts is None else parts.recovery
    )
    impulses = impulses_of(setup, history, options.least_norm, by_cause)
    results = compose(setup, history, recovery, options.reports, impulses, parts)
    looked_for = setup.rest.seconds if setup.rest is not None else 0.0  # counted as integration by the history
    seconds = {"load": options.load_seconds, "build": built - begun - looked_for, **history.seconds}
    results.work["seconds"] = seconds | {"recover": time.perf_counter() - moved}
    study = Study(spec, options, setup, history, recovery if parts is None else None, results, impulses)
    if not (conditions or spec.latches):
        return study
    from heuncli.study.ask.events import with_events  # few scenes have them

    return with_events(study, whole, by(options, deadline))


def asked_set_up(spec: Spec, options: Options, stages: Stages = ANEW) -> Setup:
    """What is solved of a spec `as_asked`: as much as the options ask for, and its conditions. Raises as `set_up`."""
    conditions = spec.analysis.conditions
    asked = options.asked.with_all(needed_by(conditions, spec)) if conditions else options.asked
    return set_up(spec, reduce=options.reduce, asked=asked, stages=stages)


def describe(spec: Spec, *, reduce: bool = True) -> Block:
    """The block `model` of a scene, with its names, advice on what is redundant, and what a run of it will take.

    Raises as `solve` does.
    """
    from heuncli.loads.redundancy.advice import advice  # runs give none
    from heuncli.study.model.forecast import noticed, outlook

    with placed(spec):
        asked = Options(wanted=None if spec.report is None else frozenset(spec.report)).asked
        setup = set_up(spec, reduce=reduce, asked=asked, looked_for=False)
        found = noticed(setup)
        if found is not None:
            setup = by_another_method(setup, *found)
        return setup.model | {
            "names": names_of(setup),
            "integrates": outlook(setup),
            "reasons": [*setup.model["reasons"], *watched(spec)],
            "notes": setup.model["notes"] + advice(setup.scene, setup.model),
        }


def names_of(setup: Setup) -> Block:
    """The names of the bodies, and of the joints with their kinds, as specs call them."""
    mechanism = setup.scene.mechanism
    kinds = {j.name: JOINTS[j.kind].spoken or j.kind for j in mechanism.joints}
    return {"bodies": [b.name for b in mechanism.bodies], "joints": kinds}


def watched(spec: Spec) -> list[str]:
    """What ends a run, what is watched, and what strikes when, in sentences."""
    times = {True: "every time", False: "the first time"}
    blows = [f"strikes: {b.name}, {times[b.every]} that {b.when.text}" for b in spec.impulses.values() if b.when]
    return [*blows, *(latched(name, stop) for name, stop in spec.latches.items())] + [
        f"ends: until {c.text}" if c.ends else f"watched: {c.name} ({c.text})" for c in spec.analysis.conditions
    ]


def latched(name: str, stop: Stop[str]) -> str:
    """What a latch holds, and when, in a sentence."""
    assert stop.latch is not None
    latch, what = stop.latch, f"{stop.joint}.{stop.quantity}"
    where = f"at the stop {latch.stop}" if latch.stop is not None else "where it is"
    if latch.at is not None:
        where = f"at {latch.at:.6g} {'rad' if stop.quantity == 'angle' else 'm'}"
    begins = f" while {latch.when.text}" if latch.when is not None else ""
    again = "and catches again after" if latch.every else "once"
    ends = f", until {latch.release.text}, {again}" if latch.release is not None else ", and never lets go"
    return f"catches: {name}, {what} {where}{begins}{ends}"


def by_another_method(setup: Setup, method: Method, why: str) -> Setup:
    """The scene with the method that a motion of it is begun anew with, being stiff or full of events."""
    told = {"method": method.name, "reasons": [*setup.model["reasons"], anew(why, method)]}
    return replace(setup, method=method, model=setup.model | told)
