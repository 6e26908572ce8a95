"""Decide whether a motion is steady: at rest, or at rest in a frame that its drives turn.

The linear equations then have constant coefficients. At rest nothing moves and nothing is pushed. Where something moves
steadily (what is driven, and what spins freely), the same must hold after the motion has continued for a while, as seen
from the moving bodies: a weight across a turning shaft turns in the shaft's frame, and nothing comes to rest there.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.indifference import IndifferentMotions, find_indifference, reduce_indifference
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.motion.linearisation.oscillations import complete_basis, spectral_norm
from heuncli.motion.linearisation.reduced_equations import (
    ReducedEquations,
    equations_on_basis,
    list_balls,
    reduce_equations,
)
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector

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


def distance_from_rest(linear_state: LinearisedState) -> float:
    """Return the distance to the rest pose by the linear equations: the largest rotation, or shift relative to the
    size.

    Infinite where a force acts on what nothing holds.
    """
    return (
        rest_displacement(linear_state, linear_state.system.remaining_acceleration)
        if linear_state.system.count
        else 0.0
    )


def rest_displacement(linear_state: LinearisedState, push: Array) -> float:
    """Return how far a push (f,) moves the rest pose by the linear equations: the largest rotation, or relative shift.

    Infinite where it acts on what nothing holds.
    """
    system = linear_state.system
    K = system.stiffness
    _, rest = complete_basis(linear_state.indifferent.right_null)
    x = rest @ solve_least_squares(K @ rest, push)
    if spectral_norm((push - K @ x)[:, None]) > tolerances.FREELY_PUSHED * system.load_scale:
        return np.inf
    return float(np.abs(linear_state.weights * (system.tangent @ x)).max(initial=0.0))


def continues_unchanged(linear_state: LinearisedState) -> bool:
    """Return whether a steady motion has the same linear equations later, as seen from the moving bodies.

    A push may change by a share of the loads, or by what moves the rest pose by no more than the tolerance of a start:
    without any loads, every rounding would exceed a share of them.
    """
    system = linear_state.system
    size = max(spectral_norm(system.stiffness), system.stiffness_scale)
    rate = size**0.5
    parts = ((system.A11, rate), (system.A21, size), (system.A22, rate), (np.eye(system.count), 1.0))
    for phase in PHASES:
        dt = phase / find_fastest_rate(linear_state)
        y, turn = continue_motion(linear_state, dt)
        linear, evaluation = linearise_and_evaluate(linear_state.runner, linear_state.t + dt, y, linear_state.holding)
        if np.abs(linear.state - y).max(initial=0.0) > tolerances.STEADY_CHANGE:
            return False  # it did not close
        T = turn @ system.tangent
        later = equations_on_basis(linear_state.layout, linear, evaluation, T, turn @ system.drift)
        push = later.remaining_acceleration - system.remaining_acceleration
        is_same_push = np.abs(push).max(initial=0.0) <= tolerances.STEADY_CHANGE * system.load_scale
        if not is_same_push and not rest_displacement(linear_state, push) <= tolerances.OFF_BALANCE:
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
