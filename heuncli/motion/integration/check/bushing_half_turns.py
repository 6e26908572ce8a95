"""Find whether within a run a bushing passes half a turn, where its moment jumps from one side to the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.errors import Problem
from heuncli.motion.integration.diagnosis.turned_bushings import find_turning_bushings, make_problem
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import BushingLoad
from heuncli.results.results import Array

CHUNK = 10_000  # ends of steps evaluated together


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
        rotations = bushing_rotations(runner, run, times, bushings)
        has_jumped = np.sum(np.square(rotations[1:] - rotations[:-1]), axis=2) > np.pi**2
        if has_jumped.any():
            k = int(np.argmax(has_jumped.any(axis=1)))
            return make_problem(bushings[int(np.argmax(has_jumped[k]))][0].name, float(times[k + 1]))
    return None


def bushing_rotations(
    runner: Runner, run: Trajectory, times: Array, bushings: Sequence[tuple[BushingLoad, int]]
) -> Array:
    """Return the rotation vector of each bushing, (n_t, bushings, 3) [rad]."""
    return np.asarray(runner.evaluate_run(run, times).loads[:, [row for _, row in bushings]]["strain"])
