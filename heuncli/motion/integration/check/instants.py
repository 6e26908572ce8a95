"""The instants at which a run is compared with its check run.

An estimate must hold for every instant of the run, asked or not. So the runs are compared at the asked instants, at the
ends of the steps, and within steps where the method's interpolation errs most: up to fifty times what the ends
themselves err by.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Indices, Mask

ENDS = 2_000  # ends of steps that are compared, in even numbers over a longer run; the horizon is then looked for again
INSIDE = 2_000  # bodies times steps up to which all steps are looked into
SOLVED = 64  # asked instants that are compared of a run that is followed
BLOCKS, BLOCK = 8, 16  # else so many stretches of so many steps, spread over the run


@record
class OwnStates:
    """A run's states at instants (n,), most of them those that it keeps itself: copied where they are looked at.

    kept, others (., n_state): the two sources; place (n,): of each instant, counted through both.
    """

    kept: Array
    others: Array
    place: Indices

    def __getitem__(self, which: slice | Mask) -> Array:
        place = self.place[which]
        found, own = np.empty((len(place), self.kept.shape[1])), place < len(self.kept)
        found[own], found[~own] = self.kept[place[own]], self.others[place[~own] - len(self.kept)]
        return found

    def first(self, n: int) -> OwnStates:
        """Those at the first so many instants."""
        return replace(self, place=self.place[:n])


@record
class ComparisonInstants:
    """Instants (n,) of a run, ascending, and its states there; asked (n,): which of them are told."""

    times: Array
    states: OwnStates
    asked: Mask


def instants_of(runner: Runner, run: Trajectory) -> ComparisonInstants:
    """All instants at which a run is compared: asked ones, ends of steps, and some within the steps.

    What is followed is solved at each instant by itself: it errs by rounding alone, most where the closures are nearest
    to a singular pose, and there its steps end most closely. So their ends tell, and some of the asked instants.
    """
    told = slice(None, None, -(-len(run.times) // SOLVED) if run.method.determined else 1)
    asked, own = run.times[told], run.states[told]
    bounds = np.concatenate([[0.0], run.ends])
    seen = np.diff(np.searchsorted(asked, bounds)) if len(run.ends) else np.zeros(0, dtype=np.intp)
    ends, states = ends_of(runner, run, seen)
    inner = np.zeros(0) if run.method.determined else within(bounds, len(runner.layout.place), run.method.within)
    times = np.concatenate([asked, ends, inner])
    others = np.concatenate([states, runner.resample(run, inner)])
    order = np.argsort(times, kind="stable")  # of equal instants the asked one comes first
    times = times[order]
    new = np.concatenate([[True], times[1:] != times[:-1]]) & (times <= run.times[-1])
    return ComparisonInstants(times[new], OwnStates(own, others, order[new]), (order < len(asked))[new])


def ends_of(runner: Runner, run: Trajectory, seen: Indices) -> tuple[Array, Array]:
    """Ends of steps with fewer than two asked instants (seen: how many), as far as their states were kept."""
    n = runner.moving.layout.n_state  # a record begins with the state
    kept = np.flatnonzero(np.append(0, seen)[run.kept.steps] < 2)
    kept = kept[:: -(-len(kept) // ENDS)]
    times = np.append(0.0, run.ends)[run.kept.steps[kept]]
    return times, runner.moving.embed(times, run.kept.records[kept, :n])


def within(bounds: Array, bodies: int, parts: tuple[float, ...]) -> Array:
    """Instants at these parts of steps, (n,) ascending; of a long run in some stretches of steps.

    However many instants are asked for: they need not lie where a step errs most, and told half of it by chance.
    """
    count = len(bounds) - 1
    steps = np.arange(count)
    if count * bodies > INSIDE and count > BLOCKS * BLOCK:
        first = np.linspace(0, count - BLOCK, BLOCKS).astype(int)
        steps = (first[:, None] + np.arange(BLOCK)).ravel()
    inner: Array = bounds[steps, None] + np.diff(bounds)[steps, None] * np.array(parts)
    return inner.ravel()


def passed_between(runner: Runner, runs: Sequence[Trajectory], begin: float, end: float) -> tuple[Array, list[Array]]:
    """The ends of the first run's steps between two instants, and the states of all runs there."""
    last = min(run.reached for run in runs)
    ends = runs[0].ends[(runs[0].ends > begin) & (runs[0].ends < end) & (runs[0].ends <= last)]
    ends = ends[:: max(1, -(-len(ends) // ENDS))]
    return ends, [runner.resample(run, ends) for run in runs]


def interleaved(times: Array, states: Sequence[Array]) -> tuple[Array, Array]:
    """The instants as often as there are runs, with the states of all runs (n, n_state) there, one after the other.

    So all are answered with the same choice of closure rows, which goes from one state to the next: what redundant
    joints leave open would else differ by more than an error.
    """
    return np.repeat(times, len(states)), np.stack(states, axis=1).reshape(len(states) * len(times), -1)
