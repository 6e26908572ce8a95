"""States of a run at other instants: by what its steps left of themselves, else they are done once more.

Steps are done again from records that were kept of some of them.

To the last bit what the run would have given, had these instants been among those it was asked for; and what it gave,
where they were. It takes no other steps than the run, so it costs at most as much and succeeds wherever the run did.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.errors import TROUBLE
from heuncli.motion.integration.run.kernel_loop import KernelLoop, Start
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Indices, Mask


def resampled(moving: IntegratedScene, run: Trajectory, times: Array) -> Array:
    """The scene's states (n_t, n) at instants of a run, ascending, within it."""
    times = np.ascontiguousarray(times, dtype=float)
    if run.within is not None:
        return run.within(times)
    out = np.empty((len(times), run.states.shape[1]))
    own = np.minimum(run.times.searchsorted(times), len(run.times) - 1)
    known = asked = run.times[own] == times
    for blow in run.blows:  # its own instant shows the state behind it
        struck = times == blow.time
        out[struck], known = blow.after, known | struck
    out[asked] = run.states[own[asked]]
    others = (~known).nonzero()[0]
    step = run.ends.searchsorted(times[others])  # the step in which an instant lies
    told, states = by_its_steps(moving, run, times[others], step)
    if len(states):
        out[others[told]] = moving.embed(times[others[told]], states)
        others, step = others[~told], step[~told]
    if not len(others):
        return out
    base = np.searchsorted(run.kept.steps, step, side="right") - 1
    # consecutive steps are replayed together
    breaks = np.flatnonzero((np.diff(step) > 1) & (np.diff(base) > 0)) + 1
    for group in np.split(np.arange(len(others)), breaks):
        if len(group):
            to = others[group]
            states = replayed(moving, run, int(base[group[0]]), int(step[group[-1]]), times[to])
            out[to] = moving.embed(times[to], states)
    return out


def by_its_steps(moving: IntegratedScene, run: Trajectory, times: Array, step: Indices) -> tuple[Mask, Array]:
    """At which instants, in these steps, the states of what is integrated follow from what was kept, and these.

    They do within steps whose polynomials were kept, and at the ends of steps behind which the next one's start was.
    """
    n = moving.layout.n_state
    states = np.empty((len(times), n))
    told = np.zeros(len(times), dtype=bool)
    if not len(times) or not len(run.ends):
        return told, states
    if run.courses is not None:
        told = run.courses.known(times, step, run.ends)
        if told.all():
            return told, run.courses.states(times, step, n)
        states[told] = run.courses.states(times[told], step[told], n)
    at_end = times == run.ends[step]
    if at_end.any():
        next_ = np.minimum(run.kept.steps.searchsorted(step + 1), len(run.kept) - 1)
        at_end &= run.kept.steps[next_] == step + 1
        if run.after_blows:  # whose records are of the states behind the blows
            at_end &= ~np.isin(step + 1, list(run.after_blows))
        states[at_end] = run.kept.records[next_[at_end], :n]
        told = told | at_end
    return told, states[told]


def replayed(moving: IntegratedScene, run: Trajectory, record: int, last: int, times: Array) -> Array:
    """States (n_t, n') of what is integrated at instants within the steps from a kept record on to step `last`.

    record: its place in `run.kept`. The run takes over the polynomials that the steps make.
    Raises SolveError where a step cannot be done again, as an implicit one.
    """
    first, state = int(run.kept.steps[record]), run.kept.records[record]
    given = Start(moving.layout.y0, math.inf, following=True)
    count, keeping = last - first + 1, run.courses is not None
    kernel = KernelLoop(moving.layout, moving.workspace, run.method, times, count, given, keeping=keeping)
    loop, after = kernel.loop, run.after_blows
    loop.stand(state)
    t = float(run.ends[first - 1]) if first else 0.0
    while first <= last:
        begin, before_end, end = run.segments.at(t)
        to = min(last, int(np.searchsorted(run.ends, end)))  # a segment ends with a step
        steps = slice(first, to + 1)
        loop.follow(run.ends[steps], run.settled[steps], run.branches[steps])
        if first in after:
            loop.stand(after[first])
        moving.workspace.hold(run.holding[first])
        if t <= begin:
            loop.begin(begin, before_end, end)
        else:
            loop.resume(t, before_end, end)
        if (left_for := loop.advance(to + 1 - first, False, False)) in TROUBLE:
            code, message, hint = TROUBLE[left_for]
            raise SolveError(Problem(code, f"at t = {loop.t:.9g} s: {message}", hint=hint))
        if run.courses is not None:
            run.courses.take(first, *kernel.put_down_courses())
        t = loop.t
        first = to + 1
    return kernel.states()
