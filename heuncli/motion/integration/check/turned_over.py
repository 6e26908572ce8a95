"""Whether within a run a bushing passes half a turn: its moment then jumps from one side to the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.errors import Problem
from heuncli.motion.integration.diagnosis.turned_bushings import half_turned, turning
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import BushingLoad
from heuncli.results.results import Array

AT_ONCE = 10_000  # ends of steps that are looked at together


def turns_over(runner: Runner, run: Trajectory, horizon: float | None) -> Problem | None:
    """The first bushing that passes half a turn within a run, before its horizon, if it has one; None where none does.

    Its rotation vector then goes on from the opposite side: between two ends of steps it jumps by nearly a whole turn.
    """
    own = turning(runner.layout.mechanism)
    if not own or not len(run.ends):
        return None
    marks = np.concatenate([[0.0], run.ends])
    marks = marks[marks < (np.inf if horizon is None else horizon)]
    for first in range(0, len(marks), AT_ONCE):
        times = marks[first : first + AT_ONCE + 1]
        turned = turns(runner, run, times, own)
        jumped = np.sum(np.square(turned[1:] - turned[:-1]), axis=2) > np.pi**2
        if jumped.any():
            k = int(np.argmax(jumped.any(axis=1)))
            return half_turned(own[int(np.argmax(jumped[k]))][0].name, float(times[k + 1]))
    return None


def turns(runner: Runner, run: Trajectory, times: Array, own: Sequence[tuple[BushingLoad, int]]) -> Array:
    """The rotation vector of each bushing, (n_t, bushings, 3) [rad]."""
    return np.asarray(runner.answers_at(run, times).loads[:, [row for _, row in own]]["strain"])
