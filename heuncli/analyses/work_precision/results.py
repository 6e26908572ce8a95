"""Results of a chart of speed versus accuracy: runs of one motion by several methods, each compared with a reference.

Errors are differences from the reference at the requested instants, up to where it is valid. The reference's error is
at most its `error`, as two runs by different methods show. A run that differs by less has an error of at most twice
that, which is only a bound; a difference of more than twice that is the run's error within half of it; in between,
twice the reference's error is reported.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal

from heuncli.base import tolerances
from heuncli.base.records import record, replace

KINDS = ("motion", "reactions", "sections")  # kinds of errors; the first decides the front
Errors = Mapping[str, float | None]  # by kind; None: not known, or indeterminate
Status = Literal["completed", "failed", "not run"]
COMPLETED: Status = "completed"
FAILED: Status = "failed"
NOT_RUN: Status = "not run"  # or not to its end
UNFINISHED = "unfinished"  # the code of a run that a limit ended
NOT_KNOWN: Errors = MappingProxyType(dict.fromkeys(KINDS))
DOUBT_FACTOR = 2.0  # times the reference's own error: a larger difference is the run's error within half of it
SHOWN_DIGITS = 2  # digits of seconds and errors that are compared: those that tables show


@record
class ChartRow:
    """A method at one tolerance, or one step.

    attitude: how attitudes are represented within a step
    has_fixed_step: whether `local` is the step [s] or the local tolerance
    """

    method: str
    attitude: str
    has_fixed_step: bool
    local: float


@record
class ChartRun:
    """A row and its outcome.

    seconds: processor time of the integration alone, median over the repeats; until failure if it failed; estimated if
    it was not run
    error: error by kind; upper_bounds: the kinds for which it is only a bound
    failure_time [s]: instant of failure; code, reason: why it failed or was not run
    front: whether no other run is better
    """

    row: ChartRow
    status: Status
    seconds: float | None = None
    repeats: int = 0
    steps: int | None = None
    evaluations: int | None = None
    error: Errors = NOT_KNOWN
    upper_bounds: frozenset[str] = frozenset()
    failure_time: float | None = None
    code: str = ""
    reason: str = ""
    front: bool = False


@record
class Reference:
    """The reference of a chart.

    description: which runs agree, and how well
    error: the reference's error by kind
    last_time [s]: last instant compared; instants: their number
    horizon [s]: where the two runs diverge, None if nowhere
    notes: further remarks
    """

    description: str
    error: Errors
    last_time: float
    instants: int
    horizon: float | None = None
    notes: tuple[str, ...] = ()

    def to_errors(self, differences: Errors) -> tuple[Errors, frozenset[str]]:
        """Convert the differences of a run from the reference to its errors, and the kinds for which they are only
        bounds.
        """
        error, upper_bounds = dict(differences), set()
        for kind, reference_error in self.error.items():
            difference = differences[kind]
            if reference_error is None or difference is None:
                error[kind] = None
                continue
            error[kind] = max(difference, DOUBT_FACTOR * reference_error)
            if difference <= reference_error:
                upper_bounds.add(kind)
        return error, frozenset(upper_bounds)


@record
class ChartResults:
    """The chart of a scene.

    size [m]: the scene's size, to which errors of motion are relative
    notes: sentences below the chart
    """

    title: str
    spec: Mapping[str, str]
    reference: Reference
    runs: tuple[ChartRun, ...]
    size: float
    notes: tuple[str, ...] = ()

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of errors for which the reference has a value."""
        return tuple(kind for kind in KINDS if self.reference.error[kind] is not None)

    @property
    def runs_by_method(self) -> dict[str, list[ChartRun]]:
        """The runs of each method, in order."""
        found: dict[str, list[ChartRun]] = {}
        for run in self.runs:
            found.setdefault(run.row.method, []).append(run)
        return found


def mark_front(runs: Sequence[ChartRun]) -> tuple[ChartRun, ...]:
    """Mark the runs that no other run beats: at least as fast, at least as accurate, and better in one of both.

    Times are measured and errors estimated, so both are compared with the digits shown. Of runs equal in both, the one
    with fewer evaluations counts as faster, then the first. A diverged run is never marked.
    """
    known = [run for run in runs if run.status == COMPLETED and has_finite_error(run)]
    merit_by_id = {id(run): compute_merit(run) for run in known}
    order = sorted(known, key=lambda run: merit_by_id[id(run)])
    best, front = float("inf"), set()
    for run in order:
        error = merit_by_id[id(run)][1]
        if error < best:
            best = error
            front.add(id(run))
    return tuple(replace(run, front=id(run) in front) for run in runs)


def has_finite_error(run: ChartRun) -> bool:
    """Return whether the motion is known to be no farther from the reference than the scene's size."""
    error = run.error["motion"]
    return error is not None and error < tolerances.LOST


def compute_merit(run: ChartRun) -> tuple[float, float, int]:
    """Return time and error of the motion as shown, and evaluations: smaller is better."""
    error = run.error["motion"]
    assert run.seconds is not None and error is not None
    return round_as_shown(run.seconds), round_as_shown(error), run.evaluations or 0


def round_as_shown(value: float) -> float:
    """Round a number to the digits that tables show."""
    return float(f"{value:.{SHOWN_DIGITS - 1}e}")


def format_setting(row: ChartRow) -> str:
    """Format the tolerance of a run, or its step with the unit; one of a single digit as 1e-6."""
    if row.local == 0.0:
        return "-"
    if row.has_fixed_step:
        return f"{row.local:g} s"
    power = f"{row.local:.0e}"
    is_round = float(power) == row.local
    return power.replace("e-0", "e-").replace("e+0", "e").replace("e0", "") if is_round else f"{row.local:g}"


def remove_instant(run: ChartRun) -> str:
    """Return the reason of a run without the instant that it may begin with."""
    prefix, colon, reason = run.reason.partition(": ")
    return reason if colon and prefix.startswith("at t = ") else run.reason


def make_remark(run: ChartRun) -> str:
    """Return why a run did not end."""
    if run.status == COMPLETED:
        return ""
    if run.status == FAILED:
        instant_text = f" at t = {run.failure_time:.6g} s" if run.failure_time is not None else ""
        return f"fails{instant_text}: {remove_instant(run)}"
    return run.reason if run.code == UNFINISHED else f"not run: {run.reason}"
