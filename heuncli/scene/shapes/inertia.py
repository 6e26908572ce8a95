"""Mass, centre of mass and inertia as one symmetric 4x4 matrix, the pseudo-inertia.

    P = [[T, m a], [m a^T, m]],   T = sum m x x^T = tr(J)/2 - J     about the origin of the axes it is given in
    J = sum m (x^2 - x x^T) = tr(T) - T                            Heun's D1, D2, D3 (no. 16) are T23, T31, T12

Bodies, shapes and cut pieces are combined by adding P; a motion x -> R x + p takes P to G P G^T, G = [[R, p], [0, 1]].
A mass distribution is possible exactly if T about the centre of mass is positive semidefinite, which is A1 + A2 >= A3.
All functions accept leading axes: (..., 4, 4).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array


def second_moment(inertia: Array) -> Array:
    """Compute T = tr(J)/2 - J of an inertia tensor J about the same point, (..., 3, 3) [kg m2]."""
    return np.asarray(0.5 * np.trace(inertia, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - inertia)


def inertia_tensor(T: Array) -> Array:
    """Compute J = tr(T) - T of second moments T about the same point, (..., 3, 3) [kg m2]."""
    return np.asarray(np.trace(T, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - T)


def pseudo_inertia(mass: float, center: Array, inertia: Array) -> Array:
    """Compute P of a body of this mass [kg], centre of mass [m] and inertia about it [kg m2], (4, 4)."""
    return assemble_pseudo_inertia(
        np.array(mass), mass * center, second_moment(inertia) + mass * np.outer(center, center)
    )


def assemble_pseudo_inertia(mass: Array, first: Array, second: Array) -> Array:
    """Assemble P from its blocks: sum m (...), sum m x (..., 3) and sum m x x^T (..., 3, 3)."""
    P = np.empty((*np.shape(mass), 4, 4))
    P[..., :3, :3] = second
    P[..., :3, 3] = P[..., 3, :3] = first
    P[..., 3, 3] = mass
    return P


def split_pseudo_inertia(P: Array) -> tuple[float, Array, Array]:
    """Return mass [kg], centre of mass (3,) [m] and inertia about it (3, 3) [kg m2] of P with mass > 0."""
    mass = float(P[3, 3])
    center = P[:3, 3] / mass
    return mass, center, inertia_tensor(P[:3, :3] - mass * np.outer(center, center))
