"""Reduce long courses to the points that can be seen: of each short interval its minimum, its maximum, and its gaps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heuncli.results.results import Array

N_INTERVALS = 1500  # nearly two a pixel of a panel


def find_visible_points(values: Array, n_intervals: int = N_INTERVALS) -> NDArray[np.intp]:
    """Return the indices (m,) of values (n,), ascending, that a figure shows; all of them if they are few."""
    count = len(values)
    if count <= 4 * n_intervals:
        return np.arange(count)
    n_per_interval = -(-count // n_intervals)
    places = np.minimum(np.arange(n_intervals * n_per_interval), count - 1).reshape(n_intervals, n_per_interval)
    parts = values[places]
    unknown = np.isnan(parts)
    rows = np.arange(n_intervals)
    chosen = [
        places[rows, np.where(unknown, np.inf, parts).argmin(axis=1)],
        places[rows, np.where(unknown, -np.inf, parts).argmax(axis=1)],
        places[rows, unknown.argmax(axis=1)],  # a gap, else the first
        places[-1:, -1],
    ]
    return np.unique(np.concatenate(chosen))
