"""Where loads that hang on coordinates have to be looked at: a body takes them along however fast they run.

Where they push what is held, no step of an integration feels them. They are asked of the machine itself: each interval
of a grid once, unless its neighbours foretold both its ends, and divided there until the cubics through four neighbours
foretell them (study/search/turnings.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.study.model.setup import Setup
from heuncli.study.search.in_time import EVENLY, UNSEEN
from heuncli.study.search.turnings import NO_INSTANTS, SampledTurns, doubtful, resolved
from heuncli.study.solve.history import History, resample


def close_to_loads(setup: Setup, history: History, grid: Array, most: int) -> tuple[Array, bool]:
    """A grid (n,), ascending, with more instants where applied loads need them; whether `most` are enough."""

    def loads(times: Array) -> Array:
        """Forces and moments of all loads, (n_t, 6 n_loads); 0 where one is open."""
        own = resample(setup.runner, history, times).loads
        found = np.concatenate([own["force"], own["moment"]], axis=2).reshape(len(times), -1)
        return np.where(np.isfinite(found), found, 0.0)

    begun = SampledTurns(grid, loads(grid), complete=True)
    # forces, moments: each of as much as the largest of its kind
    largest = np.abs(begun.values).reshape(-1, 2, 3).max(axis=(0, 2), initial=0.0)
    unseen = UNSEEN * np.tile(np.repeat(largest, 3), begun.values.shape[1] // 6)
    probes = np.setdiff1d(np.linspace(grid[0], grid[-1], EVENLY + 1), grid) if len(grid) < EVENLY else NO_INSTANTS

    def slack(size: Array, _: Array) -> Array:
        return np.broadcast_to(unseen, size.shape)

    found = resolved(loads, begun, slack, most=most, probes=probes, doubted=doubtful(begun, slack))
    return found.times, found.complete
