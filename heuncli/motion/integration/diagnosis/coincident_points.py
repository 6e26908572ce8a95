"""Find loads along the line between two points that coincide, so that the load has no direction.

A spring without free length has a force proportional to its length, so it needs no direction. If it is damped and its
points separate, the damping force does.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import PairLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

HINT = "in a pin or slide use type: torque; otherwise keep its points apart"


def find_undirected_loads(layout: Layout, evaluation: Evaluation, is_motion_start: bool = False) -> list[Problem]:
    """Return a problem for each load without a direction, at its first instant.

    is_motion_start: a motion starts here, so what may push later counts too
    """
    tolerance = tolerances.NO_LENGTH * layout.size
    problems = []
    for load, rows in layout.mechanism.iter_load_rows():
        if not isinstance(load, PairLoad):
            continue
        load_rows = evaluation.loads[:, rows][:, 0]
        is_coincident = load_rows["span"] <= tolerance
        if not is_coincident.any():
            continue
        if not load.needs_direction:
            separation_speed = np.sqrt(np.sum(separation_velocity(layout, load, evaluation) ** 2, axis=1))
            is_coincident &= (load_rows["span"] == 0.0) & (load.damping * separation_speed > 0.0)
        elif load.value is not None:
            is_coincident &= is_motion_start | (load_rows["value"] != 0.0)
        if is_coincident.any():
            problems.append(make_problem(load.name, float(evaluation.times[int(np.argmax(is_coincident))])))
    return problems


def separation_velocity(layout: Layout, load: PairLoad, evaluation: Evaluation) -> Array:
    """Return the velocity of the second point relative to the first, (n_t, 3) [m/s]."""
    speeds = []
    for body, end in ((load.a, "from_at"), (load.b, "at")):
        if body < 0:
            speeds.append(np.zeros((len(evaluation.times), 3)))
            continue
        body_rows = evaluation.bodies[:, layout.place[body]]
        position = next(
            evaluation.loads[:, rows][:, 0][end] for one, rows in layout.mechanism.iter_load_rows() if one is load
        )
        speeds.append(body_rows["v"] + np.cross(body_rows["omega"], position - body_rows["r"]))
    return np.asarray(speeds[1] - speeds[0])


def make_problem(name: str, t: float) -> Problem:
    """Make the problem of a load at an instant."""
    return Problem("no-direction", f"at t = {t:.9g} s the points of forces.{name} coincide: its force has no direction",
                   hint=HINT)  # fmt: skip
