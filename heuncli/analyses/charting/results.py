"""What a chart of speed against accuracy holds: runs of one motion by several methods, each against a reference.

Errors are differences from the reference, at the asked instants up to where it is judged. The reference errs by at most
`own`, as two runs by different methods show. A run that is no farther from it errs by at most twice that, a bound and
no error of its own; from twice that on a difference is the run's error within half of it; between, twice `own` is told.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal

from heuncli.base import tolerances
from heuncli.base.records import record, replace

KINDS = ("motion", "reactions", "sections")  # whose errors are told, the first decides the front
Errors = Mapping[str, float | None]  # by kind; None: nothing is told of it, or it is open
Status = Literal["completed", "failed", "not run"]
COMPLETED: Status = "completed"
FAILED: Status = "failed"
NOT_RUN: Status = "not run"  # or not to its end
UNFINISHED = "unfinished"  # the code of what was begun, and ended by a limit
NOT_KNOWN: Errors = MappingProxyType(dict.fromkeys(KINDS))
DOUBTED = 2.0  # times the reference's own error: a larger difference is the run's error within half of it
SHOWN = 2  # digits of seconds and errors that are compared: those that tables show


@record
class ChartRow:
    """A method at one tolerance, or one step.

    attitude: how it is held within a step; fixed: whether `local` is the step [s], else the local tolerance.
    """

    method: str
    attitude: str
    fixed: bool
    local: float


@record
class ChartedRun:
    """A row with what came of it.

    seconds: processor time of the integration alone, the median of so many repeats; of what failed, until it did; of
    what was not run, as projected. error: by kind; bounded: the kinds of which it is a bound alone. at: the instant
    [s] at which it failed; code, reason: why it failed or was not run.
    """

    row: ChartRow
    status: Status
    seconds: float | None = None
    repeats: int = 0
    steps: int | None = None
    evaluations: int | None = None
    error: Errors = NOT_KNOWN
    bounded: frozenset[str] = frozenset()
    at: float | None = None
    code: str = ""
    reason: str = ""
    front: bool = False


@record
class Reference:
    """What the runs are held against.

    words: which runs agree how well, in a sentence; own: the error of the reference by kind; until: the last instant
    judged [s]; instants: how many are; horizon: where the two runs part, None if nowhere; notes: what else is worth
    knowing of it.
    """

    words: str
    own: Errors
    until: float
    instants: int
    horizon: float | None = None
    notes: tuple[str, ...] = ()

    def judged(self, apart: Errors) -> tuple[Errors, frozenset[str]]:
        """The errors of a run so far apart from the reference, and the kinds of which they are bounds alone."""
        error, bounded = dict(apart), set()
        for kind, own in self.own.items():
            difference = apart[kind]
            if own is None or difference is None:
                error[kind] = None
                continue
            error[kind] = max(difference, DOUBTED * own)
            if difference <= own:
                bounded.add(kind)
        return error, frozenset(bounded)


@record
class ChartResults:
    """A scene's chart; size [m]: of the scene, to which errors of motion are relative; notes: sentences below it."""

    title: str
    spec: Mapping[str, str]
    reference: Reference
    runs: tuple[ChartedRun, ...]
    size: float
    notes: tuple[str, ...] = ()

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of which the reference tells something."""
        return tuple(kind for kind in KINDS if self.reference.own[kind] is not None)

    @property
    def by_method(self) -> dict[str, list[ChartedRun]]:
        """The runs of each method, in their order."""
        found: dict[str, list[ChartedRun]] = {}
        for run in self.runs:
            found.setdefault(run.row.method, []).append(run)
        return found


def with_front(runs: Sequence[ChartedRun]) -> tuple[ChartedRun, ...]:
    """The runs, those marked that no other one beats: at least as fast, at least as accurate, and better in one.

    Seconds are measured and errors estimated: both are compared with the digits that are shown. Of runs that are equal
    in both the one with fewer evaluations counts as faster, and of those the first. A run that is lost is no result,
    however fast it was.
    """
    known = [run for run in runs if run.status == COMPLETED and is_near(run)]
    merits = {id(run): merit(run) for run in known}
    order = sorted(known, key=lambda run: merits[id(run)])
    best, front = float("inf"), set()
    for run in order:
        error = merits[id(run)][1]
        if error < best:
            best = error
            front.add(id(run))
    return tuple(replace(run, front=id(run) in front) for run in runs)


def is_near(run: ChartedRun) -> bool:
    """Whether the motion is known to be no more than the scene's size away."""
    error = run.error["motion"]
    return error is not None and error < tolerances.LOST


def merit(run: ChartedRun) -> tuple[float, float, int]:
    """Seconds, error of the motion, as shown, and evaluations: less is better."""
    error = run.error["motion"]
    assert run.seconds is not None and error is not None
    return shown(run.seconds), shown(error), run.evaluations or 0


def shown(value: float) -> float:
    """A number with the digits that tables show of it."""
    return float(f"{value:.{SHOWN - 1}e}")
