"""Loads along the line between two points, where that has no length: what pushes there has no direction.

A spring without free length is as strong as it is long, and needs none; where it is damped and its points part, the
damping does.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import PairLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

HINT = "in a pin or slide use type: torque; else keep its points apart"


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
