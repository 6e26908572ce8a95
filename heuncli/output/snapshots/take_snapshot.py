"""Take the snapshot of a solved scene: the numbers of its tables, to full digits, with their stated errors.

Of every quantity it holds the first and last value, the extremes searched between the samples with their instants, the
values at eleven even instants, and sums over its whole course (output/snapshots/course_sums.py), so that a change of
the course between its extremes is seen. Of a series of cuts it holds the highest and lowest value of its cuts, with the
extremes of the whole length.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.output.snapshots.course_sums import (
    GAUSS,
    NO_PIECES,
    CourseSums,
    Pieces,
    SampledColumns,
    find_instant_spread,
    find_near_jumps,
    integrate_columns,
    make_tenth_instants,
    split_into_pieces,
    sum_tenths,
)
from heuncli.output.snapshots.golden_file import N_EVEN, RunSnapshot
from heuncli.output.snapshots.record import (
    ResultView,
    SnapshotBounds,
    SnapshotCourse,
    SnapshotScope,
    collect_all_columns,
    collect_columns,
    collect_values,
    estimate_impact_error,
    find_ending_error,
    make_run_snapshot,
)
from heuncli.output.tables.page import Page, make_page, search_stresses
from heuncli.results.results import Array, Extremes, Results
from heuncli.results.results_schema import SHARES, add_shared_reports
from heuncli.study.quantities.channels import Channel, collect_series_loads
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch
from heuncli.study.search.extremes import find_jump_sides, sort_distinct

SI = Units({})
RATE_SPAN = 1e-5  # share of the run for the rate at its end, if an event ends it
SAME_END = 1e-6  # share of the run: within it, besides the event's error, ends are equal
SLOW = 10.0  # mean speed over the lowest speed assumed at a jump; its time is uncertain accordingly
MARGIN = 5.0  # in errors: 2 for each of two runs, and 1 for the search


def take_run_snapshot(
    study: Study, reports: frozenset[str], given_instants: Sequence[float] = (), *, whole_course: bool = True
) -> RunSnapshot:
    """Take the snapshot of a study.

    reports: those whose numbers are stored
    given_instants: the even instants of the run to which it is compared
    whole_course: include sums over the course between the extremes, which envelopes do not need
    """
    results = study.results
    labels = replace(make_labels(study.spec), units=SI)
    page = make_page(results, labels, study.magnitudes)
    view, scope = ResultView(results, labels, page.certain), SnapshotScope(reports, labels)
    even = _choose_even_instants(results, given_instants) if whole_course else np.zeros(0)
    return make_run_snapshot(_make_course(study, page, view, even, scope), page, scope)


def is_searched_between_samples(study: Study, reports: frozenset[str]) -> bool:
    """Return whether the extremes of a snapshot are searched between the samples, or there is nothing between them."""
    results = study.results
    scope = SnapshotScope(reports, make_labels(study.spec))
    n_run_columns = sum(len(run.loads) for run in scope.collect_cut_series(results))
    return study.has_one_instant or study.is_searched(len(collect_columns(results, scope)) + n_run_columns)


def _choose_even_instants(results: Results, given_instants: Sequence[float]) -> Array:
    """Return eleven even instants of a run, or the given ones if they belong to the same run within rounding of its
    end.
    """
    first, last = float(results.time[0]), float(results.time[-1])
    even_instants: Array = np.linspace(first, last, N_EVEN) if last > first else np.zeros(0)
    if len(given_instants) == len(even_instants) and np.all(
        np.abs(even_instants - given_instants) <= SAME_END * (last - first)
    ):
        even_instants = np.clip(np.array(given_instants), first, last)
    return even_instants


def _make_course(study: Study, page: Page, view: ResultView, instants: Array, scope: SnapshotScope) -> SnapshotCourse:
    columns = collect_all_columns(view.results, scope)
    drift: dict[str, float] = {}
    if find_ending_error(view.results) is not None:
        first, last = float(view.results.time[0]), float(view.results.time[-1])
        time_step = RATE_SPAN * (last - first)
        near_end = collect_values(study.resample(np.array([last - time_step, last])), scope)
        rates = {path: (x[1] - x[0]) / time_step for path, x in near_end.items()}
        drift = {path: abs(float(rate)) for path, rate in rates.items() if np.isfinite(rate) and rate}
    jumps = _find_jumps(study, view)
    bounds, sampled = _search_bounds(study, page, scope, jumps)
    if not len(instants):
        return SnapshotCourse(view, columns, dict.fromkeys(columns, instants), instants, bounds, drift)
    even, sums = _sum_course(study, scope, instants, jumps, sampled)
    return SnapshotCourse(view, columns, even, instants, bounds, drift, sums)


class UncertainJumps(NamedTuple):
    """The instants of jumps in ascending order, and their errors [s], (n,) each."""

    times: Array
    errors: Array

    def find_errors(self, instants: Array) -> Array:
        """Return the errors of the jumps at some instants."""
        if not len(self.times):
            return np.zeros(len(instants))
        return np.asarray(self.errors[np.clip(np.searchsorted(self.times, instants), 0, len(self.times) - 1)])


def _find_jumps(study: Study, view: ResultView) -> UncertainJumps:
    """Find the jumps of a run. The error of a jump that depends on the motion is the motion's error over the speed
    there.
    """
    jumps = np.array(sorted(study.history.jumps))
    span = float(np.ptp(view.results.time))
    motion = view.results.accuracy.get("estimate", {}).get("motion") or 0.0
    errors = np.full(len(jumps), max(SLOW * motion, 2.0 * tolerances.EPS) * span)
    for blow in view.results.impulses:
        k = min(int(np.searchsorted(jumps, float(blow["time"]))), max(len(jumps) - 1, 0))
        for index in {max(k - 1, 0), k} if len(jumps) else ():
            errors[index] = max(errors[index], estimate_impact_error(blow, view))
    return UncertainJumps(jumps, errors)


def _sum_course(
    study: Study, scope: SnapshotScope, even: Array, jumps: UncertainJumps, samples: SampledColumns | None
) -> tuple[dict[str, Array], dict[str, CourseSums]]:
    """Return the columns at the even instants, and the sums over the whole course of each.

    samples: what a search has evaluated of them

    All instants are solved in one call.
    """
    horizon = study.results.horizon
    uneven = make_tenth_instants(even)
    beyond = np.zeros(uneven.shape, dtype=bool) if horizon is None else uneven >= horizon
    pieces = split_into_pieces(study.search_times) if samples is not None and horizon is None else NO_PIECES
    places = [even, np.where(beyond, even[0], uneven), pieces.nodes]
    values = _solve_instants(study, scope, np.concatenate([at.ravel() for at in places]))
    n, m = len(even), len(even) + uneven.size
    near_jump = find_near_jumps(uneven, jumps.times, jumps.errors) | beyond
    sums = {path: sum_tenths(own_values[n:m].reshape(uneven.shape), near_jump) for path, own_values in values.items()}
    if horizon is not None:
        sums = {path: own_values.cut_at_horizon(np.asarray(beyond.any(axis=1))) for path, own_values in sums.items()}
    if samples is not None and len(pieces.first):
        paths = [column.path for column in collect_columns(study.results, scope)]
        inner = np.stack([values[path][m:].reshape(-1, GAUSS.size) for path in paths], axis=2)
        ends = (find_ending_error(study.results) or 0.0) / float(np.ptp(study.results.time))
        own_values = {path: sums[path] for path in paths}
        sums |= _add_integrals(own_values, pieces, samples.find_values(pieces.times), inner, jumps, ends)
    return {path: own_values[:n] for path, own_values in values.items()}, {
        path: own_values.without_words for path, own_values in sums.items()
    }


def _add_integrals(
    sums: Mapping[str, CourseSums], pieces: Pieces, grid: Array, inner: Array, jumps: UncertainJumps, end_error: float
) -> dict[str, CourseSums]:
    """Add to the sums of columns their integrals over the run, where they are known throughout.

    end_error: error of the run's end, as a share of the run
    """
    uncertain = jumps.find_errors(pieces.times[:-1][find_jump_sides(pieces.times)])
    with np.errstate(invalid="ignore"):
        integrals = np.stack(integrate_columns(pieces, grid, inner, uncertain))
        integrals[2] += 2.0 * end_error * np.abs(grid).max(axis=0)
    return {
        path: column_sums._replace(mean=float(mean), moment=float(moment), mean_error=float(error))
        if np.isfinite([mean, moment, error]).all()
        else column_sums
        for (path, column_sums), mean, moment, error in zip(sums.items(), *integrals, strict=True)
    }


def _solve_instants(study: Study, scope: SnapshotScope, times: Array) -> dict[str, Array]:
    """Return all columns at instants in any order, (n,) each."""
    instants = sort_distinct(times)
    reports, batch_size = add_shared_reports(scope.reports - {SHARES}), study.chunk_size
    parts = [
        collect_values(study.compute_reports(instants[i : i + batch_size], reports), scope)
        for i in range(0, len(instants), batch_size)
    ]
    order = np.searchsorted(instants, times)
    return {path: np.concatenate([part[path] for part in parts])[order] for path in parts[0]}


def _search_bounds(
    study: Study, page: Page, scope: SnapshotScope, jumps: UncertainJumps
) -> tuple[dict[str, SnapshotBounds], SampledColumns | None]:
    """Find the extremes of all columns, searched between the samples unless there are too many columns.

    Also returns what was evaluated of the columns during the search, if there was one.
    """
    columns, runs = collect_columns(page.results, scope), scope.collect_cut_series(page.results)
    samples = SampledColumns()

    def collect(results: Results) -> list[Channel]:
        own = collect_columns(results, scope)
        values = [column.values for column in own]
        samples.add(results.time, np.stack(values, axis=1) if own else np.zeros((len(results.time), 0)))
        return own + (collect_series_loads(results) if runs else [])

    n_channels = len(columns) + sum(len(run.loads) for run in runs)
    is_searched = study.is_searched(n_channels)
    times = None if is_searched else study.results.time
    search = ChannelSearch(collect, page.certain.find_error)
    extremes = study.search_extremes(search, scope.reports - {SHARES}, whole=True, times=times)
    low, high = extremes.low, extremes.high
    bounds = {
        column.path: _make_bounds(low[i], extremes.low_at[i], high[i], extremes.high_at[i])
        for i, column in enumerate(columns)
    }
    if is_searched and columns and not study.has_one_instant:
        _add_spreads(bounds, columns, page.certain, samples, jumps)
    for run in runs:
        found = extremes.find([load.path for load in run.loads])
        found = found.join(search_stresses(run, page.certain, study)) if run.stresses else found
        bounds |= _make_run_bounds(found)
    return bounds, samples if is_searched and columns else None


def _add_spreads(
    bounds: dict[str, SnapshotBounds],
    columns: Sequence[Channel],
    certain: StatedErrors,
    samples: SampledColumns,
    jumps: UncertainJumps,
) -> None:
    """Add to the extremes of columns how far their instants may lie elsewhere."""
    times, values = samples.sorted_samples
    jump_error = float(jumps.errors.max(initial=0.0))
    for i, column in enumerate(columns):
        column_bounds, margin = bounds[column.path], MARGIN * certain.find_error(column)
        spreads: list[float | None] = []
        for side, bound in ((-1.0, column_bounds.low), (1.0, column_bounds.high)):
            known = bound is not None and np.isfinite(bound[0])
            spreads.append(
                jump_error + find_instant_spread(times, side * values[:, i], side * bound[0], bound[1], margin)
                if known and bound is not None
                else None
            )
        bounds[column.path] = column_bounds._replace(low_spread=spreads[0], high_spread=spreads[1])


def _make_bounds(low: float, low_at: float, high: float, high_at: float) -> SnapshotBounds:
    return SnapshotBounds((float(low), float(low_at), None), (float(high), float(high_at), None))


def _make_run_bounds(extremes: Extremes) -> dict[str, SnapshotBounds]:
    """Return the extremes along a series of cuts: the minimum belongs to the column of lowest values, the maximum to
    that of highest.
    """
    bounds: dict[str, SnapshotBounds] = {}
    for i, path in enumerate(extremes.paths):
        low = float(extremes.low[i]), float(extremes.low_at[i]), extremes.places[i][0]
        high = float(extremes.high[i]), float(extremes.high_at[i]), extremes.places[i][1]
        bounds |= {f"{path}.lowest": SnapshotBounds(low, None), f"{path}.highest": SnapshotBounds(None, high)}
    return bounds
