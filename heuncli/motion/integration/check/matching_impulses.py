"""Match the impulses that runs of one motion share; each run reaches them at slightly different instants."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.motion.integration.contacts.impulses import ImpulseEvent
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Indices, Mask


def match_impulses(impulses: Sequence[ImpulseEvent], others: Sequence[ImpulseEvent]) -> list[tuple[int, int]]:
    """Return index pairs of impulses that two runs share: each is the other's nearest, with a name in common.

    Rounding may add a contact to an impulse, such as a rope that hardly takes part. It is still the same impulse.
    """
    if not impulses or not others:
        return []
    times, other_times = (np.array([jump.time for jump in jumps]) for jumps in (impulses, others))
    forward, backward = find_nearest(times, other_times), find_nearest(other_times, times)
    pairs = [(i, int(k)) for i, k in enumerate(forward) if backward[k] == i]
    return [(i, k) for i, k in pairs if set(impulses[i].names) & set(others[k].names)]


def find_nearest(times: Array, sorted_times: Array) -> Indices:
    """Return for each instant the index of the nearest among sorted instants."""
    next_index = np.clip(np.searchsorted(sorted_times, times), 1, max(len(sorted_times) - 1, 1))
    is_before = np.abs(times - sorted_times[next_index - 1]) <= np.abs(
        sorted_times[np.minimum(next_index, len(sorted_times) - 1)] - times
    )
    return np.where(is_before, next_index - 1, np.minimum(next_index, len(sorted_times) - 1))


def is_between_impulses(runs: Sequence[Trajectory], times: Array) -> Mask:
    """Return which instants lie between the first run's impulse and another run's same one, (n,).

    One run reaches the impulse later by the error of the motion. In between, the velocities differ by the jump, which
    is no error of either run.
    """
    inside = np.zeros(len(times), dtype=bool)
    impulses = runs[0].impulse_events
    for other in runs[1:]:
        for i, k in match_impulses(impulses, other.impulse_events):
            first, last = sorted((impulses[i].time, other.impulse_events[k].time))
            if first < last:
                inside |= (times >= first) & (times <= last)
    return inside
