"""What of the whole course of a quantity differs between two runs: its means, its mean square, when its extremes are.

Two runs whose numbers differ by no more than E at every instant have means that differ by no more than E, mean squares
by no more than 2 E |mean of magnitudes| + E², and extremes at instants at which the other run is as high but for 2 E.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.kept import EVEN, KeptNumber, KeptRun

TENTHS = EVEN - 1
SAME_INSTANTS = 1e-6  # of a run: even instants of runs whose ends differ by no more are the same


def course_changes(
    path: str, pair: tuple[KeptNumber, KeptNumber], runs: Sequence[KeptRun], allowed: float, *, by_error: bool
) -> Iterator[Change]:
    """What differs of two courses; allowed: at one instant; by_error: whether that is the error that both state.

    What one of them does not hold, or holds as a word, is not compared: its verdict stands elsewhere.
    """
    old, new = pair
    if old.constant is not None or new.constant is not None or at_other_instants(runs):
        return  # its extremes say all of a constant
    if by_error:
        yield from _moved_extremes(path, pair)
    yield from _tenths(path, pair, runs, allowed)
    if old.mean_square is not None and new.mean_square is not None:
        size = math.sqrt(max(old.mean_square, new.mean_square))
        bound = 2.0 * allowed * size + allowed * allowed + tolerances.SUM_ROUNDING * size * size
        if not abs(new.mean_square - old.mean_square) <= bound:
            yield Change(path, "mean square", f"({old.unit})²", old.mean_square, new.mean_square, bound)
    if old.mean_error is None or new.mean_error is None:
        return
    bound = allowed + old.mean_error + new.mean_error
    for what, before, after in (("mean", old.mean, new.mean), ("first moment", old.moment, new.moment)):
        if before is not None and after is not None and not abs(after - before) <= bound:
            yield Change(path, what, old.unit, before, after, bound)


def _moved_extremes(path: str, pair: tuple[KeptNumber, KeptNumber]) -> Iterator[Change]:
    """Extremes that are as large as they were, at another instant."""
    for word in ("least", "greatest"):
        times, errors = ([getattr(number, f"{word}_at{key}") for number in pair] for key in ("", "_error"))
        if None in times or None in errors:
            continue
        allowed = max(errors) + 4.0 * tolerances.EPS * max(map(abs, times))
        if not abs(times[1] - times[0]) <= allowed:
            yield Change(path, f"instant of the {word}", "s", times[0], times[1], allowed)


def _tenths(
    path: str, pair: tuple[KeptNumber, KeptNumber], runs: Sequence[KeptRun], allowed: float
) -> Iterator[Change]:
    """The means over the tenths of a run."""
    old, new = (number.tenths for number in pair)
    if len(old) != len(new):
        return
    ends = runs[0].even_at
    size = max((abs(x) for x in (*old, *new) if not isinstance(x, str)), default=0.0)
    bound = allowed + tolerances.SUM_ROUNDING * size
    for k, (before, after) in enumerate(zip(old, new, strict=True)):
        if isinstance(before, str) or isinstance(after, str) or abs(after - before) <= bound:
            continue
        what = f"mean from t = {ends[k]:.6g} to {ends[k + 1]:.6g} s" if len(ends) > k + 1 else f"mean of tenth {k + 1}"
        yield Change(path, what, pair[0].unit, before, after, bound)


def at_other_instants(runs: Sequence[KeptRun]) -> bool:
    """Whether two runs are kept at other even instants."""
    old, new = (run.even_at for run in runs)
    if len(old) != len(new):
        return True
    return bool(old) and any(abs(a - b) > SAME_INSTANTS * (old[-1] - old[0]) for a, b in zip(old, new, strict=True))
