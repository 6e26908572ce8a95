"""One difference between two runs, in words and numbers; and the differences of a quantity over the whole course."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import append_unit
from heuncli.output.snapshots.golden_file import NumberSnapshot, RunSnapshot, Value

SAME_INSTANTS = 1e-6  # share of the run: closer even instants of two runs are the same


class Change(NamedTuple):
    """One difference between two runs: its path, which value of it, before and after.

    tolerance: by how much the two may differ
    reason: in words, if the two are not numbers that differ
    n_similar: number of further changed values of the same quantity
    time: the instant of the value, if it has one
    """

    path: str
    what: str
    unit: str
    old: Value | str | None
    new: Value | str | None
    tolerance: float | None = None
    reason: str = ""
    n_similar: int = 0
    time: float | None = None

    @property
    def difference(self) -> float | None:
        """New minus old; None if the two are not numbers."""
        if isinstance(self.old, str) or isinstance(self.new, str) or self.old is None or self.new is None:
            return None
        return self.new - self.old

    @property
    def relative(self) -> float:
        """The difference over the larger of the two; infinite without numbers, so that these changes come first."""
        if self.difference is None or isinstance(self.old, str) or isinstance(self.new, str):
            return float("inf")
        return abs(self.difference) / max(abs(self.old or 0.0), abs(self.new or 0.0))

    @property
    def excess(self) -> float:
        """The difference over the tolerance; infinite without one."""
        if self.difference is None or not self.tolerance:
            return float("inf")
        return abs(self.difference) / self.tolerance


def format_value(value: Value | str | None, unit: str) -> str:
    """Format a value to nine digits with its unit; a word stays as it is."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return append_unit(f"{value:.9g}", unit)


def format_difference(change: Change) -> str:
    """Format the difference, and its percentage of the old value."""
    difference = change.difference
    if difference is None or not difference:
        return ""
    return f"{append_unit(f'{difference:+.3g}', change.unit)} ({format_percent(change)})"


def format_percent(change: Change) -> str:
    """Format the change relative to the old value in percent; a change from zero in words."""
    old, difference = change.old, change.difference
    if difference is None or isinstance(old, str) or not old or not math.isfinite(difference / old):
        return "from 0" if difference is not None else ""
    percent = 100.0 * difference / abs(old)
    return f"{percent:+.3g} %"


def describe_failure(change: Change) -> str:
    """Return the sentence that says what is wrong."""
    if change.reason:
        return change.reason
    more = f"; {change.n_similar} more values changed" if change.n_similar else ""
    return f"changed by {format_difference(change)}, allowed {change.tolerance or 0.0:.3g}{more}"


def find_course_changes(
    path: str,
    pair: tuple[NumberSnapshot, NumberSnapshot],
    runs: Sequence[RunSnapshot],
    tolerance: float,
    *,
    by_error: bool,
) -> Iterator[Change]:
    """Yield the differences of two courses: instants of extremes, means of tenths, mean square, mean, first moment.

    tolerance: at one instant
    by_error: whether that is the sum of the stated errors

    Values that one of them lacks, or holds as a word, are not compared here.
    """
    old, new = pair
    if old.constant is not None or new.constant is not None or have_different_instants(runs):
        return  # the extremes of a constant say everything
    if by_error:
        yield from _find_moved_extremes(path, pair)
    yield from _compare_tenths(path, pair, runs, tolerance)
    if old.mean_square is not None and new.mean_square is not None:
        size = math.sqrt(max(old.mean_square, new.mean_square))
        bound = 2.0 * tolerance * size + tolerance * tolerance + tolerances.SUM_ROUNDING * size * size
        if not abs(new.mean_square - old.mean_square) <= bound:
            yield Change(path, "mean square", f"({old.unit})²", old.mean_square, new.mean_square, bound)
    if old.mean_error is None or new.mean_error is None:
        return
    bound = tolerance + old.mean_error + new.mean_error
    for what, before, after in (("mean", old.mean, new.mean), ("first moment", old.moment, new.moment)):
        if before is not None and after is not None and not abs(after - before) <= bound:
            yield Change(path, what, old.unit, before, after, bound)


def _find_moved_extremes(path: str, pair: tuple[NumberSnapshot, NumberSnapshot]) -> Iterator[Change]:
    """Yield the extremes whose value is unchanged but whose instant is not."""
    for word in ("least", "greatest"):
        times, errors = ([getattr(number, f"{word}_at{key}") for number in pair] for key in ("", "_error"))
        if None in times or None in errors:
            continue
        tolerance = max(errors) + 4.0 * tolerances.EPS * max(map(abs, times))
        if not abs(times[1] - times[0]) <= tolerance:
            yield Change(path, f"time of {word}", "s", times[0], times[1], tolerance)


def _compare_tenths(
    path: str, pair: tuple[NumberSnapshot, NumberSnapshot], runs: Sequence[RunSnapshot], tolerance: float
) -> Iterator[Change]:
    """Compare the means over the tenths of a run."""
    old, new = (number.tenths for number in pair)
    if len(old) != len(new):
        return
    ends = runs[0].even_at
    size = max((abs(x) for x in (*old, *new) if not isinstance(x, str)), default=0.0)
    bound = tolerance + tolerances.SUM_ROUNDING * size
    for k, (before, after) in enumerate(zip(old, new, strict=True)):
        if isinstance(before, str) or isinstance(after, str) or abs(after - before) <= bound:
            continue
        what = f"mean from t = {ends[k]:.6g} to {ends[k + 1]:.6g} s" if len(ends) > k + 1 else f"mean of tenth {k + 1}"
        yield Change(path, what, pair[0].unit, before, after, bound)


def have_different_instants(runs: Sequence[RunSnapshot]) -> bool:
    """Return whether the even instants of two runs differ."""
    old, new = (run.even_at for run in runs)
    if len(old) != len(new):
        return True
    return bool(old) and any(abs(a - b) > SAME_INSTANTS * (old[-1] - old[0]) for a, b in zip(old, new, strict=True))
