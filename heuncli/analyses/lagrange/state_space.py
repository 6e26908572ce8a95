"""`--state-space`: A, B, C, D of small motions about a state, for a controller.

    x = (dq, dq'),  x. = A x + B u,  y = C x + D u
The coordinates are those that no drive holds, and the driven ones whose acceleration is an input. The drives are let
go and what they exert is put on as a constant load, so that the scene without them moves as the one with them; what is
prescribed is then held, or moved, by a change dQ of that load:
    dq.. = a + n dQ,   a = A_q dq + A_u dq',   dq.._d = w:   dq.._f = a_f + n_fd n_dd^-1 (w - a_d)
An input force is a change of its value: dq.. = n k, k of a value of 1. A rate v = row q' that is an output changes with
dq, too, where something moves: rate_slopes.py.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.coordinates import Chosen, candidates, chosen
from heuncli.analyses.lagrange.equations import forces_by_cause, partials_of, reciprocal
from heuncli.analyses.lagrange.freed import FreedScene, freed
from heuncli.analyses.lagrange.instant import Instant
from heuncli.analyses.lagrange.kinds import units_of
from heuncli.analyses.lagrange.rate_slopes import RateSlopes, rate_slopes
from heuncli.analyses.lagrange.results import StateSpace
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS, RATES
from heuncli.base.nearest import did_you_mean
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import applied_loads
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.motion.linearisation.linearise import Linearised, linearised
from heuncli.motion.linearisation.smoothness import without_derivative
from heuncli.multibody.mechanism.model import JointLoad, Load, PairLoad, PointLoad
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression

CODE = "no-state-space"
UNIT = Expression.of(1.0)
AXES = "xyz"
NO_INPUTS = "this scene has no input: forces, couples, torques, actuators and drives are inputs; bushings are none"


@record
class Inputs:
    """What is put in: forces by name, and driven coordinates by their names."""

    forces: tuple[str, ...]
    drives: tuple[str, ...]


def state_space(at: Instant, by: Chosen, Q: Array, asked: Sequence[str], outputs: Sequence[str]) -> StateSpace:
    """The linear equations beside an instant; by: its coordinates, Q what drives exert there.

    Raises SolveError [no-state-space] where the equations are not those of coordinates.
    """
    require_given_loads(at)
    require_driven(at, by)
    inputs = inputs_of(at, by, asked)
    scene = freed(at.setup.scene, dict(zip(by.names, Q, strict=True)))
    state = settled(scene, at)
    found = linearised(scene.layout, at.t, state, at.holding)
    require_derivatives(scene, at, found)
    own = chosen(scene.scene, found, scene.driven, by.names)
    moving = bool(np.abs(state[rates_at(scene)]).max(initial=0.0) > 0.0)
    require_coordinates(scene, own, found, moving)
    free = [i for i, name in enumerate(own.names) if not own.driven[i] or name in inputs.drives]
    driven = [i for i, is_driven in enumerate(own.driven) if is_driven]
    epsilon = own.S.T @ found.mass @ own.S
    eta = reciprocal(own.names, epsilon)
    drift = drift_of(found, own)
    by_place = own.rows @ (found.by_place @ own.S + found.by_rate @ drift)
    by_rate = own.rows @ found.by_rate @ own.S
    push = (
        np.array([eta @ unit_force(scene, at, own, found, name) for name in inputs.forces])
        .reshape(len(inputs.forces), len(eta))
        .T
    )
    moved = np.array([[float(own.names[i] == name) for name in inputs.drives] for i in driven]).reshape(
        len(driven), len(inputs.drives)
    )
    hold = eta[:, driven] @ np.linalg.inv(eta[np.ix_(driven, driven)]) if driven else np.zeros((len(eta), 0))
    # what a drive does not ask for is taken off again; what it asks for is put on
    left = np.eye(len(eta))
    left[:, driven] -= hold
    A21, A22, B2 = left @ by_place, left @ by_rate, np.hstack([left @ push, hold @ moved])
    n, m = len(free), B2.shape[1]
    pick = np.ix_(free, free)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [A21[pick], A22[pick]]])
    B = np.vstack([np.zeros((n, m)), B2[free]])
    names = tuple(own.names[i] for i in free)
    C, D, told, units = outputs_of(scene, at, own, found, free, (A, B), outputs)
    along = [units_of(own.names[i]) for i in free]
    offset = np.concatenate([(own.rows @ state[rates_at(scene)])[free], (own.rows @ found.accelerations)[free]])
    return StateSpace(
        A=A, B=B, C=C, D=D,
        states=(*names, *(rate_name(name) for name in names)),
        inputs=(*inputs.forces, *(f"{name} acceleration" for name in inputs.drives)),
        outputs=told,
        units={
            "states": [*(unit.value for unit in along), *(unit.rate for unit in along)],
            "inputs": [
                *(unit_of(at, name) for name in inputs.forces),
                *(units_of(name).acceleration for name in inputs.drives),
            ],
            "outputs": units,
        },
        offset=beside_rounding(offset, at.setup.scene.layout.size),
    )  # fmt: skip


def require_driven(at: Instant, by: Chosen) -> None:
    """Raise SolveError where a driven coordinate, which is held or an input, is not among the chosen ones."""
    missing = [name for name in at.freed.driven if name not in by.names]
    if missing:
        message = f"{', '.join(missing)}: what is driven has to be among the coordinates of a state space"
        raise SolveError(Problem(CODE, message, hint=f"--coordinates {','.join(missing)},...; or leave it out"))


def require_given_loads(at: Instant) -> None:
    """Raise SolveError for friction that hangs on what its joint carries: it would answer the inputs, too."""
    mechanism = at.setup.scene.mechanism
    for load in mechanism.rubbing:
        where = mechanism.rubs_in(load)
        message = f"friction hangs on what presses, {where}, and so on the inputs: no state space has it yet"
        raise SolveError(Problem(CODE, message, hint="give friction a size: friction: {type: friction, force: 20 N}"))


def require_derivatives(scene: FreedScene, at: Instant, found: Linearised) -> None:
    """Raise SolveError where a load has no derivative in the state: it jumps, bends, or has a root there."""
    answered = scene.runner.recovered(np.array([at.t]), found.state[None, :], holding=at.holding)
    sentences = list(dict.fromkeys(without_derivative(scene.layout, at.t, answered)))
    if not sentences and not (np.isfinite(found.by_place).all() and np.isfinite(found.by_rate).all()):
        sentences = ["a load has no slope there"]
    hint = "take a state a little beside it, or give the load a slope there: sqrt(x**2 + 1e-6) for abs(x)"
    if sentences:
        raise SolveError(*(Problem(CODE, f"{x}: motions beside it are not linear", hint=hint) for x in sentences))


def beside_rounding(offset: Array, size: float) -> Array:
    """The rates and accelerations of a state; 0 of one that rests to rounding."""
    return np.where(np.abs(offset) <= tolerances.NO_OFFSET * max(size, 1.0), 0.0, offset)


def rate_name(name: str) -> str:
    """Of a coordinate's rate: main.rate, guide.speed; of others d/dt."""
    owner, _, quantity = name.rpartition(".")
    return f"{owner}.{RATES[quantity]}" if quantity in RATES else f"d/dt {name}"


def unit_of(at: Instant, name: str) -> str:
    """Of the value of a load."""
    load = load_named(at, name)
    if isinstance(load, PointLoad):
        return "N·m" if load.kind == "couple" else "N"
    if isinstance(load, JointLoad):
        return "N·m" if "turning" in JOINTS[at.freed.layout.mechanism.joints[load.joint].kind].motions else "N"
    return "N"


def rates_at(scene: FreedScene) -> Array:
    """Where the rates stand in the state."""
    from heuncli.multibody.tree.layout import places_of_rates

    place = places_of_rates(scene.layout)
    return place[place >= 0]


def settled(scene: FreedScene, at: Instant) -> Array:
    """The instant's state in a scene that has other loads, (n,): whether the work of loads is counted hangs on them."""
    states = scene.states(at.there)
    return np.asarray(scene.runner.recovered(np.array([at.t]), states, holding=at.holding).states[0])


def drift_of(found: Linearised, own: Chosen) -> Array:
    """What closed chains ask of the rates for a displacement, (n, f), none of it along the coordinates."""
    drift = found.drift @ np.linalg.lstsq(found.tangent, own.S, rcond=None)[0]
    return np.asarray(drift - own.S @ (own.rows @ drift))


def require_coordinates(scene: FreedScene, own: Chosen, found: Linearised, moving: bool) -> None:
    """Raise SolveError where the rows of the coordinates change with the motion, and something moves or is pushed."""
    if not moving and not np.abs(found.accelerations).max(initial=0.0) > tolerances.OFF_BALANCE:
        return
    freedoms = {
        f"{scene.layout.mechanism.joints[f.joint].name}.{f.quantity}" for f in scene.layout.freedoms if f.joint >= 0
    }
    wrong = [name for name in own.names if name not in freedoms]
    if wrong:
        message = f"{', '.join(wrong)}: beside a state that moves the equations are those of coordinates of the tree"
        hint = f"take others: {', '.join(sorted(freedoms))}; or a state at rest"
        raise SolveError(Problem(CODE, message, hint=hint))


def inputs_of(at: Instant, by: Chosen, asked: Sequence[str]) -> Inputs:
    """The inputs asked for; by default all loads that have one value. Raises SolveError for a name of neither."""
    forces = [load.name for load in at.freed.layout.mechanism.loads if has_value(load)]
    drives = {drive_name(at, name): name for name, is_driven in zip(by.names, by.driven, strict=True) if is_driven}
    drives = {f"drives.{name}" if name in forces else name: coordinate for name, coordinate in drives.items()}
    if not asked:
        loads = at.freed.layout.mechanism.loads
        plain = [own.name for own in loads if not isinstance(own, PointLoad) or direction(own) is not None]
        return Inputs(tuple(dict.fromkeys(name for name in forces if name in plain)), ())
    wrong = [name for name in asked if name not in forces and name not in drives]
    if wrong:
        known = [*dict.fromkeys(forces), *drives]
        raise SolveError(*(
            Problem(
                CODE, f"--inputs {name}: no force with a value and no drive is called so",
                hint=did_you_mean(name, known, "inputs") if known else NO_INPUTS,
            )
            for name in wrong
        ))  # fmt: skip
    return Inputs(tuple(n for n in asked if n in forces), tuple(drives[n] for n in asked if n not in forces))


def drive_name(at: Instant, coordinate: str) -> str:
    """The drive of a coordinate."""
    joint = coordinate.rpartition(".")[0]
    drives = (own.drive for own in at.setup.scene.mechanism.joints if own.name == joint)
    return next(drive.name for drive in drives if drive is not None)


def has_value(load: Load) -> bool:
    """Whether a load has one value, a force or torque, of which an input is a change.

    Springs and dampers by numbers, bushings, ropes, threads and distributed loads have none.
    """
    if isinstance(load, PointLoad):
        return load.spread is None
    return isinstance(load, PairLoad | JointLoad) and load.value is not None


def direction(load: PointLoad) -> Array | None:
    """Of a force along which its value counts: that of a constant one, or the only axis along which it varies."""
    varying = [k for k, value in enumerate(load.vector) if value.constant != 0.0]
    values = np.array([value.constant if value.constant is not None else np.nan for value in load.vector])
    if np.isfinite(values).all() and values.any():
        return np.asarray(values / np.sqrt(values @ values))
    return np.eye(3)[varying[0]] if len(varying) == 1 else None


def load_named(at: Instant, name: str) -> Load:
    """The load of a name."""
    return next(load for load in at.freed.layout.mechanism.loads if load.name == name)


def unit_force(scene: FreedScene, at: Instant, own: Chosen, found: Linearised, name: str) -> Array:
    """k (f,) of a value of 1, of a force along the direction that it has."""
    mechanism = scene.layout.mechanism
    loads = tuple(of_one(load) for load in mechanism.loads if load.name == name)
    layout = replace(scene.scene, mechanism=replace(mechanism, loads=loads))
    one = freed(layout)
    answered = one.runner.recovered(np.array([at.t]), one.states(at.there), holding=at.holding)
    states = body_states(one.layout, answered)
    actions = [load.action for load in applied_loads(one.layout.mechanism, states, answered)]
    return forces_by_cause(one.layout, partials_of(one.layout, found, own.S), actions)[name]


def of_one(load: Load) -> Load:
    """A load with a value of 1. Raises SolveError where it has no direction."""
    if not isinstance(load, PointLoad):
        return replace(load, value=UNIT)
    values = direction(load)
    if values is None:
        message = f"--inputs {load.name}: a force of several components that vary has no one value"
        raise SolveError(Problem(CODE, message, hint="make it several forces, each along one axis"))
    x, y, z = (Expression.of(float(value)) for value in values)
    return replace(load, vector=(x, y, z))


Matrices = tuple[Array, Array]


@record
class Output:
    """An output by its rows on the coordinates (f,): of a place, `by_place`; of a rate, `by_rate` and what a
    displacement makes of it at fixed rates, `by_place`; of an acceleration of a coordinate, `by_acceleration`.
    """

    by_place: Array
    by_rate: Array
    by_acceleration: Array
    unit: str


def outputs_of(
    scene: FreedScene, at: Instant, own: Chosen, found: Linearised, free: Sequence[int], of: Matrices,
    asked: Sequence[str],
) -> tuple[Array, Array, tuple[str, ...], list[str]]:  # fmt: skip
    """C, D, the names and the units of the outputs; by default the coordinates."""
    A, B = of
    n = len(free)
    names = tuple(asked) or tuple(own.names[i] for i in free)
    slopes = rate_slopes(scene.layout, at.t, at.holding, found, own.S, drift_of(found, own))
    all_rows = candidates(scene.layout, found)
    told = [output(slopes, at, own, all_rows, name) for name in names]
    C = [np.concatenate([o.by_place[free], o.by_rate[free]]) + o.by_acceleration[free] @ A[n:] for o in told]
    D = [o.by_acceleration[free] @ B[n:] for o in told]
    shape = len(names), B.shape[1]
    return np.array(C).reshape(len(names), 2 * n), np.array(D).reshape(shape), names, [o.unit for o in told]


def output(slopes: RateSlopes, at: Instant, own: Chosen, rows: dict[str, Array], name: str) -> Output:
    """An output by its name. Raises SolveError where nothing is called so."""
    owner, _, quantity = name.rpartition(".")
    base = {rate: place for place, rate in RATES.items()}
    none = np.zeros(len(own.names))
    if name in rows:
        return Output(rows[name] @ own.S, none, none, units_of(name).value)
    mechanism = slopes.layout.mechanism
    moved = f"{owner}.{base.get(quantity, quantity)}"
    if moved in rows:
        joint = next(joint for joint in mechanism.joints if joint.name == owner)
        by_place = none if moved in own.names else slopes.of_joint(joint, base[quantity])
        return Output(by_place, rows[moved] @ own.S, none, units_of(moved).rate)
    if quantity == "acceleration":
        place = next((f"{owner}.{q}" for q in ("angle", "travel") if f"{owner}.{q}" in rows), None)
        if place in own.names:
            return Output(none, none, rows[place] @ own.S, units_of(place).acceleration)
    axis = AXES.find(quantity[-1:])
    for i, body in enumerate(mechanism.bodies):
        point = owner.removeprefix(f"{body.name}.")
        if owner.startswith(f"{body.name}.") and point in body.points and axis >= 0 and quantity[:-1] in ("", "v"):
            position = body_states(at.freed.layout, at.here).point_position(i, body.points[point])[0]
            X = partials_of(slopes.layout, slopes.found, own.S).at(i, position)[axis]
            if not quantity[:-1]:
                return Output(X, none, none, "m")
            return Output(slopes.of_point(i, position)[axis], X, none, "m/s")
    hint = did_you_mean(name, list(rows), "outputs") or "coordinates, their rates, BODY.POINT.x or .vx"
    raise SolveError(Problem(CODE, f"--outputs {name}: no coordinate and no point is called so", hint=hint))
