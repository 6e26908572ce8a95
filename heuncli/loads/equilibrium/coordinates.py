"""The undriven coordinates of a scene: states displaced along them, accelerations along them, their names.

In the order of the layout's answers: three small turns of a ball about the world's axes, one number of any other.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.motion.linearisation.displacements import displaced, displacement
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.shapes.rotations import cross


@record
class Coordinates:
    """Where n coordinates stand.

    weights (n,): 1 of a turn, 1 / size of a shift; shifts (n,): which are shifts; answers (n,): their places among the
    layout's answers; rates (n,): of their rates in the state. balls: places of bodies in the tree, turns: number of the
    first turn of each; freedoms: the other undriven freedoms, numbers: which coordinate each is.
    """

    layout: Layout
    weights: Array
    shifts: Mask
    answers: Indices
    rates: Indices
    balls: Indices
    turns: Indices
    freedoms: Indices
    numbers: Indices

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.weights)

    def displaced(self, states: Array, by: Array) -> Array:
        """States (k, n_state) displaced by small turns and shifts (k, n)."""
        return displaced(self.layout, states, by)

    def between(self, state: Array, other: Array) -> Array:
        """The small turns and shifts (n,) that make a state (n_state,) another one."""
        return displacement(self.layout, state, other)

    def followed(self, by: Array, velocities: Array) -> Array:
        """How displacements (n,) from a pose change where they have led, at velocities (n,) there.

        A ball's rotation vector r changes by w - r x w / 2 + ..., w its angular velocity (Bortz).
        """
        found = velocities.copy()
        for first in self.turns.tolist():
            turn = slice(first, first + 3)
            found[turn] -= 0.5 * cross(by[turn], velocities[turn])
        return found

    def accelerations(self, at: Recovered) -> Array:
        """Accelerations of the coordinates, (k, n)."""
        return self.along(at.bodies["alpha"], at.freedoms["udot"])

    def terms(self, at: Recovered) -> Array:
        """What the accelerations of one instant are the sum of, each cause alone, (n,)."""
        assert at.causes is not None
        found = self.along(at.causes.bodies["alpha"][0], at.causes.freedoms["udot"][0])
        return np.asarray(np.abs(found).sum(axis=0))

    def along(self, alpha: Array, udot: Array) -> Array:
        """Angular accelerations of bodies (k, n_b, 3) and accelerations of freedoms (k, n_f) by coordinates, (k, n)."""
        found = np.zeros((len(alpha), self.count))
        for place, first in zip(self.balls.tolist(), self.turns.tolist(), strict=True):
            found[:, first : first + 3] = alpha[:, place]
        found[:, self.numbers] = udot[:, self.freedoms]
        return found

    def size(self, by: Array) -> float:
        """The largest of some displacements (n,): of turns in rad, of shifts by the scene's size."""
        return float(np.abs(by * self.weights).max(initial=0.0))

    def owner(self, number: int) -> tuple[str, bool]:
        """The joint or body of a coordinate, as it is named in the spec, and whether the coordinate is a turn."""
        layout = self.layout
        place = int(np.searchsorted(layout.bodies["answer_at"], self.answers[number], side="right")) - 1
        hang = layout.spanning.hangs[place]
        turns = not self.shifts[number]
        if hang.joint >= 0 and not layout.bodies["ball"][place]:
            return f"joints.{layout.mechanism.joints[hang.joint].name}", turns
        return f"bodies.{layout.mechanism.bodies[hang.body].name}", turns


def coordinates_of(layout: Layout) -> Coordinates:
    """The undriven coordinates of a scene."""
    bodies, freedoms = layout.bodies, layout.tables["freedoms"]
    balls = np.flatnonzero(bodies["ball"])
    own = np.flatnonzero(freedoms["driven"] == 0)
    places = {int(a) + k: (int(r) + k) for a, r in bodies[["answer_at", "rate_at"]][balls].tolist() for k in range(3)}
    places |= dict(freedoms[["answer_at", "u_at"]][own].tolist())
    answers = np.array(sorted(places), dtype=int)
    rates = np.array([places[a] for a in answers.tolist()], dtype=int)
    numbers = np.searchsorted(answers, freedoms["answer_at"][own])
    shifts = np.zeros(len(answers), dtype=bool)
    shifts[numbers] = freedoms["kind"][own] == kernel.SHIFT
    return Coordinates(
        layout=layout, shifts=shifts, weights=layout.weights[rates], answers=answers, rates=rates, balls=balls,
        turns=np.searchsorted(answers, bodies["answer_at"][balls]), freedoms=own,
        numbers=numbers,
    )  # fmt: skip


def at_rest(evaluator: Evaluator, t: float, states: Array, holding: Array) -> Array:
    """States (k, n_state) whose coordinates rest: rates of nothing but what drives turn and shift.

    The body on a ball turns with what it hangs on.
    """
    layout = evaluator.layout
    still = states.copy()
    for group in layout.tables["groups"]:
        still[:, group["rates"] : group["end"]] = 0.0
    if turns(layout) and layout.bodies["ball"].any():
        at = evaluator.recovered(np.full(len(states), t), still, hold_rows=True, holding=holding)
        turn_along(layout, still, at.bodies, at.freedoms)
    return still


def resting(evaluator: Evaluator, t: float, states: Array, holding: Array, *, causes: bool = False) -> Recovered:
    """The kernel's answers at states whose coordinates rest."""
    still = at_rest(evaluator, t, states, holding)
    return evaluator.recovered(np.full(len(states), t), still, hold_rows=True, holding=holding, causes=causes)


def turns(layout: Layout) -> bool:
    """Whether a drive turns what hangs on it."""
    freedoms = layout.tables["freedoms"]
    return bool(((freedoms["driven"] == 1) & (freedoms["kind"] != kernel.SHIFT)).any())


def turn_along(layout: Layout, states: Array, bodies: Table, freedoms: Table) -> None:
    """Give bodies on balls the angular velocity of what they hang on, in place; bodies, freedoms: of those states."""
    omega = angular_velocities(layout, bodies, freedoms)
    for place, body in enumerate(layout.bodies):
        if body["ball"]:
            states[:, body["rate_at"] : body["rate_at"] + 3] = omega[:, place]


def angular_velocities(layout: Layout, bodies: Table, freedoms: Table) -> Array:
    """Of the bodies where drives alone turn them, (k, n_b, 3), tree order."""
    found = np.zeros(bodies["omega"].shape)
    for place, body in enumerate(layout.bodies):
        parent = int(body["parent"])
        if parent >= 0:
            found[:, place] = found[:, parent]
        for k, axis in driven_turns(layout, place):
            s = axis if parent < 0 else bodies["R"][:, parent] @ axis
            found[:, place] += freedoms["u"][:, k, None] * s
    return found


def driven_turns(layout: Layout, place: int) -> list[tuple[int, Array]]:
    """The driven turns of a body on its joint: which freedoms, about which axes of the body it hangs on."""
    body, freedoms = layout.bodies[place], layout.tables["freedoms"]
    own = range(int(body["first_freedom"]), int(body["end_freedom"]))
    return [
        (k, np.array(freedoms["direction"][k].tolist()))
        for k in own
        if freedoms["driven"][k] and freedoms["kind"][k] != kernel.SHIFT
    ]


def rounding_of(coordinates: Coordinates, state: Array, number: int) -> Array:
    """A displacement by the rounding of the coordinates, (n,); of several numbers in several directions."""
    n = coordinates.count
    share = np.modf(0.6180339887498949 * (np.arange(1, n + 1) + number * (n + 1)))[0]
    direction = np.where(share < 0.5, -1.0, 1.0) * (0.5 + np.modf(2.0 * share)[0] / 2.0)
    large = np.ones(n)
    q = state[coordinates.layout.tables["freedoms"]["q_at"][coordinates.freedoms]]
    large[coordinates.numbers] = np.maximum(1.0, np.abs(q) * coordinates.weights[coordinates.numbers])
    return np.asarray(tolerances.START_ROUNDING * direction * large / coordinates.weights)
