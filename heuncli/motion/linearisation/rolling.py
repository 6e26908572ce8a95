"""The linear equations about a steady motion in which wheels roll, so that there are more poses than free speeds.

    dq = T x,   du = V z + S x                  T (n, p): what pose constraints admit; V (n, f): what all rows admit
    x' = A11 x + A12 z,   z' = A21 x + A22 z    p + f numbers of state

As in reduced_equations.py, seen from frames that turn with the parents. At rest S = 0, and the poses that no speed
leads to stay as they are: then the equations are those of V alone. A bicycle that runs straight on has these.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import split_null_space
from heuncli.base.records import record
from heuncli.motion.linearisation.linearise import LinearisedEquations, PoseDirections
from heuncli.motion.linearisation.oscillations import (
    Mode,
    classify_mode,
    eigenvalues_with_condition,
    spectral_norm,
)
from heuncli.motion.linearisation.reduced_equations import ball_rates, ball_rotations
from heuncli.motion.linearisation.steady_motion import (
    PHASES,
    LinearisedState,
    continue_motion,
    find_fastest_rate,
    linearise_and_evaluate,
)
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


@record
class RollingEquations:
    """The equations of p poses and f speeds.

    T (n, p), V (n, f): orthonormal in the mass matrix
    remaining_acceleration (f,): accelerations left in the state
    """

    T: Array
    V: Array
    A: Array
    remaining_acceleration: Array


def has_rolling(linear_state: LinearisedState) -> bool:
    """Return whether wheels roll in the state, so that there are more poses than speeds."""
    return linear_state.linear.pose_directions is not None and find_fastest_rate(linear_state) > tolerances.AT_REST


def make_rolling_equations(
    layout: Layout, linear: LinearisedEquations, pose_directions: PoseDirections, T: Array, V: Array, S: Array
) -> RollingEquations:
    """Make the equations on poses T, whose rates are S, and speeds V, all orthonormal in the mass matrix."""
    spin, frame = ball_rotations(layout, linear)
    P, Q = T.T @ linear.mass, V.T @ linear.mass
    slow = linear.by_rate - frame
    A11, A12 = P @ (S + (spin - frame) @ T), P @ V
    A21 = Q @ (linear.by_place @ T + slow @ S) - Q @ S @ A11
    A22 = Q @ slow @ V - Q @ S @ A12
    remaining_acceleration = Q @ (linear.accelerations - frame @ ball_rates(layout, linear))
    return RollingEquations(T, V, np.block([[A11, A12], [A21, A22]]), remaining_acceleration)


def orthonormaliser(linear: LinearisedEquations, columns: Array) -> Array:
    """Return the matrix (f, f) that makes displacements orthonormal in the mass matrix."""
    try:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(columns.T @ linear.mass @ columns)).T)
    except np.linalg.LinAlgError:
        message = "some motions have no inertia and cannot be distinguished from no motion"
        raise SolveError(
            Problem("mass-ratios", message, hint="give every body a mass, and wheels an inertia")
        ) from None


def make_steady_equations(linear_state: LinearisedState) -> RollingEquations:
    """Make the equations of a steady motion. Raises SolveError [not-at-rest] if it is not steady."""
    pose_directions = linear_state.linear.pose_directions
    assert pose_directions is not None
    to_T, to_V = (
        orthonormaliser(linear_state.linear, pose_directions.tangent),
        orthonormaliser(linear_state.linear, linear_state.linear.tangent),
    )
    T, V, S = pose_directions.tangent @ to_T, linear_state.linear.tangent @ to_V, pose_directions.drift @ to_T
    rolling = make_rolling_equations(linear_state.layout, linear_state.linear, pose_directions, T, V, S)
    if spectral_norm(
        rolling.remaining_acceleration[:, None]
    ) > tolerances.FREELY_PUSHED * linear_state.system.load_scale + tolerances.OFF_BALANCE * spectral_norm(rolling.A):
        raise unsteady_error("a load accelerates it")
    for phase in PHASES:
        dt = phase / find_fastest_rate(linear_state)
        y, turn = continue_motion(linear_state, dt)
        linear, _ = linearise_and_evaluate(linear_state.runner, linear_state.t + dt, y, linear_state.holding)
        later_directions = linear.pose_directions
        if later_directions is None or np.abs(linear.state - y).max(initial=0.0) > tolerances.STEADY_CHANGE:
            raise unsteady_error("its wheels do not keep rolling in the same way")
        later = make_rolling_equations(linear_state.layout, linear, later_directions, turn @ T, turn @ V, turn @ S)
        if np.abs(later.A - rolling.A).max(initial=0.0) > tolerances.STEADY_CHANGE * spectral_norm(rolling.A):
            raise unsteady_error("loads change along the motion")
    return rolling


def unsteady_error(why: str) -> SolveError:
    """Make the error of a motion that is not steady."""
    hint = "modes with rolling wheels need steady straight rolling, or rest: give velocities of such a motion"
    return SolveError(Problem("not-at-rest", f"the motion is not steady: {why}", hint=hint))


def find_rolling_modes(linear_state: LinearisedState) -> list[Mode]:
    """Find all motions about a steady one: free ones, one for each direction without effect, then the others."""
    rolling = make_steady_equations(linear_state)
    A, p = rolling.A, rolling.T.shape[1]
    scale = spectral_norm(A) or 1.0
    rounding = tolerances.EIGENVALUE * len(A) * scale
    small = tolerances.RANK * scale
    free, rest = split_null_space(A, small)
    remaining = rest
    while remaining.shape[1]:  # remove the generalised null space of A
        null_part, rest_part = split_null_space(remaining.T @ A @ remaining, small)
        if not null_part.shape[1]:
            break
        remaining = remaining @ rest_part
    mass = linear_state.linear.mass
    modes = [classify_mode(rolling.T @ x[:p], mass, 0j, float(np.sqrt(rounding) * scale**0.5), True) for x in free.T]
    values, _, condition = eigenvalues_with_condition(remaining.T @ A @ remaining)
    for value, error in zip(values, condition * rounding, strict=True):
        if value.imag >= 0.0 or abs(value.imag) <= error:  # the conjugate gives the same motion
            eigenvalue = complex(value.real, value.imag if abs(value.imag) > error else 0.0)
            modes.append(
                classify_mode(
                    rolling.T @ find_eigenvector(A, complex(value))[:p], mass, eigenvalue, float(error), False
                )
            )
    return sorted(modes, key=lambda mode: (mode.kind != "free", mode.frequency, abs(mode.growth)))


def find_eigenvector(A: Array, value: complex) -> Array:
    """Return the eigenvector of A for an eigenvalue."""
    return np.asarray(np.linalg.svd(A - value * np.eye(len(A)))[2][-1].conj())
