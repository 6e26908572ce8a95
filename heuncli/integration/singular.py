"""Singular poses that a run came through: where loops can go on in more than one way."""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.integration.runner import Runner, Trajectory
from heuncli.results import Array

PROBES = 17  # instants looked at in a round
ROUNDS = 5  # each narrows the place by PROBES / 2
MOST = 100  # places looked at: a mechanism that goes through such a pose for ever need not be followed for ever


def passages(runner: Runner, run: Trajectory) -> list[float]:
    """Instants [s] at which the rank of the closures fell, the first hundred."""
    suspects = np.flatnonzero(run.pivots < tolerances.SUSPECT_PIVOT)
    found: list[float] = []
    for steps in np.split(suspects, np.flatnonzero(np.diff(suspects) > 1) + 1)[:MOST]:
        if len(steps):
            begin = float(run.ends[steps[0] - 1]) if steps[0] else 0.0
            end = float(run.ends[steps[-1]])
            for a, b in valleys(runner, run, np.linspace(begin, end, 8 * len(steps) + 1)):
                t = met(runner, run, a, b)
                if t is not None and not (found and t - found[-1] <= tolerances.SAME_INSTANT * end):
                    found.append(t)
    return found


def nearness(runner: Runner, run: Trajectory, times: Array) -> Array:
    """About the smallest relative singular value of the closures that is not always zero, (n_t,)."""
    asked = np.concatenate([run.times[:1], times])  # the rows are chosen, and what they can do is seen, at the first
    pose = runner.recovered(asked, runner.within(run, asked))
    found: Array = np.sqrt(np.maximum(pose.pivot[1:], 0.0))
    return found


def valleys(runner: Runner, run: Trajectory, times: Array) -> list[tuple[float, float]]:
    """Intervals about the lowest places."""
    g = nearness(runner, run, times)
    padded = np.concatenate([[np.inf], g, [np.inf]])
    low = np.flatnonzero((g <= padded[:-2]) & (g < padded[2:]))
    return [(float(times[max(k - 1, 0)]), float(times[min(k + 1, len(times) - 1)])) for k in low.tolist()]


def met(runner: Runner, run: Trajectory, a: float, b: float) -> float | None:
    """The instant of the singular pose in [a, b], or None where the loops only come near to one."""
    span = b - a
    low, t = np.inf, a
    for _ in range(ROUNDS):
        times = np.linspace(a, b, PROBES)
        g = nearness(runner, run, times)
        k = int(np.argmin(g))
        low, t = float(g[k]), float(times[k])
        a, b = float(times[max(k - 1, 0)]), float(times[min(k + 1, PROBES - 1)])
        if low == 0.0:
            break
    return t if low <= tolerances.SINGULAR_MET * (b - a) / span else None
