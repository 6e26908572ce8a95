"""Find the state that a scene oscillates about: its start if that is at rest, else its equilibrium.

A motion is linearised about its start if no load accelerates it there, otherwise about the equilibrium found from it; a
`state` about itself only. In steady motions, where drives turn at constant rates, the modes are those in the rotating
frame. Loads that depend on time, drives of varying rate and laws without a slope are refused.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.loads.equilibrium.steady_states import has_constant_rate
from heuncli.loads.redundancy.self_stress import find_neighbour_poses
from heuncli.motion.integration.diagnosis.solvability import ErrorWording, require_solvable
from heuncli.motion.linearisation.linearise import make_coordinate_rows
from heuncli.motion.linearisation.oscillations import find_largest_coordinates, make_shape
from heuncli.motion.linearisation.smoothness import iter_without_slope
from heuncli.motion.linearisation.steady_motion import (
    LinearisedState,
    continues_unchanged,
    find_distance_from_rest,
    find_fastest_rate,
    linearise_scene,
)
from heuncli.multibody.mechanism.loads import RopeLoad
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import Setup, set_up

REST_HINT = "analysis: {type: rest} finds the rest position"
CLOSER_START_HINT = "start the model closer to its rest position"
MOVING_HINT = "leave out the velocities, or run a motion: modes are about a rest position or a steady motion"


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
        if kind == "rest":
            message, hint = f"the position found is not quite at rest: {reason}", CLOSER_START_HINT
        else:
            first_hint = MOVING_HINT if is_moving(linearised_state) else REST_HINT
            message, hint = f"the state is not at rest: {reason}", "; ".join([first_hint, *make_hold_hints(setup.spec)])
        raise SolveError(Problem("not-at-rest", message, hint=hint))
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
    distance = find_distance_from_rest(linearised_state)
    rounding = tolerances.REAL_STIFFNESS_FACTOR * linearised_state.reach if is_equilibrium else 0.0
    if not distance <= max(tolerances.OFF_BALANCE, rounding):
        how_far = f", about {distance:.2g} from its rest position" if distance < 1.0 else ""
        return f"{find_most_accelerated(linearised_state)} accelerates{how_far}"
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
