"""Search the extremes of a solved scene, and make the tables of `heun run`, of these or at given instants."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputTable
from heuncli.output.snapshots.run_notes import add_pins_note
from heuncli.output.tables.extremes_tables import MARK, NOT_SEARCHED, DoubtfulInstants
from heuncli.output.tables.page import Page, make_page
from heuncli.results.results import Array, Extremes, Results
from heuncli.results.results_schema import RESULTANTS, SHARES
from heuncli.study.compose.warnings import has_smoothed_friction, make_partial_note
from heuncli.study.model.selection import EntryKeys, Selection
from heuncli.study.quantities.channels import Channel, make_section_channels
from heuncli.study.quantities.cut_runs import CutRun, choose_cuts, collect_runs, split_into_cuts
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study, find_partial_friction
from heuncli.study.search.columns import ChannelSearch

AXIS: EntryKeys = ("foundation", "axis")
RUN_EXTREMES_SUFFIX = " (some of the extremes along series of cuts)"
AXIS_NOTE = "the central axis has no extremes: show it at given times with --at or --all"
SECTIONS = frozenset({"sections"})


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
    if query.show_all or query.instants is not None or (is_one_instant and not page.has_runs):
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
        if page.has_runs and page.doubtful.instants:
            tables.append(OutputTable("", notes=(page.doubtful.note.removeprefix(f"{MARK} ") + RUN_EXTREMES_SUFFIX,)))
        if AXIS in query.selection.entries:
            tables.append(OutputTable("", notes=(AXIS_NOTE,)))
    tables = add_pins_note(tables, study)
    if not tables:
        tables = [OutputTable("", notes=(f"nothing to show for {', '.join(sorted(reports))}: the model has none",))]
    return tables


def search_page(page: Page, study: Study, reports: frozenset[str]) -> tuple[Page, Extremes]:
    """Search the extremes of all channels of the page, with their places along its series of cuts.

    Returns the page with the extremes at single cuts of each run, if it has several instants, and all others.
    """
    found = study.search_extremes(page.make_search(), reports - {SHARES}, whole=True)
    runs = collect_runs(page.results, page.labels)
    for run in runs:
        if run.stresses:
            found = found.join(search_stresses(run, page.certain, study))
    if len(page.results.time) > 1:
        page = page._replace(cut_extremes={run.name: search_cuts(run, page.certain, study) for run in runs})
    return page, found


def search_stresses(run: CutRun, certain: StatedErrors, study: Study) -> Extremes:
    """Search the extremes of the stresses along a run."""

    def collect(results: Results) -> tuple[Channel, ...]:
        return make_section_channels(run.name, results.sections[run.name])[len(RESULTANTS) :]

    return study.search_extremes(ChannelSearch(collect, certain.find_error), SECTIONS)


def search_cuts(run: CutRun, certain: StatedErrors, study: Study) -> Extremes:
    """Search the extremes of all quantities at the cuts of a run that are shown."""

    def collect(results: Results) -> list[Channel]:
        channels = make_section_channels(run.name, results.sections[run.name])
        return split_into_cuts(channels, shown_cuts)

    shown_cuts = choose_cuts(run)
    return study.search_extremes(ChannelSearch(collect, certain.find_error), SECTIONS, whole=True)
