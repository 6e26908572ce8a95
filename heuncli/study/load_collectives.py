"""Load collectives: histories of numbers over a motion, their cycles, and the damage-equivalent range.

Each value is known within e. Cycles of a range up to 2 e may be only error: they are counted separately, and are in no
class, no crossing and no equivalent range. Larger ranges may be off by 2 e each: the cycles of histories within e of
each other have ranges within 2 e, except for cycles no larger than that themselves, by the stability of such pairings
(Cohen-Steiner, Edelsbrunner, Harer 2007). The equivalent range is a norm of the ranges, so its error is at most the
growth that follows if each of them, including those counted separately, were 2 e larger.

    D ∝ Σ n R^m        Palmgren (1924), Miner (1945): damages add up; a Wöhler line of slope m:  N R^m = constant
    R_eq = (Σ n R^m / N)^(1/m)        N: the cycle number that the range belongs to
Mean stress, endurance limits and the order of the cycles are not considered.

A history has the requested instants, the instants of the search for extremes, both sides of every jump, and the turning
points between them. It is refused if any part of it is unknown, because a missing part would hide cycles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Mask, Results
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import IMPULSES, REPORTS, add_shared_reports
from heuncli.study import rainflow
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.queries.measure import NOT_CLAIMED, NotOneNumber, find_reports, make_several_error
from heuncli.study.queries.study import Study
from heuncli.study.rainflow import (
    Cycles,
    LevelCrossings,
    Matrix,
    count_endless,
    count_once,
    count_repeated,
    find_turning_points,
)
from heuncli.study.search.columns import ChannelSearch, StudyColumns
from heuncli.study.search.grid import GOOD_ENOUGH, replace_non_finite, sort_distinct
from heuncli.study.search.turnings import add_turning_points


class EquivalentRange(NamedTuple):
    """The equivalent range of a cycle number and a slope, with its error."""

    slope: float
    cycles: float
    range: float
    error: float


def compute_range_norm(ranges: Array, counts: Array, slope: float, cycles: float) -> float:
    """Return R_eq of ranges (n,) with their counts; 0 where there are none."""
    largest = float(ranges.max(initial=0.0))
    if largest == 0.0:
        return 0.0
    total = float(np.sum(counts * (ranges / largest) ** slope))
    return float(largest * (total / cycles) ** (1.0 / slope))


def find_damage_shares(ranges: Array, counts: Array, slope: float) -> Array:
    """Return the share of each cycle in the total damage, (n,)."""
    largest = float(ranges.max(initial=0.0))
    damages = counts * (ranges / largest) ** slope if largest > 0.0 else np.zeros(len(ranges))
    return np.asarray(damages / (damages.sum() or 1.0))


DEFAULT_BINS, MAX_BINS = 10, 1000  # classes of ranges and of means
MIN_SLOPE = 1.0  # below it the equivalent range is no norm; no material has such a slope
MAX_SLOPE = 100.0  # R^m then is the largest range alone
MIN_CYCLES, MAX_CYCLES = 1e-100, 1e100  # outside, equivalent ranges overflow
MAX_REPEATS = 10**12
REFERENCE = 0.0  # the level from which on crossings count upwards (ASTM E1049-85, 5.1)


class LoadHistory(NamedTuple):
    """One number over a motion: times and values (n,), including the turning points between samples.

    unit: SI
    error: absolute error of each value
    is_magnitude: whether it is a magnitude, which is never negative and has lost its sign
    is_vector: whether it is the magnitude of a vector
    """

    path: str
    unit: str
    times: Array
    values: Array
    error: float
    is_magnitude: bool = False
    is_vector: bool = False


class InvalidOption(NamedTuple):
    """An invalid option of Counting: its field, what is required, and an example."""

    name: str
    requirement: str
    example: str


SLOPES = InvalidOption("slopes", f"slopes m of N R^m = constant, {MIN_SLOPE:g} to {MAX_SLOPE:g}", "3,5")
CYCLES = InvalidOption("cycles", f"number of cycles for the equivalent ranges, {MIN_CYCLES:g} to {MAX_CYCLES:g}", "1e6")
CLASSES = InvalidOption(
    "bins", f"a number of classes of ranges and means, 1 to {MAX_BINS}", f"{DEFAULT_BINS}, the default"
)
REPEATS = InvalidOption(
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
    bins: int = DEFAULT_BINS
    repeat: int = 1
    is_endless: bool = False

    def find_invalid_options(self) -> Sequence[InvalidOption]:
        """Return the options that cannot be used."""
        checks = (
            (all(MIN_SLOPE <= m <= MAX_SLOPE for m in self.slopes), SLOPES),
            (self.cycles is None or MIN_CYCLES <= self.cycles <= MAX_CYCLES, CYCLES),
            (1 <= self.bins <= MAX_BINS and self.bins == int(self.bins), CLASSES),
            (1 <= self.repeat <= MAX_REPEATS and self.repeat == int(self.repeat), REPEATS),
        )
        return [option for is_valid, option in checks if not is_valid]

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
    ranges = rainflow.make_class_limits(0.0, float(cycles.ranges.max(initial=0.0)), counting.bins)
    lowest, highest = float(history.values.min()), float(history.values.max())
    levels = rainflow.make_class_limits(lowest, highest, counting.bins)[1:-1] if len(cycles.counts) else np.zeros(0)
    damages = [find_damage_shares(cycles.ranges, cycles.counts, slope) for slope in counting.slopes]
    return Collective(
        history=history,
        counting=counting,
        points=len(find_turning_points(history.values)),
        cycles=cycles,
        below_error=BelowError(float(small.counts.sum()), threshold),
        matrix=rainflow.count_matrix(cycles, ranges, threshold),
        counts=rainflow.count_by_range(cycles, ranges, threshold),
        shares=np.array([rainflow.count_by_range(cycles, ranges, threshold, weights) for weights in damages]).reshape(
            -1, counting.bins
        ),
        crossings=rainflow.count_crossings(cycles, levels),
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
    value = compute_range_norm(all_cycles.ranges[is_counted], all_cycles.counts[is_counted], slope, cycles)
    most = compute_range_norm(all_cycles.ranges + threshold, all_cycles.counts, slope, cycles)
    return EquivalentRange(slope, cycles, value, most - value)


CODE = "no-collective"
MIN_INTERVALS = 256  # intervals of a run that are sampled, whatever its steps
MAX_INSTANTS = 400_000  # instants of a grid: a hundred thousand steps


def make_histories(study: Study, errors: Mapping[str, float], units: Mapping[str, str]) -> list[LoadHistory]:
    """Make the histories of the numbers at some paths over the motion; a vector counts by its magnitude.

    errors, units: of each path, SI

    Raises NotOneNumber where a path is no single number over a motion, SpecError [unknown-path], SolveError where it is
    indeterminate, unknown, or beyond the horizon somewhere, LimitError where it turns too often.
    """
    paths = list(errors)
    for path in paths:
        require_history(study, path)
    require_claimed(study, paths)
    reports = [find_reports(path) for path in paths]
    needed_reports = frozenset[str]().union(*(frozenset(REPORTS) if report is None else report for report in reports))
    search = ChannelSearch(lambda results: collect_channels(study, results, paths), lambda channel: math.nan)
    study_columns = StudyColumns(study, search, add_shared_reports(needed_reports))
    is_square, error = study_columns.is_squared, np.array([errors[path] for path in paths])
    grid, is_close_enough = study.find_close_times(MAX_INSTANTS)
    grid = sort_distinct(np.concatenate([grid, np.linspace(grid[0], grid[-1], MIN_INTERVALS + 1)]))
    rows = study_columns.sample(grid) if is_close_enough else np.zeros((len(grid), len(paths)))
    largest = replace_non_finite(np.abs(rows), 0.0).max(axis=0)
    error = np.maximum(error, tolerances.CONSTANT * np.where(is_square, np.sqrt(largest), largest))
    times, rows, complete = add_turning_points(study_columns.sample, grid, rows, error, is_square)
    require_known(times, rows, paths, frozenset(study_columns.unknown))
    if not (is_close_enough and complete):
        message = f"{', '.join(paths)}: too many reversals: more than {MAX_INSTANTS} samples needed"
        raise LimitError(Problem("too-many-turns", message, hint="a shorter motion, or one period with --repeat"))
    values = np.where(is_square, np.sqrt(np.abs(rows)), rows)
    total_error = (1.0 + GOOD_ENOUGH) * error  # a turning point is found to within a part of the error
    return [
        LoadHistory(
            path, units[path], times, values[:, k], float(total_error[k]), squared, study.find_numbers(path).is_vector
        )
        for k, (path, squared) in enumerate(zip(paths, is_square.tolist(), strict=True))
    ]


def collect_channels(study: Study, results: Results, paths: Sequence[str]) -> list[Channel]:
    """Collect the channels at paths."""
    return [
        make_path_channel(study.find_numbers(path) if results is study.results else find_values(results, path))
        for path in paths
    ]


def require_history(study: Study, path: str) -> None:
    """Raise NotOneNumber for a path that is no single number or vector over a motion."""
    numbers = study.find_numbers(path)
    if study.has_one_instant:
        message = f"{path}: a collective needs a motion, and this analysis has none"
        raise NotOneNumber(message, "give analysis.duration: --set analysis.duration=2")
    if numbers.keys[:1] == (IMPULSES,):
        raise NotOneNumber(
            f"{path} belongs to one impulse: it has no time history", "use a path of the motion: joints.NAME.force"
        )
    if not numbers.is_timed:
        raise NotOneNumber(f"{path} has no time history to be counted", f"for example heun run SPEC --measure {path}")
    if numbers.axes and not (numbers.is_vector and len(numbers.axes) == 1):
        raise make_several_error(path, numbers)


def require_claimed(study: Study, paths: Sequence[str]) -> None:
    """Raise SolveError for a motion that continues beyond its horizon, where no number is claimed."""
    horizon = study.results.horizon
    if horizon is not None and study.results.time[-1] >= horizon:
        end = f"the motion goes to t = {study.results.time[-1]:.6g} s"
        message = f"{', '.join(paths)}: {NOT_CLAIMED.format(horizon)}, and {end}"
        hint = f"end the motion before it: --set analysis.duration={0.99 * horizon:.3g}; or a smaller --tolerance"
        raise SolveError(Problem(CODE, message, hint=hint, entry_path="analysis"))


def require_known(times: Array, rows: Array, paths: Sequence[str], unknown: frozenset[float]) -> None:
    """Raise SolveError for each path whose number is indeterminate at some instant, or too close to a singular pose."""
    problems = []
    for k, path in enumerate(paths):
        gaps = np.isnan(rows[:, k])
        if gaps.any():
            time = float(times[int(gaps.argmax())])
            if time in unknown:
                why, hint = (
                    f"is not known at t = {time:.6g} s, near a singular position",
                    "heun probe shows where such positions are",
                )
            else:
                why, hint = (
                    f"is open at t = {time:.6g} s: statically indeterminate",
                    "choose a split with --least-norm or stiffness",
                )
            problems.append(Problem(CODE, f"{path} {why}", hint=hint, entry_path=path))
    if problems:
        raise SolveError(*problems)
