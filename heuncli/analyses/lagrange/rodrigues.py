"""Relate Rodrigues-Cayley vectors, coordinates of bodies that turn freely, to angular velocities.

    k = tan(angle / 2) n                           n: axis of the turn from the world's axes to those of the body
    ω = W k̇,   W = 2 (1 + k×) / (1 + k²),   W⁻¹ = (1 + k kᵀ - k×) / 2        (42), (43); k×: the cross product
    ω̇ = W (k̈ - 2 (k·k̇) / (1 + k²) k̇),   so   k̈ = W⁻¹ ω̇ + 2 (k·k̇) / (1 + k²) k̇

They are true coordinates: with them Lagrange's equations hold for the rotation of a ball, too (no. 20, and the end of
no. 22).
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_matrix, quaternion_from_matrix

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
