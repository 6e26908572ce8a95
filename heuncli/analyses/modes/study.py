"""Small oscillations of a spec's scene, in terms of its joint coordinates or of its bodies.

Along an indifferent direction the equilibrium is known only as well as the path to it
(loads/equilibrium/verification.py), and frequencies change along it: errors of modes cover that.

`find_body_modes` describes a mode by the rotation and displacement of the centre of mass of each body:

    dx = shift + turn × (x - x_c)      of a point x of a body, to first order; complex if points do not pass the pose
                                       at rest together, as on rotating shafts
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from heuncli.analyses.modes.reference_state import (
    find_state,
    is_moving,
    linearise_start,
    require_differentiable,
    require_time_independent,
    set_up_at_rest,
)
from heuncli.base.errors import SolveError
from heuncli.base.joint_kinds import RATES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.motion.linearisation.linearise import make_coordinate_rows
from heuncli.motion.linearisation.oscillations import Mode, SceneModes, find_largest_coordinates, find_modes, make_shape
from heuncli.motion.linearisation.steady_motion import (
    LinearisedState,
    linearise_scene,
)
from heuncli.multibody.tree.layout import find_speed_rows
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Drive, Spec
from heuncli.study.model.setup import attach_locations, set_up

MIN_SHARE = 0.5  # of a mode's motion: more of it across a direction makes the mode transverse
DIFFERENCE_FACTOR = 2.0  # times the difference of two poses, as for errors of loads (study/solve/error_estimates.py)


def compute_spec_modes(spec: Spec, excluded: Sequence[str] = ()) -> SceneModes:
    """Return the modes of a spec.

    excluded: entries that were left out of it or held, for the report

    Raises SolveError if there is no state to oscillate about.
    """
    with attach_locations(spec):
        return replace(solve_spec_modes(spec), omitted_paths=tuple(excluded))


def solve_spec_modes(spec: Spec) -> SceneModes:
    """Return the modes of a spec. Errors name bodies, joints and sections, but not their location in the file."""
    return make_results(spec, solve_modes(spec))


class SpecModes(NamedTuple):
    """All small motions of a scene.

    linearised_state: the scene in the state that it oscillates about
    state_kind: whether this is an equilibrium that was searched (`rest`), or the start (`state`)
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
    modes = find_modes(linearised_state.system, linearised_state.indifferent)
    return SpecModes(linearised_state, state_kind, widen_errors(modes, linearised_state, neighbour_states))


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


def make_results(spec: Spec, spec_modes: SpecModes) -> SceneModes:
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


@record
class BodyModes:
    """A scene with its modes, and its bodies by name.

    places (n_b, 3): the bodies' origins
    attitudes (n_b, 3, 3): with the axes as columns
    centres (n_b, 3): centres of mass
    turns, shifts (modes, n_b, 3): rotations, and displacements of the centres of mass, complex
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
        linearised_state = spec_modes.linearised_state
        bodies, linear_equations = linearised_state.layout.mechanism.bodies, linearised_state.linear
        order = np.array([linearised_state.layout.place[k] for k in range(len(bodies))], dtype=np.intp)
        twists = np.zeros((len(spec_modes.modes), len(bodies), 6), dtype=complex)
        for k, mode in enumerate(spec_modes.modes):
            twists[k] = linear_equations.twists[order] @ mode.shape
        attitudes, centres = linear_equations.attitudes[order], linear_equations.centres[order]
        local_centres = np.array([body.center for body in bodies]).reshape(-1, 3)
        return BodyModes(
            scene=linearised_state.scene,
            modes=replace(make_results(spec, spec_modes), omitted_paths=tuple(excluded)),
            names=tuple(body.name for body in bodies),
            places=centres - np.einsum("bij,bj->bi", attitudes, local_centres),
            attitudes=attitudes,
            centres=centres,
            turns=twists[..., :3],
            shifts=twists[..., 3:],
        )
