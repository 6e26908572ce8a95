"""The collective of a history of loads: its cycles counted, sorted and added up, with the error that the run states.

Each value is known within e. Cycles of a range up to 2 e may be nothing but error: they are counted apart, and are in
no class, no crossing and no equivalent range. Those above may be off by 2 e each: histories within e of each other have
cycles whose ranges are within 2 e, but for ones that are no larger than that themselves, by the stability of such
pairings (Cohen-Steiner, Edelsbrunner, Harer 2007). So the equivalent range, a norm of the ranges, errs by no more
than it would grow by if each of them, also of those counted apart, were 2 e larger.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Mask
from heuncli.study.load_cycles import classes
from heuncli.study.load_cycles.classes import LevelCrossings, Matrix
from heuncli.study.load_cycles.equivalent import EquivalentRange, damage, equivalent_range
from heuncli.study.load_cycles.rainflow import Cycles, endless, rainflow, repeated, turning_points

BINS, MOST_BINS = 10, 1000
LEAST_SLOPE = 1.0  # below it the equivalent range is no norm, and no material is known
MOST_SLOPE = 100.0  # R^m then is the largest range alone
LEAST_CYCLES, MOST_CYCLES = 1e-100, 1e100  # beyond, equivalent ranges leave what numbers hold
MOST_REPEATS = 10**12
REFERENCE = 0.0  # the level of 5.1 from which on crossings count upwards


class LoadHistory(NamedTuple):
    """One number over a motion: times and values (n,), the turning points between samples among them.

    unit: SI; error: how well each value is known; is_magnitude: whether it is never negative, and has lost the sign of
    what it is of; of_vector: whether it is that of a vector.
    """

    path: str
    unit: str
    times: Array
    values: Array
    error: float
    is_magnitude: bool = False
    of_vector: bool = False


class UnfitCounting(NamedTuple):
    """A way of counting that is none: the field of Counting, what is expected, such as what."""

    name: str
    expected: str
    example: str


SLOPES = UnfitCounting("slopes", f"slopes m of N R^m = constant, {LEAST_SLOPE:g} to {MOST_SLOPE:g}", "3,5")
CYCLES = UnfitCounting(
    "cycles", f"of how many cycles equivalent ranges are, {LEAST_CYCLES:g} to {MOST_CYCLES:g}", "1e6"
)
CLASSES = UnfitCounting("bins", f"how many classes of ranges and means, 1 to {MOST_BINS}", f"{BINS}, the default")
REPEATS = UnfitCounting(
    "repeat", "how often the motion is run through, a whole number, or closed", "1000; or closed: for ever"
)


class Counting(NamedTuple):
    """How a history is counted: told so many times in a row, or (closed) for ever, of which one time is counted.

    slopes: of Wöhler lines; cycles: of how many the equivalent ranges are, None for one each time; bins: classes.
    """

    slopes: Sequence[float] = ()
    cycles: float | None = None
    bins: int = BINS
    repeat: int = 1
    closed: bool = False

    def unfit(self) -> Sequence[UnfitCounting]:
        """What of it cannot be counted by."""
        checks = (
            (all(LEAST_SLOPE <= m <= MOST_SLOPE for m in self.slopes), SLOPES),
            (self.cycles is None or LEAST_CYCLES <= self.cycles <= MOST_CYCLES, CYCLES),
            (1 <= self.bins <= MOST_BINS and self.bins == int(self.bins), CLASSES),
            (1 <= self.repeat <= MOST_REPEATS and self.repeat == int(self.repeat), REPEATS),
        )
        return [unfit for fits, unfit in checks if not fits]

    @property
    def of_cycles(self) -> float:
        """Of how many cycles the equivalent ranges are."""
        return float(self.repeat) if self.cycles is None else self.cycles


class BelowError(NamedTuple):
    """How many cycles are no larger than what the error may make of nothing, 2 e."""

    cycles: float
    range: float


@record
class Collective:
    """What a history counts to; ranges and levels in its SI unit. shares (slopes, classes): of the damage."""

    history: LoadHistory
    asked: Counting
    points: int
    cycles: Cycles
    below: BelowError
    matrix: Matrix
    counts: Array
    shares: Array
    crossings: LevelCrossings
    equivalents: Sequence[EquivalentRange]

    @property
    def total(self) -> float:
        """How many cycles are counted, halves as halves."""
        return float(self.cycles.counts.sum())


def counted(history: LoadHistory, asked: Counting) -> Collective:
    """The collective of a history; of one that is repeated its last value counts as its first."""
    found, gate = cycles_of(history.values, asked), 2.0 * history.error
    above = found.ranges > gate
    cycles, small = found.some(above), found.some(~above)
    ranges = classes.limits(0.0, float(cycles.ranges.max(initial=0.0)), asked.bins)
    lowest, highest = float(history.values.min()), float(history.values.max())
    levels = classes.limits(lowest, highest, asked.bins)[1:-1] if len(cycles.counts) else np.zeros(0)
    damages = [damage(cycles.ranges, cycles.counts, slope) for slope in asked.slopes]
    return Collective(
        history=history,
        asked=asked,
        points=len(turning_points(history.values)),
        cycles=cycles,
        below=BelowError(float(small.counts.sum()), gate),
        matrix=classes.matrix(cycles, ranges, gate),
        counts=classes.by_range(cycles, ranges, gate),
        shares=np.array([classes.by_range(cycles, ranges, gate, own) for own in damages]).reshape(-1, asked.bins),
        crossings=classes.crossings(cycles, levels),
        equivalents=tuple(equivalent(found, above, gate, slope, asked.of_cycles) for slope in asked.slopes),
    )


def cycles_of(values: Array, asked: Counting) -> Cycles:
    """The cycles of a history (n,), as often as it is asked to be told."""
    if asked.closed:
        return endless(values)
    return rainflow(values) if asked.repeat == 1 else repeated(values, asked.repeat)


def equivalent(found: Cycles, above: Mask, gate: float, slope: float, cycles: float) -> EquivalentRange:
    """The equivalent range of the cycles above the gate, and its error, to which the others add."""
    value = equivalent_range(found.ranges[above], found.counts[above], slope, cycles)
    most = equivalent_range(found.ranges + gate, found.counts, slope, cycles)
    return EquivalentRange(slope, cycles, value, most - value)
