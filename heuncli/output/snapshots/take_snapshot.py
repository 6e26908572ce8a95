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
from heuncli.study.search.grid import find_jump_sides, sort_distinct

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
    view, scope = ResultView(results, labels, page.stated_errors), SnapshotScope(reports, labels)
    even = _choose_even_instants(results, given_instants) if whole_course else np.zeros(0)
    return make_run_snapshot(_make_course(study, page, view, even, scope), page, scope)


def is_searched_between_samples(study: Study, reports: frozenset[str]) -> bool:
    """Return whether the extremes of a snapshot are searched between the samples, or there is nothing between them."""
    results = study.results
    scope = SnapshotScope(reports, make_labels(study.spec))
    n_loads = sum(len(series.loads) for series in scope.collect_cut_series(results))
    return study.has_one_instant or study.is_searched(len(collect_columns(results, scope)) + n_loads)


def _choose_even_instants(results: Results, given_instants: Sequence[float]) -> Array:
    """Return eleven even instants of a run, or the given ones if they end with it, within rounding and its error."""
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
    """Find the jumps of a run. Where a jump depends on the motion, its error is the motion's error over the speed."""
    jumps = np.array(sorted(study.history.jumps))
    span = float(np.ptp(view.results.time))
    motion = view.results.accuracy.get("estimate", {}).get("motion") or 0.0
    errors = np.full(len(jumps), max(SLOW * motion, 2.0 * tolerances.EPS) * span)
    for impulse in view.results.impulses if len(jumps) else ():
        k = min(int(np.searchsorted(jumps, float(impulse["time"]))), len(jumps) - 1)
        for index in {max(k - 1, 0), k}:
            errors[index] = max(errors[index], estimate_impact_error(impulse, view))
    return UncertainJumps(jumps, errors)


def _sum_course(
    study: Study, scope: SnapshotScope, even: Array, jumps: UncertainJumps, samples: SampledColumns | None
) -> tuple[dict[str, Array], dict[str, CourseSums]]:
    """Return the columns at the even instants (n,), and the sums over the whole course of each, by their paths.

    samples: what a search has evaluated of them

    All instants are solved in one call: the even ones, uneven ones in each tenth, and the Gauss nodes of the pieces.
    """
    horizon = study.results.horizon
    uneven = make_tenth_instants(even)
    is_beyond = np.zeros(uneven.shape, dtype=bool) if horizon is None else uneven >= horizon
    pieces = split_into_pieces(study.search_times) if samples is not None and horizon is None else NO_PIECES
    instants = [even, np.where(is_beyond, even[0], uneven), pieces.nodes]
    values = _solve_instants(study, scope, np.concatenate([part.ravel() for part in instants]))
    nodes_begin = even.size + uneven.size
    near_jump = find_near_jumps(uneven, jumps.times, jumps.errors) | is_beyond
    sums: dict[str, CourseSums] = {}
    for path, column in values.items():
        own_sums = sum_tenths(column[even.size : nodes_begin].reshape(uneven.shape), near_jump)
        sums[path] = own_sums if horizon is None else own_sums.cut_at_horizon(np.asarray(is_beyond.any(axis=1)))
    if samples is not None and len(pieces.first):
        paths = [column.path for column in collect_columns(study.results, scope)]
        node_values = np.stack([values[path][nodes_begin:].reshape(-1, GAUSS.size) for path in paths], axis=2)
        end_error = (find_ending_error(study.results) or 0.0) / float(np.ptp(study.results.time))
        grid = samples.find_values(pieces.times)
        sums |= _add_integrals({path: sums[path] for path in paths}, pieces, grid, node_values, jumps, end_error)
    even_values = {path: column[: even.size] for path, column in values.items()}
    return even_values, {path: own_sums.without_words for path, own_sums in sums.items()}


def _add_integrals(
    sums: Mapping[str, CourseSums],
    pieces: Pieces,
    grid: Array,
    node_values: Array,
    jumps: UncertainJumps,
    end_error: float,
) -> dict[str, CourseSums]:
    """Add to the sums of columns their integrals over the run, where they are known throughout.

    grid (n_t, n_columns): the columns at the instants of the pieces
    node_values (m, 4, n_columns): the columns at the Gauss nodes of the pieces
    end_error: error of the run's end, as a share of the run
    """
    jump_errors = jumps.find_errors(pieces.times[:-1][find_jump_sides(pieces.times)])
    with np.errstate(invalid="ignore"):
        integrals = np.stack(integrate_columns(pieces, grid, node_values, jump_errors))
        integrals[2] += 2.0 * end_error * np.abs(grid).max(axis=0)
    found = dict(sums)
    for (path, own_sums), mean, moment, error in zip(sums.items(), *integrals.tolist(), strict=True):
        if np.isfinite([mean, moment, error]).all():
            found[path] = own_sums._replace(mean=mean, moment=moment, mean_error=error)
    return found


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
    columns, all_series = collect_columns(page.results, scope), scope.collect_cut_series(page.results)
    samples = SampledColumns()

    def collect(results: Results) -> list[Channel]:
        own = collect_columns(results, scope)
        values = [column.values for column in own]
        samples.add(results.time, np.stack(values, axis=1) if own else np.zeros((len(results.time), 0)))
        return own + (collect_series_loads(results) if all_series else [])

    n_channels = len(columns) + sum(len(series.loads) for series in all_series)
    is_searched = study.is_searched(n_channels)
    times = None if is_searched else study.results.time
    search = ChannelSearch(collect, page.stated_errors.find_error)
    extremes = study.search_extremes(search, scope.reports - {SHARES}, whole=True, times=times)
    low, high = extremes.low, extremes.high
    bounds = {
        column.path: _make_bounds(low[i], extremes.low_at[i], high[i], extremes.high_at[i])
        for i, column in enumerate(columns)
    }
    if is_searched and columns and not study.has_one_instant:
        _add_spreads(bounds, columns, page.stated_errors, samples, jumps)
    for series in all_series:
        found = extremes.find([load.path for load in series.loads])
        found = found.join(search_stresses(series, page.stated_errors, study)) if series.stresses else found
        bounds |= _make_series_bounds(found)
    return bounds, samples if is_searched and columns else None


def _add_spreads(
    bounds: dict[str, SnapshotBounds],
    columns: Sequence[Channel],
    stated_errors: StatedErrors,
    samples: SampledColumns,
    jumps: UncertainJumps,
) -> None:
    """Add to the extremes of columns how far their instants may lie elsewhere."""
    times, values = samples.sorted_samples
    jump_error = float(jumps.errors.max(initial=0.0))
    for i, column in enumerate(columns):
        column_bounds, margin = bounds[column.path], MARGIN * stated_errors.find_error(column)
        spreads: list[float | None] = [None, None]
        for k, (sign, bound) in enumerate(((-1.0, column_bounds.low), (1.0, column_bounds.high))):
            if bound is not None and np.isfinite(bound[0]):
                spread = find_instant_spread(times, sign * values[:, i], sign * bound[0], bound[1], margin)
                spreads[k] = jump_error + spread
        bounds[column.path] = column_bounds._replace(low_spread=spreads[0], high_spread=spreads[1])


def _make_bounds(low: float, low_at: float, high: float, high_at: float) -> SnapshotBounds:
    return SnapshotBounds((float(low), float(low_at), None), (float(high), float(high_at), None))


def _make_series_bounds(extremes: Extremes) -> dict[str, SnapshotBounds]:
    """Return the extremes along a series of cuts: the minimum of the lowest values, the maximum of the highest."""
    bounds: dict[str, SnapshotBounds] = {}
    for i, path in enumerate(extremes.paths):
        low = float(extremes.low[i]), float(extremes.low_at[i]), extremes.places[i][0]
        high = float(extremes.high[i]), float(extremes.high_at[i]), extremes.places[i][1]
        bounds |= {f"{path}.lowest": SnapshotBounds(low, None), f"{path}.highest": SnapshotBounds(None, high)}
    return bounds
