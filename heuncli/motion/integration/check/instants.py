"""Choose the instants at which a run is compared with its check run.

An estimate must hold for every instant of the run, requested or not. So the runs are compared at the requested
instants, at the ends of steps, and within steps where the method's interpolation errs most: up to fifty times the error
at the ends.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Indices, Mask

MAX_ENDS = 2_000  # ends of steps compared, evenly spaced in a longer run; the horizon is then refined
MAX_BODY_STEPS = 2_000  # bodies times steps up to which all steps are sampled
MAX_DETERMINED_INSTANTS = 64  # requested instants compared for a drive-determined run
BLOCKS, BLOCK = 8, 16  # else so many groups of so many steps, spread over the run


@record
class JoinedStates:
    """A run's states at instants (n,), most of which the run holds itself; they are copied only when read.

    run_states, others (., n_state): the two sources
    place (n,): index of each instant, counted through both sources
    """

    run_states: Array
    others: Array
    place: Indices

    def __getitem__(self, instants: slice | Mask) -> Array:
        place = self.place[instants]
        states, is_run_state = np.empty((len(place), self.run_states.shape[1])), place < len(self.run_states)
        states[is_run_state], states[~is_run_state] = (
            self.run_states[place[is_run_state]],
            self.others[place[~is_run_state] - len(self.run_states)],
        )
        return states

    def take_first(self, n: int) -> JoinedStates:
        """Select the states at the first n instants."""
        return replace(self, place=self.place[:n])


@record
class ComparisonInstants:
    """Instants (n,) of a run, ascending, and its states there; is_requested (n,): which of them are reported."""

    times: Array
    states: JoinedStates
    is_requested: Mask


def choose_instants(runner: Runner, run: Trajectory) -> ComparisonInstants:
    """Choose all instants at which a run is compared: requested ones, ends of steps, and some within the steps.

    A determined motion is solved at each instant independently. It errs by rounding alone, most where the closures are
    nearest to a singular position, and there its steps end most closely. So the ends of its steps and some of the
    requested instants suffice.
    """
    selection = slice(None, None, -(-len(run.times) // MAX_DETERMINED_INSTANTS) if run.method.is_determined else 1)
    requested, requested_states = run.times[selection], run.states[selection]
    bounds = np.concatenate([[0.0], run.ends])
    requested_per_step = np.diff(np.searchsorted(requested, bounds)) if len(run.ends) else np.zeros(0, dtype=np.intp)
    ends, states = find_step_ends(runner, run, requested_per_step)
    inner = (
        np.zeros(0)
        if run.method.is_determined
        else choose_inner_instants(bounds, len(runner.layout.place), run.method.sample_fractions)
    )
    times = np.concatenate([requested, ends, inner])
    others = np.concatenate([states, runner.resample(run, inner)])
    order = np.argsort(times, kind="stable")  # of equal instants the asked one comes first
    times = times[order]
    is_used = np.concatenate([[True], times[1:] != times[:-1]]) & (times <= run.times[-1])
    return ComparisonInstants(
        times[is_used], JoinedStates(requested_states, others, order[is_used]), (order < len(requested))[is_used]
    )


def find_step_ends(runner: Runner, run: Trajectory, requested_per_step: Indices) -> tuple[Array, Array]:
    """Return the ends of steps with fewer than two requested instants, and the states there, as far as they are
    stored.
    """
    n = runner.integrated_scene.layout.n_state  # a record begins with the state
    selected = np.flatnonzero(np.append(0, requested_per_step)[run.records.steps] < 2)
    selected = selected[:: -(-len(selected) // MAX_ENDS)]
    times = np.append(0.0, run.ends)[run.records.steps[selected]]
    return times, runner.integrated_scene.embed(times, run.records.records[selected, :n])


def choose_inner_instants(bounds: Array, bodies: int, fractions: tuple[float, ...]) -> Array:
    """Return instants at these fractions of the steps, (n,) ascending; of a long run only in some groups of steps.

    They are needed however many instants are requested, because those may miss the places where a step errs most.
    """
    count = len(bounds) - 1
    steps = np.arange(count)
    if count * bodies > MAX_BODY_STEPS and count > BLOCKS * BLOCK:
        first = np.linspace(0, count - BLOCK, BLOCKS).astype(int)
        steps = (first[:, None] + np.arange(BLOCK)).ravel()
    inner: Array = bounds[steps, None] + np.diff(bounds)[steps, None] * np.array(fractions)
    return inner.ravel()


def find_ends_between(
    runner: Runner, runs: Sequence[Trajectory], begin: float, end: float
) -> tuple[Array, list[Array]]:
    """Return the ends of the first run's steps between two instants, and the states of all runs there."""
    last = min(run.end_time for run in runs)
    ends = runs[0].ends[(runs[0].ends > begin) & (runs[0].ends < end) & (runs[0].ends <= last)]
    ends = ends[:: max(1, -(-len(ends) // MAX_ENDS))]
    return ends, [runner.resample(run, ends) for run in runs]


def interleave(times: Array, states: Sequence[Array]) -> tuple[Array, Array]:
    """Repeat each instant for each run, with the states of all runs (n, n_state) there, one after the other.

    So all runs are evaluated with the same choice of closure rows, which is continued from one state to the next. Else
    what redundant joints leave indeterminate would differ by more than an error.
    """
    return np.repeat(times, len(states)), np.stack(states, axis=1).reshape(len(states) * len(times), -1)
