"""Numbers of a motion over time with every turning point, between the samples, too: what collectives are counted from.

A history has the asked instants, those at which the search for extremes looks, both sides of every jump, and where the
number turns between two of these the turn. It is refused where some of it is not known: what is left out is no cycle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.results.results import Array, Mask, Results
from heuncli.results.results_paths import find
from heuncli.results.results_schema import BLOWS, REPORTS, with_shared
from heuncli.study.ask.measure import NOT_CLAIMED, NotOneNumber, is_even, report_of, several
from heuncli.study.ask.study import Study
from heuncli.study.load_cycles.counted import LoadHistory
from heuncli.study.search.columns import StudyColumns
from heuncli.study.search.extremes import GOOD_ENOUGH, ColumnSearch, distinct, finite
from heuncli.study.search.turnings import with_turnings

CODE = "no-collective"
EVENLY = 256  # intervals of a run that are looked into, whatever its steps
MOST_INSTANTS = 400_000  # of a grid: a hundred thousand steps


def histories(study: Study, errors: Mapping[str, float], units: Mapping[str, str]) -> list[LoadHistory]:
    """The numbers at some paths over the motion; errors, units: of each, SI.

    A vector counts by its magnitude. Raises NotOneNumber for what is no one number over a motion, SpecError
    [unknown-path], SolveError where some of it is open, not known, or beyond the horizon, LimitError where it
    turns too often.
    """
    paths = list(errors)
    for path in paths:
        require_history(study, path)
    require_claimed(study, paths)
    even = np.array([is_even(study.numbers(path)) for path in paths])
    reports = [report_of(path) for path in paths]
    wanted = frozenset[str]().union(*(frozenset(REPORTS) if report is None else report for report in reports))
    error = np.array([errors[path] for path in paths])
    searched = ColumnSearch(lambda results: columns(study, results, paths, even), [], error, even)
    sampled = StudyColumns(study, searched, with_shared(wanted), None)
    grid, enough = study.close_times(MOST_INSTANTS)
    grid = distinct(np.concatenate([grid, np.linspace(grid[0], grid[-1], EVENLY + 1)]))
    rows = sampled.columns(grid) if enough else np.zeros((len(grid), len(paths)))
    largest = finite(np.abs(rows), 0.0).max(axis=0)
    error = np.maximum(error, tolerances.CONSTANT * np.where(even, np.sqrt(largest), largest))
    times, rows, complete = with_turnings(sampled.columns, grid, rows, error, even)
    require_known(times, rows, paths, frozenset(sampled.unknown))
    if not (enough and complete):
        message = f"{', '.join(paths)}: the motion turns too often: more than {MOST_INSTANTS} instants to look at"
        raise LimitError(Problem("too-many-turns", message, hint="a shorter motion; or one period, and --repeat"))
    values = np.where(even, np.sqrt(np.abs(rows)), rows)
    whole = (1.0 + GOOD_ENOUGH) * error  # a turn is found to within a part of the error
    return [
        LoadHistory(path, units[path], times, values[:, k], float(whole[k]), squared, study.numbers(path).of_vectors)
        for k, (path, squared) in enumerate(zip(paths, even.tolist(), strict=True))
    ]


def columns(study: Study, results: Results, paths: Sequence[str], even: Mask) -> Array:
    """The numbers at paths, (n_t, n); of vectors and magnitudes the squares, which are smooth where these are zero."""
    rows = []
    for path, squared in zip(paths, even.tolist(), strict=True):
        there = study.numbers(path) if results is study.results else find(results, path)
        values = there.values.reshape(len(there.values), -1)
        rows.append(np.einsum("nk,nk->n", values, values) if squared else values[:, 0])
    return np.stack(rows, axis=1)


def require_history(study: Study, path: str) -> None:
    """Raise NotOneNumber for what is no one number or vector over a motion."""
    numbers = study.numbers(path)
    if study.of_one_instant:
        message = f"{path}: a collective is counted over a motion, and this analysis is none"
        raise NotOneNumber(message, "give analysis.duration: --set analysis.duration=2")
    if numbers.keys[:1] == (BLOWS,):
        raise NotOneNumber(
            f"{path} is of one blow: an impulse has no course in time", "a path of the motion: joints.NAME.force"
        )
    if not numbers.timed:
        raise NotOneNumber(f"{path} has no instants to be counted over", f"such as heun run SPEC --measure {path}")
    if numbers.axes and not (numbers.of_vectors and len(numbers.axes) == 1):
        raise several(path, numbers)


def require_claimed(study: Study, paths: Sequence[str]) -> None:
    """Raise SolveError for a motion that goes on beyond its horizon: what comes there is not known."""
    horizon = study.results.horizon
    if horizon is not None and study.results.time[-1] >= horizon:
        end = f"the motion goes to t = {study.results.time[-1]:.6g} s"
        message = f"{', '.join(paths)}: {NOT_CLAIMED.format(horizon)}, and {end}"
        hint = f"a motion that ends before it: --set analysis.duration={0.99 * horizon:.3g}; or a smaller --tolerance"
        raise SolveError(Problem(CODE, message, hint=hint, about="analysis"))


def require_known(times: Array, rows: Array, paths: Sequence[str], unknown: frozenset[float]) -> None:
    """Raise SolveError for each path at which a number is open at some instant, or beside a singular pose."""
    problems = []
    for k, path in enumerate(paths):
        gaps = np.isnan(rows[:, k])
        if gaps.any():
            at = float(times[int(gaps.argmax())])
            if at in unknown:
                why, hint = (
                    f"is not known at t = {at:.6g} s, beside a singular pose",
                    "heun probe tells where such poses are",
                )
            else:
                why, hint = (
                    f"is open at t = {at:.6g} s: redundant supports leave it open",
                    "--least-norm, or stiffness, chooses a split",
                )
            problems.append(Problem(CODE, f"{path} {why}", hint=hint, about=path))
    if problems:
        raise SolveError(*problems)
