"""The numbers of a solved scene as they are kept: what its tables tell, to full digits, with the errors it states.

Of every quantity: first and last value, the extremes searched between the samples with their instants, and the values
at eleven even instants, so that a course that changes between its extremes is seen. Of a run of cuts the highest and
the lowest of its cuts, with the extremes of the whole stretch.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.records import replace
from heuncli.report.cut_runs import CutRun, RunQuantity
from heuncli.report.labels import labels_of
from heuncli.report.page import Page, page_of
from heuncli.report.run_searches import stresses_along
from heuncli.report.table_units import Units
from heuncli.results import Array, Extremes, Place, Results
from heuncli.results_schema import SHARES
from heuncli.study.ask.study import Study
from heuncli.study.search.extremes import ColumnSearch, no_columns
from heuncli.telling.columns import KeptColumn, KeptScope, Told, all_columns, columns_of, position, run_path, values_of
from heuncli.telling.kept import (
    EVEN,
    KeptRun,
)
from heuncli.telling.record import KeptBounds, KeptCourse, ending_error, record_of

SI = Units({})
BACK = 1e-5  # of a run, over which the rate at its end is taken where an event ends it
SAME_END = 1e-6  # of a run: ends that differ by no more are those of one run, but for the error of the event there
SECTIONS = frozenset({"sections"})


def keep(study: Study, wanted: frozenset[str], even_at: Sequence[float] = ()) -> KeptRun:
    """The numbers of a study, of the reports that are wanted; even_at: the even instants of the run it is held to."""
    results = study.results
    labels = replace(labels_of(study.spec), units=SI)
    page = page_of(results, labels, study.magnitudes)
    told, scope = Told(results, labels, page.certain), KeptScope(wanted, labels)
    return record_of(_course(study, page, told, _even(results, even_at), scope), page, scope)


def looks_between(study: Study, wanted: frozenset[str]) -> bool:
    """Whether the extremes that are kept are searched between the samples, too, or there are none between them."""
    results = study.results
    scope = KeptScope(wanted, labels_of(study.spec))
    along = sum(len(run.loads) for run in scope.runs(results))
    return study.of_one_instant or study.is_searched(len(columns_of(results, scope)) + along)


def _even(results: Results, given: Sequence[float]) -> Array:
    """Eleven even instants of a run; those given where they are of the same run but for rounding of its end."""
    first, last = float(results.time[0]), float(results.time[-1])
    own: Array = np.linspace(first, last, EVEN) if last > first else np.zeros(0)
    if len(given) == len(own) and np.all(np.abs(own - given) <= SAME_END * (last - first)):
        own = np.clip(np.array(given), first, last)
    return own


def _course(study: Study, page: Page, told: Told, instants: Array, scope: KeptScope) -> KeptCourse:
    columns = all_columns(told.results, scope)
    even = values_of(study.resample(instants), scope) if len(instants) else {path: np.zeros(0) for path in columns}
    drift: dict[str, float] = {}
    if ending_error(told.results) is not None:
        first, last = float(told.results.time[0]), float(told.results.time[-1])
        back = BACK * (last - first)
        near_end = values_of(study.resample(np.array([last - back, last])), scope)
        rates = {path: (x[1] - x[0]) / back for path, x in near_end.items()}
        drift = {path: abs(float(rate)) for path, rate in rates.items() if np.isfinite(rate) and rate}
    return KeptCourse(told, columns, even, instants, _bounds(study, page, scope), drift)


def _bounds(study: Study, page: Page, scope: KeptScope) -> dict[str, KeptBounds]:
    """The extremes of all columns, searched between the samples where there are not too many of them."""
    columns, runs = columns_of(page.results, scope), scope.runs(page.results)
    certain = page.certain
    errors = [certain.error(column.kind, column.unit) for column in columns]
    errors += [certain.error("sections", load.unit) for run in runs for load in run.loads]
    even = np.array([column.even for column in columns] + [False] * (len(errors) - len(columns)), dtype=bool)
    searched = ColumnSearch(
        lambda results: _squared(columns_of(results, scope), len(results.time)), [[i] for i in range(len(columns))],
        np.array(errors), even, page.along if runs else None,
    )  # fmt: skip
    times = None if study.is_searched(len(errors)) else study.results.time
    found = study.extremes(searched, scope.wanted - {SHARES}, whole=True, times=times)
    low, high = (np.where(even, np.sqrt(np.abs(bound)), bound) for bound in (found.low, found.high))
    bounds = {
        column.path: _bounds_of(low[i], found.low_at[i], high[i], found.high_at[i]) for i, column in enumerate(columns)
    }
    start = len(columns)
    for k, run in enumerate(runs):
        first = start + k * len(run.loads)
        part = found.part(slice(first, first + len(run.loads)))
        bounds |= _along_bounds(run, run.loads, part, found.places[k * len(run.loads) : (k + 1) * len(run.loads)])
        if run.stresses:
            own = stresses_along(run, scope.labels)
            of = ColumnSearch(no_columns, [], own.errors(certain), own.even, own.along, bent=True)
            stresses = own.roots(study.extremes(of, SECTIONS))
            bounds |= _along_bounds(run, run.stresses, stresses, stresses.places)
    return bounds


def _bounds_of(low: float, low_at: float, high: float, high_at: float) -> KeptBounds:
    return KeptBounds((float(low), float(low_at), None), (float(high), float(high_at), None))


def _along_bounds(
    run: CutRun, quantities: Sequence[RunQuantity], found: Extremes, places: Sequence[tuple[Place, Place]]
) -> dict[str, KeptBounds]:
    """The extremes along a run: the lowest belongs to its lowest cuts, the highest to its highest."""
    bounds: dict[str, KeptBounds] = {}
    for i, quantity in enumerate(quantities):
        path = run_path(run, quantity)
        low = float(found.low[i]), float(found.low_at[i]), position(places[i][0])
        high = float(found.high[i]), float(found.high_at[i]), position(places[i][1])
        bounds |= {f"{path}.lowest": KeptBounds(low, None), f"{path}.highest": KeptBounds(None, high)}
    return bounds


def _squared(columns: Sequence[KeptColumn], n: int) -> Array:
    if not columns:
        return np.zeros((n, 0))
    return np.stack([column.values**2 if column.even else column.values for column in columns], axis=1)
