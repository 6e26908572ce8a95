"""What happens: the motion asked for with its check run, or the one instant of a state.

Impure: integrating looks at the clock.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.method_rows import AUTO
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.distance import Marks, motion_error
from heuncli.motion.integration.check.estimate import CheckedRun, checked_run, recovered_at
from heuncli.motion.integration.check.instants import interleaved
from heuncli.motion.integration.check.runs import Runs, moved_start
from heuncli.motion.integration.check.singular_poses import singular_poses
from heuncli.motion.integration.contacts.blows import Jump
from heuncli.motion.integration.diagnosis.solvability import Wording, require_start
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.run.errors import Eventful, Stiff
from heuncli.motion.integration.run.interruptions import at_once
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.segments import discontinuities_of
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import BushingLoad, PairLoad
from heuncli.results.results import Array, Estimate
from heuncli.scene.expressions.discontinuities import one_sided_limits
from heuncli.study.model.memory_estimate import Room, require_room_for_steps
from heuncli.study.model.setup import Setup
from heuncli.study.solve.load_errors import LoadErrors, SeenInstants
from heuncli.study.solve.singular_start import require_motion

if TYPE_CHECKING:  # loaded where there are conditions
    from heuncli.motion.integration.check.changes import Changes


@record
class History:
    """The kernel's answers at the instants asked for; of a motion the checked run behind them.

    times (n_t,) ascending [s]: fewer than asked for where the run stopped; answers: those at some of them.
    tolerance: what the motion was to keep; estimate: of the errors, by kind; blows: those that happened; beside: those
    of the check runs; jumps: instants at which a load or drive jumps or bends, events and blows among them; singular:
    those of singular poses that the run came through; seconds: what took how long;
    errors: by kind and unit, of one instant those of shares by cause;
    compared: of one instant and one beside it, what their errors were made of;
    notes: of one instant what is to be told of contacts; those of a motion are in its run.
    """

    times: Array
    answers: Callable[[slice], Recovered]
    tolerance: float
    estimate: Estimate
    checked: CheckedRun | None = None
    blows: tuple[Jump, ...] = ()
    beside: tuple[tuple[Jump, ...], ...] = ()
    jumps: tuple[float, ...] = ()
    singular: tuple[float, ...] = ()
    seconds: Mapping[str, float] = MappingProxyType({})
    errors: Mapping[tuple[str, str], float] = MappingProxyType({})
    compared: SeenInstants | None = None
    notes: tuple[str, ...] = ()

    @property
    def changes(self) -> tuple[Changes, ...]:
        """When the conditions in time and coordinates change."""
        return self.checked.changes if self.checked is not None else ()

    @property
    def followed_for(self) -> float | None:
        """How long the run is, if it was followed and not integrated [s]."""
        run = self.checked.run if self.checked is not None else None
        return float(run.times[-1]) if run is not None and run.method.determined else None

    @cached_property
    def recovered(self) -> Recovered:
        """The answers at all the instants."""
        return self.answers(slice(None))


def integrate(
    setup: Setup, tolerance: float, deadline: float | None, *, by_cause: bool = False, room: Room | None = None
) -> History:
    """The history that the analysis asks for, with a column a cause where asked; nothing moves in a state.

    room: in which its steps must fit, as far as they are known before.
    Raises SolveError where no acceleration exists or the motion cannot be continued, LimitError past the deadline.
    """
    times, runner = np.array(setup.spec.analysis.times, dtype=float), setup.runner
    if setup.method is None:
        return state(setup, float(times[0]), tolerance, by_cause)
    jumps = begin(setup)
    if room is not None:
        require_room_for_steps(setup, len(one_sided_limits(jumps)) + 1, room)
    checked = checked_motion(setup, tolerance, jumps, deadline, by_cause)
    jumps = tuple(sorted({*jumps, *checked.run.jumps}))
    require_followed(runner, checked.run)
    require_apart(runner, checked)
    seconds = {"integrate": checked.run.seconds, "check": checked.check_seconds}
    if checked.lost_seconds:
        seconds["lost"] = checked.lost_seconds
    singular = tuple(singular_poses(runner, checked.run))
    estimate, beside = Estimate(motion=checked.motion, **checked.loads), checked.beside
    return History(
        checked.run.times, checked.answers, tolerance, estimate, checked, checked.run.blows, beside, jumps, singular,
        seconds, checked.errors,
    )  # fmt: skip


def begin(setup: Setup) -> tuple[float, ...]:
    """The discontinuities in time of a motion that can begin.

    Raises SolveError, LimitError where they are more than steps may be: before a long run, not after it.
    """
    first = setup.runner.recovered(np.zeros(1), setup.scene.layout.y0[None, :])
    require_start(setup.scene, first)
    require_motion(setup.scene.layout, first)
    jumps = tuple(discontinuities_of(setup.scene.mechanism, float(setup.spec.analysis.times[-1])))
    require_steps(len(one_sided_limits(jumps)) + 1, setup.method)
    return jumps


def require_steps(segments: int, method: Method | None) -> None:
    """Raise LimitError [step-limit] where a run takes more steps than it may, were it one to a segment."""
    foreign = method is not None and method.foreign
    most = tolerances.MOST_FOREIGN if foreign else tolerances.MOST_STEPS
    if segments <= most:
        return
    message = (
        f"loads and drives jump or bend at {segments - 1:,} instants, each the end of a step: "
        f"the run takes at least {segments:,} steps, and {most:,} is the most"
    )
    hint = "a shorter duration, or tables of fewer points" + ("; or method: auto" if foreign else "")
    raise LimitError(Problem("step-limit", message, hint=hint))


def checked_motion(
    setup: Setup, tolerance: float, jumps: tuple[float, ...], deadline: float | None, by_cause: bool
) -> CheckedRun:
    """The motion asked for with its check run.

    A motion that its drives determine is followed. Where that fails, at a singular pose or where the loops cannot do
    what the drives ask, it is integrated instead: there the velocities decide on which branch it goes on, or the error
    of the integration is raised.
    """
    assert setup.method is not None
    times, method = np.array(setup.spec.analysis.times, dtype=float), setup.method
    if method.determined:
        try:
            runs = Runs(setup.runner, times, jumps, deadline, method)
            return checked_run(runs, tolerance, LoadErrors(setup, by_cause))
        except SolveError:
            method = method_of(AUTO)
        except LimitError as limit:
            if limit.problems[0].code != "step-limit":
                raise
            method = method_of(AUTO)  # towards a singular pose steps along a branch become ever shorter
    try:
        runs = Runs(setup.runner, times, jumps, deadline, method, step=setup.step, watched=setup.auto)
        return checked_between_events(runs, setup, tolerance, by_cause)
    except Stiff as stiff:
        runs = Runs(setup.runner, times, jumps, deadline, stiff.method)
        return begun_anew(runs, stiff, method, setup, tolerance, by_cause)


def checked_between_events(runs: Runs, setup: Setup, tolerance: float, by_cause: bool) -> CheckedRun:
    """A motion with its check run, by a method of few stages where events end most steps and that takes less."""
    method, runs.eventful = runs.method, setup.auto
    try:
        return checked_run(runs, tolerance, LoadErrors(setup, by_cause))
    except Eventful as left:
        from heuncli.motion.integration.check.fewer_stages import try_fewer_stages  # few scenes have so many

        runs.eventful = try_fewer_stages(runs, left)
        return begun_anew(runs, left, method, setup, tolerance, by_cause)


def begun_anew(
    runs: Runs, left: Stiff | Eventful, method: Method, setup: Setup, tolerance: float, by_cause: bool
) -> CheckedRun:
    """A motion by the method of `runs`, after a run by `method` was left for the reason that `left` tells.

    Where the method of `runs` does not come to the end either, or events become rare in its run, `method` runs it all.
    """
    lost, why = left.seconds, None if runs.method is method else left.told
    try:
        checked = checked_run(runs, tolerance, LoadErrors(setup, by_cause))
        return replace(checked, lost_seconds=checked.lost_seconds + lost, begun_anew=why)
    except Eventful as again:
        lost += again.seconds
    except SolveError:
        if runs.method is method:
            raise
    except LimitError as limit:
        if runs.method is method or limit.problems[0].code != "step-limit":
            raise
    runs.method, runs.eventful = method, False
    checked = checked_run(runs, tolerance, LoadErrors(setup, by_cause))
    return replace(checked, lost_seconds=checked.lost_seconds + lost)


def state(setup: Setup, at: float, tolerance: float, by_cause: bool = False) -> History:
    """The history of one instant, behind the blow that is asked for; beside it, from a start moved by rounding."""
    runner, layout = setup.runner, setup.scene.layout
    # a rest pose moved by rounding would be another one: beside it are those that rounding does not tell from it
    others = [moved_start(layout)] if setup.rest is None else list(setup.rest.beside)
    starts = [layout.y0, *others]
    blows: list[tuple[Jump, ...]] = [() for _ in starts]
    notes: tuple[str, ...] = ()
    if setup.spec.analysis.type == "impulse" or layout.contacts:
        found = [at_once(runner, start, at) for start in starts]
        blows, notes = [one.jumps for one in found], found[0].notes
        starts = [jumps[-1].after if jumps else start for start, jumps in zip(starts, blows, strict=True)]
    times = np.array([at])
    holding = blows[0][-1].holding if blows[0] else held(runner, at, starts[0])
    beside = interleaved(times, [start[None, :] for start in starts])
    both = runner.recovered(*beside, causes=by_cause, holding=holding)
    answers = both.at(slice(0, 1))
    require_start(setup.scene, answers, Wording("accelerations behind the blow") if blows[0] else Wording())
    require_motion(layout, answers)
    errors = LoadErrors(setup, by_cause, keeping=True)
    errors.add(both, *np.ones((2, 1), dtype=bool))
    # of one instant: what rounding of its state makes of the loads, and of a pose that was looked for
    off = 0.0 if setup.rest is None else float(motion_error(Marks(layout), both.bodies, len(starts), layout.size)[0])
    estimate = Estimate(motion=off, **errors.estimate())
    seconds = {"integrate": 0.0 if setup.rest is None else setup.rest.seconds, "check": 0.0}
    return History(
        times, answers.at, tolerance, estimate, blows=blows[0], beside=tuple(blows[1:]), seconds=seconds,
        errors=errors.errors_by_cause(), compared=None if setup.steady else errors.last, notes=notes,
    )  # fmt: skip


def held(runner: Runner, t: float, state: Array) -> Array:
    """The contacts that are closed at a state, (contacts,)."""
    if not runner.layout.contacts:
        return np.zeros(0)
    from heuncli.motion.integration.contacts.contact_events import held_at  # few scenes have them

    return held_at(runner, t, state)


def require_followed(runner: Runner, run: Trajectory) -> None:
    """Raise SolveError where drives of one loop contradict each other within the run."""
    if len(runner.layout.mechanism.laws) > 1 and runner.layout.rows:
        from heuncli.motion.integration.check.contradictions import unfollowed  # few scenes need it

        problem = unfollowed(runner, run)
        if problem is not None:
            raise SolveError(problem)


def require_apart(runner: Runner, checked: CheckedRun) -> None:
    """Raise SolveError where the points of an actuator or spring come together within a motion, before its horizon.

    Or where a bushing passes half a turn.
    """
    if any(isinstance(load, PairLoad) for load in runner.layout.mechanism.loads):
        from heuncli.motion.integration.check.meeting_points import comes_together  # few scenes have them

        problem = comes_together(runner, checked.run, checked.horizon)
        if problem is not None:
            raise SolveError(problem)
    if any(isinstance(load, BushingLoad) for load in runner.layout.mechanism.loads):
        from heuncli.motion.integration.check.turned_over import turns_over

        if (problem := turns_over(runner, checked.run, checked.horizon)) is not None:
            raise SolveError(problem)


def resample(runner: Runner, history: History, times: Array, *, by_cause: bool = False) -> Recovered:
    """The kernel's answers at other instants within the run, (n,) ascending; in a state there is one instant only."""
    if history.checked is None:
        return history.recovered
    times = np.asarray(times, dtype=float)
    run = history.checked.run
    return recovered_at(runner, run, times, runner.resample(run, times), history.jumps, causes=by_cause)
