"""Loads along the line between two points, where that has no length: what pushes there has no direction.

A spring without free length is as strong as it is long, and needs none; where it is damped and its points part, the
damping does. Points that come together within a step are found between its ends, where the line turns round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem
from heuncli.integration.evaluator import Recovered
from heuncli.integration.run.runner import Runner, Trajectory
from heuncli.mechanism.model import Mechanism, PairLoad
from heuncli.results import Array
from heuncli.tree.layout import Layout

HALVINGS = 60  # of a step: down to neighbouring doubles
AT_ONCE = 10_000  # ends of steps that are looked at together
HINT = "in a pin or slide use type: torque; else keep its points apart"


def pushing(mechanism: Mechanism) -> list[tuple[PairLoad, slice]]:
    """The loads that need a direction, with their rows: not springs without free length, nor within one body."""
    return [
        (load, rows)
        for load, rows in mechanism.load_rows()
        if isinstance(load, PairLoad) and load.a != load.b and needs_direction(load)
    ]


def needs_direction(load: PairLoad) -> bool:
    """Whether it pushes where its line has no length."""
    if load.value is None:
        return load.stiffness * load.length != 0.0
    return load.value.constant != 0.0


def without_direction(layout: Layout, recovered: Recovered, begins: bool = False) -> list[Problem]:
    """The loads that push along no line, each at its first instant; begins: a motion, so what will push counts, too."""
    near = tolerances.NO_LENGTH * layout.size
    problems = []
    for load, rows in layout.mechanism.load_rows():
        if not isinstance(load, PairLoad):
            continue
        here = recovered.loads[:, rows][:, 0]
        together = here["span"] <= near
        if not together.any():
            continue
        if not needs_direction(load):
            parts = np.sqrt(np.sum(parting(layout, load, recovered) ** 2, axis=1))
            together &= (here["span"] == 0.0) & (load.damping * parts > 0.0)
        elif load.value is not None:
            together &= begins | (here["value"] != 0.0)
        if together.any():
            problems.append(coincide(load.name, float(recovered.times[int(np.argmax(together))])))
    return problems


def parting(layout: Layout, load: PairLoad, recovered: Recovered) -> Array:
    """The velocity of its one point against the other, (n_t, 3) [m/s]."""
    speeds = []
    for body, end in ((load.a, "from_at"), (load.b, "at")):
        if body < 0:
            speeds.append(np.zeros((len(recovered.times), 3)))
            continue
        own = recovered.bodies[:, layout.place[body]]
        at = next(recovered.loads[:, rows][:, 0][end] for one, rows in layout.mechanism.load_rows() if one is load)
        speeds.append(own["v"] + np.cross(own["omega"], at - own["r"]))
    return np.asarray(speeds[1] - speeds[0])


def coincide(name: str, t: float) -> Problem:
    """The problem of a load at an instant."""
    return Problem("no-direction", f"at t = {t:.9g} s the points of forces.{name} coincide: its force has no direction",
                   hint=HINT)  # fmt: skip


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
