"""Where within a run the two points of a spring or actuator meet: there its force has no direction.

Points that come together within a step are found between its ends, where the line between them turns round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.diagnosis.coincident_points import coincide, needs_direction
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import Mechanism, PairLoad
from heuncli.results.results import Array

HALVINGS = 60  # of a step: down to neighbouring doubles
AT_ONCE = 10_000  # ends of steps that are looked at together


def pushing(mechanism: Mechanism) -> list[tuple[PairLoad, slice]]:
    """The loads that need a direction, with their rows: not springs without free length, nor within one body."""
    return [
        (load, rows)
        for load, rows in mechanism.load_rows()
        if isinstance(load, PairLoad) and load.a != load.b and needs_direction(load)
    ]


def comes_together(runner: Runner, run: Trajectory, horizon: float | None) -> Problem | None:
    """The first load whose points meet within a run, before its horizon, if it has one; None where none do."""
    loads = pushing(runner.layout.mechanism)
    if not loads or not len(run.ends):
        return None
    marks = np.concatenate([[0.0], run.ends])
    marks = marks[marks < (np.inf if horizon is None else horizon)]
    for first in range(0, len(marks), AT_ONCE):
        times = marks[first : first + AT_ONCE + 1]
        spans = separations(runner, run, times, loads)
        turned = np.sum(spans[1:] * spans[:-1], axis=2) < 0.0
        found = (meeting(runner, run, own, times[:-1][at], times[1:][at])
                 for own, at in zip(loads, turned.T, strict=True))  # fmt: skip
        instants = [one for one in found if one is not None]
        if instants:
            t, name = min(instants)
            return coincide(name, t)
    return None


def separations(runner: Runner, run: Trajectory, times: Array, loads: Sequence[tuple[PairLoad, slice]]) -> Array:
    """From the one point to the other, of each load, (n_t, loads, 3) [m]."""
    rows = runner.answers_at(run, times).loads[:, [own.start for _, own in loads]]
    return np.asarray(rows["at"] - rows["from_at"])


def meeting(
    runner: Runner, run: Trajectory, load: tuple[PairLoad, slice], begins: Array, ends: Array
) -> tuple[float, str] | None:
    """The first instant at which a load pushes along no line, in steps within which that turns round, and its name.

    Its length has one least in such a step, where the points no longer approach.
    """
    if not len(begins):
        return None
    low, high = begins.copy(), ends.copy()
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        nearing = runner.answers_at(run, middle).loads[:, load[1].start]["rate"] < 0.0
        low, high = np.where(nearing, middle, low), np.where(nearing, high, middle)
    sides = [runner.answers_at(run, at).loads[:, load[1].start] for at in (low, high)]
    close = np.minimum(sides[0]["span"], sides[1]["span"]) <= tolerances.NO_LENGTH * runner.layout.size
    close &= (sides[0]["value"] != 0.0) | (sides[1]["value"] != 0.0)
    return (float(high[close][0]), load[0].name) if close.any() else None
