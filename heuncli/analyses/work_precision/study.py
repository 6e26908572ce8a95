"""Speed against accuracy: run several methods at several tolerances, or steps, on a scene's own motion.

Each run is compared with a reference that is itself verified, then repeated in turns, to measure its time. A failure
becomes a row with its instant and reason, and so does a run that would take too long. Impure: reads the clock.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from importlib import import_module

from heuncli.analyses.work_precision import plan as chart_plan
from heuncli.analyses.work_precision.plan import ChartOptions, MotionProblem, make_motion, plan_chart
from heuncli.analyses.work_precision.reference import VerifiedReference, find_reference
from heuncli.analyses.work_precision.results import (
    COMPLETED,
    FAILED,
    NOT_RUN,
    UNFINISHED,
    ChartResults,
    ChartRow,
    ChartRun,
    mark_front,
)
from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED, Method, load_method_by_name
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import attach_locations

MIN_LIMIT_SECONDS = 1.0  # time limit of a run, or LIMIT_FACTOR times the reference's time, if longer
LIMIT_FACTOR = 5.0
MIN_PROCESSOR_SHARE, MAX_PATIENCE = 0.5, 10.0  # least share of processor time in wall time; below, a run gets more time
REPEATS, REPEAT_SECONDS = (3, 25), 0.06  # of each run: least and most, and the time for them
MAX_SPREAD = 0.03  # interquartile range relative to the median, below which the median is accepted
FOLLOWED_TOLERANCE = 1e-9  # of a motion solved instant by instant: without effect
ReportProgress = Callable[[int, int, str], None]  # steps done, steps in all, name of the current step


@record
class TimedRun:
    """A run that is being repeated: its row, the function that repeats it, and the processor seconds so far."""

    chart_run: ChartRun
    repeat: Callable[[], float]
    seconds: list[float]

    @property
    def is_timed(self) -> bool:
        """Whether the median is known well enough, or the time for it is used up."""
        least, most = REPEATS
        n, used = len(self.seconds), sum(self.seconds)
        if n >= most or used > REPEAT_SECONDS:
            return True
        if n < least:
            return False
        low, middle, high = statistics.quantiles(self.seconds, n=4)
        return high - low <= MAX_SPREAD * middle

    @property
    def timed_run(self) -> ChartRun:
        """The run with the median of its times."""
        return replace(self.chart_run, seconds=statistics.median(self.seconds), repeats=len(self.seconds))


class ChartRunner:
    """Runs the rows of a plan on a motion. Impure: remembers the times of earlier rows of each method."""

    def __init__(self, motion: MotionProblem, verified: VerifiedReference, report_progress: ReportProgress) -> None:
        self.motion, self.verified, self.report_progress = motion, verified, report_progress
        self.limit = max(MIN_LIMIT_SECONDS, LIMIT_FACTOR * verified.seconds)
        self.completed: dict[str, ChartRun] = {}  # the last completed row of each method
        self.unfinished: dict[str, ChartRow] = {}  # the first row of each method that exceeded the limit

    def run_all(self, rows: Sequence[ChartRow]) -> tuple[ChartRun, ...]:
        """Run each row, in order: completed, with its time; failed; or not run, with the reason."""
        outcomes: list[ChartRun | TimedRun] = []
        for k, row in enumerate(rows):
            self.report_progress(k, 2 * len(rows), row.method)
            outcomes.append(self.run_row(row))
        waiting = [each for each in outcomes if isinstance(each, TimedRun) and not each.is_timed]
        waiting_count = len(waiting)
        while waiting and not self.motion.late:
            self.report_progress(2 * len(rows) - len(rows) * len(waiting) // waiting_count, 2 * len(rows), "times")
            for each in waiting:
                if self.motion.late:  # checked between runs, too: a round of many runs would exceed the limit
                    break
                each.seconds.append(each.repeat())
            waiting = [each for each in waiting if not each.is_timed]
        return tuple(each.timed_run if isinstance(each, TimedRun) else each for each in outcomes)

    def run_row(self, row: ChartRow) -> ChartRun | TimedRun:
        """Run one row: not run, failed, or timed once."""
        skipped = self.skip_if_too_long(row)
        if skipped is not None:
            return skipped
        preload_method(row)
        start = time.process_time()
        try:
            return self.compare_run(row, *self.run_first(row))
        except HeunError as error:
            return self.make_failure(row, error, time.process_time() - start)

    def run_first(self, row: ChartRow) -> tuple[Runs, Trajectory, float]:
        """Run a row for the first time; repeat it with more patience if other work took the processor."""
        patience = 1.0
        while True:
            runs = self.make_runs(row, patience)
            start = time.process_time()
            try:
                return runs, self.run(row, runs), time.process_time() - start
            except LimitError as error:
                share = (time.process_time() - start) / self.limit
                if (
                    patience > 1.0
                    or share > MIN_PROCESSOR_SHARE
                    or self.motion.late
                    or error.problems[0].code != "time-limit"
                ):
                    raise
                patience = min(1.0 / max(share, 1e-3), MAX_PATIENCE)

    def compare_run(self, row: ChartRow, runs: Runs, run: Trajectory, seconds: float) -> ChartRun | TimedRun:
        """Compare a row that completed, or ended where a rope would have to push."""
        chart_run = ChartRun(row, COMPLETED, seconds, 1, run.steps, run.evaluations)
        self.completed[row.method] = chart_run
        last = float(self.verified.comparison.times[-1])
        if float(run.times[-1]) < last:
            reason = f"the rope {run.pushing_rope} would have to push; the reference continues to t = {last:.6g} s"
            return replace(chart_run, status=FAILED, failure_time=float(run.times[-1]), code="stopped", reason=reason)
        error, upper_bounds = self.verified.reference.to_errors(self.verified.comparison.compute_differences(run))
        return TimedRun(
            replace(chart_run, error=error, upper_bounds=upper_bounds), lambda: self.time_run(row, runs), [seconds]
        )

    def make_runs(self, row: ChartRow, patience: float) -> Runs:
        """Return runs by a row's method, which share what is prepared once."""
        return self.motion.make_runs(get_method(row), patience * self.limit)

    def run(self, row: ChartRow, runs: Runs) -> Trajectory:
        """Run the motion by a row's method, over the instants that are compared with the reference."""
        return runs.run(row.local or FOLLOWED_TOLERANCE, self.verified.comparison.times)

    def time_run(self, row: ChartRow, runs: Runs) -> float:
        """Return the processor time of one more run of a row that completed before."""
        runs.deadline = None
        start = time.process_time()
        self.run(row, runs)
        return time.process_time() - start

    def make_failure(self, row: ChartRow, error: HeunError, seconds: float) -> ChartRun:
        """Return a row that did not complete: it failed, was cut short, or its method cannot run such a scene."""
        problem = error.problems[0]
        if isinstance(error, LimitError):
            late = self.motion.late
            self.unfinished.setdefault(row.method, row)
            reason = "the time limit was reached" if late else f"not finished within {self.limit:.2g} s"
            return ChartRun(
                row, NOT_RUN, seconds, code=UNFINISHED, reason=f"{reason}:{extract_progress(problem.message)}"
            )
        status = FAILED if isinstance(error, SolveError) else NOT_RUN
        failure_time = getattr(error, "reached", None)
        return ChartRun(row, status, seconds, failure_time=failure_time, code=problem.code, reason=problem.message)

    def skip_if_too_long(self, row: ChartRow) -> ChartRun | None:
        """Return the row as not run if it would exceed its limit, else None."""
        if self.motion.late:
            return ChartRun(row, NOT_RUN, code="time-limit", reason="the time limit was already reached")
        last = float(self.verified.comparison.times[-1])
        if row.has_fixed_step and row.local > last:
            return ChartRun(row, NOT_RUN, code="step", reason=f"the step is longer than the run of {last:.6g} s")
        unfinished_row = self.unfinished.get(row.method)
        if unfinished_row is not None and row.local <= unfinished_row.local:
            setting = "step" if row.has_fixed_step else "tolerance"
            return ChartRun(
                row, NOT_RUN, code="too-long", reason=f"the run with {setting} {unfinished_row.local:g} did not finish"
            )
        previous = self.completed.get(row.method)
        steps = self.predict_steps(row, previous)
        if steps is None:
            return None
        seconds_per_step = self.verified.seconds / max(self.verified.comparison.reference.steps, 1) / 12.0
        if previous is not None and previous.seconds is not None and previous.steps:
            seconds_per_step = previous.seconds / previous.steps
        seconds = steps * seconds_per_step
        if steps <= tolerances.MOST_STEPS and seconds <= self.limit:
            return None
        step_text = f"about {steps:.0e} steps".replace("e+0", "e").replace("e+", "e")
        reason = (
            f"{step_text}, {seconds:.2g} s" if steps <= tolerances.MOST_STEPS else f"{step_text}, more than allowed"
        )
        return ChartRun(row, NOT_RUN, seconds, code="too-long", reason=reason)

    def predict_steps(self, row: ChartRow, previous: ChartRun | None) -> float | None:
        """Predict the number of steps of a row; None if nothing is known."""
        if row.has_fixed_step:
            return float(math.ceil(self.verified.comparison.times[-1] / row.local))
        if previous is None or not previous.steps or row.method == chart_plan.FOLLOWED:
            return None
        return float(previous.steps * (previous.row.local / row.local) ** (1.0 / chart_plan.get_order(row.method)))


def get_method(row: ChartRow) -> Method:
    """Return the method of a row."""
    return DRIVE_DETERMINED if row.method == chart_plan.FOLLOWED else load_method_by_name(row.method)


def preload_method(row: ChartRow) -> None:
    """Import what must not count as part of a run's time: SciPy takes half a second."""
    if get_method(row).scipy_name:
        import_module("scipy.integrate")


def extract_progress(message: str) -> str:
    """Return the part of a message that says at which instant a run was cut short; else empty."""
    _, separator, rest = message.partition(" at t = ")
    return f"{separator}{rest}" if separator else ""


DRIVEN_NOTE = (
    "motion fully prescribed: heun run solves each instant (followed), nothing integrated; the other "
    "rows show what integrating it would cost"
)


def chart(
    spec: Spec, options: ChartOptions, report_progress: ReportProgress = lambda done, of, what: None
) -> ChartResults:
    """Return the chart of a spec. Raises SpecError, SolveError, LimitError if there is none."""
    with attach_locations(spec):
        return make_chart(spec, options, report_progress)


def make_chart(spec: Spec, options: ChartOptions, report_progress: ReportProgress) -> ChartResults:
    """Return the chart of a spec. Errors name bodies, joints and sections, but not their location in the file."""
    deadline = None if options.time_limit is None else time.monotonic() + options.time_limit
    motion = make_motion(spec, deadline)
    chart_plan = plan_chart(motion, options)
    report_progress(0, 1, "reference")
    verified = find_reference(motion)
    runs = ChartRunner(motion, verified, report_progress).run_all(chart_plan.rows)
    return ChartResults(
        title=spec.title,
        spec={"path": spec.path, "sha256": spec.sha256},
        reference=verified.reference,
        runs=mark_front(runs),
        size=motion.setup.scene.layout.size,
        notes=(*([DRIVEN_NOTE] if motion.is_determined else []), *chart_plan.notes),
    )
