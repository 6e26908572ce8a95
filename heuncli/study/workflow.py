"""From a validated spec to its results: `heun run` and `heun model` as lists of their stages.

    Spec -> Setup                 model/     what is solved, by which method, and why
    Setup -> History              solve/     the motion, and the errors of its numbers
    History -> Results            compose/   the kernel's solutions at some instants as blocks of results
    between the instants          search/    extremes, crossings of zero
    Study                         queries/   the solved scene: measures, expectations, events

Each folder imports only those above it in this list; the workflow imports all of them. compose/blocks.py describes how
one number gets from the kernel's solution to the cell of a table. `heun model` shows the first two, with a forecast
from the beginning of the run. Impure: reads the clock.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from heuncli.base.errors import LimitError, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.method_rows import find_method
from heuncli.base.records import replace
from heuncli.base.spelling import format_count
from heuncli.motion.integration.check.runs import Runs, try_fewer_stages
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.kernel_loop import depends_on_state
from heuncli.motion.integration.run.request import EventfulRun, MotionTask, StiffRun, StoppingRules
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.results.results import Block
from heuncli.results.results_schema import SHARES
from heuncli.scene.file_format.models import ResultCondition, Spec, Stop
from heuncli.study.compose.recovery import recover
from heuncli.study.compose.results import compose, find_impulses
from heuncli.study.model.memory import has_few_numbers, require_memory
from heuncli.study.model.method_choice import explain_restart, is_smooth
from heuncli.study.model.options import Options, apply_options
from heuncli.study.model.selection import select_for_conditions
from heuncli.study.model.setup import Setup, attach_locations, set_up
from heuncli.study.queries.study import Study
from heuncli.study.solve.history import integrate

TRIAL_SHARE = 0.1  # share of the run that a forecast integrates
MAX_TRIAL_SECONDS = 0.5  # seconds for it
MAX_TRIAL_STEPS = 2_000


def solve(spec: Spec, options: Options | None = None, stages: Stages = NO_CACHE) -> Study:
    """Solve the scene of a spec as its analysis requires.

    stages: the cache of set-up stages that a call may reuse.

    Raises SpecError, LimitError, and SolveError whose problems carry their locations in the spec.
    """
    options = options or Options()
    deadline = time.monotonic() + options.time_limit if options.time_limit is not None else None
    with attach_locations(spec):
        try:
            return solve_by_deadline(spec, options, deadline, stages)
        except SolveError as error:
            has_result_condition = any(c.ends and isinstance(c, ResultCondition) for c in spec.analysis.conditions)
            if error.reached is None or not has_result_condition:
                raise
            from heuncli.study.queries.events import solve_before_failure  # few scenes end so

            return solve_before_failure(spec, make_solver(options, deadline), error)


def make_solver(options: Options, deadline: float | None) -> Callable[[Spec], Study]:
    """Make a function that solves the spec at other instants or conditions, with the same options and deadline."""
    return lambda spec: solve_by_deadline(spec, options, deadline)


def solve_by_deadline(spec: Spec, options: Options, deadline: float | None, stages: Stages = NO_CACHE) -> Study:
    """Solve the scene up to its last instant.

    deadline: by time.monotonic() [s]

    Raises what `solve` does; SolveError also where a motion fails after the event that was to end it.
    """
    start = time.perf_counter()
    conditions = spec.analysis.conditions
    spec = apply_options(spec, options)
    setup = set_up_requested(spec, options, stages)
    if options.memory_budget is not None:
        require_memory(setup, options.memory_budget, in_parts=options.in_parts)
    setup_end = time.perf_counter()
    by_cause = SHARES in options.reports
    history = integrate(
        setup, spec.analysis.tolerance, deadline, by_cause=by_cause, memory_budget=options.memory_budget
    )
    # conditions may need more results than are shown: `full_setup` has all of them, `setup` the requested ones
    full_setup, setup = setup, replace(setup, selection=options.selection) if conditions else setup
    motion_end = time.perf_counter()
    parts = None
    if options.in_parts:
        from heuncli.study.compose.results import compose_in_parts  # only for exports

        parts = compose_in_parts(setup, history, options.reports, options.least_norm)
        if parts is None and options.memory_budget is not None and not has_few_numbers(setup, len(history.times)):
            require_memory(setup, options.memory_budget)  # a chain that turned out to need all instants
    recovery = (
        recover(setup, history.solutions, options.least_norm, history.state_instants)
        if parts is None
        else parts.recovery
    )
    impulses = find_impulses(setup, history, options.least_norm, by_cause)
    results = compose(setup, history, recovery, options.reports, impulses, parts)
    rest_seconds = setup.rest.seconds if setup.rest is not None else 0.0  # counted as integration by the history
    seconds = {"load": options.load_seconds, "build": setup_end - start - rest_seconds, **history.seconds}
    results.work["seconds"] = seconds | {"recover": time.perf_counter() - motion_end}
    study = Study(spec, options, setup, history, recovery if parts is None else None, results, impulses)
    if not (conditions or spec.latches or history.changes):
        return study
    from heuncli.study.queries.events import add_events  # few scenes have them

    return add_events(study, full_setup, make_solver(options, deadline))


def set_up_requested(spec: Spec, options: Options, stages: Stages = NO_CACHE) -> Setup:
    """Set up the parts of a spec that the options request and its conditions need. Raises what `set_up` does.

    spec: as `apply_options` returns it
    """
    conditions = spec.analysis.conditions
    selection = options.selection.union(select_for_conditions(conditions, spec)) if conditions else options.selection
    return set_up(spec, reduce=options.reduce, selection=selection, stages=stages)


# Model and forecast


def describe(spec: Spec, *, reduce: bool = True) -> Block:
    """Return the block `model` of a scene, with its names, advice on redundant constraints, and a forecast of the run.

    Raises what `solve` does.
    """
    from heuncli.loads.redundancy.advice import propose_replacements  # runs give none

    with attach_locations(spec):
        selection = Options(
            requested_reports=None if spec.report.results is None else frozenset(spec.report.results)
        ).selection
        setup = set_up(spec, reduce=reduce, selection=selection, find_rest=False)
        restart = find_restart_method(setup)
        if restart is not None:
            setup = with_restart_method(setup, *restart)
        return setup.model | {
            "names": list_names(setup),
            "integrates": describe_integration(setup),
            "reasons": [*setup.model["reasons"], *describe_conditions(spec)],
            "notes": setup.model["notes"] + propose_replacements(setup.scene, setup.model),
        }


def list_names(setup: Setup) -> Block:
    """Return the names of the bodies, and of the joints with their kinds, as specs write them."""
    mechanism = setup.scene.mechanism
    kinds = {j.name: JOINTS[j.kind].display_name or j.kind for j in mechanism.joints}
    return {"bodies": [b.name for b in mechanism.bodies], "joints": kinds}


def describe_conditions(spec: Spec) -> list[str]:
    """Describe in sentences what ends the run, what is watched, and which impulses act when."""
    times = {True: "each time", False: "the first time"}
    impulses = [f"impulse: {b.name}, {times[b.every]} {b.when.text}" for b in spec.impulses.values() if b.when]
    return [*impulses, *(describe_latch(name, stop) for name, stop in spec.latches.items())] + [
        f"end condition: {c.text}" if c.ends else f"event monitored: {c.name} ({c.text})"
        for c in spec.analysis.conditions
    ]


def describe_latch(name: str, stop: Stop[str]) -> str:
    """Describe in a sentence what a latch holds, and when."""
    assert stop.latch is not None
    latch, what = stop.latch, f"{stop.joint}.{stop.quantity}"
    where = f"at the stop {latch.stop}" if latch.stop is not None else "where it is"
    if latch.position is not None:
        where = f"at {latch.position:.6g} {'rad' if stop.quantity == 'angle' else 'm'}"
    begins = f" while {latch.when.text}" if latch.when is not None else ""
    again = "and latches again after" if latch.every else "once"
    ends = f", until {latch.release.text}, {again}" if latch.release is not None else ", and never releases"
    return f"latches: {name}, {what} {where}{begins}{ends}"


def with_restart_method(setup: Setup, method: Method, why: str) -> Setup:
    """Return the setup with the method that replaces the first one, because the motion is stiff or full of events."""
    changes = {"method": method.name, "reasons": [*setup.model["reasons"], explain_restart(why, method)]}
    return replace(setup, method=method, model=setup.model | changes)


def describe_integration(setup: Setup) -> list[str]:
    """Describe in sentences what is integrated, and what the first part of the run costs."""
    if setup.spec.analysis.type == "rest":
        return ["none: search for the rest position that a heavily damped motion from the start would reach"]
    if setup.method is None:
        return ["none: one instant is solved"]
    if setup.method.is_determined:
        return ["none: motion fully prescribed, solved at each instant on the same assembly branch"]
    layout, tolerance = setup.runner.integrated_scene.layout, setup.spec.analysis.tolerance
    how = f"tolerance {tolerance:.3g} of the model size; repeated at 1/30 of this tolerance as a check"
    if setup.step is not None:
        how = f"in steps of {setup.step:.4g} s; repeated with steps of a quarter as a check"
    row = find_method(setup.method.name)
    kind = f"an {row.kind}" if row is not None and row.kind != "SciPy" else "a"
    sentence = (
        f"{format_count(layout.n_state, 'state variable')}, integrated by {setup.method.name}, {kind} method of order "
        f"{setup.method.order}, {how}"
    )
    return [sentence, *describe_cost(setup, tolerance if setup.step is None else setup.step)]


def find_restart_method(setup: Setup) -> tuple[Method, str] | None:
    """Find the method that the run would be restarted with, and why; None if it would not.

    A run is restarted if its beginning is stiff, or if events end most steps.
    """
    if not setup.is_auto or setup.method is None or setup.method.is_determined:
        return None
    mechanism, last = setup.scene.mechanism, float(setup.spec.analysis.times[-1])
    if not (
        any(depends_on_state(load) for load in mechanism.loads) or not is_smooth(setup.runner.integrated_scene.layout)
    ):
        return None
    with suppress(SolveError, LimitError):
        try:
            run_first_part(setup, setup.spec.analysis.tolerance, last, stops_early=True)
        except StiffRun as stiff:
            return stiff.method, stiff.reason
        except EventfulRun as eventful:
            jumps = find_discontinuities(mechanism, eventful.end_time)
            runs = Runs(setup.runner, np.array([eventful.end_time]), jumps, None, setup.method)
            return (runs.method, eventful.reason) if try_fewer_stages(runs, eventful) else None
    return None


def describe_cost(setup: Setup, tolerance_or_step: float) -> list[str]:
    """Describe what the first part of the run costs; empty if it cannot be solved, because the run itself will say
    why.
    """
    last = TRIAL_SHARE * float(setup.spec.analysis.times[-1])
    whole = round(1.0 / TRIAL_SHARE)
    with suppress(SolveError):
        try:
            run = min((run_first_part(setup, tolerance_or_step, last) for _ in range(2)), key=lambda run: run.seconds)
        except LimitError:
            return [f"the first {last:.4g} s take over {MAX_TRIAL_STEPS:,} steps or {MAX_TRIAL_SECONDS} s: a long run"]
        steps, evaluations = format_count(run.steps, "step"), format_count(run.evaluations, "evaluation")
        check = "1.3 to 1.5" if setup.step is None else "5"
        took = f"the first {last:.4g} s take {steps}, {evaluations}, {1e3 * run.seconds:.2g} ms"
        return [f"{took}; the whole run about {whole} times that, and the check {check} times as much again"]
    return []


def run_first_part(setup: Setup, tolerance_or_step: float, last: float, *, stops_early: bool = False) -> Trajectory:
    """Integrate the run up to `last` [s]; stops_early: raises StiffRun or EventfulRun as soon as it turns out so."""
    jumps = tuple(find_discontinuities(setup.scene.mechanism, last))
    assert setup.method is not None
    deadline = time.monotonic() + MAX_TRIAL_SECONDS
    request = MotionTask(
        [0.0, last], tolerance_or_step, setup.method, jumps, deadline=deadline, most_steps=MAX_TRIAL_STEPS
    )
    return setup.runner.run(request, StoppingRules(stiffness=stops_early, events=stops_early))
