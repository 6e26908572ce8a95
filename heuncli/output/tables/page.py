"""The whole report of a run as tables, the channels whose extremes they need, and the search of these.

`search_run` makes the page of a solved scene and searches the extremes; `make_tables_of_page` makes the tables. Step by
step: `make_page(results, labels, magnitudes)`, search `page.make_search()`, pass the extremes to
`make_tables_of_extremes`; or call `make_tables_at_instants`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputTable
from heuncli.output.tables import cut_tables
from heuncli.output.tables.extremes_tables import (
    MARK,
    NO_DOUBT,
    NOT_SEARCHED,
    DoubtfulInstants,
    drop_components,
    make_extremes_tables,
)
from heuncli.output.tables.indeterminate import make_sums_table
from heuncli.output.tables.instants_tables import make_instants_tables
from heuncli.output.tables.run_description import add_pins_note
from heuncli.output.tables.table_blocks import TableBlock, build_block
from heuncli.output.tables.table_plans import PLANS
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Array, DeterminateSum, Extremes, Magnitudes, Results
from heuncli.results.results_schema import REPORT_OF, REPORTS, RESULTANTS, SHARES
from heuncli.study.compose.warnings import has_smoothed_friction, make_partial_note
from heuncli.study.model.selection import EntryKeys, Selection
from heuncli.study.quantities.channel_selection import ChannelSelection
from heuncli.study.quantities.channels import Channel, iter_channels, make_section_channels
from heuncli.study.quantities.cut_series import CutSeries, choose_cuts, collect_cut_series, split_into_cuts
from heuncli.study.quantities.digits import StatedErrors, add_axis_errors, find_stated_errors
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study, find_partial_friction
from heuncli.study.search.columns import ChannelSearch

if TYPE_CHECKING:
    from heuncli.output.tables.page_cause_tables import ShareSource

TABLE_DEFAULT = frozenset(REPORTS) - {"motion", "points"}
EXPORT_DEFAULT = frozenset(REPORTS) - {"points"}
NO_EXTREMES: Mapping[str, Extremes] = MappingProxyType({})
AXIS: EntryKeys = ("foundation", "axis")
SERIES_EXTREMES_SUFFIX = " (some of the extremes along series of cuts)"
AXIS_NOTE = "the central axis has no extremes: show it at given times with --at or --all"
SECTIONS = frozenset({"sections"})


class Page(NamedTuple):
    """The tables of a run: its blocks and series of cuts up to the horizon, before they are laid out.

    magnitudes: what its numbers are summed from
    last_instant: results at the last instant, if the run ends beyond its horizon
    impact_extremes: for each impact, the extremes along its series of cuts
    cut_extremes: for each series of cuts, the extremes at the cuts that are shown
    details: whether to include tables that are shown only on request
    doubtful: instants whose extremes are marked
    full: whether to repeat what is constant or indeterminate
    """

    results: Results
    labels: Labels
    stated_errors: StatedErrors
    magnitudes: Magnitudes
    last_instant: Results | None = None
    impact_extremes: Sequence[Mapping[str, Extremes]] = ()
    cut_extremes: Mapping[str, Extremes] = NO_EXTREMES
    details: bool = True
    doubtful: DoubtfulInstants = NO_DOUBT
    full: bool = True

    @property
    def has_cut_series(self) -> bool:
        """Whether there are series of cuts."""
        return any("s" in section for section in self.results.sections.values())

    def make_search(self) -> ChannelSearch:
        """Make the search of the numbers of all blocks, and of the section forces along series of cuts."""
        blocks = self.make_blocks(self.results, only_searched=True)
        numbers = [row for block in blocks for group in block.groups for row in group.rows]
        selection = ChannelSelection(self.labels, numbers, has_cut_series=self.has_cut_series)
        return ChannelSearch(selection.collect, self.stated_errors.find_error)

    def make_tables_of_extremes(self, search_result: Extremes, shares: ShareSource | None = None) -> list[OutputTable]:
        """Make the tables of extremes.

        search_result: the extremes of the channels
        shares: source of loads by cause, if they are requested
        """
        tables: list[OutputTable] = []
        times, last_values = self.results.time, self._find_last_values()
        for block in self.make_blocks(self.results, only_searched=True):
            part = search_result.find(block.paths)
            tables += make_extremes_tables(
                block, times, part, self.stated_errors, last_values, self.doubtful, full=self.full
            )
        for series in collect_cut_series(self.results, self.labels):
            cuts = self.cut_extremes.get(series.name)
            tables += cut_tables.make_extremes_tables(series, times, search_result, self.stated_errors, cuts)
        share_tables = self._make_extremes_share_tables(search_result, shares) if shares is not None else []
        return [*tables, *share_tables, *self._make_closing_tables()]

    def _make_extremes_share_tables(self, search_result: Extremes, shares: ShareSource) -> list[OutputTable]:
        """Make the tables of what each cause contributes to the extremes."""
        from heuncli.output.tables.page_cause_tables import PageContents, make_page_extremes_tables

        contents = PageContents(
            self.make_blocks(self.results, only_searched=True),
            collect_cut_series(self.results, self.labels),
            self.labels,
            self.stated_errors,
        )
        return make_page_extremes_tables(contents, search_result, shares, float(np.ptp(self.results.time)))

    def make_tables_at_instants(
        self,
        results: Results,
        *,
        every_cut: bool = False,
        search_result: Extremes | None = None,
        shares: ShareSource | None = None,
    ) -> list[OutputTable]:
        """Make the tables at the instants of `results`, which is the same run solved at any instants.

        search_result: extremes along the series of cuts, if there is one instant only
        """
        horizon = self.results.horizon
        unknown = frozenset(results.accuracy.get("unknown", ()))
        stated_errors = add_axis_errors(self.stated_errors._replace(singular_times=unknown), results, self.magnitudes)
        tables: list[OutputTable] = []
        for block in self.make_blocks(results):
            tables += make_instants_tables(block, results.time, horizon, stated_errors)
        for series in collect_cut_series(results, self.labels):
            if search_result is not None:
                tables.append(cut_tables.make_extremes_table(series, results.time, search_result, self.stated_errors))
            series_tables = cut_tables.make_instants_tables(
                series, results.time, horizon, self.stated_errors, every_cut=every_cut
            )
            tables += (
                [series_tables[0]._replace(heading=""), *series_tables[1:]]
                if search_result is not None
                else series_tables
            )
        if shares is not None:
            tables += self._make_instants_share_tables(results, stated_errors, search_result, shares)
        return [*tables, *self._make_closing_tables(every_cut)]

    def _make_instants_share_tables(
        self, results: Results, stated_errors: StatedErrors, search_result: Extremes | None, shares: ShareSource
    ) -> list[OutputTable]:
        """Make the tables of what each cause contributes at the given instants."""
        from heuncli.output.tables.page_cause_tables import (
            PageContents,
            find_series_extremes_tables,
            make_page_instants_tables,
            make_series_instants_tables,
        )

        horizon, all_series = self.results.horizon, collect_cut_series(results, self.labels)
        contents = PageContents(self.make_blocks(results), all_series, self.labels, self.stated_errors)
        tables = make_page_instants_tables(contents, results, horizon, stated_errors)
        for series in all_series:
            if search_result is not None:
                tables += find_series_extremes_tables(series, self.stated_errors, search_result, shares)
            else:
                tables += make_series_instants_tables(series, results, horizon, stated_errors)
        return tables

    def _find_last_values(self) -> dict[str, float]:
        """Return the numbers at the last instant by their paths, if the run ends beyond its horizon."""
        if self.last_instant is None:
            return {}
        blocks = self.make_blocks(self.last_instant, only_searched=True)
        return {row.path: float(row.values[-1]) for block in blocks for group in block.groups for row in group.rows}

    def make_blocks(self, results: Results, *, only_searched: bool = False) -> list[TableBlock]:
        """Make the blocks of results of this run; only_searched: those whose extremes are searched."""
        channels = list(iter_channels(results, self.labels))
        plans = [
            plan for plan in PLANS if (plan.has_extremes or not only_searched) and (self.details or not plan.is_detail)
        ]
        blocks = [block for plan in plans if (block := build_block(plan, results, self.labels, channels)) is not None]
        return [drop_components(block) for block in blocks] if only_searched else blocks

    def _make_closing_tables(self, show_all: bool = False) -> list[OutputTable]:
        """Make the tables at the end of the page: determinate sums, events, impulses."""
        sums = make_sums_table(self.results, self.stated_errors, self.last_instant)
        return [*([sums] if sums else []), *self._make_event_tables(show_all), *self._make_impulse_tables(show_all)]

    def _make_event_tables(self, show_all: bool) -> list[OutputTable]:
        """Make the table of the instants at which conditions are met, if there are any."""
        if not self.results.events:
            return []
        from heuncli.output.tables.event_tables import make_events_table  # if there are conditions

        return [make_events_table(self.results, all_instants=show_all)]

    def _make_impulse_tables(self, show_all: bool) -> list[OutputTable]:
        """Make the tables of impulses and impacts, if there are any."""
        if not self.results.impulses:
            return []
        from heuncli.output.tables.event_tables import ImpactReport, make_impulse_tables  # if there are impacts

        report = ImpactReport(
            self.results, self.labels, self.stated_errors, self.magnitudes, self.impact_extremes, self.details
        )
        return make_impulse_tables(report, show_all=show_all)


def make_page(
    results: Results, labels: Labels, magnitudes: Magnitudes, *, details: bool = True, full: bool = True
) -> Page:
    """Make the page of a run; instants from the horizon on are left out, except the last, which is kept apart.

    magnitudes: what its numbers are summed from
    """
    horizon = results.horizon
    stated_errors = find_stated_errors(results, labels, magnitudes)
    if horizon is None or results.time[-1] < horizon:
        return Page(results, labels, stated_errors, magnitudes, details=details, full=full)
    n_known = max(1, int(np.searchsorted(results.time, horizon)))
    last_instant = select_instants(results, slice(-1, None))
    known = select_instants(results, slice(n_known))
    return Page(known, labels, stated_errors, magnitudes, last_instant, details=details, full=full)


def select_instants(results: Results, which: slice) -> Results:
    """Return the results at some of their instants."""

    def select(keys: tuple[str, ...], value: Any) -> Any:
        if isinstance(value, dict):
            return {key: select((*keys, key), member) for key, member in value.items()}
        row = find_quantity(keys)
        return value[which] if row is not None and row.is_timed else value

    blocks = {block: select((block,), getattr(results, block)) for block in REPORT_OF}
    sums = [_select_sum_instants(block, which) for block in results.certain_sums]
    return replace(results, time=results.time[which], certain_sums=sums, **blocks)


def _select_sum_instants(block: DeterminateSum, which: slice) -> DeterminateSum:
    """Return a determinate sum at some instants; a factor that depends on the pose is an array over them."""
    factors = {
        path: factor[which] if isinstance(factor, np.ndarray) else factor for path, factor in block["terms"].items()
    }
    return {**block, "terms": factors, "value": block["value"][which]}


class TablesQuery(NamedTuple):
    """What the tables are to show.

    selection: the reports and entries
    instants (n,): None for the extremes
    show_all: all instants, and every cut of a series of cuts
    details: include what is shown only on request by name
    full: repeat what is constant or indeterminate
    """

    selection: Selection
    instants: Array | None = None
    show_all: bool = False
    details: bool = False
    full: bool = True


class SearchedPage(NamedTuple):
    """The page of a run and the extremes of its channels; None where none are searched: at given instants, or at the
    only one.
    """

    page: Page
    extremes: Extremes | None


def search_run(study: Study, labels: Labels, query: TablesQuery) -> SearchedPage:
    """Make the page of a solved scene, and search the extremes that its tables need."""
    page = make_page(study.results, labels, study.magnitudes, details=query.details, full=query.full)
    if study.results.impulses:
        page = page._replace(impact_extremes=study.find_impulse_extremes())
    is_one_instant = len(study.results.time) == 1
    if query.show_all or query.instants is not None or (is_one_instant and not page.has_cut_series):
        return SearchedPage(page, None)
    page, extremes = search_page(page, study, query.selection.reports)
    if has_smoothed_friction(study.setup.scene.mechanism):
        doubtful_instants = find_partial_friction(study, [*extremes.low_at.tolist(), *extremes.high_at.tolist()])
        page = page._replace(
            doubtful=DoubtfulInstants.with_reason(doubtful_instants, make_partial_note(doubtful_instants))
        )
    return SearchedPage(page, extremes)


def make_tables(study: Study, labels: Labels, query: TablesQuery) -> list[OutputTable]:
    """Search the extremes and make the tables before they are split to a width; never an empty list."""
    return make_tables_of_page(study, search_run(study, labels, query), query)


def make_tables_of_page(study: Study, searched: SearchedPage, query: TablesQuery) -> list[OutputTable]:
    """Make the tables of a searched run; never an empty list."""
    page, extremes = searched
    reports = query.selection.reports
    shares = study if SHARES in reports else None
    if extremes is None or len(study.results.time) == 1:
        shown = study.results if query.instants is None else study.resample(query.instants)
        tables = page.make_tables_at_instants(shown, every_cut=query.show_all, search_result=extremes, shares=shares)
    else:
        tables = page.make_tables_of_extremes(extremes, shares)
        if not extremes.is_searched:
            tables.insert(0, OutputTable("", notes=(NOT_SEARCHED,)))
        if page.has_cut_series and page.doubtful.instants:
            tables.append(
                OutputTable("", notes=(page.doubtful.note.removeprefix(f"{MARK} ") + SERIES_EXTREMES_SUFFIX,))
            )
        if AXIS in query.selection.entries:
            tables.append(OutputTable("", notes=(AXIS_NOTE,)))
    tables = add_pins_note(tables, study)
    if not tables:
        tables = [OutputTable("", notes=(f"nothing to show for {', '.join(sorted(reports))}: the model has none",))]
    return tables


def search_page(page: Page, study: Study, reports: frozenset[str]) -> tuple[Page, Extremes]:
    """Search the extremes of all channels of the page, with their places along its series of cuts.

    Returns the page, which for several instants now holds the extremes at single cuts, and those of all channels.
    """
    found = study.search_extremes(page.make_search(), reports - {SHARES}, whole=True)
    all_series = collect_cut_series(page.results, page.labels)
    for series in all_series:
        if series.stresses:
            found = found.join(search_stresses(series, page.stated_errors, study))
    if len(page.results.time) > 1:
        page = page._replace(
            cut_extremes={series.name: search_cuts(series, page.stated_errors, study) for series in all_series}
        )
    return page, found


def search_stresses(series: CutSeries, stated_errors: StatedErrors, study: Study) -> Extremes:
    """Search the extremes of the stresses along a series of cuts."""

    def collect(results: Results) -> tuple[Channel, ...]:
        # the stresses follow the resultants
        return make_section_channels(series.name, results.sections[series.name])[len(RESULTANTS) :]

    return study.search_extremes(ChannelSearch(collect, stated_errors.find_error), SECTIONS)


def search_cuts(series: CutSeries, stated_errors: StatedErrors, study: Study) -> Extremes:
    """Search the extremes of all quantities at the cuts of a series that are shown."""

    shown_cuts = choose_cuts(series)

    def collect(results: Results) -> list[Channel]:
        channels = make_section_channels(series.name, results.sections[series.name])
        return split_into_cuts(channels, shown_cuts)

    return study.search_extremes(ChannelSearch(collect, stated_errors.find_error), SECTIONS, whole=True)
