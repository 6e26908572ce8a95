"""Blows that runs of one motion share: each run meets them at instants of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.motion.integration.contacts.blows import Jump
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Indices, Mask


def matched(own: Sequence[Jump], others: Sequence[Jump]) -> list[tuple[int, int]]:
    """The blows that two runs of one motion share: each the other's nearest, with a name in common.

    What rounding adds to a blow, a rope that hardly takes part, does not make it another one.
    """
    if not own or not others:
        return []
    times, among = (np.array([jump.time for jump in jumps]) for jumps in (own, others))
    there, back = nearest(times, among), nearest(among, times)
    pairs = [(i, int(k)) for i, k in enumerate(there) if back[k] == i]
    return [(i, k) for i, k in pairs if set(own[i].names) & set(others[k].names)]


def nearest(times: Array, among: Array) -> Indices:
    """Of each instant the place of the nearest among others, ascending."""
    behind = np.clip(np.searchsorted(among, times), 1, max(len(among) - 1, 1))
    before = np.abs(times - among[behind - 1]) <= np.abs(among[np.minimum(behind, len(among) - 1)] - times)
    return np.where(before, behind - 1, np.minimum(behind, len(among) - 1))


def between_strikes(runs: Sequence[Trajectory], times: Array) -> Mask:
    """Which instants lie between the first run's strike and another run's same one, (n,): one has jumped by then.

    What strikes at an instant of its own in each run is later in one of them by the error of the motion: there the
    velocities differ by the jump, which is no error of either.
    """
    inside = np.zeros(len(times), dtype=bool)
    own = runs[0].blows
    for other in runs[1:]:
        for i, k in matched(own, other.blows):
            first, last = sorted((own[i].time, other.blows[k].time))
            if first < last:
                inside |= (times >= first) & (times <= last)
    return inside
