"""What a report asks a study to search for: the extremes of its rows, along its runs of cuts, and at their cuts."""

from __future__ import annotations

from heuncli.output.tables.cut_runs import CutRun, runs_of
from heuncli.output.tables.page import Page
from heuncli.output.tables.run_searches import RunExtremes, RunSearch, at_cuts, stresses_along
from heuncli.results.results import Extremes
from heuncli.results.results_schema import SHARES
from heuncli.study.ask.study import Study
from heuncli.study.search.extremes import ColumnSearch, no_columns

SECTIONS = frozenset({"sections"})


def rows(page: Page, study: Study, wanted: frozenset[str]) -> Extremes:
    """Of the rows of the page, and of the loads along its runs of cuts."""
    along = page.along if page.has_runs else None
    searched = ColumnSearch(page.columns, page.groups(), page.errors(), page.even(), along)
    return study.extremes(searched, wanted - {SHARES}, whole=True)


def along_runs(page: Page, study: Study) -> dict[str, RunExtremes]:
    """Of the stresses along each run of cuts, and of all at its cuts where more than one instant is told."""
    return {run.name: of_run(run, page, study) for run in runs_of(page.results, page.labels)}


def of_run(run: CutRun, page: Page, study: Study) -> RunExtremes:
    """Those of one run."""
    stresses = cuts = None
    if run.stresses:
        own = stresses_along(run, page.labels)
        searched = ColumnSearch(no_columns, [], own.errors(page.certain), own.even, own.along, bent=True)
        stresses = own.roots(study.extremes(searched, SECTIONS))
    if len(page.results.time) > 1:
        cuts = extremes_at_cuts(at_cuts(run, page.labels), page, study)
    return RunExtremes(stresses, cuts)


def extremes_at_cuts(own: RunSearch, page: Page, study: Study) -> Extremes:
    """Those of the quantities at each cut."""
    searched = ColumnSearch(own.columns, own.groups, own.errors(page.certain), own.even)
    return own.roots(study.extremes(searched, SECTIONS, whole=True))
