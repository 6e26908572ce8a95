"""The searches of a report: extremes of its channels, along its series of cuts, and at their cuts."""

from __future__ import annotations

from heuncli.output.tables.page import Page
from heuncli.results.results import Extremes, Results
from heuncli.results.results_schema import RESULTANTS, SHARES
from heuncli.study.quantities.channels import Channel, make_section_channels
from heuncli.study.quantities.cut_runs import CutRun, choose_cuts, collect_runs, split_into_cuts
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch

SECTIONS = frozenset({"sections"})


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
