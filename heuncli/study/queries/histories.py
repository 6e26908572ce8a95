"""Histories of numbers over a motion, with every turning point between the samples: load collectives are counted from
them.

A history has the requested instants, the instants of the search for extremes, both sides of every jump, and the turning
points between them. It is refused if any part of it is unknown, because a missing part would hide cycles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.results.results import Array, Results
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import IMPULSES, REPORTS, add_shared_reports
from heuncli.study.load_cycles.collective import LoadHistory
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.queries.measure import NOT_CLAIMED, NotOneNumber, find_reports, make_several_error
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch, StudyColumns
from heuncli.study.search.extremes import GOOD_ENOUGH, replace_non_finite, sort_distinct
from heuncli.study.search.turnings import add_turning_points

CODE = "no-collective"
MIN_INTERVALS = 256  # intervals of a run that are sampled, whatever its steps
MAX_INSTANTS = 400_000  # of a grid: a hundred thousand steps


def make_histories(study: Study, errors: Mapping[str, float], units: Mapping[str, str]) -> list[LoadHistory]:
    """Return the histories of the numbers at some paths over the motion; errors, units: of each path, SI.

    A vector counts by its magnitude. Raises NotOneNumber where a path is no single number over a motion, SpecError
    [unknown-path], SolveError where some of it is indeterminate, unknown, or beyond the horizon, LimitError where it
    turns too often.
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
