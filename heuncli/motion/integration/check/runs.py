"""Runs of one motion at several tolerances: the reported run A, its check runs B, and finer ones (estimate.py).

Where a run in fixed steps ended early, the step is too long, or no method can pass. A method with automatic steps is
tried: if it passes the instant, the step was too long. The fastest rate of the linearised motion at the start tells how
long the step may be, where that rate is too fast for it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.base.records import replace
from heuncli.motion.integration.check.run_comparison import MotionPoints
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import ClosuresLost, EventfulRun, MotionTask, StiffRun, StoppingRules
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.run.supervision import FEW_STAGES
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.response import tangent
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

# Runs

RATIO = 30.0  # local tolerance of A over that of B
FIRST_RATIO = 1.0  # local tolerance of the first run over the requested tolerance
MIN_RATIO = 4.0  # smallest such ratio: errors scale with tolerances, so 2 |A - B| is still 1.5 times A's error
MIN_STEP_RATIO = 2.0  # for a fixed step: at order 1, 2 |A - B| still equals the error of A
AUTOMATIC_TOLERANCE = 1e-6  # tolerance of a run with automatic steps, where fixed ones fail
COLLAPSE_CODES = ("step-collapsed", "closure-lost")  # how a run may end near a singular pose because of rounding
# a finer run that takes more than so many times the steps of the coarser one is dominated by rounding
MAX_STEP_GROWTH = 20


class Runs:
    """Runs of one motion at several tolerances. Between two runs, `method` and `eventful` may change."""

    def __init__(
        self, runner: Runner, times: Array, jumps: Sequence[float], deadline: float | None, method: Method = DOP853,
        *, step: float | None = None, watch_stiffness: bool = False,
    ) -> None:  # fmt: skip
        """times (n_t,), jumps: requested instants and discontinuities in time [s]
        deadline: by time.monotonic()
        step: of a method of fixed step [s]
        watch_stiffness: stop a run at the requested instants where another method takes less work (StiffRun)
        """
        self.runner, self.times, self.jumps, self.step = runner, times, jumps, step
        self.deadline, self.method, self.watch_stiffness = deadline, method, watch_stiffness
        self.eventful = False  # whether to stop where events end most steps, or no longer do (EventfulRun)
        self.last_check: Trajectory | None = None  # from the moved start
        self.perturbed_start, self.motion_points = perturb_start(runner.layout), MotionPoints(runner.layout)

    def run(
        self, local: float, check_times: Array | None = None, start: Array | None = None,
        most_steps: int = tolerances.MOST_STEPS, check_method: Method | None = None,
    ) -> Trajectory:  # fmt: skip
        """Run at a tolerance (or step) from the scene's start or another one (n,).

        check_times: other instants than the requested ones, for a check run. It runs as far as the run that it checks,
        even after the condition that ends the motion became true.
        check_method: another method
        """
        is_reported, times = check_times is None, self.times if check_times is None else check_times
        method = check_method or self.method
        may_be_repeated = start is self.perturbed_start and not method.has_fixed_step and needs_moved_run(method, local)
        request = MotionTask(
            times, local, method, self.jumps, start, self.deadline, most_steps,
            stores_polynomials=is_reported or may_be_repeated,
        )  # fmt: skip
        rules = StoppingRules(
            ending=is_reported, stiffness=is_reported and self.watch_stiffness, events=is_reported and self.eventful
        )
        return self.runner.run(request, rules)

    def run_first(self, tolerance: float) -> Trajectory:
        """Make the requested run; where it collapses at a singular position, a coarser one that passes it."""
        if self.step is not None:
            return self.run_fixed_steps(self.step)
        local = max(tolerance * FIRST_RATIO, tolerances.LEAST_TOLERANCE)
        try:
            return self.run(local)
        except SolveError as error:
            if self.method.is_determined:
                raise
            collapsed = self.runner.layout.rows and error.problems[0].code in COLLAPSE_CODES
            coarser = [local * RATIO**k for k in (1, 2, 3)] if collapsed else []
            for other in (x for x in coarser if x <= tolerances.COARSEST_RETRY):
                with contextlib.suppress(SolveError):
                    return self.run(other)
            if isinstance(error, ClosuresLost):
                # only on the way to an error
                from heuncli.motion.integration.check.contradictions import locate_contradiction

                lock = locate_contradiction(self.runner, error)
                lock.reached = error.reached
                raise lock from None
            raise

    def run_fixed_steps(self, step: float) -> Trajectory:
        """Make the run in steps of a given length."""
        try:
            return self.run(step)
        except SolveError as error:
            raise explain_fixed_step_error(
                error, self.runner, self.method, step, self.run_with_automatic_steps
            ) from None

    def run_with_automatic_steps(self) -> HeunError | None:
        """Return how the motion fails with automatic steps, as `auto` takes them; None if it reaches its end."""
        method, watch_stiffness = DOP853, True
        while True:
            try:
                Runs(
                    self.runner, self.times, self.jumps, self.deadline, method, watch_stiffness=watch_stiffness
                ).run_first(AUTOMATIC_TOLERANCE)
            except StiffRun as stiff:
                method, watch_stiffness = stiff.method, False
            except HeunError as error:
                return error
            else:
                return None

    def try_run(
        self,
        local: float,
        reference: Trajectory,
        check_times: Array | None,
        start: Array | None,
        check_method: Method | None = None,
    ) -> Trajectory | None:
        """Make a run of not many more steps than a reference; None where rounding makes it collapse, as near a singular
        position.
        """
        try:
            return self.run(local, check_times, start, MAX_STEP_GROWTH * reference.steps + 1000, check_method)
        except SolveError:
            return None
        except LimitError as limit:
            if limit.problems[0].code == "time-limit":
                raise
            return None

    def run_finer(self, a: Trajectory, factor: float) -> Trajectory | None:
        """Make a run whose tolerance is smaller by a factor; by that of check runs at least, and where the first one
        collapses.
        """
        for ratio in (factor, RATIO) if factor > RATIO else (RATIO,):
            run = self.try_run(max(a.local / ratio, tolerances.LEAST_TOLERANCE), a, None, None)
            if run is not None:
                return run
        return None

    def run_checks(self, a: Trajectory, check_times: Array) -> tuple[Trajectory, ...]:
        """Make the check run B of A, and before it a finer one where both would have the same errors.

        Where rounding prevents a finer run, a less fine one is used; without any, a coarser one: then the estimate is
        larger, never too small. A start moved by rounding may make what A holds exactly at rest oscillate so fast that
        no run can follow: then the start stays.
        """
        most, least = (
            (RATIO, MIN_RATIO) if not a.method.has_fixed_step else (float(tolerances.CHECK_STEPS), MIN_STEP_RATIO)
        )
        attempts = [(a.local / ratio, self.perturbed_start) for ratio in (most, least, 1.0 / most)]
        for local, start in (*attempts, (a.local / most, None)):
            run = self.try_run(local, a, check_times, start, a.method.check)
            if run is not None:
                self.last_check = run if start is self.perturbed_start else None
                return self.add_finest(a, run, check_times, start)
        return (self.run(a.local * most, check_times, check_method=a.method.check),)

    def add_finest(
        self, a: Trajectory, b: Trajectory, check_times: Array, start: Array | None
    ) -> tuple[Trajectory, ...]:
        """Return the check run B, and before it the finest possible run where B takes steps that A took.

        In common steps both have the same error, and their difference shows nothing. Steps are common where events
        determine them, not the tolerance. B counts as well: in a short pulse each run errs by the rounding of its own
        instants, and two may agree by chance.
        """
        if a.method.has_fixed_step or a.method.is_determined or not has_shared_steps(a.ends, b.ends):
            return (b,)
        if b.local <= tolerances.LEAST_TOLERANCE:
            return (b,)
        finest = self.try_run(tolerances.LEAST_TOLERANCE, a, check_times, start)
        return (b,) if finest is None else (finest, b)

    def run_from_moved_start(self, a: Trajectory, check_times: Array) -> Trajectory | None:
        """Make the run M: like A from the moved start, where rounding may matter; else None.

        If A is the finer run in place of one that missed the tolerance, that one's check run took the steps of M.
        """
        if not needs_moved_run(a.method, a.local):
            return None
        check = self.last_check
        if check is not None and is_same_run(check, a, check_times):
            with contextlib.suppress(SolveError):  # a step that cannot be repeated
                return replace(check, times=check_times, states=self.runner.resample(check, check_times))
        return self.try_run(a.local, a, check_times, self.perturbed_start)


def needs_moved_run(method: Method, local: float) -> bool:
    """Return whether rounding may matter in a run by this method at this local tolerance."""
    return not method.is_determined and (method.has_fixed_step or local < tolerances.ROUNDING_MATTERS)


def is_same_run(check: Trajectory, a: Trajectory, check_times: Array) -> bool:
    """Return whether a check run is the one that would follow A from the moved start, at other instants."""
    return (
        check.polynomials is not None
        and check.local == a.local
        and check.method is a.method
        and check.pushing_rope is None
        and check.times[-1] == check_times[-1]
        and check.steps <= MAX_STEP_GROWTH * a.steps
    )


def has_shared_steps(a: Array, b: Array) -> bool:
    """Return whether two runs, given by the ends of their steps, have a long step in common."""
    if not len(b):
        return False  # it was ended at its start
    begins, other_begins = (np.append(0.0, ends[:-1]) for ends in (a, b))
    is_long = a - begins > tolerances.SHARED_STEP * np.max(a - begins, initial=0.0)
    begin, end = begins[is_long], a[is_long]
    margin = tolerances.SAME_STEP * (end - begin)
    k = np.minimum(np.searchsorted(other_begins, begin - margin), len(b) - 1)
    return bool(np.any((np.abs(other_begins[k] - begin) <= margin) & (np.abs(b[k] - end) <= margin)))


@cache
def list_asymmetric_numbers(count: int) -> Array:
    """Return numbers between a half and one of either sign, without a pattern, (count,)."""
    fraction = np.modf(0.6180339887498949 * np.arange(1, count + 1))[0]
    numbers = np.where(fraction < 0.5, -1.0, 1.0) * (0.5 + np.modf(2.0 * fraction)[0] / 2.0)
    numbers.flags.writeable = False
    return np.asarray(numbers)


def perturb_start(layout: Layout) -> Array:
    """Return a start that differs from the given one by the rounding of its numbers; the run closes the closures again.

    It shows what an unstable start makes of rounding: upright at 180 degrees, A stays there for ever. Rates change by
    the rounding of the body's largest rate, so that what rests stays at rest. The direction has no symmetry: fractions
    of the golden section.
    """
    y = layout.y0.copy()
    direction = list_asymmetric_numbers(len(y))
    for group in layout.tables["groups"]:
        coordinates, rates, end = group["coordinates"], group["rates"], group["end"]
        unit = 1.0 / layout.weights[coordinates:end]
        size = np.maximum(np.abs(y[coordinates:rates]), unit[: rates - coordinates])
        largest = (np.abs(y[rates:end]) / unit[rates - coordinates :]).max(initial=0.0)
        scale = np.concatenate([size, largest * unit[rates - coordinates :]])
        y[coordinates:end] += tolerances.START_ROUNDING * direction[coordinates:end] * scale
    return y


# Given steps

# stable h |lambda| of explicit fixed-step methods: 2 for Euler's and Heun's, 2.5 for Heun3, 2.8 for RK4
STABILITY_LIMIT = 2.0
STEP_MESSAGES = {
    "not-a-number": "a motion in steps of {step:g} s has no finite acceleration after this instant",
    "closure-lost": "with steps of {step:g} s closed loops cannot be assembled after this instant",
    "stages-unsolved": "the equations of a step of {step:g} s cannot be solved: Newton's iteration does not converge",
}


def explain_fixed_step_error(
    error: SolveError,
    runner: Runner,
    method: Method,
    step: float,
    run_with_automatic_steps: Callable[[], HeunError | None],
) -> SolveError:
    """Return the error to report in place of that of a run in fixed steps [s], which ended at `error.reached`.

    run_with_automatic_steps: returns how the motion fails with automatic steps, None if it reaches its end; called only
    if needed
    """
    problem, t = error.problems[0], error.reached
    if problem.code not in STEP_MESSAGES or t is None:
        return error
    other = run_with_automatic_steps()
    end = other.reached if isinstance(other, SolveError) and other.reached is not None else None
    if isinstance(other, SolveError) and (end is None or end <= t + step):
        return other  # no step would pass, and this error says where and why
    message = f"at t = {t:.9g} s: {STEP_MESSAGES[problem.code].format(step=step)}"
    hint = f"{suggest_step(runner, method, step)}, or --method auto, which chooses its own"
    if other is None:
        hint += " and reaches the end"
    elif end is not None:
        hint += f"; but that stops {other.problems[0].message}"
        hint += f": {other.problems[0].hint}" if other.problems[0].hint else ""
    explained = SolveError(Problem(problem.code, message, hint=hint, entry_path="analysis.step"))
    explained.reached = t
    return explained


def suggest_step(runner: Runner, method: Method, step: float) -> str:
    """Say which steps to try in place of a step [s]."""
    rate = 0.0 if method.implicit else find_fastest_rate(runner)
    if rate * step > STABILITY_LIMIT:
        return f"the fastest rate at the start is {rate:.2g} 1/s: use steps of {STABILITY_LIMIT / rate:.1g} s or less"
    return f"use steps shorter than {step:g} s"


def find_fastest_rate(runner: Runner) -> float:
    """Return the largest eigenvalue magnitude of the linearised motion at the start [1/s]; 0 if it has none."""
    integrated_scene = runner.integrated_scene
    start = integrated_scene.restrict(0.0, runner.layout.y0)
    linearised = tangent(integrated_scene.workspace, 0.0, start)
    if not np.isfinite(linearised).all():
        return 0.0
    return float(np.abs(np.linalg.eigvals(linearised)).max(initial=0.0))


# Fewer stages

FEWER_STAGES_MESSAGE = (
    "events (contact, condition, jump, table point) end {cut} of the first {steps} steps; up to t = {t:.3g} s "
    "{name} takes {few} evaluations, {method} {many}"
)


def try_fewer_stages(runs: Runs, eventful: EventfulRun) -> bool:
    """Switch the runs to a method of few stages if it takes fewer evaluations, and record why; return whether it
    did.
    """
    method, jumps = load_method_by_name(FEW_STAGES), [t for t in runs.jumps if t < eventful.end_time]
    with suppress(SolveError, LimitError):
        most = eventful.evaluations // (len(method.nodes) - 1)
        request = MotionTask(
            [eventful.end_time], eventful.local, method, jumps, deadline=runs.deadline, most_steps=most
        )
        trial = runs.runner.run(request, StoppingRules())
        if trial.evaluations < eventful.evaluations:
            eventful.reason = FEWER_STAGES_MESSAGE.format(
                cut=eventful.cut, steps=eventful.steps, t=eventful.end_time, name=method.name, few=trial.evaluations,
                method=runs.method.name, many=eventful.evaluations,
            )  # fmt: skip
            runs.method = method
            return True
    return False
