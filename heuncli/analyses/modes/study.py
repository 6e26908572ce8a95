"""Small oscillations of a spec's scene: about its start where that is at rest, else about the pose that rests.

A motion is looked at about its start if nothing pushes it there, about the rest pose found from it otherwise; a `state`
about itself alone. In steady motions, where drives turn at constant rates, modes are those in the turning frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from heuncli.analyses.modes.rest_digits import as_known
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.equilibrium.steady_states import is_steady
from heuncli.loads.redundancy.neighbours import neighbours
from heuncli.motion.integration.diagnosis.solvability import Wording, require_solvable
from heuncli.motion.linearisation.modes import SceneModes, most, shape_of
from heuncli.motion.linearisation.oscillations import Mode, oscillations
from heuncli.motion.linearisation.shapes import coordinates
from heuncli.motion.linearisation.smoothness import without_slope
from heuncli.motion.linearisation.steady_motion import Looked, fastest, goes_on_as_it_is, look, off_balance
from heuncli.multibody.mechanism.model import RopeLoad, path_of_load
from heuncli.multibody.tree.held_speeds import holds_speed
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.error_places import placed
from heuncli.study.model.setup import Setup, set_up

REST_HINT = "analysis: {type: rest} looks for the pose that rests"
NEARLY = "look for it from nearer by: draw the scene closer to where it rests"
MOVING_HINT = "leave out the velocities, or run a motion: modes are those about a pose, or a steady motion"


def modes(spec: Spec, without: Sequence[str] = ()) -> SceneModes:
    """The modes of a spec; without: entries that were left out of it or held, which is told.

    Raises SolveError where there is no state to oscillate about.
    """
    with placed(spec):
        return replace(found_in(spec), without=tuple(without))


def found_in(spec: Spec) -> SceneModes:
    """The modes of a spec. Errors name bodies, joints and sections, but not where these stand in the file."""
    return told(spec, looked_for(spec))


class FoundModes(NamedTuple):
    """The scene in the state that it oscillates about, whether that was found to rest, and all motions about it."""

    here: Looked
    at: Literal["rest", "state"]
    modes: list[Mode]


def looked_for(spec: Spec) -> FoundModes:
    """All small motions of a spec's scene. Raises SolveError where there is no state to oscillate about."""
    setup = set_up_at_rest(spec) if spec.analysis.type == "rest" else set_up(spec, reduce=False)
    require_no_time(setup)
    if holds_speed(setup.scene.layout).any() and setup.spec.analysis.type != "rest":
        from heuncli.motion.linearisation.rolling import rolling_modes, rolls_on  # few scenes have wheels

        here = looked_at(setup)
        if rolls_on(here):
            require_slopes(here)
            return FoundModes(here, "state", rolling_modes(here))
    here, at, beside = state_of(setup)
    require_slopes(here)
    return FoundModes(here, at, as_known(oscillations(here.system, here.loose), here, beside))


def told(spec: Spec, found: FoundModes) -> SceneModes:
    """The modes by the coordinates of the joints."""
    here = found.here
    rows = coordinates(here.layout, here.found)
    shapes = [shape_of(mode.shape, rows) for mode in found.modes]
    return SceneModes(
        title=spec.title,
        at=found.at,
        steady=moves(here) and bool(found.modes),  # with nothing free nothing was compared at later instants
        held=here.layout.driven and not moves(here),
        modes=tuple(found.modes),
        shapes=tuple(shapes),
        largest=tuple(most(shape, here.layout.size) for shape in shapes),
    )


def set_up_at_rest(spec: Spec) -> Setup:
    """The scene at its rest pose. Raises SolveError, of what depends on the time with what to leave out."""
    try:
        return set_up(spec, reduce=False)
    except SolveError:
        asked = spec.analysis._replace(type="state", times=(0.0,))
        start = set_up(spec._replace(analysis=asked), reduce=False)
        require_no_time(start)
        require_resting_drives(start)
        raise


def require_no_time(setup: Setup) -> None:
    """Raise SolveError for loads that depend on the time."""
    moving = [load for load in setup.scene.mechanism.loads if any(value.time_dependent for value in load.values)]
    names = list(dict.fromkeys(load.name for load in moving if not isinstance(load, RopeLoad)))
    left_out = f"--without {','.join(names)} leaves out what excites; or " if names else ""
    hint = f"{left_out}give it the value that it has there, by --set"
    problems = [
        Problem(
            "no-modes",
            f"{name} depends on t: small oscillations are those about a state at which nothing changes",
            hint=hint,
        )
        for name in dict.fromkeys(path_of_load(load) for load in moving)
    ]
    if problems:
        raise SolveError(*problems)


def state_of(setup: Setup) -> tuple[Looked, Literal["rest", "state"], tuple[Array, ...]]:
    """The scene in the state that it oscillates about, and states that are not told from a rest pose that was found."""
    kind = setup.spec.analysis.type
    here = looked_at(setup)
    reason = restless(here, kind == "rest")
    if reason is None:
        beside = () if setup.rest is None else setup.rest.beside
        return here, "rest" if kind == "rest" else "state", beside
    if kind in ("state", "rest"):
        what = "state is not at rest" if kind == "state" else "pose found is not quite at rest"
        hint = (MOVING_HINT if moves(here) else REST_HINT) + "".join(f"; {x}" for x in held_hints(setup.spec))
        raise SolveError(Problem("not-at-rest", f"the {what}: {reason}", hint=hint if kind == "state" else NEARLY))
    require_resting_drives(setup)
    return state_of(at_rest(setup.spec))


def held_hints(spec: Spec) -> list[str]:
    """What to write to have the drives that move held where they start."""
    moving = ",".join(name for name, drive in spec.drives.items() if drive.by_rate or drive.value.time_dependent)
    return (
        [f"--without {moving} holds {'them where they start' if ',' in moving else 'it where it starts'}"]
        if moving
        else []
    )


def require_resting_drives(setup: Setup) -> None:
    """Raise SolveError where a drive neither rests nor goes on at a constant rate, so that nothing rests beside it."""
    laws = [law for law in setup.scene.mechanism.laws if not is_steady(law.value)]
    if laws:
        drives = [law.name for law in laws if not law.of_rope]
        hint = f"--without {','.join(drives)}: modes with it held where it starts"
        hint = hint if drives else "a length that stays, or grows at a constant rate"
        raise SolveError(*(
            Problem("no-modes", f"{law.path} does not go on at a constant rate", hint=hint) for law in laws
        ))  # fmt: skip


def looked_at(setup: Setup) -> Looked:
    """The scene at its start, or at the rest pose that was found."""
    runner, layout = setup.runner, setup.scene.layout
    t = float(setup.spec.analysis.times[0]) if setup.spec.analysis.type == "state" else 0.0
    at = runner.recovered(np.array([t]), layout.y0[None, :])
    require_solvable(setup.scene, at, Wording("accelerations of the start"))
    return look(setup.scene, runner, t, layout.y0, runner.start_holding)


def at_rest(spec: Spec) -> Setup:
    """The scene at the rest pose that is found from its start."""
    asked = spec.analysis._replace(type="rest", times=(0.0,), duration=None, conditions=())
    return set_up(spec._replace(analysis=asked), reduce=False)


def moves(here: Looked) -> bool:
    """Whether anything moves there, if steadily."""
    return fastest(here) > tolerances.AT_REST


def restless(here: Looked, found: bool) -> str | None:
    """Why a state is no rest and no steady motion; None where it is one. found: a pose known to its rounding."""
    if not here.system.count:
        return None
    off = off_balance(here)
    if not off <= max(tolerances.OFF_BALANCE, tolerances.HELD * here.reach if found else 0.0):
        return f"{pushed_most(here)} is pushed" + (f", some {off:.2g} from where it would rest" if off < 1.0 else "")
    if moves(here) and not goes_on_as_it_is(here):
        return "its motion is not steady: loads change as it goes on, also in the frame that turns along"
    return None


def is_singular(here: Looked) -> bool:
    """Whether fewer closure rows are independent there than close by."""
    if not here.layout.rows or not here.system.count:
        return False
    near = neighbours(here.runner, here.t, here.found.state, (tolerances.NEIGHBOUR,), holding=here.holding)
    return near is not None and bool(near.rows["chosen"].sum(axis=1).max() > here.at.rows["chosen"].sum())


def pushed_most(here: Looked) -> str:
    """The coordinate with the largest acceleration, lengths by the scene's size."""
    rows = coordinates(here.layout, here.found)
    return most(shape_of(here.system.tangent @ here.system.pushed, rows), here.layout.size)[0]


def require_slopes(here: Looked) -> None:
    """Raise SolveError where a law has no slope, or where closed chains give way to the first order only."""
    sentences = list(dict.fromkeys(without_slope(here)))
    if is_singular(here):
        sentences.append("closed chains are stretched, folded or flat there, and give way to the first order only")
    if sentences:
        so = "oscillations about it are not linear, however small"
        hint = "take modes a little beside it, by type: state; or run a motion, which shows how it moves there"
        raise SolveError(*(Problem("no-modes", f"{sentence}: {so}", hint=hint) for sentence in sentences))
