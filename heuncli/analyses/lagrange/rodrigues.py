"""Rodrigues-Cayley vectors as coordinates of bodies that turn freely (no. 20, and the end of no. 22).

    k = tan(angle / 2) n, of the turn from where the body's axes are those of the world
    w = W k',   W = 2/(1 + k^2) (1 + k^),   W^-1 = (1 + k k' - k^) / 2              (42), (43)
    w. = W (k'' - 2 k . k' / (1 + k^2) k'),   so   k'' = W^-1 w. + 2 k . k' / (1 + k^2) k'
They are coordinates proper: with them the quasi-velocities of a ball have Lagrange's equations, too.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.motion.linearisation.linearise import Linearised
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import hat, to_quaternion

WORD = "rodrigues"  # what asks for them
NAMES = ("kappa_x", "kappa_y", "kappa_z")
HALF_TURN = 1e-3  # [rad] of a half turn: k is above 2000, and six digits of its equations are lost


def rows(layout: Layout, found: Linearised) -> dict[str, Array]:
    """The rows of k' on the rates of the tree, of the bodies that hang on balls or on nothing.

    Raises SolveError beside a half turn.
    """
    made: dict[str, Array] = {}
    for place, hang in enumerate(layout.spanning.hangs):
        if layout.bodies["ball"][place] and not layout.mechanism.planar:
            name = layout.mechanism.bodies[hang.body].name
            back = inverse(vector(found.attitudes[place], name))
            made |= {f"{name}.{axis}": row for axis, row in zip(NAMES, back @ found.twists[place, :3], strict=True)}
    return made


def vector(R: Array, body: str) -> Array:
    """k (3,) of an attitude, body to world. Raises SolveError [half-turn] where it has no bound."""
    q = to_quaternion(R)
    if abs(q[0]) < np.sin(0.5 * HALF_TURN):
        message = (
            f"{body} is within {HALF_TURN:g} rad of half a turn from its own axes: its Rodrigues vector has no bound"
        )
        hint = "draw the body in another attitude, its axes nearer to the world's"
        raise SolveError(Problem("half-turn", message, hint=hint))
    return np.asarray(q[1:] / q[0])


def inverse(k: Array) -> Array:
    """W^-1 (3, 3)."""
    return np.asarray(0.5 * (np.eye(3) + np.outer(k, k) - hat(k)))


def moved(R: Array, omega: Array, alpha: Array, body: str) -> tuple[Array, Array]:
    """k' and k'' of attitudes (n_t, 3, 3) with these angular velocities and accelerations, (n_t, 3) each."""
    rates, accelerations = np.zeros_like(omega), np.zeros_like(omega)
    for i, attitude in enumerate(R):
        k = vector(attitude, body)
        back = inverse(k)
        rates[i] = back @ omega[i]
        accelerations[i] = back @ alpha[i] + 2.0 * float(k @ rates[i]) / (1.0 + float(k @ k)) * rates[i]
    return rates, accelerations
