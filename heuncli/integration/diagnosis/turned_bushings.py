"""Bushings that come to half a turn, where their moment has two values. Imported only where there are bushings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem
from heuncli.integration.evaluator import Recovered
from heuncli.integration.run.runner import Runner
from heuncli.integration.trajectory import Trajectory
from heuncli.mechanism.model import Bushing, Mechanism
from heuncli.results import Array

HINT = "bushings are for less than half a turn: what turns on needs a joint, as a pin with a turn_spring"
AT_ONCE = 10_000  # ends of steps that are looked at together


def turning(mechanism: Mechanism) -> list[tuple[Bushing, int]]:
    """The bushings that resist turning, with the row of it in the kernel's table of loads."""
    return [
        (load, rows.start + 1)
        for load, rows in mechanism.load_rows()
        if isinstance(load, Bushing) and (load.turn.stiffness.any() or any(e.constant != 0.0 for e in load.turn.given))
    ]


def half_turned(name: str, t: float) -> Problem:
    """The problem of a bushing at an instant."""
    message = f"at t = {t:.9g} s forces.{name} has come to half a turn: which way its moment acts there, nothing tells"
    return Problem("bushing-turned", message, hint=HINT, about=f"forces.{name}")


def at_half_turn(mechanism: Mechanism, recovered: Recovered, instant: int) -> list[Problem]:
    """The problems of bushings that are so far turned at one of the instants, or about to be."""
    loads, t = recovered.loads[instant], float(recovered.times[instant])
    own, nearly = turning(mechanism), np.pi - tolerances.NEARLY_TURNED_OVER
    return [half_turned(b.name, t) for b, row in own if loads["span"][row] >= nearly]


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


def turns(runner: Runner, run: Trajectory, times: Array, own: Sequence[tuple[Bushing, int]]) -> Array:
    """The rotation vector of each bushing, (n_t, bushings, 3) [rad]."""
    return np.asarray(runner.answers_at(run, times).loads[:, [row for _, row in own]]["strain"])
