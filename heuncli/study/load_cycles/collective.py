"""The collective of a load history: its cycles counted, sorted and summed, with the error that the run states.

Each value is known within e. Cycles of a range up to 2 e may be only error: they are counted separately, and are in no
class, no crossing and no equivalent range. Larger ranges may be off by 2 e each: the cycles of histories within e of
each other have ranges within 2 e, except for cycles no larger than that themselves, by the stability of such pairings
(Cohen-Steiner, Edelsbrunner, Harer 2007). The equivalent range is a norm of the ranges, so its error is at most the
growth that follows if each of them, including those counted separately, were 2 e larger.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Mask
from heuncli.study.load_cycles import classes
from heuncli.study.load_cycles.classes import LevelCrossings, Matrix
from heuncli.study.load_cycles.equivalent import EquivalentRange, damage_shares, equivalent_range
from heuncli.study.load_cycles.rainflow import Cycles, count_endless, count_once, count_repeated, find_turning_points

BINS, MOST_BINS = 10, 1000
LEAST_SLOPE = 1.0  # below it the equivalent range is no norm; no material has such a slope
MOST_SLOPE = 100.0  # R^m then is the largest range alone
LEAST_CYCLES, MOST_CYCLES = 1e-100, 1e100  # outside, equivalent ranges overflow
MOST_REPEATS = 10**12
REFERENCE = 0.0  # the level of 5.1 from which on crossings count upwards


class LoadHistory(NamedTuple):
    """One number over a motion: times and values (n,), including the turning points between samples.

    unit: SI
    error: absolute error of each value
    is_magnitude: whether it is a magnitude, which is never negative and has lost its sign
    of_vector: whether it is the magnitude of a vector
    """

    path: str
    unit: str
    times: Array
    values: Array
    error: float
    is_magnitude: bool = False
    of_vector: bool = False


class UnfitCounting(NamedTuple):
    """An invalid option of Counting: its field, what is required, and an example."""

    name: str
    requirement: str
    example: str


SLOPES = UnfitCounting("slopes", f"slopes m of N R^m = constant, {LEAST_SLOPE:g} to {MOST_SLOPE:g}", "3,5")
CYCLES = UnfitCounting(
    "cycles", f"number of cycles for the equivalent ranges, {LEAST_CYCLES:g} to {MOST_CYCLES:g}", "1e6"
)
CLASSES = UnfitCounting("bins", f"a number of classes of ranges and means, 1 to {MOST_BINS}", f"{BINS}, the default")
REPEATS = UnfitCounting(
    "repeat", "a whole number of repetitions of the motion, or closed", "1000; or closed: endless repetition"
)


class Counting(NamedTuple):
    """How a history is counted: repeated so many times, or (is_endless) for ever, of which one period is counted.

    slopes: of Wöhler lines
    cycles: the cycle number of the equivalent ranges, None for one per repetition
    bins: number of classes
    """

    slopes: Sequence[float] = ()
    cycles: float | None = None
    bins: int = BINS
    repeat: int = 1
    is_endless: bool = False

    def find_unfit(self) -> Sequence[UnfitCounting]:
        """Return the options that cannot be used."""
        checks = (
            (all(LEAST_SLOPE <= m <= MOST_SLOPE for m in self.slopes), SLOPES),
            (self.cycles is None or LEAST_CYCLES <= self.cycles <= MOST_CYCLES, CYCLES),
            (1 <= self.bins <= MOST_BINS and self.bins == int(self.bins), CLASSES),
            (1 <= self.repeat <= MOST_REPEATS and self.repeat == int(self.repeat), REPEATS),
        )
        return [unfit for fits, unfit in checks if not fits]

    @property
    def equivalent_cycles(self) -> float:
        """The cycle number of the equivalent ranges."""
        return float(self.repeat) if self.cycles is None else self.cycles


class BelowError(NamedTuple):
    """The number of cycles that are no larger than what the error alone may cause, 2 e."""

    cycles: float
    range: float


@record
class Collective:
    """The counted cycles of a history; ranges and levels in its SI unit. shares (slopes, classes): of the damage."""

    history: LoadHistory
    counting: Counting
    points: int
    cycles: Cycles
    below_error: BelowError
    matrix: Matrix
    counts: Array
    shares: Array
    crossings: LevelCrossings
    equivalents: Sequence[EquivalentRange]

    @property
    def total_cycles(self) -> float:
        """The number of counted cycles; a half cycle counts one half."""
        return float(self.cycles.counts.sum())


def make_collective(history: LoadHistory, counting: Counting) -> Collective:
    """Count the collective of a history; if it is repeated, its last value counts as its first."""
    all_cycles, threshold = find_cycles(history.values, counting), 2.0 * history.error
    is_counted = all_cycles.ranges > threshold
    cycles, small = all_cycles.select(is_counted), all_cycles.select(~is_counted)
    ranges = classes.make_class_limits(0.0, float(cycles.ranges.max(initial=0.0)), counting.bins)
    lowest, highest = float(history.values.min()), float(history.values.max())
    levels = classes.make_class_limits(lowest, highest, counting.bins)[1:-1] if len(cycles.counts) else np.zeros(0)
    damages = [damage_shares(cycles.ranges, cycles.counts, slope) for slope in counting.slopes]
    return Collective(
        history=history,
        counting=counting,
        points=len(find_turning_points(history.values)),
        cycles=cycles,
        below_error=BelowError(float(small.counts.sum()), threshold),
        matrix=classes.count_matrix(cycles, ranges, threshold),
        counts=classes.count_by_range(cycles, ranges, threshold),
        shares=np.array([classes.count_by_range(cycles, ranges, threshold, weights) for weights in damages]).reshape(
            -1, counting.bins
        ),
        crossings=classes.count_crossings(cycles, levels),
        equivalents=tuple(
            compute_equivalent_range(all_cycles, is_counted, threshold, slope, counting.equivalent_cycles)
            for slope in counting.slopes
        ),
    )


def find_cycles(values: Array, counting: Counting) -> Cycles:
    """Find the cycles of a history (n,), repeated as `counting` says."""
    if counting.is_endless:
        return count_endless(values)
    return count_once(values) if counting.repeat == 1 else count_repeated(values, counting.repeat)


def compute_equivalent_range(
    all_cycles: Cycles, is_counted: Mask, threshold: float, slope: float, cycles: float
) -> EquivalentRange:
    """Compute the equivalent range of the cycles above the threshold, and its error, which includes the others."""
    value = equivalent_range(all_cycles.ranges[is_counted], all_cycles.counts[is_counted], slope, cycles)
    most = equivalent_range(all_cycles.ranges + threshold, all_cycles.counts, slope, cycles)
    return EquivalentRange(slope, cycles, value, most - value)
