"""`--state-space`: A, B, C, D of small motions about a state, for a controller.
    x = (dq, dq'),  x. = A x + B u,  y = C x + D u
The coordinates are those that no drive holds, and the driven ones whose acceleration is an input. The drives are
removed and their efforts applied as a constant load, so that the scene without drives moves as the one with them;
prescribed coordinates are then held, or moved, by a change dQ of that load:
    dq.. = a + n dQ,   a = A_q dq + A_u dq',   dq.._d = w:   dq.._f = a_f + n_fd n_dd^-1 (w - a_d)
An input force is a change of its value: dq.. = n k, k of a value of 1. A rate v = row q' that is an output also changes
with dq if something moves: outputs.py.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinates import CoordinateChoice, choose_coordinates
from heuncli.analyses.lagrange.equations import compute_forces_by_cause, invert_inertia, make_partials
from heuncli.analyses.lagrange.freed_scene import FreedScene, Instant, free_drives
from heuncli.analyses.lagrange.outputs import PROBLEM_CODE, compute_outputs, compute_rate_slopes
from heuncli.analyses.lagrange.results import StateSpace, get_units
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS, RATES
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.base.spelling import suggest
from heuncli.loads.kinetostatics.actions import collect_applied_loads
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.motion.linearisation.smoothness import iter_without_derivative
from heuncli.multibody.mechanism.loads import JointLoad, Load, PointLoad
from heuncli.multibody.tree.layout import rate_indices
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression

UNIT_VALUE = Expression.from_number(1.0)
NO_INPUTS_HINT = "this model has no input: forces, couples, torques, actuators and drives are inputs; bushings are not"


@record
class StateSpaceInputs:
    """The inputs: forces by name, and driven coordinates by name."""

    forces: tuple[str, ...]
    drives: tuple[str, ...]


def compute_state_space(
    instant: Instant, choice: CoordinateChoice, Q: Array, requested_inputs: Sequence[str], outputs: Sequence[str]
) -> StateSpace:
    """Return the linear equations about an instant.

    choice: its coordinates
    Q: what drives exert there

    Raises SolveError [no-state-space] if the equations are not those of coordinates.
    """
    require_given_friction(instant)
    require_driven_chosen(instant, choice)
    inputs = select_inputs(instant, choice, requested_inputs)
    scene = free_drives(instant.setup.scene, dict(zip(choice.names, Q, strict=True)))
    state = recover_state(scene, instant)
    linear_equations = linearise(scene.layout, instant.t, state, instant.holding)
    require_derivatives(scene, instant, linear_equations)
    freed_choice = choose_coordinates(scene.scene, linear_equations, scene.driven_coordinates, choice.names)
    is_moving = bool(np.abs(state[find_rate_indices(scene)]).max(initial=0.0) > 0.0)
    require_tree_coordinates(scene, freed_choice, linear_equations, is_moving)
    free = [i for i, name in enumerate(freed_choice.names) if not freed_choice.is_driven[i] or name in inputs.drives]
    slopes = compute_acceleration_slopes(scene, instant, freed_choice, linear_equations, inputs)
    n, m = len(free), slopes.by_input.shape[1]
    free_block = np.ix_(free, free)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [slopes.by_place[free_block], slopes.by_rate[free_block]]])
    B = np.vstack([np.zeros((n, m)), slopes.by_input[free]])
    drift = compute_drift(linear_equations, freed_choice)
    rate_slopes = compute_rate_slopes(scene.layout, instant.t, instant.holding, linear_equations, freed_choice.S, drift)
    found_outputs = compute_outputs(rate_slopes, instant, freed_choice, free, (A[n:], B[n:]), outputs)
    names = tuple(freed_choice.names[i] for i in free)
    units_along = [get_units(name) for name in names]
    motion = (state[find_rate_indices(scene)], linear_equations.accelerations)
    offset = np.concatenate([(freed_choice.rows @ values)[free] for values in motion])
    return StateSpace(
        A=A, B=B, C=found_outputs.C, D=found_outputs.D,
        states=(*names, *(format_rate_name(name) for name in names)),
        inputs=(*inputs.forces, *(f"{name} acceleration" for name in inputs.drives)),
        outputs=found_outputs.names,
        units={
            "states": [*(unit.value for unit in units_along), *(unit.rate for unit in units_along)],
            "inputs": [
                *(get_load_unit(instant, name) for name in inputs.forces),
                *(get_units(name).acceleration for name in inputs.drives),
            ],
            "outputs": found_outputs.units,
        },
        offset=drop_rounding(offset, instant.setup.scene.layout.size),
    )  # fmt: skip


class AccelerationSlopes(NamedTuple):
    """Derivatives of the accelerations of f coordinates by displacements and rates (f, f), and by m inputs (f, m)."""

    by_place: Array
    by_rate: Array
    by_input: Array


def compute_acceleration_slopes(
    scene: FreedScene,
    instant: Instant,
    choice: CoordinateChoice,
    linear_equations: LinearisedEquations,
    inputs: StateSpaceInputs,
) -> AccelerationSlopes:
    """Return the derivatives of the accelerations, with driven coordinates held or moved as the inputs prescribe."""
    driven = [i for i, is_driven in enumerate(choice.is_driven) if is_driven]
    eta = invert_inertia(choice.names, choice.S.T @ linear_equations.mass @ choice.S)
    drift = compute_drift(linear_equations, choice)
    by_place = choice.rows @ (linear_equations.by_place @ choice.S + linear_equations.by_rate @ drift)
    by_rate = choice.rows @ linear_equations.by_rate @ choice.S
    unit_forces = (compute_unit_force(scene, instant, choice, linear_equations, name) for name in inputs.forces)
    by_force = np.array([eta @ force for force in unit_forces]).reshape(len(inputs.forces), len(eta)).T
    driven_inputs = np.array([[float(choice.names[i] == name) for name in inputs.drives] for i in driven])
    driven_inputs = driven_inputs.reshape(len(driven), len(inputs.drives))
    hold = eta[:, driven] @ np.linalg.inv(eta[np.ix_(driven, driven)]) if driven else np.zeros((len(eta), 0))
    # accelerations of held coordinates are cancelled, prescribed ones are added
    remaining = np.eye(len(eta))
    remaining[:, driven] -= hold
    by_input = np.hstack([remaining @ by_force, hold @ driven_inputs])
    return AccelerationSlopes(remaining @ by_place, remaining @ by_rate, by_input)


def require_driven_chosen(instant: Instant, choice: CoordinateChoice) -> None:
    """Raise SolveError [no-state-space] if a driven coordinate, which is held or an input, is not among the chosen
    ones.
    """
    missing = [name for name in instant.freed_scene.driven_coordinates if name not in choice.names]
    if missing:
        message = f"{', '.join(missing)}: driven coordinates must be among those of the state space"
        raise SolveError(Problem(PROBLEM_CODE, message, hint=f"--coordinates {','.join(missing)},...; or leave it out"))


def require_given_friction(instant: Instant) -> None:
    """Raise SolveError [no-state-space] for friction that depends on joint reactions: it would respond to the inputs,
    too.
    """
    mechanism = instant.setup.scene.mechanism
    for load in mechanism.joint_friction:
        joint_path = mechanism.describe_friction(load)
        message = f"friction depends on the joint reaction, {joint_path}, and so on the inputs: no state space yet"
        raise SolveError(
            Problem(PROBLEM_CODE, message, hint="give friction a fixed size: friction: {type: friction, force: 20 N}")
        )


def require_derivatives(scene: FreedScene, instant: Instant, linear_equations: LinearisedEquations) -> None:
    """Raise SolveError [no-state-space] if a load has no derivative by the state: it has a jump, a kink, or a root
    there.
    """
    recovered = scene.runner.evaluate(np.array([instant.t]), linear_equations.state[None, :], holding=instant.holding)
    sentences = list(dict.fromkeys(iter_without_derivative(scene.layout, instant.t, recovered)))
    if not sentences and not (
        np.isfinite(linear_equations.by_place).all() and np.isfinite(linear_equations.by_rate).all()
    ):
        sentences = ["a load has no derivative there"]
    hint = "use a nearby state, or smooth the load there: sqrt(x**2 + 1e-6) for abs(x)"
    if sentences:
        raise SolveError(
            *(Problem(PROBLEM_CODE, f"{x}: motions near it cannot be linearised", hint=hint) for x in sentences)
        )


def drop_rounding(offset: Array, size: float) -> Array:
    """Return the rates and accelerations of a state; 0 if it is at rest to rounding."""
    return np.where(np.abs(offset) <= tolerances.NO_OFFSET * max(size, 1.0), 0.0, offset)


def format_rate_name(name: str) -> str:
    """Return the name of a coordinate's rate: main.rate, guide.speed; d/dt of others."""
    owner, _, quantity = name.rpartition(".")
    return f"{owner}.{RATES[quantity]}" if quantity in RATES else f"d/dt {name}"


def get_load_unit(instant: Instant, name: str) -> str:
    """Return the unit of the value of a load."""
    load = find_load(instant, name)
    if isinstance(load, JointLoad):
        return JOINTS[instant.freed_scene.layout.mechanism.joints[load.joint].kind].load_unit
    return load.row.unit or "N"


def find_rate_indices(scene: FreedScene) -> Array:
    """Return the indices of the rates in the state."""
    indices = rate_indices(scene.layout)
    return indices[indices >= 0]


def recover_state(scene: FreedScene, instant: Instant) -> Array:
    """Return the instant's state in a scene with other loads, (n,): they decide whether the work of loads is a state
    variable.
    """
    states = scene.convert_states(instant.driven_recovered)
    return np.asarray(scene.runner.evaluate(np.array([instant.t]), states, holding=instant.holding).states[0])


def compute_drift(linear_equations: LinearisedEquations, choice: CoordinateChoice) -> Array:
    """Return the change of the rates that closed chains require for a displacement, (n, f), without a part along the
    coordinates.
    """
    drift = linear_equations.drift @ solve_least_squares(linear_equations.tangent, choice.S)
    return np.asarray(drift - choice.S @ (choice.rows @ drift))


def require_tree_coordinates(
    scene: FreedScene, choice: CoordinateChoice, linear_equations: LinearisedEquations, is_moving: bool
) -> None:
    """Raise SolveError [no-state-space] if the rows of the coordinates change with the motion, and something moves or
    accelerates.
    """
    if not is_moving and not np.abs(linear_equations.accelerations).max(initial=0.0) > tolerances.OFF_BALANCE:
        return
    freedoms = {
        f"{scene.layout.mechanism.joints[f.joint].name}.{f.quantity}" for f in scene.layout.freedoms if f.joint >= 0
    }
    wrong = [name for name in choice.names if name not in freedoms]
    if wrong:
        message = f"{', '.join(wrong)}: about a moving state only coordinates of the spanning tree can be used"
        hint = f"use others: {', '.join(sorted(freedoms))}; or a state at rest"
        raise SolveError(Problem(PROBLEM_CODE, message, hint=hint))


def select_inputs(instant: Instant, choice: CoordinateChoice, requested: Sequence[str]) -> StateSpaceInputs:
    """Return the requested inputs; by default all loads that have one value. Raises SolveError [no-state-space] for
    other names.
    """
    forces = [load.name for load in instant.freed_scene.layout.mechanism.loads if load.has_value]
    drives = {
        find_drive_name(instant, name): name
        for name, is_driven in zip(choice.names, choice.is_driven, strict=True)
        if is_driven
    }
    drives = {f"drives.{name}" if name in forces else name: coordinate for name, coordinate in drives.items()}
    if not requested:
        loads = instant.freed_scene.layout.mechanism.loads
        with_direction = [
            load.name for load in loads if not isinstance(load, PointLoad) or find_direction(load) is not None
        ]
        return StateSpaceInputs(tuple(dict.fromkeys(name for name in forces if name in with_direction)), ())
    wrong = [name for name in requested if name not in forces and name not in drives]
    if wrong:
        known = [*dict.fromkeys(forces), *drives]
        raise SolveError(*(
            Problem(
                PROBLEM_CODE, f"--inputs {name}: no force with a value and no drive has this name",
                hint=suggest(name, known, "inputs") if known else NO_INPUTS_HINT,
            )
            for name in wrong
        ))  # fmt: skip
    return StateSpaceInputs(
        tuple(n for n in requested if n in forces), tuple(drives[n] for n in requested if n not in forces)
    )


def find_drive_name(instant: Instant, coordinate: str) -> str:
    """Return the name of the drive of a coordinate."""
    joint = coordinate.rpartition(".")[0]
    drives = (other.drive for other in instant.setup.scene.mechanism.joints if other.name == joint)
    return next(drive.name for drive in drives if drive is not None)


def find_direction(load: PointLoad) -> Array | None:
    """Return the direction of a force's value: that of a constant force, or the only axis along which it varies."""
    varying = [k for k, value in enumerate(load.vector) if value.constant != 0.0]
    values = np.array([value.constant if value.constant is not None else np.nan for value in load.vector])
    if np.isfinite(values).all() and values.any():
        return np.asarray(values / np.sqrt(values @ values))
    return np.eye(3)[varying[0]] if len(varying) == 1 else None


def find_load(instant: Instant, name: str) -> Load:
    """Return the load with this name."""
    return next(load for load in instant.freed_scene.layout.mechanism.loads if load.name == name)


def compute_unit_force(
    scene: FreedScene, instant: Instant, choice: CoordinateChoice, linear_equations: LinearisedEquations, name: str
) -> Array:
    """Return k (f,) of a load of value 1, for a force along its direction."""
    mechanism = scene.layout.mechanism
    loads = tuple(make_unit_load(load) for load in mechanism.loads if load.name == name)
    layout = replace(scene.scene, mechanism=replace(mechanism, loads=loads))
    unit_scene = free_drives(layout)
    recovered = unit_scene.runner.evaluate(
        np.array([instant.t]), unit_scene.convert_states(instant.driven_recovered), holding=instant.holding
    )
    states = make_body_states(unit_scene.layout, recovered)
    actions = [load.action for load in collect_applied_loads(unit_scene.layout.mechanism, states, recovered)]
    return compute_forces_by_cause(
        unit_scene.layout, make_partials(unit_scene.layout, linear_equations, choice.S), actions
    )[name]


def make_unit_load(load: Load) -> Load:
    """Return a load with a value of 1. Raises SolveError [no-state-space] if it has no direction."""
    if not isinstance(load, PointLoad):
        return replace(load, value=UNIT_VALUE)
    values = find_direction(load)
    if values is None:
        message = f"--inputs {load.name}: a force with several varying components has no single value"
        raise SolveError(Problem(PROBLEM_CODE, message, hint="split it into several forces, each along one axis"))
    x, y, z = (Expression.from_number(float(value)) for value in values)
    return replace(load, vector=(x, y, z))
