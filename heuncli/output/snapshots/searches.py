"""The searches of a report: extremes of its rows, along its runs of cuts, and at their cuts."""

from __future__ import annotations

from heuncli.output.tables.cut_runs import CutRun, collect_runs
from heuncli.output.tables.page import Page
from heuncli.output.tables.run_searches import RunExtremes, RunSearch, search_cuts, search_stresses
from heuncli.results.results import Extremes
from heuncli.results.results_schema import SHARES
from heuncli.study.queries.study import Study
from heuncli.study.search.extremes import ColumnSearch, make_no_columns

SECTIONS = frozenset({"sections"})


def search_rows(page: Page, study: Study, reports: frozenset[str]) -> Extremes:
    """Search the extremes of the rows of the page, and of the section forces along its runs of cuts."""
    run_columns = page.make_run_columns if page.has_runs else None
    searched = ColumnSearch(
        page.make_columns, page.make_groups(), page.find_errors(), page.find_magnitude_mask(), run_columns
    )
    return study.search_extremes(searched, reports - {SHARES}, whole=True)


def search_runs(page: Page, study: Study) -> dict[str, RunExtremes]:
    """Search the extremes of each run of cuts: of its stresses, and at its cuts if the page has several instants."""
    return {run.name: search_run(run, page, study) for run in collect_runs(page.results, page.labels)}


def search_run(run: CutRun, page: Page, study: Study) -> RunExtremes:
    """Search the extremes of one run of cuts."""
    stresses = cuts = None
    if run.stresses:
        stress_search = search_stresses(run, page.labels)
        searched = ColumnSearch(
            make_no_columns,
            [],
            stress_search.find_errors(page.certain),
            stress_search.magnitude_columns,
            stress_search.run_columns,
            bent=True,
        )
        stresses = stress_search.take_roots(study.search_extremes(searched, SECTIONS))
    if len(page.results.time) > 1:
        cuts = search_cut_extremes(search_cuts(run, page.labels), page, study)
    return RunExtremes(stresses, cuts)


def search_cut_extremes(cut_search: RunSearch, page: Page, study: Study) -> Extremes:
    """Search the extremes of the quantities at each cut."""
    searched = ColumnSearch(
        cut_search.make_columns, cut_search.groups, cut_search.find_errors(page.certain), cut_search.magnitude_columns
    )
    return cut_search.take_roots(study.search_extremes(searched, SECTIONS, whole=True))
