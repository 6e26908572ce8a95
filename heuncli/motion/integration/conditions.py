"""Conditions on a motion: whether each is true.

A condition is a program with branches that the kernel holds within a step and ends steps at, as those of loads
(kernel/events.py). Between two changes of its branches it stands still, so it is asked once for each: with the branches
of the step, whatever rounding says of margins beside zero.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from heuncli.kernel.choose import expressions as kernel
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.named_points import Jet, motion_of
from heuncli.multibody.response import variables_at
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Pack
from heuncli.scene.file_format.models import Condition

HELD, FREE, TAKEN = (kernel.HOLDING[name] for name in ("held", "free", "taken"))
Coordinates = Mapping[tuple[str, str], Jet]  # of a joint or point, and a quantity


class Conditions:
    """The conditions of a scene; places: where their branches stand among all that its kernel holds."""

    def __init__(self, layout: Layout) -> None:
        self.conditions: tuple[Condition, ...] = layout.mechanism.conditions
        self.pack = Pack()
        self.programs = [self.pack.add(condition.value) for condition in self.conditions]
        known = {(id(e), k): i for i, (e, k) in enumerate(layout.pack.branches)}
        self.places = [known[id(e), k] for e, k in self.pack.branches]

    def held(self, t: float, branches: Sequence[float], coordinates: Coordinates) -> list[float]:
        """Whether each is true (1 or 0) with its branches among those that the kernel holds; nan: it has no value."""
        own = self.pack.expressions
        own.hold_branches([branches[i] for i in self.places])
        own.hold(HELD)
        values = [own.evaluate(*program, self.variables(t, coordinates)) for program in self.programs]
        own.hold(FREE)
        return values

    def taken(self, t: float, coordinates: Coordinates) -> list[float]:
        """The branches as the coordinates have them, to rounding; ordered as `places`."""
        own = self.pack.expressions
        own.hold(TAKEN)
        for program in self.programs:
            own.evaluate(*program, self.variables(t, coordinates))
        own.hold(FREE)
        return own.branches()

    def free(self, number: int, t: float, d: float, coordinates: Coordinates) -> float:
        """Whether one is true at t + d, by the coordinates at t."""
        return self.pack.value(*self.programs[number], self.variables(t, coordinates, d))

    def variables(self, t: float, coordinates: Coordinates, d: float = 0.0) -> list[float]:
        """The time, and the coordinates that are used, d later than at t."""
        uses = [coordinates[use] for use in self.pack.variables if not isinstance(use, str)]
        return [t + d, *(q + d * (u + 0.5 * d * a) for q, u, a in uses)]


def coordinates_in(layout: Layout, t: float, state: Array) -> Coordinates:
    """The coordinates of the joints at a state, by their places in it, without their second derivatives; of points as
    they stand there, without any.

    Nothing is asked of the kernel, which may be under way.
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
        put(found, joint.name, freedom.quantity, (q, u, 0.0))
    if layout.mechanism.points:
        for use, x in zip(layout.pack.variables, variables_at(layout, t, state), strict=True):
            if not isinstance(use, str) and use[0] in layout.mechanism.points:
                found[use] = x, 0.0, 0.0
    return found


def put(to: dict[tuple[str, str], Jet], joint: str, quantity: str, jet: Jet) -> None:
    """Add a coordinate of a joint, and its rate, by their names in conditions."""
    q, u, a = jet
    to[joint, quantity] = q, u, a
    to[joint, "rate" if quantity == "angle" else "speed"] = u, a, 0.0


def coordinates_at(scene: Evaluator, times: Array, states: Array) -> list[Coordinates]:
    """The coordinates of the joints at states of a scene, as they go on from there."""
    if not any(condition.value.uses for condition in scene.layout.mechanism.conditions):
        return [{}] * len(times)
    layout, answers = scene.layout, scene.recovered(times, states)
    points = {name: motion_of(layout, point, answers.bodies) for name, point in layout.mechanism.points.items()}
    found: list[Coordinates] = []
    for i, row in enumerate(answers.freedoms):
        own = {(name, quantity): jet for name, jets in points.items() for quantity, jet in jets[i].items()}
        for freedom, (q, u, a, _) in zip(layout.freedoms, row.tolist(), strict=True):
            if freedom.joint >= 0 and freedom.quantity in ("angle", "travel"):
                name = layout.mechanism.joints[freedom.joint].name
                put(own, name, freedom.quantity, (q, u, a if math.isfinite(a) else 0.0))
        found.append(own)
    return found
