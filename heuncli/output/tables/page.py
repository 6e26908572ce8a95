"""The whole report of a run as tables, and the columns whose extremes must be searched.

Call `make_page(results, labels, magnitudes)` first. Then search with `make_columns` and `make_groups` and pass the
outcome to `make_tables_of_extremes`, or call `make_tables_at_instants`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputTable
from heuncli.output.tables import cut_runs
from heuncli.output.tables.certain_sums import make_sums_table
from heuncli.output.tables.extremes_tables import NO_DOUBT, DoubtfulInstants, drop_components, make_extremes_tables
from heuncli.output.tables.instants_tables import make_instants_tables
from heuncli.output.tables.run_searches import NO_EXTREMES, RunExtremes, append_stresses
from heuncli.output.tables.table_blocks import NumberRow, TableBlock, build_block
from heuncli.output.tables.table_plans import PLANS
from heuncli.results.results import Array, CutPosition, DeterminateSum, Extremes, Magnitudes, Mask, Results
from heuncli.results.results_schema import REPORT_OF, REPORTS, find_quantity
from heuncli.study.quantities.digits import StatedErrors, add_axis_errors, find_stated_errors
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, convert_units, iter_series

TABLE_DEFAULT = frozenset(REPORTS) - {"motion", "points"}
EXPORT_DEFAULT = frozenset(REPORTS) - {"points"}


if TYPE_CHECKING:
    from heuncli.output.tables import cause_tables


class ShareSource(Protocol):
    """Solves a run's loads by cause at any instants."""

    def compute_shares(self, times: Array) -> Results:
        """Return the results with shares at instants (n,), in ascending order."""

    def compute_shares_along(self, name: str, times: Array, places: Sequence[CutPosition]) -> Results:
        """Return the results with shares at instants (n,), with a run of cuts that is cut only at these places."""


class Page(NamedTuple):
    """The tables of a run: its blocks and runs of cuts up to the horizon, before they are laid out.

    magnitudes: what its numbers are summed from
    last_instant: results at the last instant, if the run ends beyond its horizon
    impact_extremes: for each impact, the extremes along its runs of cuts
    run_extremes: for the whole run, further extremes of its runs of cuts
    details: whether to include tables that are shown only on request
    doubtful: instants whose extremes are marked
    """

    results: Results
    labels: Labels
    certain: StatedErrors
    magnitudes: Magnitudes
    last_instant: Results | None = None
    impact_extremes: Sequence[Mapping[str, Extremes]] = ()
    run_extremes: Mapping[str, RunExtremes] = NO_EXTREMES
    details: bool = True
    doubtful: DoubtfulInstants = NO_DOUBT

    def make_columns(self, results: Results) -> Array:
        """Return all rows of all blocks as columns for the search, (n_t, n), magnitudes squared."""
        rows = [row.values**2 if row.is_magnitude else row.values for row in self._find_rows(results)]
        return np.stack(rows, axis=1) if rows else np.zeros((len(results.time), 0))

    def make_run_columns(self, results: Results) -> list[tuple[str, Array]]:
        """Return the section forces of the runs of cuts, (n_t, n_cuts) each, with the names of their runs."""
        runs = cut_runs.collect_runs(results, self.labels)
        return [(run.name, values) for run in runs for values in run.values[: len(cut_runs.LOADS)]]

    @property
    def has_runs(self) -> bool:
        """Whether there are runs of cuts."""
        return any("s" in section for section in self.results.sections.values())

    def make_groups(self) -> list[list[int]]:
        """Return the groups of columns that are compared with each other: here each column is its own group."""
        return [[column] for column in range(len(self._find_rows(self.results)))]

    def find_errors(self) -> Array:
        """Return the error of each row and of each section force of runs, (n,)."""
        errors = [self.certain.error_of(row.kind, row.unit) for row in self._find_rows(self.results)]
        for _ in cut_runs.collect_runs(self.results, self.labels):
            errors += [self.certain.error_of("sections", load.unit) for load in cut_runs.LOADS]
        return np.array(errors)

    def find_magnitude_mask(self) -> Mask:
        """Return the mask of columns that are squares of magnitudes, (n,)."""
        rows = [row.is_magnitude for row in self._find_rows(self.results)]
        n_loads = len(cut_runs.LOADS) * len(cut_runs.collect_runs(self.results, self.labels))
        return np.array(rows + [False] * n_loads, dtype=bool)

    def make_tables_of_extremes(self, search_result: Extremes, shares: ShareSource | None = None) -> list[OutputTable]:
        """Make the tables of extremes.

        search_result: the extremes of each group of columns
        shares: source of loads by cause, if they are requested
        """
        tables: list[OutputTable] = []
        start = 0
        times, all_last_values = self.results.time, self._find_last_values()
        for block in self._find_searched_blocks(self.results):
            rows = [row for group in block.groups for row in group.rows]
            columns = slice(start, start + len(rows))
            part = self._take_roots(block, search_result.select(columns))
            last_values = all_last_values[columns] if all_last_values is not None else None
            tables += make_extremes_tables(block, times, part, self.certain, last_values, self.doubtful)
            start += len(rows)
        for k, run in enumerate(cut_runs.collect_runs(self.results, self.labels)):
            found = self.run_extremes.get(run.name, RunExtremes())
            loads_and_stresses = append_stresses(run, *self._find_run_extremes(search_result, k), found.stresses)
            tables += cut_runs.make_extremes_tables(run, times, *loads_and_stresses, self.certain, found.cuts)
        share_tables = self._make_share_tables(search_result, shares) if shares is not None else []
        return [*tables, *share_tables, *self._make_last_tables()]

    def _make_share_tables(self, search_result: Extremes, shares: ShareSource) -> list[OutputTable]:
        """Make the tables of what each cause contributes to the extremes."""
        from heuncli.output.tables import cause_tables  # few runs ask for them

        n = len(search_result.low) - len(search_result.places)
        instants = np.unique(np.concatenate([search_result.low_at[:n], search_result.high_at[:n]]))
        numbers = self._collect_shares(shares.compute_shares(instants)) if n else {}
        span, tables, start = float(np.ptp(self.results.time)), list[OutputTable](), 0
        for block in self._find_searched_blocks(self.results):
            count = sum(len(group.rows) for group in block.groups)
            block_extremes = self._take_roots(block, search_result.select(slice(start, start + count)))
            tables += cause_tables.make_extremes_tables(block, numbers, instants, block_extremes, self.certain, span)
            start += count
        for k, run in enumerate(cut_runs.collect_runs(self.results, self.labels)):
            tables += self._make_run_share_tables(run, search_result, k, shares)
        return tables

    def _collect_shares(self, results: Results) -> dict[cause_tables.NumberKey, cause_tables.NumberWithShares]:
        from heuncli.output.tables import cause_tables

        return cause_tables.collect_shares(results, convert_units(iter_series(results, self.labels), self.labels.units))

    def _make_run_share_tables(
        self, run: cut_runs.CutRun, search_result: Extremes, k: int, shares: ShareSource
    ) -> list[OutputTable]:
        """Make the tables of what each cause contributes to the extremes along a run of cuts."""
        from heuncli.output.tables import cause_tables

        extremes, places = self._find_run_extremes(search_result, k)
        instants = np.unique(np.concatenate([extremes.low_at, extremes.high_at]))
        results = shares.compute_shares_along(run.name, instants, [place for both in places for place in both])
        return cause_tables.make_run_extremes_tables(run, results, extremes, places, self.certain)

    @staticmethod
    def _take_roots(block: TableBlock, extremes: Extremes) -> Extremes:
        """Replace the extremes of squared magnitudes by those of the magnitudes."""
        is_magnitude = np.array([row.is_magnitude for group in block.groups for row in group.rows], dtype=bool)
        low, high = (np.where(is_magnitude, np.sqrt(np.abs(bound)), bound) for bound in (extremes.low, extremes.high))
        return extremes._replace(low=low, high=high)

    def make_tables_at_instants(
        self,
        results: Results,
        *,
        every_cut: bool = False,
        search_result: Extremes | None = None,
        shares: ShareSource | None = None,
    ) -> list[OutputTable]:
        """Make the tables at the instants of `results`, which is the same run solved at any instants.

        search_result: extremes along the runs of cuts, if there is one instant only
        """
        horizon = self.results.horizon
        unknown = frozenset(results.accuracy.get("unknown", ()))
        certain = add_axis_errors(
            self.certain._replace(singular_times=unknown), results, self.magnitudes, self.labels.units
        )
        tables: list[OutputTable] = []
        for block in self._make_blocks(results):
            tables += make_instants_tables(block, results.time, horizon, certain)
        for k, run in enumerate(cut_runs.collect_runs(results, self.labels)):
            if search_result is not None:
                found = self.run_extremes.get(run.name, RunExtremes())
                loads_and_stresses = append_stresses(run, *self._find_run_extremes(search_result, k), found.stresses)
                tables.append(cut_runs.make_extremes_table(run, results.time, *loads_and_stresses, self.certain))
            run_tables = cut_runs.make_instants_tables(run, results.time, horizon, self.certain, every_cut=every_cut)
            tables += [run_tables[0]._replace(heading=""), *run_tables[1:]] if search_result is not None else run_tables
        if shares is not None:
            tables += self._make_instants_share_tables(results, certain, search_result, shares)
        return [*tables, *self._make_last_tables(every_cut)]

    def _make_instants_share_tables(
        self, results: Results, certain: StatedErrors, search_result: Extremes | None, shares: ShareSource
    ) -> list[OutputTable]:
        """Make the tables of what each cause contributes at the given instants."""
        from heuncli.output.tables import cause_tables  # few runs ask for them

        horizon = self.results.horizon
        numbers, tables = self._collect_shares(results), list[OutputTable]()
        for block in self._make_blocks(results):
            tables += cause_tables.make_instants_tables(block, numbers, results.time, horizon, certain)
        for k, run in enumerate(cut_runs.collect_runs(results, self.labels)):
            if search_result is not None:
                tables += self._make_run_share_tables(run, search_result, k, shares)
            else:
                tables += cause_tables.make_run_instants_tables(run, results, horizon, certain)
        return tables

    def _find_run_extremes(
        self, search_result: Extremes, k: int
    ) -> tuple[Extremes, tuple[tuple[CutPosition, CutPosition], ...]]:
        """Return the extremes of the section forces of run k, and their places."""
        n = len(cut_runs.LOADS)
        first = len(search_result.low) - len(search_result.places) + n * k
        return search_result.select(slice(first, first + n)), search_result.places[n * k : n * (k + 1)]

    def _find_last_values(self) -> Array | None:
        """Return the values of all rows at the last instant, or None if the run ends within its horizon."""
        if self.last_instant is None:
            return None
        blocks = self._find_searched_blocks(self.last_instant)
        return np.array([row.values[-1] for block in blocks for group in block.groups for row in group.rows])

    def _find_rows(self, results: Results) -> list[NumberRow]:
        return [row for block in self._find_searched_blocks(results) for group in block.groups for row in group.rows]

    def _find_searched_blocks(self, results: Results) -> list[TableBlock]:
        return self._make_blocks(results, only_searched=True)

    def _make_blocks(self, results: Results, *, only_searched: bool = False) -> list[TableBlock]:
        series: Sequence[Series] = convert_units(iter_series(results, self.labels), self.labels.units)
        plans = [
            plan for plan in PLANS if (plan.has_extremes or not only_searched) and (self.details or not plan.is_detail)
        ]
        blocks = [block for plan in plans if (block := build_block(plan, results, self.labels, series)) is not None]
        return [drop_components(block) for block in blocks] if only_searched else blocks

    def _make_last_tables(self, show_all: bool = False) -> list[OutputTable]:
        sums = make_sums_table(self.results, self.certain, self.last_instant, self.labels.units.find("N"))
        return [*([sums] if sums else []), *self._make_event_tables(show_all), *self._make_impulse_tables(show_all)]

    def _make_event_tables(self, show_all: bool) -> list[OutputTable]:
        if not self.results.events:
            return []
        from heuncli.output.tables.event_table import make_events_table  # if there are conditions

        return [make_events_table(self.results, all_instants=show_all)]

    def _make_impulse_tables(self, show_all: bool) -> list[OutputTable]:
        if not self.results.impulses:
            return []
        from heuncli.output.tables.impulse_tables import ImpactReport, make_impulse_tables  # if there are impacts

        report = ImpactReport(
            self.results, self.labels, self.certain, self.magnitudes, self.impact_extremes, self.details
        )
        return make_impulse_tables(report, show_all=show_all)


def make_page(results: Results, labels: Labels, magnitudes: Magnitudes, *, details: bool = True) -> Page:
    """Make the page of a run, which ends before the run's horizon.

    magnitudes: what its numbers are summed from
    """
    horizon = results.horizon
    certain = find_stated_errors(results, labels, magnitudes)
    if horizon is None or results.time[-1] < horizon:
        return Page(results, labels, certain, magnitudes, details=details)
    n_known = max(1, int(np.searchsorted(results.time, horizon)))
    last_instant = select_instants(results, slice(-1, None))
    return Page(select_instants(results, slice(n_known)), labels, certain, magnitudes, last_instant, details=details)


def select_instants(results: Results, which: slice) -> Results:
    """Return the results at some of their instants."""

    def those(keys: tuple[str, ...], value: Any) -> Any:
        if isinstance(value, dict):
            return {key: those((*keys, key), member) for key, member in value.items()}
        row = find_quantity(keys)
        return value[which] if row is not None and row.is_timed else value

    blocks = {block: those((block,), getattr(results, block)) for block in REPORT_OF}
    sums = [_select_sum_instants(block, which) for block in results.certain_sums]
    return replace(results, time=results.time[which], certain_sums=sums, **blocks)


def _select_sum_instants(block: DeterminateSum, which: slice) -> DeterminateSum:
    """Return a determinate sum at some instants; a factor that depends on the pose is an array over them."""
    factors = {
        path: factor[which] if isinstance(factor, np.ndarray) else factor for path, factor in block["terms"].items()
    }
    return {"terms": factors, "value": block["value"][which]}
