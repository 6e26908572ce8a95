"""The numbers of a solved scene as they are kept: what its tables tell, to full digits, with the errors it states.

Of every quantity: first and last value, the extremes searched between the samples with their instants, the values at
eleven even instants, and sums over its whole course (output/snapshots/course_sums.py), so that a course that changes
between its extremes is seen. Of a run of cuts the highest and the lowest of its cuts, with the extremes of the whole
stretch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.output.snapshots.columns import (
    KeptColumn,
    KeptScope,
    Told,
    all_columns,
    columns_of,
    position,
    run_path,
    values_of,
)
from heuncli.output.snapshots.course_sums import (
    GAUSS,
    NO_PIECES,
    CourseSums,
    Pieces,
    SampledColumns,
    instants_of_tenths,
    integrate_columns,
    near_jumps,
    pieces_of,
    spread_of_instant,
    sum_tenths,
)
from heuncli.output.snapshots.kept import EVEN, KeptRun
from heuncli.output.snapshots.record import KeptBounds, KeptCourse, blow_error, ending_error, record_of
from heuncli.output.tables.cut_runs import CutRun, RunQuantity
from heuncli.output.tables.page import Page, page_of
from heuncli.output.tables.run_searches import stresses_along
from heuncli.results.results import Array, Extremes, Place, Results
from heuncli.results.results_schema import SHARES, with_shared
from heuncli.study.ask.study import Study
from heuncli.study.quantities.labels import labels_of
from heuncli.study.quantities.table_units import Units
from heuncli.study.search.extremes import ColumnSearch, distinct, no_columns, sides_of_jumps

SI = Units({})
BACK = 1e-5  # of a run, over which the rate at its end is taken where an event ends it
SAME_END = 1e-6  # of a run: ends that differ by no more are those of one run, but for the error of the event there
SECTIONS = frozenset({"sections"})
SLOW = 10.0  # times slower than its size over its length a run may come to where it jumps: so much later is the jump
MARGIN = 5.0  # errors: two runs, of which the one is at most as uncertain, twice on either side, and the search's own


def keep(study: Study, wanted: frozenset[str], even_at: Sequence[float] = (), *, whole_course: bool = True) -> KeptRun:
    """The numbers of a study, of the reports that are wanted; even_at: the even instants of the run it is held to.

    whole_course: with what tells of the course between the extremes, which envelopes have no use for.
    """
    results = study.results
    labels = replace(labels_of(study.spec), units=SI)
    page = page_of(results, labels, study.magnitudes)
    told, scope = Told(results, labels, page.certain), KeptScope(wanted, labels)
    even = _even(results, even_at) if whole_course else np.zeros(0)
    return record_of(_course(study, page, told, even, scope), page, scope)


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
    drift: dict[str, float] = {}
    if ending_error(told.results) is not None:
        first, last = float(told.results.time[0]), float(told.results.time[-1])
        back = BACK * (last - first)
        near_end = values_of(study.resample(np.array([last - back, last])), scope)
        rates = {path: (x[1] - x[0]) / back for path, x in near_end.items()}
        drift = {path: abs(float(rate)) for path, rate in rates.items() if np.isfinite(rate) and rate}
    jumps = _jumps(study, told)
    bounds, sampled = _bounds(study, page, scope, jumps)
    if not len(instants):
        return KeptCourse(told, columns, dict.fromkeys(columns, instants), instants, bounds, drift)
    even, sums = _whole_course(study, scope, instants, jumps, sampled)
    return KeptCourse(told, columns, even, instants, bounds, drift, sums)


class UncertainJumps(NamedTuple):
    """The instants at which something jumps, ascending, and how far each may lie elsewhere [s], (n,) each."""

    times: Array
    errors: Array

    def errors_at(self, instants: Array) -> Array:
        """How far the jumps at some instants may lie elsewhere."""
        if not len(self.times):
            return np.zeros(len(instants))
        return np.asarray(self.errors[np.clip(np.searchsorted(self.times, instants), 0, len(self.times) - 1)])


def _jumps(study: Study, told: Told) -> UncertainJumps:
    """The jumps of a run. One that hangs on the motion is as uncertain as that, over the speed at which it is met."""
    jumps = np.array(sorted(study.history.jumps))
    span = float(np.ptp(told.results.time))
    motion = told.results.accuracy.get("estimate", {}).get("motion") or 0.0
    errors = np.full(len(jumps), max(SLOW * motion, 2.0 * tolerances.EPS) * span)
    for blow in told.results.impulses:
        k = min(int(np.searchsorted(jumps, float(blow["time"]))), max(len(jumps) - 1, 0))
        for own in {max(k - 1, 0), k} if len(jumps) else ():
            errors[own] = max(errors[own], blow_error(blow, told))
    return UncertainJumps(jumps, errors)


def _whole_course(
    study: Study, scope: KeptScope, even: Array, jumps: UncertainJumps, sampled: SampledColumns | None
) -> tuple[dict[str, Array], dict[str, CourseSums]]:
    """The columns at the even instants, and what tells of the whole course of each; sampled: what a search saw of them.

    All instants are answered in one go.
    """
    horizon = study.results.horizon
    uneven = instants_of_tenths(even)
    beyond = np.zeros(uneven.shape, dtype=bool) if horizon is None else uneven >= horizon
    pieces = pieces_of(study.search_times) if sampled is not None and horizon is None else NO_PIECES
    places = [even, np.where(beyond, even[0], uneven), pieces.nodes]
    values = _at_instants(study, scope, np.concatenate([at.ravel() for at in places]))
    n, m = len(even), len(even) + uneven.size
    near = near_jumps(uneven, jumps.times, jumps.errors) | beyond
    sums = {path: sum_tenths(own[n:m].reshape(uneven.shape), near) for path, own in values.items()}
    if horizon is not None:
        sums = {path: own.ended(np.asarray(beyond.any(axis=1))) for path, own in sums.items()}
    if sampled is not None and len(pieces.first):
        paths = [column.path for column in columns_of(study.results, scope)]
        inner = np.stack([values[path][m:].reshape(-1, GAUSS.size) for path in paths], axis=2)
        ends = (ending_error(study.results) or 0.0) / float(np.ptp(study.results.time))
        own = {path: sums[path] for path in paths}
        sums |= _with_integrals(own, pieces, sampled.at(pieces.times), inner, jumps, ends)
    return {path: own[:n] for path, own in values.items()}, {path: own.told for path, own in sums.items()}


def _with_integrals(
    sums: Mapping[str, CourseSums], pieces: Pieces, grid: Array, inner: Array, jumps: UncertainJumps, ends: float
) -> dict[str, CourseSums]:
    """The sums of columns with their integrals over the run, where they are known throughout.

    ends: the share of the run by which its end may lie elsewhere.
    """
    uncertain = jumps.errors_at(pieces.times[:-1][sides_of_jumps(pieces.times)])
    with np.errstate(invalid="ignore"):
        found = np.stack(integrate_columns(pieces, grid, inner, uncertain))
        found[2] += 2.0 * ends * np.abs(grid).max(axis=0)
    return {
        path: own._replace(mean=float(mean), moment=float(moment), mean_error=float(error))
        if np.isfinite([mean, moment, error]).all()
        else own
        for (path, own), mean, moment, error in zip(sums.items(), *found, strict=True)
    }


def _at_instants(study: Study, scope: KeptScope, times: Array) -> dict[str, Array]:
    """All columns at instants in any order, (n,) each."""
    instants = distinct(times)
    wanted, most = with_shared(scope.wanted - {SHARES}), study.instants_at_once
    parts = [values_of(study.reports_at(instants[i : i + most], wanted), scope) for i in range(0, len(instants), most)]
    order = np.searchsorted(instants, times)
    return {path: np.concatenate([part[path] for part in parts])[order] for path in parts[0]}


def _bounds(
    study: Study, page: Page, scope: KeptScope, jumps: UncertainJumps
) -> tuple[dict[str, KeptBounds], SampledColumns | None]:
    """The extremes of all columns, searched between the samples where there are not too many of them.

    Beside them what was seen of the columns on the way, where it was searched.
    """
    columns, runs = columns_of(page.results, scope), scope.runs(page.results)
    certain = page.certain
    errors = [certain.error(column.kind, column.unit) for column in columns]
    errors += [certain.error("sections", load.unit) for run in runs for load in run.loads]
    even = np.array([column.even for column in columns] + [False] * (len(errors) - len(columns)), dtype=bool)
    seen = SampledColumns()

    def sample(results: Results) -> Array:
        own = columns_of(results, scope)
        values = np.stack([column.values for column in own], axis=1) if own else np.zeros((len(results.time), 0))
        seen.add(results.time, values)
        return np.where(even[: len(own)], values * values, values)

    searched = ColumnSearch(
        sample, [[i] for i in range(len(columns))], np.array(errors), even, page.along if runs else None
    )
    is_searched = study.is_searched(len(errors))
    times = None if is_searched else study.results.time
    found = study.extremes(searched, scope.wanted - {SHARES}, whole=True, times=times)
    low, high = (np.where(even, np.sqrt(np.abs(bound)), bound) for bound in (found.low, found.high))
    bounds = {
        column.path: _bounds_of(low[i], found.low_at[i], high[i], found.high_at[i]) for i, column in enumerate(columns)
    }
    if is_searched and columns and not study.of_one_instant:
        _add_spreads(bounds, columns, errors, seen, jumps)
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
    return bounds, seen if is_searched and columns else None


def _add_spreads(
    bounds: dict[str, KeptBounds], columns: Sequence[KeptColumn], errors: Sequence[float], seen: SampledColumns,
    jumps: UncertainJumps,
) -> None:  # fmt: skip
    """Put into the extremes of columns how far their instants may lie elsewhere."""
    times, values = seen.together
    off = float(jumps.errors.max(initial=0.0))
    for i, column in enumerate(columns):
        own, margin = bounds[column.path], MARGIN * errors[i]
        spreads: list[float | None] = []
        for side, bound in ((-1.0, own.low), (1.0, own.high)):
            known = bound is not None and np.isfinite(bound[0])
            spreads.append(
                off + spread_of_instant(times, side * values[:, i], side * bound[0], bound[1], margin)
                if known and bound is not None
                else None
            )
        bounds[column.path] = own._replace(low_spread=spreads[0], high_spread=spreads[1])


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
