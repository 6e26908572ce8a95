"""Compare the courses of a quantity in two runs: its means, its mean square, the instants of its extremes.

Two runs whose numbers differ by no more than E at every instant have means that differ by no more than E, and mean
squares that differ by no more than 2 E |mean of magnitudes| + E². Their extremes lie at instants at which the other run
reaches the same value within 2 E.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.golden_file import N_EVEN, NumberSnapshot, RunSnapshot

N_TENTHS = N_EVEN - 1
SAME_INSTANTS = 1e-6  # as a share of the run


def find_course_changes(
    path: str,
    pair: tuple[NumberSnapshot, NumberSnapshot],
    runs: Sequence[RunSnapshot],
    tolerance: float,
    *,
    by_error: bool,
) -> Iterator[Change]:
    """Yield the differences of two courses.

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
