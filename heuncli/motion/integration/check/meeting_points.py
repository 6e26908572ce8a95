"""Find where within a run the two points of a spring or actuator meet, so that its force has no direction.

If points meet within a step, the line between them reverses from one end of the step to the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.diagnosis.coincident_points import make_problem
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import Mechanism, PairLoad
from heuncli.results.results import Array

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
        spans = separations(runner, run, times, loads)
        reversed_lines = np.sum(spans[1:] * spans[:-1], axis=2) < 0.0
        meetings = (locate_meeting(runner, run, load, times[:-1][in_steps], times[1:][in_steps])
                 for load, in_steps in zip(loads, reversed_lines.T, strict=True))  # fmt: skip
        instants = [one for one in meetings if one is not None]
        if instants:
            t, name = min(instants)
            return make_problem(name, t)
    return None


def separations(runner: Runner, run: Trajectory, times: Array, loads: Sequence[tuple[PairLoad, slice]]) -> Array:
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
    sides = [runner.evaluate_run(run, at).loads[:, load[1].start] for at in (low, high)]
    close = np.minimum(sides[0]["span"], sides[1]["span"]) <= tolerances.NO_LENGTH * runner.layout.size
    close &= (sides[0]["value"] != 0.0) | (sides[1]["value"] != 0.0)
    return (float(high[close][0]), load[0].name) if close.any() else None
