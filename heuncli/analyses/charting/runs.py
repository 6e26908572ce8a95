"""The runs of a chart: each once, against the reference; then again in turns, for its time.

What fails is a row with its instant and its reason; what would take too long is not run, and a row as well. Impure:
looks at the clock.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from importlib import import_module

from heuncli.analyses.charting import plan as chart_plan
from heuncli.analyses.charting.motion import ChartedMotion
from heuncli.analyses.charting.reference import JudgedReference
from heuncli.analyses.charting.results import COMPLETED, FAILED, NOT_RUN, UNFINISHED, ChartedRun, ChartRow
from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.followed import FOLLOWED
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.trajectory import Trajectory

SECONDS = 1.0  # a run may take, or so many times what the reference took, if that is more
TIMES = 5.0
STARVED, MOST_PATIENCE = 0.5, 10.0  # of its seconds on the clock a run had the processor; then it may take longer
REPEATS, REPEAT_SECONDS = (3, 25), 0.06  # of each run: least and most, and the time for them
SPREAD = 0.03  # between the quartiles, of the median: then it is known
LOCAL = 1e-9  # of what is followed: any, for nothing hangs on it
Tell = Callable[[int, int, str], None]  # how much of how much is done, and what is under way


@record
class TimedRun:
    """A run under repetition: its row, what is repeated, and the processor seconds so far."""

    charted: ChartedRun
    again: Callable[[], float]
    seconds: list[float]

    @property
    def settled(self) -> bool:
        """Whether the median is known, or the time for it is used up."""
        least, most = REPEATS
        n, used = len(self.seconds), sum(self.seconds)
        if n >= most or used > REPEAT_SECONDS:
            return True
        if n < least:
            return False
        low, middle, high = statistics.quantiles(self.seconds, n=4)
        return high - low <= SPREAD * middle

    @property
    def done(self) -> ChartedRun:
        """The run with the median of its times."""
        return replace(self.charted, seconds=statistics.median(self.seconds), repeats=len(self.seconds))


class ChartRuns:
    """Runs the rows of a plan on a motion. Impure: keeps what earlier rows of a method took."""

    def __init__(self, motion: ChartedMotion, referred: JudgedReference, tell: Tell) -> None:
        self.motion, self.referred, self.tell = motion, referred, tell
        self.limit = max(SECONDS, TIMES * referred.seconds)
        self.before: dict[str, ChartedRun] = {}  # of each method the last row that came to its end
        self.unfinished: dict[str, ChartRow] = {}  # and the first that did not within the limit

    def all(self, rows: Sequence[ChartRow]) -> tuple[ChartedRun, ...]:
        """Each row's run, in the order of the rows: completed, with its time; failed; or not run, with the reason."""
        found: list[ChartedRun | TimedRun] = []
        for k, row in enumerate(rows):
            self.tell(k, 2 * len(rows), row.method)
            found.append(self.one(row))
        waiting = [each for each in found if isinstance(each, TimedRun) and not each.settled]
        many = len(waiting)
        while waiting and not self.motion.late:
            self.tell(2 * len(rows) - len(rows) * len(waiting) // many, 2 * len(rows), "times")
            for each in waiting:
                if self.motion.late:  # between two of a round, too: a round of many runs would outlast the limit
                    break
                each.seconds.append(each.again())
            waiting = [each for each in waiting if not each.settled]
        return tuple(each.done if isinstance(each, TimedRun) else each for each in found)

    def one(self, row: ChartRow) -> ChartedRun | TimedRun:
        """One row: not run, failed, or timed once."""
        too_long = self.too_long(row)
        if too_long is not None:
            return too_long
        ready(row)
        begun = time.process_time()
        try:
            return self.judged(row, *self.first(row))
        except HeunError as error:
            return self.failed(row, error, time.process_time() - begun)

    def first(self, row: ChartRow) -> tuple[Runs, Trajectory, float]:
        """The first run of a row and its time; once more where other work on the machine took the time it may take."""
        patience = 1.0
        while True:
            runs = self.runs(row, patience)
            begun = time.process_time()
            try:
                return runs, self.run(row, runs), time.process_time() - begun
            except LimitError as error:
                share = (time.process_time() - begun) / self.limit
                if patience > 1.0 or share > STARVED or self.motion.late or error.problems[0].code != "time-limit":
                    raise
                patience = min(1.0 / max(share, 1e-3), MOST_PATIENCE)

    def judged(self, row: ChartRow, runs: Runs, run: Trajectory, seconds: float) -> ChartedRun | TimedRun:
        """A row that came to its end, or to where a rope would push."""
        charted = ChartedRun(row, COMPLETED, seconds, 1, run.steps, run.evaluations)
        self.before[row.method] = charted
        last = float(self.referred.judge.times[-1])
        if float(run.times[-1]) < last:
            reason = f"the rope {run.stopped} would have to push; the reference goes on to t = {last:.6g} s"
            return replace(charted, status=FAILED, at=float(run.times[-1]), code="stopped", reason=reason)
        error, bounded = self.referred.reference.judged(self.referred.judge.apart(run))
        return TimedRun(replace(charted, error=error, bounded=bounded), lambda: self.seconds(row, runs), [seconds])

    def runs(self, row: ChartRow, patience: float) -> Runs:
        """Runs by a row's method, with what is made ready once."""
        return self.motion.runs(method_by(row), patience * self.limit)

    def run(self, row: ChartRow, runs: Runs) -> Trajectory:
        """The motion by a row's method, over the instants at which it is compared with the reference."""
        return runs.run(row.local or LOCAL, self.referred.judge.times)

    def seconds(self, row: ChartRow, runs: Runs) -> float:
        """Processor time of one more run, which has come to its end before."""
        runs.deadline = None
        begun = time.process_time()
        self.run(row, runs)
        return time.process_time() - begun

    def failed(self, row: ChartRow, error: HeunError, seconds: float) -> ChartedRun:
        """A row that did not come to its end: it failed, was cut short, or its method takes no such scene."""
        problem = error.problems[0]
        if isinstance(error, LimitError):
            late = self.motion.late
            self.unfinished.setdefault(row.method, row)
            reason = "the time limit was reached" if late else f"not finished within {self.limit:.2g} s"
            return ChartedRun(row, NOT_RUN, seconds, code=UNFINISHED, reason=f"{reason}:{progress(problem.message)}")
        status = FAILED if isinstance(error, SolveError) else NOT_RUN
        at = getattr(error, "reached", None)
        return ChartedRun(row, status, seconds, at=at, code=problem.code, reason=problem.message)

    def too_long(self, row: ChartRow) -> ChartedRun | None:
        """The row as one that is not run, where it would take longer than it may."""
        if self.motion.late:
            return ChartedRun(row, NOT_RUN, code="time-limit", reason="the time limit was reached before")
        last = float(self.referred.judge.times[-1])
        if row.fixed and row.local > last:
            return ChartedRun(row, NOT_RUN, code="step", reason=f"the step is longer than the run of {last:.6g} s")
        longer = self.unfinished.get(row.method)
        if longer is not None and row.local <= longer.local:
            of = "step" if row.fixed else "tolerance"
            return ChartedRun(row, NOT_RUN, code="too-long", reason=f"a {of} of {longer.local:g} was not finished")
        before = self.before.get(row.method)
        steps = self.projected(row, before)
        if steps is None:
            return None
        a_step = self.referred.seconds / max(self.referred.judge.reference.steps, 1) / 12.0
        if before is not None and before.seconds is not None and before.steps:
            a_step = before.seconds / before.steps
        seconds = steps * a_step
        if steps <= tolerances.MOST_STEPS and seconds <= self.limit:
            return None
        about = f"about {steps:.0e} steps".replace("e+0", "e").replace("e+", "e")
        reason = f"{about}, {seconds:.2g} s" if steps <= tolerances.MOST_STEPS else f"{about}, more than are taken"
        return ChartedRun(row, NOT_RUN, seconds, code="too-long", reason=reason)

    def projected(self, row: ChartRow, before: ChartedRun | None) -> float | None:
        """How many steps a row will take; None where nothing tells."""
        if row.fixed:
            return float(math.ceil(self.referred.judge.times[-1] / row.local))
        if before is None or not before.steps or row.method == chart_plan.FOLLOWED:
            return None
        return float(before.steps * (before.row.local / row.local) ** (1.0 / chart_plan.order_of(row.method)))


def method_by(row: ChartRow) -> Method:
    """A row's method."""
    return FOLLOWED if row.method == chart_plan.FOLLOWED else method_of(row.method)


def ready(row: ChartRow) -> None:
    """Load what is no part of a run's time: SciPy takes half a second, which the first run by it would have."""
    if method_by(row).foreign:
        import_module("scipy.integrate")


def progress(message: str) -> str:
    """The words of a message that tell at which instant a run was cut short, and what follows them; else empty."""
    _, at, behind = message.partition(" at t = ")
    return f"{at}{behind}" if at else ""
