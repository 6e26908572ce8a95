"""Find singular positions that a run passed: there the closures lose rank, and the loops can continue in several
ways.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array

PROBES = 17  # instants looked at in a round
ROUNDS = 5  # each narrows the interval by PROBES / 2
MOST = 100  # suspected intervals examined; a mechanism may pass such a pose in every revolution


def find_singular_positions(runner: Runner, run: Trajectory) -> list[float]:
    """Return the instants [s] at which the rank of the closures fell, the first hundred."""
    suspects = np.flatnonzero(run.pivots < tolerances.SUSPECT_PIVOT)
    instants: list[float] = []
    for steps in np.split(suspects, np.flatnonzero(np.diff(suspects) > 1) + 1)[:MOST]:
        if len(steps):
            begin = float(run.ends[steps[0] - 1]) if steps[0] else 0.0
            end = float(run.ends[steps[-1]])
            for a, b in bracket_minima(runner, run, np.linspace(begin, end, 8 * len(steps) + 1)):
                t = find_singular_instant(runner, run, a, b)
                if t is not None and not (instants and t - instants[-1] <= tolerances.SAME_INSTANT * end):
                    instants.append(t)
    return instants


def least_singular_values(runner: Runner, run: Trajectory, times: Array) -> Array:
    """Estimate the smallest relative singular value of the independent closures, (n_t,)."""
    # the rows are selected at the first instant, and pivots are relative to those there
    instants = np.concatenate([run.times[:1], times])
    states = np.concatenate([run.states[:1], runner.resample(run, times)])
    evaluation = runner.evaluate(instants, states, hold_rows=True, holding=run.find_holding(instants))
    least: Array = np.sqrt(np.maximum(evaluation.pivot[1:], 0.0))
    return least


def bracket_minima(runner: Runner, run: Trajectory, times: Array) -> list[tuple[float, float]]:
    """Return intervals [a, b] around the local minima."""
    g = least_singular_values(runner, run, times)
    padded = np.concatenate([[np.inf], g, [np.inf]])
    low = np.flatnonzero((g <= padded[:-2]) & (g < padded[2:]))
    return [(float(times[max(k - 1, 0)]), float(times[min(k + 1, len(times) - 1)])) for k in low.tolist()]


def find_singular_instant(runner: Runner, run: Trajectory, a: float, b: float) -> float | None:
    """Return the instant of the singular position in [a, b], or None where the loops only come close to one."""
    span = b - a
    low, high, t = np.inf, 0.0, a
    for _ in range(ROUNDS):
        times = np.linspace(a, b, PROBES)
        g = least_singular_values(runner, run, times)
        k = int(np.argmin(g))
        low, high, t = float(g[k]), max(high, float(g.max())), float(times[k])
        a, b = float(times[max(k - 1, 0)]), float(times[min(k + 1, PROBES - 1)])
        if low == 0.0:
            break
    # a scene that is close to singular everywhere does not pass a singular position
    falls = low < tolerances.SINGULAR_FALL * high
    return t if falls and low <= tolerances.SINGULAR_MET * (b - a) / span else None
