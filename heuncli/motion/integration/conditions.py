"""Evaluate whether the conditions on a motion are true, and end a run where the one that ends it is.

A condition is a program whose branches the kernel holds within a step. The kernel ends a step where they change, as it
does for the branches of loads (kernel/events.py). Between two changes a condition is constant. So it is evaluated once
for each such interval, with the branches of the step, whatever rounding makes of margins near zero.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.kernel.choose import expressions as kernel
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import NamedPoint
from heuncli.multibody.response import evaluate_variables
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Pack
from heuncli.scene.file_format.models import Condition
from heuncli.scene.shapes.rotations import cross_rows

# Named points

Jet = tuple[float, float, float]  # value, rate, second derivative


def point_motion(layout: Layout, point: NamedPoint, bodies: Table) -> list[dict[str, Jet]]:
    """Return a point's position and velocity components with their derivatives at each instant, by name; bodies (n_t,
    n_b).
    """
    if point.body == GROUND:
        place = np.tile(point.place, (len(bodies), 1))
        velocity = acceleration = np.zeros_like(place)
    else:
        index = layout.place[point.body]
        body_rows = bodies[:, index]
        arm = body_rows["R"] @ (point.place - layout.reference[index])
        swept = cross_rows(body_rows["omega"], arm)
        place, velocity = body_rows["r"] + arm, body_rows["v"] + swept
        acceleration = body_rows["a"] + layout.mechanism.gravity + cross_rows(body_rows["alpha"], arm)
        acceleration = np.nan_to_num(acceleration + cross_rows(body_rows["omega"], swept))
    x, v, a = (rows @ point.axes.T for rows in (place, velocity, acceleration))
    x = x + point.offset
    return [
        {name: (float(x[i, k]), float(v[i, k]), float(a[i, k])) for k, name in enumerate("xyz")}
        | {f"v{name}": (float(v[i, k]), float(a[i, k]), 0.0) for k, name in enumerate("xyz")}
        for i in range(len(bodies))
    ]


# Conditions

HELD, FREE, TAKEN = (kernel.HOLDING[name] for name in ("held", "free", "taken"))
Coordinates = Mapping[tuple[str, str], Jet]  # of a joint or point, and a quantity


class Conditions:
    """The conditions of a scene.

    places: position of each of their branches among all branches that the kernel holds
    """

    def __init__(self, layout: Layout) -> None:
        self.conditions: tuple[Condition, ...] = layout.mechanism.conditions
        self.pack = Pack()
        self.programs = [self.pack.add(condition.value) for condition in self.conditions]
        known = {(id(e), k): i for i, (e, k) in enumerate(layout.pack.branches)}
        self.places = [known[id(e), k] for e, k in self.pack.branches]

    def evaluate_held(self, t: float, branches: Sequence[float], coordinates: Coordinates) -> list[float]:
        """Return the truth of each condition (1 or 0) with the branches that the kernel holds; nan where it has no
        value.
        """
        expressions = self.pack.expressions
        expressions.hold_branches([branches[i] for i in self.places])
        expressions.hold(HELD)
        values = [
            expressions.evaluate(*program, self.extrapolate_variables(t, coordinates)) for program in self.programs
        ]
        expressions.hold(FREE)
        return values

    def take_branches(self, t: float, coordinates: Coordinates) -> list[float]:
        """Return the branches that follow from the coordinates, up to rounding, in the order of `places`."""
        expressions = self.pack.expressions
        expressions.hold(TAKEN)
        for program in self.programs:
            expressions.evaluate(*program, self.extrapolate_variables(t, coordinates))
        expressions.hold(FREE)
        return expressions.branches()

    def evaluate_free(self, number: int, t: float, d: float, coordinates: Coordinates) -> float:
        """Return the truth of one condition at t + d, from the coordinates at t."""
        return self.pack.value(*self.programs[number], self.extrapolate_variables(t, coordinates, d))

    def extrapolate_variables(self, t: float, coordinates: Coordinates, d: float = 0.0) -> list[float]:
        """Return the time t + d and the coordinates in use, extrapolated from t to second order."""
        uses = [coordinates[use] for use in self.pack.variables if not isinstance(use, str)]
        return [t + d, *(q + d * (u + 0.5 * d * a) for q, u, a in uses)]


def read_coordinates(layout: Layout, t: float, state: Array) -> Coordinates:
    """Read the coordinates of joints and points from a state, without calling the kernel, which may be running.

    Joint coordinates have no second derivatives (0); points have neither rates nor second derivatives.
    """
    found: dict[tuple[str, str], Jet] = {}
    for freedom in layout.freedoms:
        if freedom.joint < 0 or freedom.quantity not in ("angle", "travel"):
            continue
        joint = layout.mechanism.joints[freedom.joint]
        if freedom.q >= 0:
            q, u = float(state[freedom.q]), float(state[freedom.u])
        else:
            assert joint.drive is not None
            q, u, _ = joint.drive.value.derivatives(t)
        put_coordinate(found, joint.name, freedom.quantity, (q, u, 0.0))
    if layout.mechanism.points:
        for use, x in zip(layout.pack.variables, evaluate_variables(layout, t, state), strict=True):
            if not isinstance(use, str) and use[0] in layout.mechanism.points:
                found[use] = x, 0.0, 0.0
    return found


def put_coordinate(coordinates: dict[tuple[str, str], Jet], joint: str, quantity: str, jet: Jet) -> None:
    """Add a joint's coordinate and its rate under their names in conditions."""
    q, u, a = jet
    coordinates[joint, quantity] = q, u, a
    coordinates[joint, "rate" if quantity == "angle" else "speed"] = u, a, 0.0


def evaluate_coordinates(scene: Evaluator, times: Array, states: Array) -> list[Coordinates]:
    """Return the coordinates of joints and points at given states, with rates and second derivatives."""
    if not any(condition.value.uses for condition in scene.layout.mechanism.conditions):
        return [{}] * len(times)
    layout, evaluation = scene.layout, scene.evaluate(times, states)
    points = {name: point_motion(layout, point, evaluation.bodies) for name, point in layout.mechanism.points.items()}
    found: list[Coordinates] = []
    for i, row in enumerate(evaluation.freedoms):
        jets_by_name = {(name, quantity): jet for name, jets in points.items() for quantity, jet in jets[i].items()}
        for freedom, (q, u, a, _) in zip(layout.freedoms, row.tolist(), strict=True):
            if freedom.joint >= 0 and freedom.quantity in ("angle", "travel"):
                name = layout.mechanism.joints[freedom.joint].name
                put_coordinate(jets_by_name, name, freedom.quantity, (q, u, a if math.isfinite(a) else 0.0))
        found.append(jets_by_name)
    return found


# Ending


class EndingCondition:
    """The condition that ends a run, evaluated where a piece begins and where branches change. Remembers its last
    value.
    """

    def __init__(self, layout: Layout) -> None:
        self.conditions = Conditions(layout)
        self.layout = layout
        self.number = next(i for i, condition in enumerate(self.conditions.conditions) if condition.ends)
        self.previous_truth: float | None = None

    def has_become_true(self, t: float, state: Array) -> bool:
        """Return whether it became true at t, in an integrated state (n',); at the start it may already be true."""
        branches = self.layout.pack.expressions.branches()
        now = self.conditions.evaluate_held(t, branches, read_coordinates(self.layout, t, state))[self.number]
        became = self.previous_truth == 0.0 and now == 1.0 and t > 0.0
        self.previous_truth = now
        return became
