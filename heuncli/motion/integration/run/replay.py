"""Return states of a run at other instants, from the stored polynomials of its steps, or by repeating steps.

Steps are repeated from records that are stored for some of them. The states agree to the last bit with those that the
run would have given at these instants; also where these are its own. A replay takes the same steps as the run, so it
costs at most as much and succeeds wherever the run did.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.errors import KERNEL_ERRORS
from heuncli.motion.integration.run.kernel_loop import KernelLoop, LoopStart
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Indices, Mask


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
    step = run.ends.searchsorted(times[unknown])  # the step in which an instant lies
    is_interpolated, states = interpolate_stored(integrated_scene, run, times[unknown], step)
    if len(states):
        out[unknown[is_interpolated]] = integrated_scene.embed(times[unknown[is_interpolated]], states)
        unknown, step = unknown[~is_interpolated], step[~is_interpolated]
    if not len(unknown):
        return out
    base = np.searchsorted(run.records.steps, step, side="right") - 1
    # consecutive steps are replayed together
    breaks = np.flatnonzero((np.diff(step) > 1) & (np.diff(base) > 0)) + 1
    for group in np.split(np.arange(len(unknown)), breaks):
        if len(group):
            instants = unknown[group]
            states = replay_steps(integrated_scene, run, int(base[group[0]]), int(step[group[-1]]), times[instants])
            out[instants] = integrated_scene.embed(times[instants], states)
    return out


def interpolate_stored(
    integrated_scene: IntegratedScene, run: Trajectory, times: Array, step: Indices
) -> tuple[Mask, Array]:
    """Return at which instants, within these steps, the integrated states follow from stored data, and the states
    there.

    These are instants in steps with a stored polynomial, and ends of steps where the next one's start is stored.
    """
    n = integrated_scene.layout.n_state
    states = np.empty((len(times), n))
    is_interpolated = np.zeros(len(times), dtype=bool)
    if not len(times) or not len(run.ends):
        return is_interpolated, states
    if run.polynomials is not None:
        is_interpolated = run.polynomials.has_polynomial(times, step, run.ends)
        if is_interpolated.all():
            return is_interpolated, run.polynomials.interpolate_states(times, step, n)
        states[is_interpolated] = run.polynomials.interpolate_states(times[is_interpolated], step[is_interpolated], n)
    at_end = times == run.ends[step]
    if at_end.any():
        next_record = np.minimum(run.records.steps.searchsorted(step + 1), len(run.records) - 1)
        at_end &= run.records.steps[next_record] == step + 1
        if run.records_after_impulses:  # whose records hold the states after the impulses
            at_end &= ~np.isin(step + 1, list(run.records_after_impulses))
        states[at_end] = run.records.records[next_record[at_end], :n]
        is_interpolated = is_interpolated | at_end
    return is_interpolated, states[is_interpolated]


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
