"""Rates, accelerations and lengths of Lagrange's coordinates from the motion of the bodies; Rodrigues vectors.

Rodrigues-Cayley vectors k are coordinates of bodies that turn freely. They are true coordinates: with them Lagrange's
equations hold for the rotation of a ball, too (no. 20, and the end of no. 22).

    k = tan(angle / 2) n                           n: axis of the turn from the world's axes to those of the body
    ω = W k̇,   W = 2 (1 + k×) / (1 + k²),   W⁻¹ = (1 + k kᵀ - k×) / 2        (42), (43); k×: the cross product
    ω̇ = W (k̈ - 2 (k·k̇) / (1 + k²) k̇),   so   k̈ = W⁻¹ ω̇ + 2 (k·k̇) / (1 + k²) k̇
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_matrix, cross_rows, quaternion_from_matrix

RODRIGUES_NAMES = ("kappa_x", "kappa_y", "kappa_z")
HALF_TURN = 1e-3  # [rad] to a half turn: there k exceeds 2000, and its equations lose six digits


def make_rodrigues_rows(layout: Layout, linear_equations: LinearisedEquations) -> dict[str, Array]:
    """Return the rows of k̇ on the rates of the tree, for bodies on balls and free bodies.

    Raises SolveError [half-turn] close to half a turn.
    """
    rows_by_name: dict[str, Array] = {}
    for place, link in enumerate(layout.spanning.links):
        if layout.bodies["ball"][place] and not layout.mechanism.planar:
            name = layout.mechanism.bodies[link.body].name
            W_inverse = compute_rodrigues_inverse(compute_rodrigues_vector(linear_equations.attitudes[place], name))
            rows_by_name |= {
                f"{name}.{axis}": row
                for axis, row in zip(RODRIGUES_NAMES, W_inverse @ linear_equations.twists[place, :3], strict=True)
            }
    return rows_by_name


def compute_rodrigues_vector(R: Array, body: str) -> Array:
    """Return k (3,) of an attitude, body to world. Raises SolveError [half-turn] where it is unbounded."""
    q = quaternion_from_matrix(R)
    if abs(q[0]) < np.sin(0.5 * HALF_TURN):
        message = f"{body} within {HALF_TURN:g} rad of 180 deg from the world axes: its Rodrigues vector is unbounded"
        hint = "choose body axes closer to the world axes"
        raise SolveError(Problem("half-turn", message, hint=hint))
    return np.asarray(q[1:] / q[0])


def compute_rodrigues_inverse(k: Array) -> Array:
    """Return W⁻¹ (3, 3)."""
    return np.asarray(0.5 * (np.eye(3) + np.outer(k, k) - cross_matrix(k)))


def compute_rodrigues_rates(R: Array, omega: Array, alpha: Array, body: str) -> tuple[Array, Array]:
    """Return k̇ and k̈ of attitudes (n_t, 3, 3) with these angular velocities and accelerations, (n_t, 3) each."""
    rates, accelerations = np.zeros_like(omega), np.zeros_like(omega)
    for i, attitude in enumerate(R):
        k = compute_rodrigues_vector(attitude, body)
        W_inverse = compute_rodrigues_inverse(k)
        rates[i] = W_inverse @ omega[i]
        accelerations[i] = W_inverse @ alpha[i] + 2.0 * float(k @ rates[i]) / (1.0 + float(k @ k)) * rates[i]
    return rates, accelerations


def compute_rates(layout: Layout, names: Sequence[str], states: BodyStates) -> Array:
    """Return the rates q' of the coordinates, (n_t, f), from the motion of the bodies."""
    return np.stack([_compute_rate(layout, name, states)[0] for name in names], axis=1)


def compute_accelerations(layout: Layout, names: Sequence[str], states: BodyStates) -> Array:
    """Return q'' of the coordinates, (n_t, f), from the accelerations of the bodies; for quasi-velocities their
    derivatives.
    """
    return np.stack([_compute_rate(layout, name, states)[1] for name in names], axis=1)


def _compute_rate(layout: Layout, name: str, states: BodyStates) -> tuple[Array, Array]:
    """Return the rate of one coordinate and its derivative, (n_t,) each."""
    owner, _, quantity = name.rpartition(".")
    mechanism = layout.mechanism
    joint = next((joint for joint in mechanism.joints if joint.name == owner), None)
    if quantity in RODRIGUES_NAMES:
        body = next(i for i, other in enumerate(mechanism.bodies) if other.name == owner)
        axis = RODRIGUES_NAMES.index(quantity)
        rate, acceleration = compute_rodrigues_rates(
            states.R[:, body], states.omega[:, body], states.alpha[:, body], owner
        )
        return rate[:, axis], acceleration[:, axis]
    if joint is None:
        return get_body_rate(mechanism, owner, quantity, states)
    if quantity == "length":
        return compute_length_rate(joint, states)
    return compute_joint_rate(joint, quantity, states)


def compute_joint_rate(joint: Joint, quantity: str, states: BodyStates) -> tuple[Array, Array]:
    """Return the rate of an angle or a travel and its derivative, or a component of a relative angular velocity or
    velocity and its derivative, (n_t,) each.
    """
    omega_a, alpha_a = get_rotation(states, joint.a)
    omega_b, alpha_b = get_rotation(states, joint.b)
    n = states.world_direction(joint.a, joint.axis)
    if quantity == "angle":
        return dot_rows(n, omega_b - omega_a), dot_rows(n, alpha_b - alpha_a)
    if quantity in "xyz":
        axis = "xyz".index(quantity)
        return (omega_b - omega_a)[:, axis], (alpha_b - alpha_a)[:, axis]
    Q = states.point_position(joint.b, joint.q)
    v = states.point_velocity(joint.b, Q) - states.point_velocity(joint.a, Q)
    a = states.point_acceleration(joint.b, Q) - states.point_acceleration(joint.a, Q)
    if quantity == "travel":
        return dot_rows(n, v), dot_rows(n, a - 2.0 * cross_rows(omega_a, v))
    axis = "xyz".index(quantity[1])
    # the position is that of `to`, which moves past `from` with v
    return v[:, axis], (a - cross_rows(omega_a, v))[:, axis]


def get_rotation(states: BodyStates, body: int) -> tuple[Array, Array]:
    """Return angular velocity and acceleration of a body, or of the ground, (n_t, 3) each."""
    if body == GROUND:
        return np.zeros((len(states.x), 3)), np.zeros((len(states.x), 3))
    return states.omega[:, body], states.alpha[:, body]


def get_body_rate(mechanism: Mechanism, name: str, quantity: str, states: BodyStates) -> tuple[Array, Array]:
    """Return a component of the angular velocity, or of the centre's velocity, of a free body, and its derivative."""
    body = next(i for i, other in enumerate(mechanism.bodies) if other.name == name)
    k = "xyz".index(quantity[-1])
    if quantity.startswith("d"):
        return states.v_centre[:, body, k], states.a_centre[:, body, k]
    return states.omega[:, body, k], states.alpha[:, body, k]


def compute_length(layout: Layout, states: BodyStates, name: str) -> float:
    """Return the distance of a rod's two points at the first instant [m]."""
    joint = next(joint for joint in layout.mechanism.joints if joint.name == name)
    D = states.point_position(joint.b, joint.q)[0] - states.point_position(joint.a, joint.p)[0]
    return float(np.sqrt(D @ D))


def compute_length_rate(joint: Joint, states: BodyStates) -> tuple[Array, Array]:
    """Return the derivatives of the distance D of two points: e . v, and e . a + (v^2 - (e . v)^2) / |D|."""
    A, B = states.point_position(joint.a, joint.p), states.point_position(joint.b, joint.q)
    v = states.point_velocity(joint.b, B) - states.point_velocity(joint.a, A)
    a = states.point_acceleration(joint.b, B) - states.point_acceleration(joint.a, A)
    D = B - A
    length = np.sqrt(dot_rows(D, D))
    e = D / length[:, None]
    return dot_rows(e, v), dot_rows(e, a) + (dot_rows(v, v) - dot_rows(e, v) ** 2) / length


def dot_rows(a: Array, b: Array) -> Array:
    """Return the scalar products of vectors (n_t, 3)."""
    return np.asarray(np.sum(a * b, axis=1))
