"""Find singular positions that a run passed: of closures, of loads along the line between two points, of bushings.

Where closures lose rank, the loops can continue in several ways. Where the two points of a spring or actuator meet,
its force has no direction: the line between them reverses from one end of a step to the other. Where a bushing passes
half a turn, its moment jumps from one side to the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.diagnosis.ambiguous_laws import (
    find_turning_bushings,
    make_bushing_problem,
    make_coincidence_problem,
)
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.loads import BushingLoad, PairLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array

# Singular poses

PROBES = 17  # instants looked at in a round
ROUNDS = 5  # each narrows the interval by PROBES / 2
MOST = 100  # suspected intervals examined; a mechanism may pass such a pose in every revolution


def find_singular_positions(runner: Runner, run: Trajectory) -> list[float]:
    """Return the instants [s] at which the rank of the closures fell, the first hundred."""
    suspects = np.flatnonzero(run.pivots < tolerances.SUSPECT_PIVOT)
    instants: list[float] = []
    if not len(suspects):
        return instants
    for steps in np.split(suspects, np.flatnonzero(np.diff(suspects) > 1) + 1)[:MOST]:
        if len(steps):
            begin = float(run.ends[steps[0] - 1]) if steps[0] else 0.0
            end = float(run.ends[steps[-1]])
            for a, b in bracket_minima(runner, run, np.linspace(begin, end, 8 * len(steps) + 1)):
                t = find_singular_instant(runner, run, a, b)
                if t is not None and not (instants and t - instants[-1] <= tolerances.SAME_INSTANT * end):
                    instants.append(t)
    return instants


def find_least_singular_values(runner: Runner, run: Trajectory, times: Array) -> Array:
    """Estimate the smallest relative singular value of the independent closures, (n_t,)."""
    # the rows are selected at the first instant, and pivots are relative to those there
    instants = np.concatenate([run.times[:1], times])
    states = np.concatenate([run.states[:1], runner.resample(run, times)])
    evaluation = runner.evaluate(instants, states, hold_rows=True, holding=run.find_holding(instants))
    least: Array = np.sqrt(np.maximum(evaluation.pivot[1:], 0.0))
    return least


def bracket_minima(runner: Runner, run: Trajectory, times: Array) -> list[tuple[float, float]]:
    """Return intervals [a, b] around the local minima."""
    g = find_least_singular_values(runner, run, times)
    padded = np.concatenate([[np.inf], g, [np.inf]])
    low = np.flatnonzero((g <= padded[:-2]) & (g < padded[2:]))
    return [(float(times[max(k - 1, 0)]), float(times[min(k + 1, len(times) - 1)])) for k in low.tolist()]


def find_singular_instant(runner: Runner, run: Trajectory, a: float, b: float) -> float | None:
    """Return the instant of the singular position in [a, b], or None where the loops only come close to one."""
    span = b - a
    low, high, t = np.inf, 0.0, a
    for _ in range(ROUNDS):
        times = np.linspace(a, b, PROBES)
        g = find_least_singular_values(runner, run, times)
        k = int(np.argmin(g))
        low, high, t = float(g[k]), max(high, float(g.max())), float(times[k])
        a, b = float(times[max(k - 1, 0)]), float(times[min(k + 1, PROBES - 1)])
        if low == 0.0:
            break
    # a scene that is close to singular everywhere does not pass a singular position
    falls = low < tolerances.SINGULAR_FALL * high
    return t if falls and low <= tolerances.SINGULAR_MET * (b - a) / span else None


# Meeting points

HALVINGS = 60  # of a step: down to neighbouring doubles
CHUNK = 10_000  # ends of steps evaluated together


def find_directed_loads(mechanism: Mechanism) -> list[tuple[PairLoad, slice]]:
    """Return the loads that need a direction, with their rows: no springs without free length, none within one body."""
    return [
        (load, rows)
        for load, rows in mechanism.iter_load_rows()
        if isinstance(load, PairLoad) and load.a != load.b and load.needs_direction
    ]


def find_meeting(runner: Runner, run: Trajectory, horizon: float | None) -> Problem | None:
    """Return the problem of the first load whose points meet within a run, before its horizon if it has one; else
    None.
    """
    loads = find_directed_loads(runner.layout.mechanism)
    if not loads or not len(run.ends):
        return None
    marks = np.concatenate([[0.0], run.ends])
    marks = marks[marks < (np.inf if horizon is None else horizon)]
    for first in range(0, len(marks), CHUNK):
        times = marks[first : first + CHUNK + 1]
        spans = find_separations(runner, run, times, loads)
        reversed_lines = np.sum(spans[1:] * spans[:-1], axis=2) < 0.0
        meetings = (locate_meeting(runner, run, load, times[:-1][in_steps], times[1:][in_steps])
                 for load, in_steps in zip(loads, reversed_lines.T, strict=True))  # fmt: skip
        instants = [one for one in meetings if one is not None]
        if instants:
            t, name = min(instants)
            return make_coincidence_problem(name, t)
    return None


def find_separations(runner: Runner, run: Trajectory, times: Array, loads: Sequence[tuple[PairLoad, slice]]) -> Array:
    """Return the vector from one point to the other of each load, (n_t, loads, 3) [m]."""
    rows = runner.evaluate_run(run, times).loads[:, [load_rows.start for _, load_rows in loads]]
    return np.asarray(rows["at"] - rows["from_at"])


def locate_meeting(
    runner: Runner, run: Trajectory, load: tuple[PairLoad, slice], begins: Array, ends: Array
) -> tuple[float, str] | None:
    """Return the first instant at which a load has no direction, in steps within which its line reverses, and its name.

    The length has one minimum in such a step, where the points stop approaching.
    """
    if not len(begins):
        return None
    low, high = begins.copy(), ends.copy()
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        is_approaching = runner.evaluate_run(run, middle).loads[:, load[1].start]["rate"] < 0.0
        low, high = np.where(is_approaching, middle, low), np.where(is_approaching, high, middle)
    sides = [runner.evaluate_run(run, times).loads[:, load[1].start] for times in (low, high)]
    close = np.minimum(sides[0]["span"], sides[1]["span"]) <= tolerances.NO_LENGTH * runner.layout.size
    close &= (sides[0]["value"] != 0.0) | (sides[1]["value"] != 0.0)
    return (float(high[close][0]), load[0].name) if close.any() else None


# Bushing half turns


def find_half_turn(runner: Runner, run: Trajectory, horizon: float | None) -> Problem | None:
    """Return the problem of the first bushing that passes half a turn within a run, before its horizon; else None.

    Its rotation vector then continues on the opposite side: between two ends of steps it jumps by nearly a whole turn.
    """
    bushings = find_turning_bushings(runner.layout.mechanism)
    if not bushings or not len(run.ends):
        return None
    marks = np.concatenate([[0.0], run.ends])
    marks = marks[marks < (np.inf if horizon is None else horizon)]
    for first in range(0, len(marks), CHUNK):
        times = marks[first : first + CHUNK + 1]
        rotations = find_bushing_rotations(runner, run, times, bushings)
        has_jumped = np.sum(np.square(rotations[1:] - rotations[:-1]), axis=2) > np.pi**2
        if has_jumped.any():
            k = int(np.argmax(has_jumped.any(axis=1)))
            return make_bushing_problem(bushings[int(np.argmax(has_jumped[k]))][0].name, float(times[k + 1]))
    return None


def find_bushing_rotations(
    runner: Runner, run: Trajectory, times: Array, bushings: Sequence[tuple[BushingLoad, int]]
) -> Array:
    """Return the rotation vector of each bushing, (n_t, bushings, 3) [rad]."""
    return np.asarray(runner.evaluate_run(run, times).loads[:, [row for _, row in bushings]]["strain"])
