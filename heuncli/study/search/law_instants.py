"""Find where laws of time and of coordinates need more instants, so that no turning point is missed.

A body that cannot move feels no push, so that no integration step shows how fast a load on it changes; nor does a
drive's law force small steps. Each law is sampled on its own, which costs almost nothing: its value and both its
derivatives, because a ripple that hardly shows in a travel may dominate an acceleration. Instants are added to a grid
until the cubics through four neighbours predict it (study/search/turnings.py). Features shorter than the distance of
the samples are found by bounds of the values over intervals of time, which also hold for what was not sampled.

Loads that depend on coordinates change as fast as the body moves that carries them. Where they push along a constrained
direction, no integration step notices them. So they are sampled directly:
each interval of a grid once, unless cubics through its neighbours predict both its ends, and divided there until the
cubics through four neighbours predict them (study/search/turnings.py).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.study.model.setup import Setup
from heuncli.study.search.grid import sort_distinct
from heuncli.study.search.turnings import NO_INSTANTS, SampledTurns, find_doubtful, refine_until_predicted
from heuncli.study.solve.history import History, resample

MIN_INTERVALS = 256  # intervals of a run whose bounds are checked, however few instants the grid has
NEGLIGIBLE = 1e-9  # share of the largest value: smaller changes of a load or a law are in no digit shown
BOUND_MARGIN = 0.02  # share of the range of an expression by which its bounds may exceed the neighbouring samples
ORDERS = 3  # value, first and second derivative


def find_time_laws(mechanism: Mechanism) -> tuple[list[Expression], list[Expression]]:
    """Return the loads that depend on time alone, and the laws of drives that are not constant, each once."""
    laws = {law.value for law in mechanism.laws}
    time_laws = dict.fromkeys(e for e in mechanism.iter_expressions() if e.time_dependent and not e.uses)
    return [e for e in time_laws if e not in laws], [e for e in time_laws if e in laws]


def refine_for_time_laws(mechanism: Mechanism, grid: Array, max_instants: int) -> tuple[Array, bool]:
    """Return a grid (n,), ascending, with more instants where time laws need them; and whether `max_instants` are
    enough.
    """
    loads, laws = find_time_laws(mechanism)
    time_laws = [*loads, *laws]
    span = float(np.ptp(grid))
    if not time_laws or not span > 0.0:
        return grid, True
    fine_grid = sort_distinct(np.concatenate([grid, np.linspace(grid[0], grid[-1], MIN_INTERVALS + 1)]))
    fine_grid, complete = refine_to_bounds(time_laws, fine_grid, max_instants)
    size = np.abs(sample_laws(time_laws, fine_grid)).max(axis=0).reshape(len(time_laws), ORDERS)
    of_load = np.arange(len(time_laws)) < len(loads)

    def slack(_: Array, width: Array) -> Array:
        """Return the negligible part of the values and derivatives over intervals of some widths, (m, 3 n)."""
        h = width[:, None]
        value, rate, second = (NEGLIGIBLE * size[None, :, k] + 0.0 * h for k in range(ORDERS))
        # for a load only its value counts, and the change that its derivatives make within an interval
        rate, second = np.where(of_load, 4.0 * value / h, rate), np.where(of_load, 8.0 * value / (h * h), second)
        return np.asarray(np.stack([value, rate, second], axis=2).reshape(len(width), -1))

    first_samples = SampledTurns(grid, sample_laws(time_laws, grid), complete)
    probes = np.setdiff1d(fine_grid, grid, assume_unique=True)
    found = refine_until_predicted(
        lambda times: sample_laws(time_laws, times), first_samples, slack, max_instants=max_instants, probes=probes
    )
    return found.times, complete and found.complete


def sample_laws(time_laws: Sequence[Expression], times: Array) -> Array:
    """Sample values, first and second derivatives of expressions, (n_t, 3 n); 0 where there is none, as of a root at
    0.
    """
    values = np.array([e.sample_derivatives(times.tolist()) for e in time_laws]).reshape(-1, len(times)).T
    return np.where(np.isfinite(values), values, 0.0)


def refine_to_bounds(time_laws: Sequence[Expression], times: Array, max_instants: int) -> tuple[Array, bool]:
    """Add instants until no expression can leave its samples by much between them, according to its bounds.

    Returns whether `max_instants` are enough.
    """
    span = float(np.ptp(times))
    for expression in time_laws:
        values = np.array(expression.sample(times.tolist()))
        k = np.arange(len(times) - 1)  # the stretches whose bounds are not known
        while len(k):
            k = k[times[k + 1] - times[k] > tolerances.SIDE_BY_SIDE * span]
            if len(times) > max_instants:
                return times, False
            least, largest = (np.array(x) for x in expression.bounds(times[k].tolist(), times[k + 1].tolist()))
            near = np.stack([values[np.clip(k + i, 0, len(times) - 1)] for i in (-1, 0, 1, 2)])
            allowed = np.maximum(np.ptp(near, axis=0), BOUND_MARGIN * np.ptp(values))
            # no bounds, no stretch
            is_unbounded = np.maximum(largest - near.max(axis=0), near.min(axis=0) - least) > allowed
            k = k[is_unbounded]
            middles = 0.5 * (times[k] + times[k + 1])
            times = np.insert(times, k + 1, middles)
            values = np.insert(values, k + 1, expression.sample(middles.tolist()))
            left = k + np.arange(len(k))
            k = np.sort(np.concatenate([left, left + 1]))
    return times, True


def refine_for_loads(setup: Setup, history: History, grid: Array, max_instants: int) -> tuple[Array, bool]:
    """Add instants to a grid (n,) where applied loads need them; return also whether `max_instants` are enough."""

    def loads(times: Array) -> Array:
        """Sample forces and moments of all loads, (n_t, 6 n_loads); 0 where one is indeterminate."""
        own = resample(setup.runner, history, times).loads
        found = np.concatenate([own["force"], own["moment"]], axis=2).reshape(len(times), -1)
        return np.where(np.isfinite(found), found, 0.0)

    first_samples = SampledTurns(grid, loads(grid), complete=True)
    # forces, moments: each of as much as the largest of its kind
    largest = np.abs(first_samples.values).reshape(-1, 2, 3).max(axis=(0, 2), initial=0.0)
    unseen = NEGLIGIBLE * np.tile(np.repeat(largest, 3), first_samples.values.shape[1] // 6)
    probes = (
        np.setdiff1d(np.linspace(grid[0], grid[-1], MIN_INTERVALS + 1), grid)
        if len(grid) < MIN_INTERVALS
        else NO_INSTANTS
    )

    def slack(size: Array, _: Array) -> Array:
        return np.broadcast_to(unseen, size.shape)

    found = refine_until_predicted(
        loads,
        first_samples,
        slack,
        max_instants=max_instants,
        probes=probes,
        is_doubtful=find_doubtful(first_samples, slack),
    )
    return found.times, found.complete
