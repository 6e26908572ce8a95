"""The undriven coordinates of a scene: displacements and accelerations along them, their names, which are coupled.

They have the order of the layout's results: three small rotations of a ball joint about the world's axes, one number
for any other freedom.

Coordinates that a gear, a thread or a belt couples are found, so that none of them counts as farther than the others: a
spindle turns many times before its nut reaches its spring, and a pinion before its wheel does.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.linearisation.displacements import displace, find_displacement
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.couplings import Belt, Gear, Ratio, Screw
from heuncli.scene.shapes.rotations import cross_vectors

GOLDEN_SHARE = 0.6180339887498949  # its multiples, less whole numbers, are spread evenly and without a pattern

# Coordinates


@record
class Coordinates:
    """The n undriven coordinates and their positions in the layout.

    weights (n,): 1 for a rotation, 1 / size for a shift
    shifts (n,): whether a coordinate is a shift
    result_indices (n,): their indices in the layout's results
    rates (n,): indices of their rates in the state
    balls: tree indices of the bodies on ball joints
    turns: for each of these, the number of the first of its three rotations
    freedoms: indices of the other undriven freedoms
    numbers: for each of these, the number of its coordinate
    """

    layout: Layout
    weights: Array
    shifts: Mask
    result_indices: Indices
    rates: Indices
    balls: Indices
    turns: Indices
    freedoms: Indices
    numbers: Indices

    @property
    def count(self) -> int:
        """Number of coordinates."""
        return len(self.weights)

    def displace(self, states: Array, displacements: Array) -> Array:
        """Displace states (k, n_state) by small rotations and shifts (k, n)."""
        return displace(self.layout, states, displacements)

    def find_displacement(self, state: Array, other: Array) -> Array:
        """Return the small rotations and shifts (n,) that turn one state (n_state,) into another one."""
        return find_displacement(self.layout, state, other)

    def transport_velocities(self, displacement: Array, velocities: Array) -> Array:
        """Return the rates of displacements (n,) from a pose, for velocities (n,) at their end.

        The rotation vector r of a ball joint changes by w - r x w / 2 + ..., w its angular velocity (Bortz).
        """
        rates = velocities.copy()
        for first in self.turns.tolist():
            turn = slice(first, first + 3)
            rates[turn] -= 0.5 * cross_vectors(displacement[turn], velocities[turn])
        return rates

    def accelerations(self, evaluation: Evaluation) -> Array:
        """Return the accelerations of the coordinates, (k, n)."""
        return self.collect(evaluation.bodies["alpha"], evaluation.freedoms["udot"])

    def acceleration_terms(self, evaluation: Evaluation) -> Array:
        """Return the sum of the magnitudes of each cause's accelerations at one instant, (n,)."""
        assert evaluation.causes is not None
        by_cause = self.collect(evaluation.causes.bodies["alpha"][0], evaluation.causes.freedoms["udot"][0])
        return np.asarray(np.abs(by_cause).sum(axis=0))

    def collect(self, alpha: Array, udot: Array) -> Array:
        """Collect angular accelerations of bodies (k, n_b, 3) and accelerations of freedoms (k, n_f) by coordinate, (k,
        n).
        """
        collected = np.zeros((len(alpha), self.count))
        for place, first in zip(self.balls.tolist(), self.turns.tolist(), strict=True):
            collected[:, first : first + 3] = alpha[:, place]
        collected[:, self.numbers] = udot[:, self.freedoms]
        return collected

    def max_magnitude(self, displacement: Array) -> float:
        """Return the largest component of a displacement (n,): rotations in rad, shifts relative to the scene's
        size.
        """
        return float(np.abs(displacement * self.weights).max(initial=0.0))

    def find_owner(self, number: int) -> tuple[str, bool]:
        """Return the joint or body of a coordinate, as named in the spec, and whether the coordinate is a rotation."""
        layout = self.layout
        place = int(np.searchsorted(layout.bodies["velocity_at"], self.result_indices[number], side="right")) - 1
        link = layout.spanning.links[place]
        turns = not self.shifts[number]
        if link.joint >= 0 and not layout.bodies["ball"][place]:
            return f"joints.{layout.mechanism.joints[link.joint].name}", turns
        return f"bodies.{layout.mechanism.bodies[link.body].name}", turns


def make_coordinates(layout: Layout) -> Coordinates:
    """Make the undriven coordinates of a scene."""
    bodies, freedoms = layout.bodies, layout.tables["freedoms"]
    balls = np.flatnonzero(bodies["ball"])
    undriven = np.flatnonzero(freedoms["driven"] == 0)
    places = {int(a) + k: (int(r) + k) for a, r in bodies[["velocity_at", "rate_at"]][balls].tolist() for k in range(3)}
    places |= dict(freedoms[["velocity_at", "u_at"]][undriven].tolist())
    result_indices = np.array(sorted(places), dtype=int)
    rates = np.array([places[a] for a in result_indices.tolist()], dtype=int)
    numbers = np.searchsorted(result_indices, freedoms["velocity_at"][undriven])
    shifts = np.zeros(len(result_indices), dtype=bool)
    shifts[numbers] = freedoms["kind"][undriven] == kernel.SHIFT
    return Coordinates(
        layout=layout, shifts=shifts, weights=layout.weights[rates], result_indices=result_indices, rates=rates,
        balls=balls, turns=np.searchsorted(result_indices, bodies["velocity_at"][balls]), freedoms=undriven,
        numbers=numbers,
    )  # fmt: skip


def set_to_rest(evaluator: Evaluator, t: float, states: Array, holding: Array) -> Array:
    """Return states (k, n_state) whose coordinates rest: the only rates are those of what drives turn and shift.

    A body on a ball joint turns with its parent.
    """
    layout = evaluator.layout
    resting_states = states.copy()
    for group in layout.tables["groups"]:
        resting_states[:, group["rates"] : group["end"]] = 0.0
    if has_driven_rotation(layout) and layout.bodies["ball"].any():
        evaluation = evaluator.evaluate(np.full(len(states), t), resting_states, hold_rows=True, holding=holding)
        set_parent_rotation(layout, resting_states, evaluation.bodies, evaluation.freedoms)
    return resting_states


def evaluate_at_rest(
    evaluator: Evaluator, t: float, states: Array, holding: Array, *, causes: bool = False
) -> Evaluation:
    """Evaluate states whose coordinates rest."""
    resting_states = set_to_rest(evaluator, t, states, holding)
    return evaluator.evaluate(np.full(len(states), t), resting_states, hold_rows=True, holding=holding, causes=causes)


def has_driven_rotation(layout: Layout) -> bool:
    """Return whether a drive turns what is attached to it."""
    freedoms = layout.tables["freedoms"]
    return bool(((freedoms["driven"] == 1) & (freedoms["kind"] != kernel.SHIFT)).any())


def set_parent_rotation(layout: Layout, states: Array, bodies: Table, freedoms: Table) -> None:
    """Give bodies on ball joints the angular velocity of their parents, in place; bodies, freedoms: results at those
    states.
    """
    omega = find_driven_angular_velocities(layout, bodies, freedoms)
    for place, body in enumerate(layout.bodies):
        if body["ball"]:
            states[:, body["rate_at"] : body["rate_at"] + 3] = omega[:, place]


def find_driven_angular_velocities(layout: Layout, bodies: Table, freedoms: Table) -> Array:
    """Return the angular velocities of the bodies where drives alone turn them, (k, n_b, 3), tree order."""
    omegas = np.zeros(bodies["omega"].shape)
    for place, body in enumerate(layout.bodies):
        parent = int(body["parent"])
        if parent >= 0:
            omegas[:, place] = omegas[:, parent]
        for k, axis in find_driven_rotations(layout, place):
            s = axis if parent < 0 else bodies["R"][:, parent] @ axis
            omegas[:, place] += freedoms["u"][:, k, None] * s
    return omegas


def find_driven_rotations(layout: Layout, place: int) -> list[tuple[int, Array]]:
    """Return the driven rotations of a body on its joint: the freedoms, and their axes in the parent."""
    body, freedoms = layout.bodies[place], layout.tables["freedoms"]
    joint_freedoms = range(int(body["first_freedom"]), int(body["end_freedom"]))
    return [
        (k, np.array(freedoms["direction"][k].tolist()))
        for k in joint_freedoms
        if freedoms["driven"][k] and freedoms["kind"][k] != kernel.SHIFT
    ]


def make_rounding_displacement(coordinates: Coordinates, state: Array, number: int) -> Array:
    """Return a displacement by the rounding of the coordinates, (n,); each number gives another direction."""
    n = coordinates.count
    fraction = np.modf(GOLDEN_SHARE * (np.arange(1, n + 1) + number * (n + 1)))[0]
    direction = np.where(fraction < 0.5, -1.0, 1.0) * (0.5 + np.modf(2.0 * fraction)[0] / 2.0)
    scale = np.ones(n)
    q = state[coordinates.layout.tables["freedoms"]["q_at"][coordinates.freedoms]]
    scale[coordinates.numbers] = np.maximum(1.0, np.abs(q) * coordinates.weights[coordinates.numbers])
    return np.asarray(tolerances.START_ROUNDING * direction * scale / coordinates.weights)


# Coupled coordinates


@record
class CoupledPairs:
    """Pairs of coordinates, by their numbers in the scene, each of which moves exactly as the other does."""

    pairs: tuple[tuple[int, int], ...]

    def take_minimum(self, distances: Array) -> Array:
        """Return for each coordinate (n,) the smallest distance of itself and all that it is coupled to."""
        minima = distances.copy()
        for _ in self.pairs:  # along a train from its one end to the other
            for one, other in self.pairs:
                minima[one] = minima[other] = min(minima[one], minima[other])
        return minima


def find_coupled_pairs(layout: Layout, freedoms: Indices, numbers: Indices) -> CoupledPairs:
    """Find the pairs of a scene: coordinates of couplings between just two; freedoms, numbers (k,): as in
    Coordinates.
    """
    number = dict(zip(freedoms.tolist(), numbers.tolist(), strict=True))
    named = {(f.joint, f.quantity): number[i] for i, f in enumerate(layout.freedoms) if i in number}
    joints = {joint.name: k for k, joint in enumerate(layout.mechanism.joints)}
    pairs = []
    for coupling in layout.mechanism.couplings:
        if isinstance(coupling.entry, Ratio):
            coupled = [(joints[x.joint], x.quantity) for x in coupling.entry.terms]
        elif isinstance(coupling.entry, Gear | Screw | Belt):
            coupled = [(x.joint, x.quantity) for row in coupling.rows for part in row.parts for x in part.coordinates]
        else:
            continue
        undriven = [named[x] for x in coupled if x in named]
        if len(coupled) == len(undriven) == 2:
            pairs.append((undriven[0], undriven[1]))
    return CoupledPairs(tuple(pairs))
