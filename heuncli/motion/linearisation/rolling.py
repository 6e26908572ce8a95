"""The linear equations about a steady motion in which wheels roll: more poses are reached than speeds are free.

    dq = T x,   du = V z + S x                  T (n, p): what rows that hold poses admit; V (n, f): what all rows do
    x' = A11 x + A12 z,   z' = A21 x + A22 z    p + f numbers of state
As in reduced_equations.py, seen from frames that turn with what bodies hang on; at rest S = 0, and the poses that no
speed leads to stay as they are: then the equations are those of V alone. A bicycle that runs straight on has these.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.linearisation.linearise import Linearised, Posed
from heuncli.motion.linearisation.oscillations import Mode, eigenvalues, motion_of, norm, null_space
from heuncli.motion.linearisation.reduced_equations import frames, rates_of_balls
from heuncli.motion.linearisation.steady_motion import PHASES, Looked, carried_on, equations, fastest
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


@record
class RollingEquations:
    """The equations of p poses and f speeds; T (n, p), V (n, f) orthonormal in the mass matrix; pushed (f,)."""

    T: Array
    V: Array
    A: Array
    pushed: Array


def rolls_on(here: Looked) -> bool:
    """Whether wheels roll in the state that is looked at, so that there are more poses than speeds."""
    return here.found.posed is not None and fastest(here) > tolerances.AT_REST


def rolling_equations(
    layout: Layout, found: Linearised, posed: Posed, T: Array, V: Array, S: Array
) -> RollingEquations:
    """The equations on poses T, whose rates are S, and speeds V, all orthonormal in the mass matrix."""
    spin, frame = frames(layout, found)
    P, Q = T.T @ found.mass, V.T @ found.mass
    slow = found.by_rate - frame
    A11, A12 = P @ (S + (spin - frame) @ T), P @ V
    A21 = Q @ (found.by_place @ T + slow @ S) - Q @ S @ A11
    A22 = Q @ slow @ V - Q @ S @ A12
    pushed = Q @ (found.accelerations - frame @ rates_of_balls(layout, found))
    return RollingEquations(T, V, np.block([[A11, A12], [A21, A22]]), pushed)


def orthonormal(found: Linearised, columns: Array) -> Array:
    """What makes of displacements such as are orthonormal in the mass matrix, (f, f)."""
    try:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(columns.T @ found.mass @ columns)).T)
    except np.linalg.LinAlgError:
        message = "some motions have no inertia: they are not told from none"
        raise SolveError(
            Problem("mass-ratios", message, hint="give every part a mass, and wheels an inertia")
        ) from None


def steady(here: Looked) -> RollingEquations:
    """The equations of a steady motion. Raises SolveError [not-at-rest] where it is none."""
    posed = here.found.posed
    assert posed is not None
    to_T, to_V = orthonormal(here.found, posed.tangent), orthonormal(here.found, here.found.tangent)
    T, V, S = posed.tangent @ to_T, here.found.tangent @ to_V, posed.drift @ to_T
    own = rolling_equations(here.layout, here.found, posed, T, V, S)
    if norm(own.pushed[:, None]) > tolerances.FREELY_PUSHED * here.system.loads + tolerances.OFF_BALANCE * norm(own.A):
        raise unsteady("it is pushed")
    for phase in PHASES:
        dt = phase / fastest(here)
        y, turn = carried_on(here, dt)
        found, _ = equations(here.runner, here.t + dt, y, here.holding)
        again = found.posed
        if again is None or np.abs(found.state - y).max(initial=0.0) > tolerances.GOES_ON:
            raise unsteady("its wheels do not go on as they do")
        later = rolling_equations(here.layout, found, again, turn @ T, turn @ V, turn @ S)
        if np.abs(later.A - own.A).max(initial=0.0) > tolerances.GOES_ON * norm(own.A):
            raise unsteady("loads change as it goes on")
    return own


def unsteady(why: str) -> SolveError:
    """The error of a motion that is not steady."""
    hint = "modes of wheels that roll are those of a straight run, or of rest: give velocities with which it goes on so"
    return SolveError(Problem("not-at-rest", f"the motion is not steady: {why}", hint=hint))


def rolling_modes(here: Looked) -> list[Mode]:
    """All motions about a steady one: what is free, one a direction in which nothing happens; then the others."""
    own = steady(here)
    A, p = own.A, own.T.shape[1]
    scale = norm(A) or 1.0
    rounding = tolerances.EIGENVALUE * len(A) * scale
    small = tolerances.RANK * scale
    free, rest = null_space(A, small)
    kept = rest
    while kept.shape[1]:  # what A takes to nothing sooner or later
        nothing, left = null_space(kept.T @ A @ kept, small)
        if not nothing.shape[1]:
            break
        kept = kept @ left
    mass = here.found.mass
    modes = [motion_of(own.T @ x[:p], mass, 0j, float(np.sqrt(rounding) * scale**0.5), True) for x in free.T]
    values, _, condition = eigenvalues(kept.T @ A @ kept)
    for value, error in zip(values, condition * rounding, strict=True):
        if value.imag >= 0.0 or abs(value.imag) <= error:  # the conjugate says the same
            found = complex(value.real, value.imag if abs(value.imag) > error else 0.0)
            modes.append(motion_of(own.T @ vector_of(A, complex(value))[:p], mass, found, float(error), False))
    return sorted(modes, key=lambda mode: (mode.kind != "free", mode.frequency, abs(mode.growth)))


def vector_of(A: Array, value: complex) -> Array:
    """The eigenvector of A for an eigenvalue."""
    return np.asarray(np.linalg.svd(A - value * np.eye(len(A)))[2][-1].conj())
