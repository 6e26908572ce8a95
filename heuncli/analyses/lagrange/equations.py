"""Lagrange's equations at an instant: ε q̈ + C = k + Q, and the origin of each term (no. 18, 19; (29) to (39)).
    v = Σ s_i q̇_i,   ω = Σ t_i q̇_i            s_i, t_i: partials of the velocities, Partials.shift and turn; (29), (30)
    ε_ij = Σ m s_i · s_j + t_i · I t_j        E = q̇ᵀ ε q̇ / 2,   p = ε q̇ (35),   η = ε⁻¹,   F = pᵀ η p / 2
    C_i = Σ m s_i · a + t_i · (I ω̇ + ω × I ω)  of the accelerations a, ω̇ without loads, less ε q̈: (37)
    k_i = Σ K · s_i + M · t_i                 of loads K at their points and M, by cause: (34)
The sums are over the bodies, of mass m and inertia I about the centre. C is quadratic in the rates: C(q̇) = G q̇. With
u_k, the rates of which only that of coordinate k is 1,
    2 G u_k = C(q̇ + u_k) - C(q̇) - C(u_k),   γ_ilk = (C_i(u_l + u_k) - C_i(u_l) - C_i(u_k)) / 2
from the kernel's solutions at other rates.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.coordinate_rates import compute_accelerations
from heuncli.analyses.lagrange.coordinates import CoordinateChoice, make_candidate_rows
from heuncli.analyses.lagrange.freed_scene import FreedScene, Instant
from heuncli.analyses.lagrange.results import SectionForces
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.foundation import find_inertia_loads
from heuncli.loads.kinetostatics.shares import GRAVITY, MOTION
from heuncli.motion.integration.evaluator import CAUSES, Evaluation
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.results.results import Array


@record
class Partials:
    """Partial derivatives of the bodies' velocities by the rates of the coordinates; bodies in the order of the spec,
    world axes.

    turn (n, 3, f): of the angular velocities
    shift (n, 3, f): of the velocities of the centres of mass
    centres (n, 3) [m]: centres of mass
    """

    turn: Array
    shift: Array
    centres: Array

    def point_partials(self, body: int, position: Array) -> Array:
        """Return the partials (3, f) of the velocity of a body's point at a world position; 0 for the ground."""
        if body == GROUND:
            return np.zeros(self.shift.shape[1:])
        arm = position - self.centres[body]
        return np.asarray(self.shift[body] + np.cross(self.turn[body], arm, axis=0))

    def turn_partials(self, body: int) -> Array:
        """Return the partials (3, f) of a body's angular velocity; 0 for the ground."""
        return np.zeros(self.turn.shape[1:]) if body == GROUND else self.turn[body]

    def compute_generalised_force(self, action: Action) -> Array:
        """Return the generalised force (f,) of an action at its first instant."""
        k = np.zeros(self.turn.shape[2])
        for end, force, moment in action.iter_ends():
            k = k + force[0] @ self.point_partials(end.body, end.position[0]) + moment[0] @ self.turn_partials(end.body)
        return k


def make_partials(layout: Layout, linear_equations: LinearisedEquations, S: Array) -> Partials:
    """Return the partials of all bodies by the coordinates."""
    order = [layout.place[i] for i in range(len(layout.mechanism.bodies))]
    twists = linear_equations.twists[order] @ S
    return Partials(twists[:, :3], twists[:, 3:], linear_equations.centres[order])


def invert_inertia(names: Sequence[str], epsilon: Array) -> Array:
    """Return η = ε⁻¹. Raises SolveError [no-inertia] if a motion has no inertia."""
    try:
        L = np.linalg.cholesky(epsilon)
    except np.linalg.LinAlgError:
        _, V = np.linalg.eigh(epsilon)
        name = names[int(np.argmax(np.abs(V[:, 0])))]
        message = f"{name} has no inertia: a force along it gives no finite acceleration"
        raise SolveError(Problem("no-inertia", message, hint="give a mass to the bodies that it moves")) from None
    half = np.linalg.inv(L)
    return np.asarray(half.T @ half)


@record
class InstantEquations:
    """The inertial terms of the equations at an instant: ε, η (f, f), and the partials they are made of."""

    instant: Instant
    choice: CoordinateChoice
    partials: Partials
    epsilon: Array
    eta: Array


def make_instant_equations(instant: Instant, choice: CoordinateChoice) -> InstantEquations:
    """Return the inertial terms. Raises SolveError [no-inertia] if a motion has no inertia."""
    epsilon = symmetrise(choice.S.T @ instant.linear_equations.mass @ choice.S)
    eta = invert_inertia(choice.names, epsilon)
    partials = make_partials(instant.freed_scene.layout, instant.linear_equations, choice.S)
    return InstantEquations(instant, choice, partials, epsilon, eta)


def symmetrise(M: Array) -> Array:
    """Return the symmetric part of a matrix that is symmetric except for rounding."""
    return np.asarray(0.5 * (M + M.T))


@record
class VelocityTerms:
    """Computes the velocity terms C at given rates, from the freed scene with only its velocity terms at work."""

    freed_scene: FreedScene
    choice: CoordinateChoice
    partials: Partials
    epsilon: Array
    t: float
    state: Array
    holding: Array

    def compute_terms(self, rates: Array) -> Array:
        """Return C (m, f) at rates of the coordinates (m, f), in the pose of the state."""
        layout = self.freed_scene.layout
        rate_places = rate_indices(layout)
        states = np.repeat(self.state[None, :], len(rates), axis=0)
        states[:, rate_places[rate_places >= 0]] = rates @ self.choice.S.T
        times = np.full(len(rates), self.t)
        recovered = self.freed_scene.runner.evaluate(times, states, causes=True, holding=self.holding)
        velocity_motion = get_velocity_motion(layout, recovered)
        force, moment = find_inertia_loads(layout.mechanism, velocity_motion)
        forces = np.einsum("tni,nif->tf", force, self.partials.shift) + np.einsum(
            "tni,nif->tf", moment, self.partials.turn
        )
        return np.asarray(forces - compute_accelerations(layout, self.choice.names, velocity_motion) @ self.epsilon)

    def coriolis_matrix(self, rates: Array) -> Array:
        """Return G (f, f) with C = G q̇, such that the rate of ε minus 2 G is antisymmetric; rates (f,)."""
        f = len(rates)
        unit = np.eye(f) * max(float(np.abs(rates).max(initial=0.0)), 1.0)
        C = self.compute_terms(np.vstack([rates, rates + unit, unit]))
        return np.asarray(0.5 * (C[1 : f + 1] - C[0] - C[f + 1 :]).T / unit[0, 0])

    def compute_christoffel_symbols(self) -> Array:
        """Return gamma[i, l, k], the Christoffel symbols of the first kind."""
        f = len(self.epsilon)
        pairs = [(l, k) for l in range(f) for k in range(l, f)]
        unit = np.eye(f)
        C = self.compute_terms(np.array([unit[l] + unit[k] for l, k in pairs]))
        twice = {pair: C[n] for n, pair in enumerate(pairs)}  # C(2 u_l) = 4 C(u_l)
        gamma = np.zeros((f, f, f))
        for (l, k), value in twice.items():
            diagonal_part = 0.25 * (twice[l, l] + twice[k, k])
            gamma[:, l, k] = gamma[:, k, l] = 0.25 * value if l == k else 0.5 * (value - diagonal_part)
        return gamma


def get_velocity_motion(layout: Layout, recovered: Evaluation) -> BodyStates:
    """Return the bodies' motion with the accelerations due to the velocities alone, without loads or drives."""
    assert recovered.causes is not None, "recovered without causes"
    column = len(layout.tables["loads"]) + CAUSES.index(MOTION)
    bodies = recovered.bodies.copy()
    caused = recovered.causes.bodies[:, column]
    bodies["alpha"] = caused["alpha"]
    bodies["a"] = caused["a"] - layout.mechanism.gravity  # the kernel's accelerations are relative to free fall
    return make_body_states(layout, replace(recovered, bodies=bodies))


def compute_forces_by_cause(layout: Layout, partials: Partials, actions: Sequence[Action]) -> dict[str, Array]:
    """Return k (f,) of each cause: of weight, and of the applied loads by name."""
    mechanism = layout.mechanism
    weight = np.array([body.mass for body in mechanism.bodies])[:, None] * mechanism.gravity
    k = {GRAVITY: np.einsum("ni,nif->f", weight, partials.shift)} if mechanism.gravity.any() else {}
    for action in actions:
        k[action.name] = k.get(action.name, 0.0) + partials.compute_generalised_force(action)
    return k


def estimate_term_sizes(layout: Layout, partials: Partials, actions: Sequence[Action], states: BodyStates) -> Array:
    """Return the size of the terms in the equations, (f,): the sum of |F| |x_P,i| + |M| |w_i| over all loads."""
    mechanism = layout.mechanism
    weight = np.array([body.mass for body in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = (compute_norms(part[0], 1) for part in find_inertia_loads(mechanism, states))
    size = (compute_norms(weight, 1) + force) @ compute_norms(partials.shift, 1) + moment @ compute_norms(
        partials.turn, 1
    )
    for action in actions:
        for end, F, M in action.iter_ends():
            size = size + compute_norms(F[0], 0) * compute_norms(partials.point_partials(end.body, end.position[0]), 0)
            size = size + compute_norms(M[0], 0) * compute_norms(partials.turn_partials(end.body), 0)
    return np.asarray(size)


def compute_norms(vectors: Array, axis: int) -> Array:
    """Return the magnitudes of vectors along an axis."""
    return np.asarray(np.sqrt(np.sum(vectors**2, axis=axis)))


@record
class DriveRows:
    """The driven coordinates: names, the joint of each, their rows (d, f) on the rates of the chosen coordinates."""

    names: tuple[str, ...]
    joints: tuple[str, ...]
    rows: Array

    def project_on_drives(self, remainder: Array) -> Array:
        """Return Q (f,): the part of the equations' remainder that drives can exert."""
        return np.asarray(self.rows.T @ solve_least_squares(self.rows.T, remainder))


def make_drive_rows(instant: Instant, choice: CoordinateChoice) -> DriveRows:
    """Return the driven coordinates at an instant."""
    driven = instant.freed_scene.driven_coordinates
    rows = make_candidate_rows(instant.freed_scene.layout, instant.linear_equations)
    unit = dict(zip(choice.names, np.eye(len(choice.names)), strict=True))
    driven_rows = [unit[name] if name in unit else rows[name] @ choice.S for name in driven]
    return DriveRows(
        tuple(driven), tuple(driven.values()), np.array(driven_rows).reshape(len(driven_rows), len(choice.names))
    )


def subtract_drive_efforts(instant: Instant, drives: DriveRows, remainder: Array) -> tuple[Array, Array]:
    """Subtract the drives' efforts, as the joint reactions have them, from e q'' + C - k, (f,); also return where the
    result is known.

    If supports are redundant, the effort of a drive may be indeterminate: the coordinates along which it acts are then
    unknown.
    """
    loads = {load.joint.name: load for load in instant.recovery.joints} if not instant.setup.model["redundant"] else {}
    is_known = np.ones(len(remainder), dtype=bool)
    for joint, row in zip(drives.joints, drives.rows, strict=True):
        load = loads.get(joint)
        if load is not None and load.drive is not None:
            remainder = remainder - float(load.drive[0]) * row
        else:
            is_known &= row == 0.0
    return remainder, is_known


def to_lists(section: SectionForces) -> Any:
    """Return the forces as JSON lists: one per cut, or that of the only cut; None where indeterminate."""
    values = [None if np.isnan(s).any() else s.tolist() for s in section.s]
    return values if section.is_cut_series else values[0]


def list_cuts(name: str, section: SectionForces) -> list[tuple[str, Array | None]]:
    """Return the cuts by name with their forces; None where indeterminate."""
    return [
        (f"{name}.{k}" if section.is_cut_series else name, None if np.isnan(s).any() else s)
        for k, s in enumerate(section.s)
    ]
