"""Small oscillations of a spec's scene: about its start if that is at rest, else about its equilibrium.

A motion is linearised about its start if no load accelerates it there, otherwise about the equilibrium found from it; a
`state` about itself only. In steady motions, where drives turn at constant rates, the modes are those in the rotating
frame.

Along an indifferent direction the equilibrium is known only as well as the path to it
(loads/equilibrium/verification.py), and frequencies change along it.

`find_body_modes` describes a mode by the rotation and displacement of the centre of mass of each body:

    dx = shift + turn × (x - x_c)      of a point x of a body, to first order; complex if points do not pass the pose
                                       at rest together, as on rotating shafts
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import RATES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.steady_states import has_constant_rate
from heuncli.loads.redundancy.self_stress import find_neighbour_poses
from heuncli.motion.integration.diagnosis.solvability import ErrorWording, require_solvable
from heuncli.motion.linearisation.linearise import make_coordinate_rows
from heuncli.motion.linearisation.oscillations import Mode, SceneModes, find_largest_coordinates, find_modes, make_shape
from heuncli.motion.linearisation.smoothness import iter_without_slope
from heuncli.motion.linearisation.steady_motion import (
    LinearisedState,
    continues_unchanged,
    find_distance_from_rest,
    find_fastest_rate,
    linearise_scene,
)
from heuncli.multibody.mechanism.loads import RopeLoad
from heuncli.multibody.tree.layout import find_speed_rows
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Drive, Spec
from heuncli.study.model.setup import Setup, attach_locations, set_up

DIFFERENCE_FACTOR = 2.0  # times the difference of two poses, as for errors of loads (study/solve/error_estimates.py)


def widen_errors(
    modes: list[Mode], linearised_state: LinearisedState, neighbour_states: tuple[Array, ...]
) -> list[Mode]:
    """Return the modes with errors that cover those at neighbouring states (n_state,); growth within the error is
    dropped.
    """
    neighbour_eigenvalues = [
        values for state in neighbour_states if len(values := compute_eigenvalues(linearised_state, state))
    ]
    return [mode if mode.kind == "free" else widen_error(mode, neighbour_eigenvalues) for mode in modes]


def compute_eigenvalues(linearised_state: LinearisedState, state: Array) -> Array:
    """Return the eigenvalues of all motions about another state, (m,) [1/s]; empty if its laws have no slope there."""
    try:
        neighbour = linearise_scene(
            linearised_state.scene, linearised_state.runner, linearised_state.t, state, linearised_state.holding
        )
    except SolveError:
        return np.zeros(0, dtype=complex)
    return np.array([mode.eigenvalue for mode in find_modes(neighbour.system, neighbour.indifferent)])


def widen_error(mode: Mode, neighbour_eigenvalues: list[Array]) -> Mode:
    """Return a mode whose error covers the nearest eigenvalue in each of the arrays (m,)."""
    distance = max((float(np.abs(values - mode.eigenvalue).min()) for values in neighbour_eigenvalues), default=0.0)
    error, value = mode.error + DIFFERENCE_FACTOR * distance, mode.eigenvalue
    if abs(value.real) > error:
        return replace(mode, error=error)
    kind = "oscillation" if value.imag else "decay"
    return replace(mode, kind=kind, eigenvalue=complex(0.0, value.imag), error=error)


REST_HINT = "analysis: {type: rest} finds the rest position"
CLOSER_START_HINT = "start the model closer to its rest position"
MOVING_HINT = "leave out the velocities, or run a motion: modes are about a rest position or a steady motion"


def compute_spec_modes(spec: Spec, excluded: Sequence[str] = ()) -> SceneModes:
    """Return the modes of a spec.

    excluded: entries that were left out of it or held, for the report

    Raises SolveError if there is no state to oscillate about.
    """
    with attach_locations(spec):
        return replace(solve_spec_modes(spec), omitted_paths=tuple(excluded))


def solve_spec_modes(spec: Spec) -> SceneModes:
    """Return the modes of a spec. Errors name bodies, joints and sections, but not their location in the file."""
    return to_results(spec, solve_modes(spec))


class SpecModes(NamedTuple):
    """The scene in the state that it oscillates about, whether this is an equilibrium that was searched, and all
    motions about it.
    """

    linearised_state: LinearisedState
    state_kind: Literal["rest", "state"]
    modes: list[Mode]


def solve_modes(spec: Spec) -> SpecModes:
    """Find all small motions of a spec's scene. Raises SolveError if there is no state to oscillate about."""
    setup = set_up_at_rest(spec) if spec.analysis.type == "rest" else set_up(spec, reduce=False)
    require_time_independent(setup)
    if find_speed_rows(setup.scene.layout).any() and setup.spec.analysis.type != "rest":
        from heuncli.motion.linearisation.steady_motion import find_rolling_modes, has_rolling  # few scenes have wheels

        linearised_state = linearise_start(setup)
        if has_rolling(linearised_state):
            require_differentiable(linearised_state)
            return SpecModes(linearised_state, "state", find_rolling_modes(linearised_state))
    linearised_state, state_kind, neighbour_states = find_state(setup)
    require_differentiable(linearised_state)
    return SpecModes(
        linearised_state,
        state_kind,
        widen_errors(
            find_modes(linearised_state.system, linearised_state.indifferent), linearised_state, neighbour_states
        ),
    )


def to_results(spec: Spec, spec_modes: SpecModes) -> SceneModes:
    """Return the modes in terms of the joint coordinates."""
    linearised_state = spec_modes.linearised_state
    rows = make_coordinate_rows(linearised_state.layout, linearised_state.linear)
    shapes = [make_shape(mode.shape, rows) for mode in spec_modes.modes]
    return SceneModes(
        title=spec.title,
        reference=spec_modes.state_kind,
        is_steady=is_moving(linearised_state)
        and bool(spec_modes.modes),  # without freedoms nothing was compared at later instants
        has_held_drives=linearised_state.layout.has_laws and not is_moving(linearised_state),
        modes=tuple(spec_modes.modes),
        shapes=tuple(shapes),
        largest=tuple(find_largest_coordinates(shape, linearised_state.layout.size) for shape in shapes),
        sticking_paths=tuple(dict.fromkeys(iter_sticking_friction(linearised_state))),
    )


def iter_sticking_friction(linearised_state: LinearisedState) -> Iterator[str]:
    """Yield the paths of the dry frictions that stick in a state."""
    layout = linearised_state.layout
    for k in layout.friction_contacts:
        if linearised_state.holding[k] > 0.0:
            yield layout.contacts[k].name


def set_up_at_rest(spec: Spec) -> Setup:
    """Set the scene up at its equilibrium. Raises SolveError, for what depends on time with a hint what to leave
    out.
    """
    try:
        return set_up(spec, reduce=False)
    except SolveError:
        state_analysis = spec.analysis._replace(type="state", times=(0.0,))
        start = set_up(spec._replace(analysis=state_analysis), reduce=False)
        require_time_independent(start)
        require_steady_drives(start)
        raise


def require_time_independent(setup: Setup) -> None:
    """Raise SolveError [no-modes] for loads that depend on time."""
    time_loads = [load for load in setup.scene.mechanism.loads if any(value.time_dependent for value in load.values)]
    names = list(dict.fromkeys(load.name for load in time_loads if not isinstance(load, RopeLoad)))
    left_out = f"--without {','.join(names)} leaves out the excitation; or " if names else ""
    hint = f"{left_out}give it a constant value with --set"
    problems = [
        Problem(
            "no-modes",
            f"{name} depends on t: small oscillations need a state that does not change",
            hint=hint,
        )
        for name in dict.fromkeys(load.path for load in time_loads)
    ]
    if problems:
        raise SolveError(*problems)


def find_state(setup: Setup) -> tuple[LinearisedState, Literal["rest", "state"], tuple[Array, ...]]:
    """Return the scene in the state that it oscillates about, and neighbouring states within the equilibrium's
    error.
    """
    kind = setup.spec.analysis.type
    linearised_state = linearise_start(setup)
    reason = find_unsteadiness(linearised_state, kind == "rest")
    if reason is None:
        neighbour_states = () if setup.rest is None else setup.rest.nearby_states
        return linearised_state, "rest" if kind == "rest" else "state", neighbour_states
    if kind in ("state", "rest"):
        subject = "state is not at rest" if kind == "state" else "position found is not quite at rest"
        hint = (MOVING_HINT if is_moving(linearised_state) else REST_HINT) + "".join(
            f"; {x}" for x in make_hold_hints(setup.spec)
        )
        raise SolveError(
            Problem("not-at-rest", f"the {subject}: {reason}", hint=hint if kind == "state" else CLOSER_START_HINT)
        )
    require_steady_drives(setup)
    return find_state(set_up_equilibrium(setup.spec))


def make_hold_hints(spec: Spec) -> list[str]:
    """Return hints on how to hold the moving drives at their start."""
    moving = ",".join(name for name, drive in spec.drives.items() if drive.by_rate or drive.value.time_dependent)
    return (
        [f"--without {moving} fixes {'them at their start' if ',' in moving else 'it at its start'}"] if moving else []
    )


def require_steady_drives(setup: Setup) -> None:
    """Raise SolveError [no-modes] if a drive neither rests nor moves at a constant rate."""
    laws = [law for law in setup.scene.mechanism.laws if not has_constant_rate(law.value)]
    if laws:
        drives = [law.name for law in laws if not law.is_rope]
        hint = f"--without {','.join(drives)}: finds the modes with the drive locked at its start"
        hint = hint if drives else "give a length that is constant or grows at a constant rate"
        raise SolveError(*(
            Problem("no-modes", f"{law.path} does not have a constant rate", hint=hint) for law in laws
        ))  # fmt: skip


def linearise_start(setup: Setup) -> LinearisedState:
    """Linearise the scene about its start, or about the equilibrium that was found."""
    runner, layout = setup.runner, setup.scene.layout
    t = float(setup.spec.analysis.times[0]) if setup.spec.analysis.type == "state" else 0.0
    recovered = runner.evaluate(np.array([t]), layout.y0[None, :])
    require_solvable(setup.scene, recovered, ErrorWording("accelerations at the start"))
    return linearise_scene(setup.scene, runner, t, layout.y0, runner.start_holding)


def set_up_equilibrium(spec: Spec) -> Setup:
    """Set the scene up at the equilibrium found from its start."""
    rest_analysis = spec.analysis._replace(type="rest", times=(0.0,), duration=None, conditions=())
    return set_up(spec._replace(analysis=rest_analysis), reduce=False)


def is_moving(linearised_state: LinearisedState) -> bool:
    """Return whether anything moves in the state, even steadily."""
    return find_fastest_rate(linearised_state) > tolerances.AT_REST


def find_unsteadiness(linearised_state: LinearisedState, is_equilibrium: bool) -> str | None:
    """Return why a state is neither at rest nor in steady motion; None if it is.

    is_equilibrium: whether the pose was found by a search and is known to its rounding
    """
    if not linearised_state.system.count:
        return None
    imbalance = find_distance_from_rest(linearised_state)
    if not imbalance <= max(
        tolerances.OFF_BALANCE, tolerances.REAL_STIFFNESS_FACTOR * linearised_state.reach if is_equilibrium else 0.0
    ):
        return f"{find_most_accelerated(linearised_state)} accelerates" + (
            f", about {imbalance:.2g} from its rest position" if imbalance < 1.0 else ""
        )
    if is_moving(linearised_state) and not continues_unchanged(linearised_state):
        return "its motion is not steady: loads change with time, also in the co-rotating frame"
    return None


def is_singular(linearised_state: LinearisedState) -> bool:
    """Return whether fewer closure rows are independent in this pose than close by."""
    if not linearised_state.layout.rows or not linearised_state.system.count:
        return False
    neighbour = find_neighbour_poses(
        linearised_state.runner,
        linearised_state.t,
        linearised_state.linear.state,
        (tolerances.NEIGHBOUR,),
        holding=linearised_state.holding,
    )
    return neighbour is not None and bool(
        neighbour.rows["chosen"].sum(axis=1).max() > linearised_state.evaluation.rows["chosen"].sum()
    )


def find_most_accelerated(linearised_state: LinearisedState) -> str:
    """Return the coordinate with the largest acceleration; lengths are divided by the scene's size."""
    rows = make_coordinate_rows(linearised_state.layout, linearised_state.linear)
    return find_largest_coordinates(
        make_shape(linearised_state.system.tangent @ linearised_state.system.remaining_acceleration, rows),
        linearised_state.layout.size,
    )[0]


def require_differentiable(linearised_state: LinearisedState) -> None:
    """Raise SolveError [no-modes] if a law has no slope, or if closed chains can move to first order only."""
    sentences = list(dict.fromkeys(iter_without_slope(linearised_state)))
    if is_singular(linearised_state):
        sentences.append("closed loops are stretched, folded or flat there, and can move to first order only")
    if sentences:
        consequence = "oscillations about it are not linear, however small"
        hint = "use a nearby position with type: state, or run a motion"
        raise SolveError(*(Problem("no-modes", f"{sentence}: {consequence}", hint=hint) for sentence in sentences))


def exclude_entries(spec: Spec, entries: Sequence[str]) -> Spec:
    """Return the spec without some forces, and with some drives held at their start."""
    drives = dict(spec.drives)
    joints = dict(spec.joints)
    t = float(spec.analysis.times[0]) if spec.analysis.type == "state" else 0.0
    for name, drive in spec.drives.items():
        if f"drives.{name}" in entries:
            drives[name] = hold_drive(drive, t)
            if drive.quantity != "length":  # a rod has no start rate that must be removed
                joints[drive.joint] = replace(joints[drive.joint], **{RATES[drive.quantity]: None})
    forces = {name: force for name, force in spec.forces.items() if f"forces.{name}" not in entries}
    return spec._replace(forces=forces, drives=drives, joints=joints)


def hold_drive(drive: Drive, t: float) -> Drive:
    """Return a drive that keeps its coordinate at the start value."""
    value = 0.0 if drive.by_rate else drive.value.value(t)
    return replace(drive, value=Expression.from_number(value, drive.value.location))


MIN_SHARE = 0.5


@record
class BodyModes:
    """A scene with its modes, and its bodies by name.

    places (n_b, 3): the bodies' origins
    attitudes (n_b, 3, 3): with the axes as columns
    centres (n_b, 3): centres of mass
    turns, shifts (modes, n_b, 3): complex
    """

    scene: PreparedScene
    modes: SceneModes
    names: tuple[str, ...]
    places: Array
    attitudes: Array
    centres: Array
    turns: Array
    shifts: Array

    def displace_points(self, mode: int, body: int, points: Array) -> Array:
        """Return the displacements (..., 3), complex, of a body's points at world positions (..., 3)."""
        turn, shift = self.turns[mode, body], self.shifts[mode, body]
        return np.asarray(shift + np.cross(np.broadcast_to(turn, points.shape), points - self.centres[body]))

    def is_transverse(self, mode: int, direction: Array) -> bool:
        """Return whether a mode moves bodies across a direction rather than along it: centres shift across it, or
        bodies turn about it.
        """
        shifts, turns = np.abs(self.shifts[mode]) ** 2, np.abs(self.turns[mode]) ** 2
        along = np.abs(self.shifts[mode] @ direction) ** 2
        about = np.abs(self.turns[mode] @ direction) ** 2
        return bool(along.sum() <= MIN_SHARE * shifts.sum() and about.sum() >= MIN_SHARE * turns.sum())


def find_body_modes(spec: Spec, excluded: Sequence[str] = ()) -> BodyModes:
    """Return the modes of a spec, and how its bodies move.

    excluded: entries left out, as for compute_spec_modes

    Raises SolveError as that does.
    """
    with attach_locations(spec):
        spec_modes = solve_modes(spec)
        linearised_state, bodies = spec_modes.linearised_state, spec_modes.linearised_state.layout.mechanism.bodies
        order = np.array([linearised_state.layout.place[k] for k in range(len(bodies))], dtype=np.intp)
        linear_equations = linearised_state.linear
        twists = np.zeros((len(spec_modes.modes), len(bodies), 6), dtype=complex)
        for k, mode in enumerate(spec_modes.modes):
            twists[k] = linear_equations.twists[order] @ mode.shape
        attitudes, centres = linear_equations.attitudes[order], linear_equations.centres[order]
        local_centres = np.array([body.center for body in bodies]).reshape(-1, 3)
        return BodyModes(
            linearised_state.scene,
            replace(to_results(spec, spec_modes), omitted_paths=tuple(excluded)),
            tuple(body.name for body in bodies),
            centres - np.einsum("bij,bj->bi", attitudes, local_centres),
            attitudes,
            centres,
            twists[..., :3],
            twists[..., 3:],
        )
