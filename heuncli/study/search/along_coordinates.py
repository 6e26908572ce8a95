"""Find where loads that depend on coordinates need more instants: they change as fast as the body moves that carries
them.

Where such loads push along a constrained direction, no integration step notices them. So they are sampled directly:
each interval of a grid once, unless cubics through its neighbours predict both its ends, and divided there until the
cubics through four neighbours predict them (study/search/turnings.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.study.model.setup import Setup
from heuncli.study.search.in_time import MIN_INTERVALS, NEGLIGIBLE
from heuncli.study.search.turnings import NO_INSTANTS, SampledTurns, find_doubtful, refine_until_predicted
from heuncli.study.solve.history import History, resample


def refine_for_loads(setup: Setup, history: History, grid: Array, max_instants: int) -> tuple[Array, bool]:
    """Return a grid (n,), ascending, with more instants where applied loads need them; and whether `max_instants` are
    enough.
    """

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
