"""Outputs of a state space, and the derivatives of velocities by a displacement at fixed rates that they need.
    v = row(q) q',   dv = row dq' + (d row/dq q') dq
The kernel differentiates angular velocities and velocities of all bodies along displacements of the tree, at fixed
rates of the tree. The change of these rates that closed chains require for the displacement is added (drift).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinates import CoordinateChoice, make_candidate_rows
from heuncli.analyses.lagrange.equations import make_partials
from heuncli.analyses.lagrange.freed_scene import Instant
from heuncli.analyses.lagrange.results import get_units
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import RATES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.base.spelling import suggest
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.motion.linearisation.linearise import LinearisedEquations, find_velocity_derivatives
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

PROBLEM_CODE = "no-state-space"
AXES = "xyz"
POINT_QUANTITIES = ("x", "y", "z", "vx", "vy", "vz")


@record
class RateSlopes:
    """Changes along f displacements at fixed rates of the chosen coordinates; n_b bodies in tree order, world axes.

    turns, shifts (n_b, 3, f): of attitudes, as small rotations, and of centres of mass
    spins, speeds (n_b, 3, f): of angular velocities, and of the velocities of the centres
    """

    layout: Layout
    linear_equations: LinearisedEquations
    turns: Array
    shifts: Array
    spins: Array
    speeds: Array

    def compute_point_slope(self, body: int, place: Array, shift: Array | None = None) -> Array:
        """Return the change (3, f) of the velocity of a body's point at a world position.

        shift (3, f): how the position moves; by default with the body
        """
        f = self.turns.shape[2]
        if body == GROUND:
            return np.zeros((3, f))
        k = self.layout.place[body]
        arm = (place - self.linear_equations.centres[k])[:, None]
        turned = np.cross(self.turns[k], arm, axis=0) if shift is None else shift - self.shifts[k]
        spin = self.linear_equations.omega[k][:, None]
        return np.asarray(self.speeds[k] + np.cross(self.spins[k], arm, axis=0) + np.cross(spin, turned, axis=0))

    def compute_joint_slope(self, joint: Joint, quantity: str) -> Array:
        """Return the change (f,) of the rate of an angle, or of the speed of a travel."""
        turn_a, spin_a, omega_a, attitude = self._get_carrier(joint.a)
        _, spin_b, omega_b, _ = self._get_carrier(joint.b)
        n = attitude @ joint.axis
        if quantity == "angle":
            return np.asarray(np.cross(turn_a, n[:, None], axis=0).T @ (omega_b - omega_a) + n @ (spin_b - spin_a))
        place = self._locate_point(joint.b, joint.q)
        shift = self._compute_point_shift(joint.b, place)
        change = self.compute_point_slope(joint.b, place) - self.compute_point_slope(joint.a, place, shift)
        speed = self._compute_velocity(joint.b, place) - self._compute_velocity(joint.a, place)
        relative_change = change - np.cross(turn_a, speed[:, None], axis=0)  # relative to the rotating carrier
        if joint.path is None:
            return np.asarray(n @ relative_change)
        return self._compute_path_slope(
            joint, attitude, speed, relative_change, shift - self._compute_point_shift(joint.a, place)
        )

    def _compute_path_slope(
        self, joint: Joint, attitude: Array, speed: Array, relative_change: Array, shift: Array
    ) -> Array:
        """Return the change for the parameter s of a path r(s), with v = r' s': r' . dv / r'^2 - s' (r' . r'') ds /
        r'^2.

        shift: displacement relative to `from`

        Zero if s is a freedom of the tree.
        """
        k = next(i for i, other in enumerate(self.layout.mechanism.joints) if other.name == joint.name)
        if k not in self.layout.counters:
            return np.zeros(relative_change.shape[1])
        assert joint.path is not None
        s = float(self.linear_equations.state[self.layout.counters[k]])
        _, slope, curvature = (attitude @ part for part in joint.path.evaluate(s)[:3])
        square = slope @ slope
        return np.asarray(
            (slope @ relative_change - (slope @ speed) / square * (slope @ curvature) * (slope @ shift) / square)
            / square
        )

    def _get_carrier(self, body: int) -> tuple[Array, Array, Array, Array]:
        """Return small rotations, changes of the angular velocity, angular velocity and attitude of a body or of the
        ground.
        """
        if body == GROUND:
            zero = np.zeros(self.turns.shape[1:])
            return zero, zero, np.zeros(3), np.eye(3)
        k = self.layout.place[body]
        return self.turns[k], self.spins[k], self.linear_equations.omega[k], self.linear_equations.attitudes[k]

    def _locate_point(self, body: int, point: Array) -> Array:
        """Return where a point of a body is, (3,) in the world."""
        if body == GROUND:
            return point
        k, center = self.layout.place[body], self.layout.mechanism.bodies[body].center
        return np.asarray(self.linear_equations.centres[k] + self.linear_equations.attitudes[k] @ (point - center))

    def _compute_velocity(self, body: int, place: Array) -> Array:
        """Return the velocity of a body at a place, (3,) in the world."""
        if body == GROUND:
            return np.zeros(3)
        k = self.layout.place[body]
        return np.asarray(
            self.linear_equations.velocities[k]
            + np.cross(self.linear_equations.omega[k], place - self.linear_equations.centres[k])
        )

    def _compute_point_shift(self, body: int, place: Array) -> Array:
        """Return the displacement (3, f) of a body's point at a world position."""
        if body == GROUND:
            return np.zeros(self.turns.shape[1:])
        k = self.layout.place[body]
        return np.asarray(
            self.shifts[k] + np.cross(self.turns[k], (place - self.linear_equations.centres[k])[:, None], axis=0)
        )


def compute_rate_slopes(
    layout: Layout, t: float, holding: Array, linear_equations: LinearisedEquations, partials: Array, drift: Array
) -> RateSlopes:
    """Return the slopes along displacements of the tree (n, f).

    drift (n, f): changes of the rates of the tree that these require
    """
    spins, speeds = find_velocity_derivatives(layout, t, linear_equations, holding)
    twists, drift_twists = linear_equations.twists @ partials, linear_equations.twists @ drift
    return RateSlopes(
        layout,
        linear_equations,
        twists[:, :3],
        twists[:, 3:],
        spins @ partials + drift_twists[:, :3],
        speeds @ partials + drift_twists[:, 3:],
    )


@record
class OutputRow:
    """An output by its rows on the coordinates (f,).

    by_place: of a position; of a rate, its change by a displacement at fixed rates
    by_rate: of a rate
    by_acceleration: of the acceleration of a coordinate
    """

    by_place: Array
    by_rate: Array
    by_acceleration: Array
    unit: str


class StateOutputs(NamedTuple):
    """The outputs of a state space: C (outputs, states), D (outputs, inputs), names and units."""

    C: Array
    D: Array
    names: tuple[str, ...]
    units: list[str]


def compute_outputs(
    slopes: RateSlopes,
    instant: Instant,
    choice: CoordinateChoice,
    free: Sequence[int],
    acceleration_rows: tuple[Array, Array],
    requested: Sequence[str],
) -> StateOutputs:
    """Return the outputs; by default the coordinates.

    free: indices of the coordinates that are states
    acceleration_rows: their accelerations by the states (f, 2 f) and by the inputs (f, m)
    """
    by_states, by_inputs = acceleration_rows
    n, m = by_inputs.shape
    names = tuple(requested) or tuple(choice.names[i] for i in free)
    candidate_rows = make_candidate_rows(slopes.layout, slopes.linear_equations)
    outputs = [make_output(slopes, instant, choice, candidate_rows, name) for name in names]
    C = [
        np.concatenate([output.by_place[free], output.by_rate[free]]) + output.by_acceleration[free] @ by_states
        for output in outputs
    ]
    D = [output.by_acceleration[free] @ by_inputs for output in outputs]
    return StateOutputs(
        np.array(C).reshape(len(names), 2 * n),
        np.array(D).reshape(len(names), m),
        names,
        [output.unit for output in outputs],
    )


def make_output(
    slopes: RateSlopes, instant: Instant, choice: CoordinateChoice, rows: dict[str, Array], name: str
) -> OutputRow:
    """Return an output by its name. Raises SolveError [no-state-space] if nothing has this name."""
    owner, _, quantity = name.rpartition(".")
    quantity_of_rate = {rate: place for place, rate in RATES.items()}
    zero = np.zeros(len(choice.names))
    if name in rows:
        return OutputRow(rows[name] @ choice.S, zero, zero, get_units(name).value)
    mechanism = slopes.layout.mechanism
    coordinate = f"{owner}.{quantity_of_rate.get(quantity, quantity)}"
    if coordinate in rows:
        joint = next(joint for joint in mechanism.joints if joint.name == owner)
        by_place = zero if coordinate in choice.names else slopes.compute_joint_slope(joint, quantity_of_rate[quantity])
        return OutputRow(by_place, rows[coordinate] @ choice.S, zero, get_units(coordinate).rate)
    if quantity == "acceleration":
        place = next((f"{owner}.{q}" for q in ("angle", "travel") if f"{owner}.{q}" in rows), None)
        if place in choice.names:
            return OutputRow(zero, zero, rows[place] @ choice.S, get_units(place).acceleration)
    if quantity in POINT_QUANTITIES:
        for i, body in enumerate(mechanism.bodies):
            point = owner.removeprefix(f"{body.name}.")
            if owner.startswith(f"{body.name}.") and point in body.points:
                return make_point_output(slopes, instant, choice, i, body.points[point], quantity)
    hint = suggest(name, list(rows), "outputs") or "coordinates, their rates, BODY.POINT.x or .vx"
    raise SolveError(Problem(PROBLEM_CODE, f"--outputs {name}: no coordinate and no point has this name", hint=hint))


def make_point_output(
    slopes: RateSlopes, instant: Instant, choice: CoordinateChoice, body: int, point: Array, quantity: str
) -> OutputRow:
    """Return a component of the position or velocity of a body's point, `x` or `vx`; point (3,): body axes."""
    axis, zero = AXES.index(quantity[-1]), np.zeros(len(choice.names))
    states = make_body_states(instant.freed_scene.layout, instant.freed_recovered)
    position = states.point_position(body, point)[0]
    partials = make_partials(slopes.layout, slopes.linear_equations, choice.S).point_partials(body, position)[axis]
    if quantity in AXES:
        return OutputRow(partials, zero, zero, "m")
    return OutputRow(slopes.compute_point_slope(body, position)[axis], partials, zero, "m/s")
