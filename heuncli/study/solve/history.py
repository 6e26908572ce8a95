"""Compute the motion of the analysis with its check run, or the single instant of a state.

Impure: integration reads the clock.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.method_rows import AUTO
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.estimate import CheckedRun, evaluate_run, make_checked_run
from heuncli.motion.integration.check.run_comparison import MotionPoints, find_motion_error, interleave
from heuncli.motion.integration.check.runs import Runs, perturb_start
from heuncli.motion.integration.check.singular_poses import find_singular_positions
from heuncli.motion.integration.contacts.impulses import ImpulseEvent
from heuncli.motion.integration.diagnosis.solvability import ErrorWording, require_start
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.interruptions import solve_single_instant
from heuncli.motion.integration.run.request import EventfulRun, StiffRun
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.loads import BushingLoad, PairLoad
from heuncli.results.results import Array, ErrorEstimate
from heuncli.scene.expressions.discontinuities import pair_adjacent_instants
from heuncli.study.model.memory import MemoryBudget, require_memory_for_steps
from heuncli.study.model.setup import Setup
from heuncli.study.solve.load_errors import ComparedInstants, LoadErrors
from heuncli.study.solve.singular_start import require_motion

if TYPE_CHECKING:  # loaded where there are conditions
    from heuncli.motion.integration.check.changes import ConditionChanges


@record
class History:
    """The kernel's solutions at the requested instants; of a motion also the checked run behind them.

    times (n_t,): ascending [s]; fewer than requested where the run stopped
    find_solutions: returns the solutions at some of them
    tolerance: required of the motion
    estimate: of the errors, by kind
    checked_run: the run with its check run
    impulses: those that occurred
    check_impulses: those of the check runs
    jumps: instants at which a load or drive jumps or bends, including events and impulses
    singular: instants of the singular poses that the run passed
    seconds: durations of the parts of the computation
    errors: by kind and unit; of a state those of shares by cause
    state_instants: of a state, the instant and one with a perturbed start, from which its errors were computed
    notes: of a state, the notes on contacts; those of a motion are in its run
    """

    times: Array
    find_solutions: Callable[[slice], Evaluation]
    tolerance: float
    estimate: ErrorEstimate
    checked_run: CheckedRun | None = None
    impulses: tuple[ImpulseEvent, ...] = ()
    check_impulses: tuple[tuple[ImpulseEvent, ...], ...] = ()
    jumps: tuple[float, ...] = ()
    singular: tuple[float, ...] = ()
    seconds: Mapping[str, float] = MappingProxyType({})
    errors: Mapping[tuple[str, str], float] = MappingProxyType({})
    state_instants: ComparedInstants | None = None
    notes: tuple[str, ...] = ()

    @property
    def changes(self) -> tuple[ConditionChanges, ...]:
        """The changes of the conditions on time and coordinates."""
        return self.checked_run.changes if self.checked_run is not None else ()

    @property
    def followed_duration(self) -> float | None:
        """How long the run is if it was followed and not integrated [s], else None."""
        run = self.checked_run.run if self.checked_run is not None else None
        return float(run.times[-1]) if run is not None and run.method.is_determined else None

    @cached_property
    def solutions(self) -> Evaluation:
        """The solutions at all the instants."""
        return self.find_solutions(slice(None))


def integrate(
    setup: Setup,
    tolerance: float,
    deadline: float | None,
    *,
    by_cause: bool = False,
    memory_budget: MemoryBudget | None = None,
) -> History:
    """Compute the history of the analysis; by_cause: with one column of loads per cause. A state is not integrated.

    memory_budget: the memory that its steps must fit into, as far as their number is known beforehand

    Raises SolveError where no acceleration exists or the motion cannot be continued, LimitError past the deadline.
    """
    times, runner = np.array(setup.spec.analysis.times, dtype=float), setup.runner
    if setup.method is None:
        return solve_state(setup, float(times[0]), tolerance, by_cause)
    jumps = check_start(setup)
    if memory_budget is not None:
        require_memory_for_steps(setup, len(pair_adjacent_instants(jumps)) + 1, memory_budget)
    checked = integrate_checked(setup, tolerance, jumps, deadline, by_cause)
    jumps = tuple(sorted({*jumps, *checked.run.jumps}))
    require_followed(runner, checked.run)
    require_separate_points(runner, checked)
    seconds = {"integrate": checked.run.seconds, "check": checked.check_seconds}
    if checked.discarded_seconds:
        seconds["lost"] = checked.discarded_seconds
    singular = tuple(find_singular_positions(runner, checked.run))
    estimate, check_impulses = ErrorEstimate(motion=checked.motion, **checked.loads), checked.check_impulses
    return History(
        checked.run.times,
        checked.evaluate,
        tolerance,
        estimate,
        checked,
        checked.run.impulse_events,
        check_impulses,
        jumps,
        singular,
        seconds,
        checked.errors,
    )


def check_start(setup: Setup) -> tuple[float, ...]:
    """Require that a motion can begin, and return its discontinuities in time.

    Raises SolveError, or LimitError where these are more than steps are allowed: before a long run, not after it.
    """
    first = setup.runner.evaluate(np.zeros(1), setup.scene.layout.y0[None, :])
    require_start(setup.scene, first)
    require_motion(setup.scene.layout, first)
    jumps = tuple(find_discontinuities(setup.scene.mechanism, float(setup.spec.analysis.times[-1])))
    require_steps(len(pair_adjacent_instants(jumps)) + 1, setup.method)
    return jumps


def require_steps(segments: int, method: Method | None) -> None:
    """Raise LimitError [step-limit] where the segments of a run alone, one step each, exceed the allowed number of
    steps.
    """
    is_foreign = method is not None and method.scipy_name
    max_steps = tolerances.MOST_FOREIGN if is_foreign else tolerances.MOST_STEPS
    if segments <= max_steps:
        return
    message = (
        f"loads and drives have {segments - 1:,} jumps or kinks, each of which ends a step: "
        f"the run takes at least {segments:,} steps, at most {max_steps:,} are allowed"
    )
    hint = "a shorter duration, or tables with fewer points" + ("; or method: auto" if is_foreign else "")
    raise LimitError(Problem("step-limit", message, hint=hint))


def integrate_checked(
    setup: Setup, tolerance: float, jumps: tuple[float, ...], deadline: float | None, by_cause: bool
) -> CheckedRun:
    """Compute the motion with its check run.

    A motion that its drives determine is followed. Where that fails, at a singular pose or where the loops cannot
    follow the drives, it is integrated: then the velocities decide which branch continues, or the error of the
    integration is raised.
    """
    assert setup.method is not None
    times, method = np.array(setup.spec.analysis.times, dtype=float), setup.method
    if method.is_determined:
        try:
            runs = Runs(setup.runner, times, jumps, deadline, method)
            return make_checked_run(runs, tolerance, LoadErrors(setup, by_cause))
        except SolveError:
            method = load_method_by_name(AUTO)
        except LimitError as limit:
            if limit.problems[0].code != "step-limit":
                raise
            method = load_method_by_name(AUTO)  # close to a singular pose, steps along a branch become ever shorter
    try:
        runs = Runs(setup.runner, times, jumps, deadline, method, step=setup.step, watch_stiffness=setup.is_auto)
        return integrate_with_event_method(runs, setup, tolerance, by_cause)
    except StiffRun as stiff:
        runs = Runs(setup.runner, times, jumps, deadline, stiff.method)
        return restart_run(runs, stiff, method, setup, tolerance, by_cause)


def integrate_with_event_method(runs: Runs, setup: Setup, tolerance: float, by_cause: bool) -> CheckedRun:
    """Integrate a motion with its check run; restart it with a method of few stages if that passes events faster."""
    method, runs.eventful = runs.method, setup.is_auto
    try:
        return make_checked_run(runs, tolerance, LoadErrors(setup, by_cause))
    except EventfulRun as eventful:
        from heuncli.motion.integration.check.runs import try_fewer_stages  # few scenes have so many

        runs.eventful = try_fewer_stages(runs, eventful)
        return restart_run(runs, eventful, method, setup, tolerance, by_cause)


def restart_run(
    runs: Runs, interruption: StiffRun | EventfulRun, method: Method, setup: Setup, tolerance: float, by_cause: bool
) -> CheckedRun:
    """Compute a motion by the method of `runs`, after a run by `method` was given up for the reason in `interruption`.

    Where the method of `runs` does not reach the end either, or events become rare in its run, `method` runs all of it.
    """
    lost_seconds, reason = interruption.seconds, None if runs.method is method else interruption.reason
    try:
        checked = make_checked_run(runs, tolerance, LoadErrors(setup, by_cause))
        return replace(checked, discarded_seconds=checked.discarded_seconds + lost_seconds, restart_reason=reason)
    except EventfulRun as next_interruption:
        lost_seconds += next_interruption.seconds
    except SolveError:
        if runs.method is method:
            raise
    except LimitError as limit:
        if runs.method is method or limit.problems[0].code != "step-limit":
            raise
    runs.method, runs.eventful = method, False
    checked = make_checked_run(runs, tolerance, LoadErrors(setup, by_cause))
    return replace(checked, discarded_seconds=checked.discarded_seconds + lost_seconds)


def solve_state(setup: Setup, time: float, tolerance: float, by_cause: bool = False) -> History:
    """Compute the history of one instant, after its impulse if there is one, and again from a start perturbed by
    rounding.
    """
    runner, layout = setup.runner, setup.scene.layout
    # a perturbed rest pose would not be at rest: use the states that rounding does not distinguish from it
    others = [perturb_start(layout)] if setup.rest is None else list(setup.rest.nearby_states)
    starts = [layout.y0, *others]
    impulses: list[tuple[ImpulseEvent, ...]] = [() for _ in starts]
    notes: tuple[str, ...] = ()
    if setup.spec.analysis.type == "impulse" or layout.contacts:
        transitions = [solve_single_instant(runner, start, time) for start in starts]
        impulses, notes = [one.events for one in transitions], transitions[0].notes
        starts = [jumps[-1].after_state if jumps else start for start, jumps in zip(starts, impulses, strict=True)]
    times = np.array([time])
    contact_states = impulses[0][-1].contact_states if impulses[0] else find_closed_contacts(runner, time, starts[0])
    interleaved_states = interleave(times, [start[None, :] for start in starts])
    solutions = runner.evaluate(*interleaved_states, causes=by_cause, holding=contact_states)
    own_solution = solutions.select(slice(0, 1))
    require_start(
        setup.scene, own_solution, ErrorWording("accelerations after the impulse") if impulses[0] else ErrorWording()
    )
    require_motion(layout, own_solution)
    errors = LoadErrors(setup, by_cause, keep_instants=True)
    errors.add(solutions, *np.ones((2, 1), dtype=bool))
    # for one instant: the effect of rounding of its state on the loads, and on a rest pose
    pose_error = (
        0.0
        if setup.rest is None
        else float(find_motion_error(MotionPoints(layout), solutions.bodies, len(starts), layout.size)[0])
    )
    estimate = ErrorEstimate(motion=pose_error, **errors.estimate())
    seconds = {"integrate": 0.0 if setup.rest is None else setup.rest.seconds, "check": 0.0}
    return History(
        times,
        own_solution.select,
        tolerance,
        estimate,
        impulses=impulses[0],
        check_impulses=tuple(impulses[1:]),
        seconds=seconds,
        errors=errors.estimate_errors_by_cause(),
        state_instants=None if setup.steady_spin_axes else errors.last,
        notes=notes,
    )


def find_closed_contacts(runner: Runner, t: float, state: Array) -> Array:
    """Return the closed contacts of a state, (contacts,)."""
    if not runner.layout.contacts:
        return np.zeros(0)
    from heuncli.motion.integration.contacts.contact_events import find_held_contacts  # few scenes have them

    return find_held_contacts(runner, t, state)


def require_followed(runner: Runner, run: Trajectory) -> None:
    """Raise SolveError where drives of one loop contradict each other within the run."""
    if len(runner.layout.mechanism.laws) > 1 and runner.layout.rows:
        from heuncli.motion.integration.check.contradictions import find_contradiction_in_steps  # few scenes need it

        problem = find_contradiction_in_steps(runner, run)
        if problem is not None:
            raise SolveError(problem)


def require_separate_points(runner: Runner, run: CheckedRun) -> None:
    """Raise SolveError where the points of an actuator or spring coincide during a motion, before its horizon.

    Also where a bushing passes half a turn.
    """
    if any(isinstance(load, PairLoad) for load in runner.layout.mechanism.loads):
        from heuncli.motion.integration.check.singular_poses import find_meeting  # few scenes have them

        problem = find_meeting(runner, run.run, run.horizon)
        if problem is not None:
            raise SolveError(problem)
    if any(isinstance(load, BushingLoad) for load in runner.layout.mechanism.loads):
        from heuncli.motion.integration.check.singular_poses import find_half_turn

        if (problem := find_half_turn(runner, run.run, run.horizon)) is not None:
            raise SolveError(problem)


def resample(runner: Runner, history: History, times: Array, *, by_cause: bool = False) -> Evaluation:
    """Return the kernel's solutions at other instants within the run, (n,) ascending; a state has only its one
    instant.
    """
    if history.checked_run is None:
        return history.solutions
    times = np.asarray(times, dtype=float)
    run = history.checked_run.run
    return evaluate_run(runner, run, times, runner.resample(run, times), history.jumps, causes=by_cause)
