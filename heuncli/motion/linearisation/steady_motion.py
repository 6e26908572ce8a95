"""Decide whether a motion is steady: at rest, or at rest in a frame that its drives turn.

The linear equations then have constant coefficients. At rest nothing moves and nothing is pushed. Where something moves
steadily (what is driven, and what spins freely), the same must hold after the motion has continued for a while, as seen
from the moving bodies: a weight across a turning shaft turns in the shaft's frame, and nothing comes to rest there.

Where wheels roll, there are more poses than free speeds, and the linear equations are:

    dq = T x,   du = V z + S x                  T (n, p): what pose constraints admit; V (n, f): what all rows admit
    x' = A11 x + A12 z,   z' = A21 x + A22 z    p + f numbers of state

As in reduced_equations.py, seen from frames that turn with the parents. At rest S = 0, and the poses that no speed
leads to stay as they are: then the equations are those of V alone. A bicycle that runs straight on has these.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import solve_least_squares, split_null_space
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.indifference import IndifferentMotions, find_indifference, reduce_indifference
from heuncli.motion.linearisation.linearise import LinearisedEquations, PoseDirections, linearise
from heuncli.motion.linearisation.oscillations import (
    Mode,
    classify_mode,
    complete_basis,
    find_eigenvalues_with_condition,
    find_spectral_norm,
)
from heuncli.motion.linearisation.reduced_equations import (
    ReducedEquations,
    find_ball_rates,
    find_ball_rotations,
    list_balls,
    project_equations,
    reduce_equations,
)
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector

# Steady motion

PHASES = (0.7, 2.0, 4.1)  # [rad] of the fastest rotation, after which a steady motion is checked again


@record
class LinearisedState:
    """A scene in one state, with its linear equations, full and reduced, and the loads there."""

    scene: PreparedScene
    runner: Runner
    t: float
    holding: Array
    linear: LinearisedEquations
    evaluation: Evaluation
    system: ReducedEquations
    indifferent: IndifferentMotions
    reach: float  # how far rounding moves the rest pose [rad, or relative to the size]

    @property
    def layout(self) -> Layout:
        """The scene's layout."""
        return self.scene.layout

    @property
    def weights(self) -> Array:
        """Weights of the undriven freedoms: 1 for rotations, 1 / size for shifts."""
        place = rate_indices(self.layout)
        return np.asarray(self.layout.weights[place[place >= 0]])


def linearise_scene(scene: PreparedScene, runner: Runner, t: float, state: Array, holding: Array) -> LinearisedState:
    """Linearise a scene in a state. Raises SolveError [no-modes] where its laws have no slope."""
    linear, evaluation = linearise_and_evaluate(runner, t, state, holding)
    if not (np.isfinite(linear.by_place).all() and np.isfinite(linear.by_rate).all()):
        message = "a load has no derivative there (a root at 0, the angle of a point on the axis)"
        hint = "start slightly away from it, or smooth the load: sqrt(x**2 + 1e-6) for abs(x)"
        raise SolveError(Problem("no-modes", f"{message}: even small oscillations about it are not linear", hint=hint))
    system = reduce_equations(scene, linear, evaluation)
    null_motions = find_indifference(scene, t, holding, linear)
    return LinearisedState(
        scene,
        runner,
        t,
        holding,
        linear,
        evaluation,
        system,
        reduce_indifference(system, null_motions),
        null_motions.reach,
    )


def linearise_and_evaluate(
    evaluator: Evaluator, t: float, state: Array, holding: Array
) -> tuple[LinearisedEquations, Evaluation]:
    """Return the linear equations in a state, and the results there."""
    linear = linearise(evaluator.layout, t, state, holding)
    return linear, evaluator.evaluate(np.array([t]), linear.state[None, :], holding=holding)


def find_fastest_rate(linear_state: LinearisedState) -> float:
    """Return the fastest rotation of any body [rad/s], or speed of its centre relative to the scene's size."""
    turn, shift = (
        np.sqrt(np.sum(v**2, axis=1)).max(initial=0.0)
        for v in (linear_state.linear.omega, linear_state.linear.velocities)
    )
    return float(max(turn, shift / linear_state.layout.size))


def find_distance_from_rest(linear_state: LinearisedState) -> float:
    """Return the distance to the rest pose by the linear equations: the largest rotation, or shift relative to the
    size.

    Infinite where a force acts on what nothing holds.
    """
    return (
        find_rest_displacement(linear_state, linear_state.system.remaining_acceleration)
        if linear_state.system.count
        else 0.0
    )


def find_rest_displacement(linear_state: LinearisedState, push: Array) -> float:
    """Return how far a push (f,) moves the rest pose by the linear equations: the largest rotation, or relative shift.

    Infinite where it acts on what nothing holds.
    """
    system = linear_state.system
    K = system.stiffness
    _, rest = complete_basis(linear_state.indifferent.right_null)
    x = rest @ solve_least_squares(K @ rest, push)
    if find_spectral_norm((push - K @ x)[:, None]) > tolerances.FREELY_PUSHED * system.load_scale:
        return np.inf
    return float(np.abs(linear_state.weights * (system.tangent @ x)).max(initial=0.0))


def continues_unchanged(linear_state: LinearisedState) -> bool:
    """Return whether a steady motion has the same linear equations later, as seen from the moving bodies.

    A push may change by a share of the loads, or by what moves the rest pose by no more than the tolerance of a start:
    without any loads, every rounding would exceed a share of them.
    """
    system = linear_state.system
    size = max(find_spectral_norm(system.stiffness), system.stiffness_scale)
    rate = size**0.5
    parts = ((system.A11, rate), (system.A21, size), (system.A22, rate), (np.eye(system.count), 1.0))
    for phase in PHASES:
        dt = phase / find_fastest_rate(linear_state)
        y, turn = continue_motion(linear_state, dt)
        linear, evaluation = linearise_and_evaluate(linear_state.runner, linear_state.t + dt, y, linear_state.holding)
        if np.abs(linear.state - y).max(initial=0.0) > tolerances.STEADY_CHANGE:
            return False  # it did not close
        T = turn @ system.tangent
        later = project_equations(linear_state.layout, linear, evaluation, T, turn @ system.drift)
        push = later.remaining_acceleration - system.remaining_acceleration
        is_same_push = np.abs(push).max(initial=0.0) <= tolerances.STEADY_CHANGE * system.load_scale
        if not is_same_push and not find_rest_displacement(linear_state, push) <= tolerances.OFF_BALANCE:
            return False
        later_parts = (later.A11, later.A21, later.A22, T.T @ linear.mass @ T)
        for (a, scale), b in zip(parts, later_parts, strict=True):
            if np.abs(a - b).max(initial=0.0) > tolerances.STEADY_CHANGE * scale:
                return False
    return True


def continue_motion(linear_state: LinearisedState, dt: float) -> tuple[Array, Array]:
    """Return the state a while later if its motion is steady, and the rotation of the freedoms' axes, (n, n).

    A body on a ball joint first spins in the frame of its parent, then turns with that.
    """
    layout, place = linear_state.layout, rate_indices(linear_state.layout)
    rates = linear_state.linear.state[place[place >= 0]]
    rotation, parent_rotation = np.eye(len(rates)), np.zeros(len(rates))
    for first, _, carrier in list_balls(layout, linear_state.linear):
        rotation[first : first + 3, first : first + 3] = rotation_from_vector(carrier * dt)
        parent_rotation[first : first + 3] = carrier * dt
    spun_state = displace(layout, linear_state.linear.state, rates * dt - parent_rotation)
    return displace(layout, spun_state, parent_rotation, rotation @ rates - rates), rotation


# Rolling


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
    spin, frame = find_ball_rotations(layout, linear)
    P, Q = T.T @ linear.mass, V.T @ linear.mass
    slow = linear.by_rate - frame
    A11, A12 = P @ (S + (spin - frame) @ T), P @ V
    A21 = Q @ (linear.by_place @ T + slow @ S) - Q @ S @ A11
    A22 = Q @ slow @ V - Q @ S @ A12
    remaining_acceleration = Q @ (linear.accelerations - frame @ find_ball_rates(layout, linear))
    return RollingEquations(T, V, np.block([[A11, A12], [A21, A22]]), remaining_acceleration)


def make_orthonormaliser(linear: LinearisedEquations, columns: Array) -> Array:
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
        make_orthonormaliser(linear_state.linear, pose_directions.tangent),
        make_orthonormaliser(linear_state.linear, linear_state.linear.tangent),
    )
    T, V, S = pose_directions.tangent @ to_T, linear_state.linear.tangent @ to_V, pose_directions.drift @ to_T
    rolling = make_rolling_equations(linear_state.layout, linear_state.linear, pose_directions, T, V, S)
    if find_spectral_norm(
        rolling.remaining_acceleration[:, None]
    ) > tolerances.FREELY_PUSHED * linear_state.system.load_scale + tolerances.OFF_BALANCE * find_spectral_norm(
        rolling.A
    ):
        raise make_unsteady_error("a load accelerates it")
    for phase in PHASES:
        dt = phase / find_fastest_rate(linear_state)
        y, turn = continue_motion(linear_state, dt)
        linear, _ = linearise_and_evaluate(linear_state.runner, linear_state.t + dt, y, linear_state.holding)
        later_directions = linear.pose_directions
        if later_directions is None or np.abs(linear.state - y).max(initial=0.0) > tolerances.STEADY_CHANGE:
            raise make_unsteady_error("its wheels do not keep rolling in the same way")
        later = make_rolling_equations(linear_state.layout, linear, later_directions, turn @ T, turn @ V, turn @ S)
        if np.abs(later.A - rolling.A).max(initial=0.0) > tolerances.STEADY_CHANGE * find_spectral_norm(rolling.A):
            raise make_unsteady_error("loads change along the motion")
    return rolling


def make_unsteady_error(why: str) -> SolveError:
    """Make the error of a motion that is not steady."""
    hint = "modes with rolling wheels need steady straight rolling, or rest: give velocities of such a motion"
    return SolveError(Problem("not-at-rest", f"the motion is not steady: {why}", hint=hint))


def find_rolling_modes(linear_state: LinearisedState) -> list[Mode]:
    """Find all motions about a steady one: free ones, one for each direction without effect, then the others."""
    rolling = make_steady_equations(linear_state)
    A, p = rolling.A, rolling.T.shape[1]
    scale = find_spectral_norm(A) or 1.0
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
    values, _, condition = find_eigenvalues_with_condition(remaining.T @ A @ remaining)
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
