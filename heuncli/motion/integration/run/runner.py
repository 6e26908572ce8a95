"""A scene that can be run: its motion over requested instants, and states and loads of that motion at others.

Read these modules in this order: request.py, what is requested, and how a run may stop; stepper.py, from segment to
segment, with the checks on the way; kernel_loop.py, the steps themselves (kernel/integration.py takes them);
interruptions.py, impulses and contacts between them; progress.py, how far a run has come, and what is recorded of its
steps; supervision.py, the checks; conditions.py; and, where it ends too soon, failure.py. scipy_loop.py replaces all of
it where a method of SciPy is requested.

States at other instants come from the stored polynomials of the steps, or from steps repeated from records that are
stored for some of them. They agree to the last bit with those that the run would have given at these instants; also
where these are its own. A replay takes the same steps as the run, so it costs at most as much and succeeds wherever the
run did.

Impure: a `Runner` holds the kernel's work arrays; `run` reads the clock where a deadline is set.
"""

from __future__ import annotations

import math
import time

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene, integrate_itself
from heuncli.motion.integration.run.interruptions import find_closed_at_start
from heuncli.motion.integration.run.kernel_loop import KernelLoop, LoopStart
from heuncli.motion.integration.run.request import (
    DEFAULT_RULES,
    KERNEL_ERRORS,
    EventfulRun,
    MotionTask,
    StiffRun,
    StoppingRules,
)
from heuncli.motion.integration.run.stepper import Stepper, begin_run
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, find_missing_inertia
from heuncli.results.results import Array, Mask

# Replay


def resample_run(integrated_scene: IntegratedScene, run: Trajectory, times: Array) -> Array:
    """Return the scene's states (n_t, n) at instants of a run, ascending, within it."""
    times = np.ascontiguousarray(times, dtype=float)
    if run.interpolate is not None:
        return run.interpolate(times)
    out = np.empty((len(times), run.states.shape[1]))
    sample_index = np.minimum(run.times.searchsorted(times), len(run.times) - 1)
    is_known = is_requested = run.times[sample_index] == times
    for event in run.impulse_events:  # at its own instant, the state after it counts
        is_at_event = times == event.time
        out[is_at_event], is_known = event.after_state, is_known | is_at_event
    out[is_requested] = run.states[sample_index[is_requested]]
    unknown = (~is_known).nonzero()[0]
    unknown_times = times[unknown]
    is_interpolated, states = interpolate_stored(integrated_scene, run, unknown_times)
    if is_interpolated.all():
        out[unknown] = integrated_scene.embed(unknown_times, states)
        return out
    out[unknown[is_interpolated]] = integrated_scene.embed(unknown_times[is_interpolated], states[is_interpolated])
    unknown = unknown[~is_interpolated]
    step = run.ends.searchsorted(times[unknown])  # the step in which an instant lies
    base = np.searchsorted(run.records.steps, step, side="right") - 1
    # consecutive steps are replayed together
    breaks = np.flatnonzero((np.diff(step) > 1) & (np.diff(base) > 0)) + 1
    for group in np.split(np.arange(len(unknown)), breaks):
        if len(group):
            instants = unknown[group]
            states = replay_steps(integrated_scene, run, int(base[group[0]]), int(step[group[-1]]), times[instants])
            out[instants] = integrated_scene.embed(times[instants], states)
    return out


def interpolate_stored(integrated_scene: IntegratedScene, run: Trajectory, times: Array) -> tuple[Mask, Array]:
    """Return at which instants the integrated states follow from stored data, (n_t,), and the states, (n_t, n), there.

    These are instants in steps with a stored polynomial, and ends of steps where the next one's start is stored.
    """
    n = integrated_scene.layout.n_state
    if not len(times) or not len(run.ends):
        return np.zeros(len(times), dtype=bool), np.empty((len(times), n))
    if run.polynomials is not None:
        is_interpolated, states = run.polynomials.interpolate_states(times, run.ends, n)
        if is_interpolated.all():
            return is_interpolated, states
    else:
        is_interpolated, states = np.zeros(len(times), dtype=bool), np.empty((len(times), n))
    step = run.ends.searchsorted(times)
    at_end = times == run.ends[step]
    if at_end.any():
        next_record = np.minimum(run.records.steps.searchsorted(step + 1), len(run.records) - 1)
        at_end &= run.records.steps[next_record] == step + 1
        if run.records_after_impulses:  # whose records hold the states after the impulses
            at_end &= ~np.isin(step + 1, list(run.records_after_impulses))
        states[at_end] = run.records.records[next_record[at_end], :n]
        is_interpolated = is_interpolated | at_end
    return is_interpolated, states


def replay_steps(integrated_scene: IntegratedScene, run: Trajectory, record: int, last: int, times: Array) -> Array:
    """Return integrated states (n_t, n') at instants within the steps from a stored record on to step `last`.

    record: its index in `run.records`. The run stores the polynomials that the steps make. Raises SolveError where a
    step cannot be repeated, such as an implicit one.
    """
    first, state = int(run.records.steps[record]), run.records.records[record]
    loop_start = LoopStart(integrated_scene.layout.y0, math.inf, is_replay=True)
    count, keeping = last - first + 1, run.polynomials is not None
    kernel = KernelLoop(
        integrated_scene.layout,
        integrated_scene.workspace,
        run.method,
        times,
        count,
        loop_start,
        stores_polynomials=keeping,
    )
    loop, records_after = kernel.loop, run.records_after_impulses
    loop.restore(state)
    t = float(run.ends[first - 1]) if first else 0.0
    while first <= last:
        begin, before_end, end = run.segments.find_segment(t)
        last_in_segment = min(last, int(np.searchsorted(run.ends, end)))  # a segment ends with a step
        steps = slice(first, last_in_segment + 1)
        loop.set_followed_steps(run.ends[steps], run.is_projected[steps], run.branches[steps])
        if first in records_after:
            loop.restore(records_after[first])
        integrated_scene.workspace.hold(run.holding[first])
        if t <= begin:
            loop.begin(begin, before_end, end)
        else:
            loop.resume(t, before_end, end)
        if (end_code := loop.advance(last_in_segment + 1 - first, False, False)) in KERNEL_ERRORS:
            code, message, hint = KERNEL_ERRORS[end_code]
            raise SolveError(Problem(code, f"at t = {loop.t:.9g} s: {message}", hint=hint))
        if run.polynomials is not None:
            run.polynomials.store(first, *kernel.read_polynomials())
        t = loop.t
        first = last_in_segment + 1
    return kernel.read_states()


# Runner


class Runner(Evaluator):
    """A scene's layout with the kernel's work arrays. Each call depends only on its arguments.

    integrated_scene: the scene that is integrated in place of this one; by default this one
    """

    def __init__(self, layout: Layout, integrated_scene: IntegratedScene | None = None) -> None:
        super().__init__(layout, find_closed_at_start)
        self.integrated_scene = integrate_itself(self) if integrated_scene is None else integrated_scene

    def run(self, request: MotionTask, rules: StoppingRules = DEFAULT_RULES) -> Trajectory:
        """Integrate from the start at t = 0 over the requested instants.

        The run ends where a rope would have to push: the result has the instants up to there, and that one. It also
        ends where the condition that ends it becomes true, if that is watched.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline; if they are watched,
        StiffRun where an implicit method takes less work, EventfulRun where events end most steps, or no longer do.
        """
        clock_start = time.perf_counter()
        if request.method.scipy_name:
            from heuncli.motion.integration.run import scipy_loop  # loads SciPy

            return scipy_loop.run_scipy(self.layout, self.integrated_scene, request)
        progress = begin_run(self, self.integrated_scene, request, rules)
        stepper = Stepper(progress, request, rules)
        try:
            ending = stepper.run_to_end()
        except SolveError as error:
            error.reached = progress.t if error.reached is None else error.reached
            raise
        except (StiffRun, EventfulRun) as stop:
            stop.seconds = time.perf_counter() - clock_start
            raise
        return stepper.make_trajectory(ending, time.perf_counter() - clock_start)

    def evaluate_run(self, run: Trajectory, times: Array) -> Evaluation:
        """Evaluate accelerations and loads at instants of a run (ascending, within it), with the contacts that held
        there.
        """
        return self.evaluate(times, self.resample(run, times), holding=run.find_holding(times))

    def resample(self, run: Trajectory, times: Array) -> Array:
        """Return states (n_t, n) of a run at other instants (ascending, within it), by replaying its own steps."""
        return resample_run(self.integrated_scene, run, times)


def make_runner(scene: PreparedScene, stage_cache: Stages = NO_CACHE) -> tuple[PreparedScene, Runner]:
    """Return a scene that can be run and its runner; massless motions of its tree get artificial inertia."""
    lacking = find_missing_inertia(scene, stage_cache)
    if lacking:
        from heuncli.motion.integration.diagnosis.massless_motions import add_artificial_inertia  # few scenes need it

        scene = add_artificial_inertia(scene, lacking)
    return scene, Runner(scene.layout)
