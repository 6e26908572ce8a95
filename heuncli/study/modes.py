"""Small oscillations of a spec's scene: about its start where that is at rest, else about the pose that rests.

A motion is looked at about its start if nothing pushes it there, about the rest pose found from it otherwise; a `state`
about itself alone. In steady motions, where drives turn at constant rates, modes are those in the turning frame.
"""

from __future__ import annotations

from typing import Any, Literal

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.linearisation.oscillations import Mode, oscillations
from heuncli.linearisation.shapes import coordinates
from heuncli.linearisation.smooth import without_slope
from heuncli.linearisation.steady import Looked, fastest, goes_on_as_it_is, look, off_balance
from heuncli.records import record
from heuncli.results import Array
from heuncli.spec.models import Spec
from heuncli.study.setup import Setup, set_up

REST_HINT = "analysis: {type: rest} looks for the pose that rests"


@record
class Modes:
    """The modes of a scene; at: about which pose; shapes: of each mode its coordinates, the largest 1."""

    title: str
    at: Literal["rest", "state"]
    steady: bool  # in a frame that turns with the drives
    modes: tuple[Mode, ...]
    shapes: tuple[dict[str, complex], ...]
    largest: tuple[tuple[str, ...], ...]  # of each mode the coordinates that move most, lengths by the scene's size

    def block(self) -> dict[str, Any]:
        """As JSON has it."""
        rows = [row(mode, shape) for mode, shape in zip(self.modes, self.shapes, strict=True)]
        return {"at": self.at, "steady": self.steady, "modes": rows}


def row(mode: Mode, shape: dict[str, complex]) -> dict[str, Any]:
    """A mode as JSON has it; error [1/s]: what growth and 2 pi frequency may be off by."""
    return {
        "frequency": mode.frequency,
        "damping": mode.damping,
        "growth": mode.growth,
        "kind": mode.kind,
        "error": mode.error,
        "shape": {name: [x.real, x.imag] for name, x in shape.items()},
    }


def modes(spec: Spec) -> Modes:
    """The modes of a spec. Raises SolveError where there is no state to oscillate about."""
    setup = set_up(spec, reduce=False)
    require_no_time(setup)
    here, at = state_of(setup)
    require_slopes(here)
    found = oscillations(here.system)
    rows = coordinates(here.layout, here.found)
    shapes = [shape_of(mode.shape, rows) for mode in found]
    return Modes(
        title=spec.title,
        at=at,
        steady=moves(here),
        modes=tuple(found),
        shapes=tuple(shapes),
        largest=tuple(most(shape, here.layout.size) for shape in shapes),
    )


def require_no_time(setup: Setup) -> None:
    """Raise SolveError for loads that depend on the time."""
    problems = [
        Problem(
            "no-modes",
            f"forces.{load.name} depends on t: small oscillations are those about a state at which nothing changes",
            hint="give it the value that it has there, by --set forces... or a parameter",
        )
        for load in setup.scene.mechanism.loads
        if any(value.time_dependent for value in load.values)
    ]
    if problems:
        raise SolveError(*problems)


def state_of(setup: Setup) -> tuple[Looked, Literal["rest", "state"]]:
    """The scene in the state that it oscillates about."""
    runner, layout = setup.runner, setup.scene.layout
    t = float(setup.spec.analysis.times[0]) if setup.spec.analysis.type == "state" else 0.0
    here = look(setup.scene, runner, t, layout.y0, runner.start_holding)
    reason = restless(here)
    if reason is None:
        return here, "state"
    raise SolveError(Problem("not-at-rest", f"the state is not at rest: {reason}", hint=REST_HINT))


def moves(here: Looked) -> bool:
    """Whether anything moves there, if steadily."""
    return fastest(here) > tolerances.AT_REST


def restless(here: Looked) -> str | None:
    """Why a state is no rest and no steady motion; None where it is one."""
    if not here.system.count:
        return None
    off = off_balance(here)
    if not off <= tolerances.OFF_BALANCE:
        return f"{pushed_most(here)} is pushed" + (f", some {off:.2g} from where it would rest" if off < 1.0 else "")
    if moves(here) and not goes_on_as_it_is(here):
        return "what moves there changes what acts, also as seen by what turns with it"
    return None


def pushed_most(here: Looked) -> str:
    """The coordinate with the largest acceleration, lengths by the scene's size."""
    rows = coordinates(here.layout, here.found)
    return most(shape_of(here.system.tangent @ here.system.pushed, rows), here.layout.size)[0]


def require_slopes(here: Looked) -> None:
    """Raise SolveError where a law has no slope."""
    problems = [
        Problem("no-modes", f"{sentence}: oscillations about it are not linear, however small", hint=None)
        for sentence in dict.fromkeys(without_slope(here))
    ]
    if problems:
        raise SolveError(*problems)


def shape_of(x: Array, rows: dict[str, Array]) -> dict[str, complex]:
    """A displacement by coordinates, its largest 1."""
    found = {name: complex(row @ x) for name, row in rows.items()}
    largest = max(found.values(), key=abs, default=0j)
    return {name: value / largest if largest else value for name, value in found.items()}


def most(shape: dict[str, complex], size: float) -> tuple[str, ...]:
    """The coordinates that move most, at most three that move by half of it; lengths by the scene's size."""
    by = {name: abs(x) / (size if is_length(name) else 1.0) for name, x in shape.items()}
    largest = max(by.values(), default=0.0)
    names = sorted((name for name, x in by.items() if x >= 0.5 * largest), key=lambda name: -round(by[name], 9))
    return tuple(names[:3]) or ("nothing",)


def is_length(name: str) -> bool:
    """Whether a coordinate is a length."""
    end = name.rpartition(".")[2]
    return end == "travel" or end.startswith("d")
