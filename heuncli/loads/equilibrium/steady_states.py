"""Decide whether a scene can rest at all, where what turns or shifts steadily rests in its own frame; whether stably.

What is attached to a driven body turns with it. Loads that do not turn with it, such as weight across the axis, or
parts that closed chains move against the frame, keep it from resting. So the pose is checked again after the drives
have moved on.

Stability follows from the slowest or growing small motions:

    x'' + C x' + K x = 0,     x ~ e^(s t)

A pose is stable if no s has a growing part. The motions are those of `heun modes` (linearisation), and the same
decision tells which are indifferent (motion/linearisation/indifference.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import Coordinates, evaluate_at_rest, find_driven_rotations, set_to_rest
from heuncli.loads.equilibrium.pose import Pose, make_no_rest_problem
from heuncli.loads.equilibrium.rest_law import RestLaw
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.linearisation.indifference import Indifference, reduce_indifference
from heuncli.motion.linearisation.linearise import LinearisedEquations
from heuncli.motion.linearisation.oscillations import find_modes, find_nilpotent_shapes, find_stiffnesses
from heuncli.motion.linearisation.reduced_equations import reduce_equations
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Mask
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.shapes.rotations import quaternion_from_matrix, quaternion_product, rotation_matrix_about

# Steady states

SAMPLE_TIMES = (0.0, 1e-3, 0.0317, 0.618, 1.0, 2.718, 14.14, 99.7)  # s; a rate equal at all of them is constant
HINT = "does weight act across the axis, or a spring to the ground? run a motion"
PHASES = (0.37, 1.13, 2.71)  # motion of the drives until the next check: rad, or relative to the size


def require_constant(mechanism: Mechanism) -> None:
    """Raise SolveError [no-rest-pose] where loads, or the rates of drives, depend on time."""
    problems = [
        make_no_rest_problem(f"{load.path} depends on t", "give its value at rest, or run a motion with dampers")
        for load in mechanism.loads
        if any(value.time_dependent for value in load.values)
    ]
    for law in mechanism.laws:
        if not has_constant_rate(law.value):
            hint = "use a constant, or a constant rate: no equilibrium exists relative to an accelerating drive"
            problems.append(make_no_rest_problem(f"{law.path} does not have a constant rate", hint))
    if problems:
        raise SolveError(*problems)


def has_constant_rate(value: Expression) -> bool:
    """Return whether a drive's value grows at a constant rate."""
    if not value.time_dependent:
        return True
    if value.switches or value.tables:
        return False
    rates, seconds = np.array([value.derivatives(t)[1:] for t in SAMPLE_TIMES]).T
    size = float(np.abs(rates).max())
    return bool(np.ptp(rates) <= tolerances.SAME_VALUE * size and np.abs(seconds).max() <= tolerances.SAME_VALUE * size)


def find_moving_drives(mechanism: Mechanism) -> dict[str, float]:
    """Return the rates of the drives that move, by their path in the spec [rad/s or m/s]."""
    rates = {law.path: law.value.derivatives(0.0)[1] for law in mechanism.laws if law.value.time_dependent}
    return {path: rate for path, rate in rates.items() if rate != 0.0}


def require_common_motion(evaluator: Evaluator, coordinates: Coordinates, pose: Pose) -> None:
    """Raise SolveError [no-rest-pose] where closed chains move parts against what drives turn or shift."""
    rates = find_moving_drives(evaluator.layout.mechanism)
    if not rates:
        return
    resting_state = set_to_rest(evaluator, pose.t, pose.state[None, :], pose.holding)[0]
    change = np.abs(pose.state - resting_state)[coordinates.rates] * coordinates.weights
    largest = max(abs(rate) for rate in rates.values()) / max(1.0, evaluator.size)
    if change.max(initial=0.0) > tolerances.STEADY * largest:
        name, _ = coordinates.find_owner(int(np.argmax(change)))
        drives = " and ".join(rates)
        hint = "equilibrium needs drives at rest, or drives that move all connected bodies as one; run a motion"
        raise SolveError(make_no_rest_problem(f"{drives} {'keeps' if len(rates) == 1 else 'keep'} {name} moving", hint))


def require_steady(evaluator: Evaluator, coordinates: Coordinates, pose: Pose, law: RestLaw) -> None:
    """Raise SolveError [no-rest-pose] where a pose does not stay at rest in the frame of the moving drives."""
    rates = find_moving_drives(evaluator.layout.mechanism)
    if not rates:
        return
    require_common_motion(evaluator, coordinates, pose)
    fastest = max(abs(rate) for rate in rates.values())
    terms = coordinates.acceleration_terms(
        evaluate_at_rest(evaluator, pose.t, pose.state[None, :], pose.holding, causes=True)
    )
    allowed = law.noise + tolerances.STEADY * (np.abs(law.inverse) @ (np.abs(law.T_inverse) @ terms))
    drives = " and ".join(rates)
    for phase in PHASES:
        t = pose.t + phase / fastest
        later = evaluate_at_rest(evaluator, t, rotate_state(evaluator.layout, pose, t)[None, :], pose.holding)
        remaining = np.abs(law.project(coordinates.accelerations(later)[0])) - allowed
        if (remaining > 0.0).any():
            worst = int(np.argmax(np.abs(law.T @ law.V[:, int(np.argmax(remaining))])))
            message = f"{coordinates.find_owner(worst)[0]} does not stay at rest in the frame that {drives} moves"
            raise SolveError(make_no_rest_problem(f"{message}: loads do not move with that frame", HINT))
        place = find_changed_body(pose.evaluation, later, evaluator.size)
        if place >= 0:
            layout = evaluator.layout
            name = layout.mechanism.bodies[layout.spanning.links[place].body].name
            message = f"the load of bodies.{name} changes as {drives} moves: loads do not move with that frame"
            raise SolveError(make_no_rest_problem(message, HINT))


def find_changed_body(earlier: Evaluation, later: Evaluation, size: float) -> int:
    """Return a body whose joint carries another load than before, as seen from the body; -1 if none does."""
    force, moment = (
        [
            np.einsum("nji,nj->ni", evaluation.bodies["R"][0], evaluation.bodies[name][0])
            for evaluation in (earlier, later)
        ]
        for name in ("joint_force", "joint_moment")
    )
    largest = max(float(np.abs(force).max()), float(np.abs(moment).max()) / size)
    change = np.maximum(np.abs(force[1] - force[0]), np.abs(moment[1] - moment[0]) / size).max(axis=1)
    index = int(np.argmax(change))
    return index if change[index] > tolerances.STEADY * largest else -1


def rotate_state(layout: Layout, pose: Pose, t: float) -> Array:
    """Return the state at a later instant at which everything keeps its pose relative to what drives turn,
    (n_state,).
    """
    state, R = pose.state.copy(), pose.evaluation.bodies["R"][0]
    rotations = np.repeat(np.eye(3)[None], len(R) + 1, axis=0)  # of each body since then; the last is the ground
    for place, body in enumerate(layout.bodies):
        parent = int(body["parent"])
        rotations[place] = rotations[parent]
        for k, axis in find_driven_rotations(layout, place):
            value = find_drive_value(layout, k)
            s = axis if parent < 0 else R[parent] @ axis
            rotations[place] = rotations[place] @ rotation_matrix_about(s, value.value(t) - value.value(pose.t))
        if body["ball"]:
            attitude = slice(int(body["attitude_at"]), int(body["attitude_at"]) + 4)
            state[attitude] = quaternion_product(quaternion_from_matrix(rotations[place]), state[attitude])
    return state


def find_drive_value(layout: Layout, freedom: int) -> Expression:
    """Return the drive's value for a freedom of the tree."""
    drive = layout.mechanism.joints[layout.freedoms[freedom].joint].drive
    assert drive is not None
    return drive.value


# Stability


@record
class NamedMotion:
    """A motion: the names of what moves in it, and by how much relative to the first, in rad or m."""

    names: tuple[str, ...]
    shares: tuple[float, ...]
    units: tuple[str, ...]


@record
class Stability:
    """The stability of a rest pose.

    growth: growth rate of what grows fastest [1/s], 0 where nothing does
    grows: name of what moves in it
    least: smallest eigenvalue stiffness/inertia of what is held, or pushed off [1/s^2]
    slowest: name of what moves in it, "" where nothing does
    frequency: of the slowest small oscillation [Hz], 0 where nothing oscillates
    motions: number of free motions
    indifferent: motions that nothing holds
    flat: motions that nothing holds to first order; bending holds them, or pushes them off
    edge: motions that push what nothing holds when displaced; stiffness may be lost there where forces follow the
    motion
    """

    growth: float
    grows: str
    least: float
    slowest: str
    frequency: float
    motions: int
    indifferent: tuple[NamedMotion, ...]
    flat: tuple[NamedMotion, ...]
    edge: tuple[NamedMotion, ...]


def find_stability(
    scene: PreparedScene,
    coordinates: Coordinates,
    equations: LinearisedEquations,
    evaluation: Evaluation,
    indifference: Indifference,
    is_bending: Mask,
) -> Stability:
    """Find the stability of a rest pose; is_bending (g,): which motions without stiffness bending holds, or pushes."""
    system = reduce_equations(scene, equations, evaluation)
    indifferent = reduce_indifference(system, indifference)
    modes = [mode for mode in find_modes(system, indifferent) if mode.kind != "free"]
    fastest_growing = max(modes, key=lambda mode: mode.growth, default=None)
    swings = [mode.frequency for mode in modes if mode.frequency > 0.0]
    values, shapes = find_stiffnesses(system, indifferent)
    softest = int(np.argmin(values)) if len(values) else -1
    unstable = fastest_growing is not None and fastest_growing.growth > 0.0
    free_motions, is_massive = indifference.free_motions, moves_mass(coordinates, indifference.free_motions, equations)
    return Stability(
        growth=fastest_growing.growth if fastest_growing is not None and unstable else 0.0,
        grows=name_largest(coordinates, fastest_growing.shape) if fastest_growing is not None and unstable else "",
        least=float(values[softest]) if softest >= 0 else 0.0,
        slowest=name_largest(coordinates, system.tangent @ shapes[:, softest]) if softest >= 0 else "",
        frequency=min(swings, default=0.0),
        motions=system.count,
        indifferent=name_motions(coordinates, free_motions[:, is_massive & ~is_bending]),
        flat=name_motions(coordinates, free_motions[:, is_massive & is_bending]),
        edge=name_motions(
            coordinates, system.tangent @ find_nilpotent_shapes(indifferent)[:, indifferent.right_null.shape[1] :]
        ),
    )


def moves_mass(coordinates: Coordinates, shapes: Array, equations: LinearisedEquations) -> Mask:
    """Return which displacements (n, g) move mass; massless spins do not."""
    inertia = np.einsum("ng,nm,mg->g", shapes, equations.mass, shapes)
    largest = float(np.linalg.norm(equations.tangent.T @ equations.mass @ equations.tangent))
    size = np.sum((coordinates.weights[:, None] * shapes) ** 2, axis=0)
    return np.asarray(inertia > tolerances.NO_INERTIA * largest * size)


def name_motions(coordinates: Coordinates, shapes: Array) -> tuple[NamedMotion, ...]:
    """Name displacements (n, g), without repetitions."""
    named = {motion.names + motion.shares: motion for motion in (name_motion(coordinates, x) for x in shapes.T)}
    return tuple(named.values())


def name_motion(coordinates: Coordinates, shape: Array) -> NamedMotion:
    """Name the joints and bodies that move in a displacement (n,), the first by 1; for ball joints the largest
    rotation.
    """
    size = np.abs(shape) * coordinates.weights
    parts: dict[str, tuple[float, str]] = {}
    for k in np.flatnonzero(size > tolerances.REMAINING_RATE * size.max(initial=0.0)).tolist():
        name, turns = coordinates.find_owner(k)
        if name not in parts or abs(shape[k]) > abs(parts[name][0]):
            parts[name] = float(shape[k]), "rad" if turns else "m"
    first = next(iter(parts.values()))[0] if parts else 1.0
    shares = tuple(share / first for share, _ in parts.values())
    return NamedMotion(tuple(parts), shares, tuple(unit for _, unit in parts.values()))


def name_largest(coordinates: Coordinates, shape: Array) -> str:
    """Return the name of what moves most in a small motion."""
    return coordinates.find_owner(int(np.argmax(np.abs(shape) * coordinates.weights)))[0]
