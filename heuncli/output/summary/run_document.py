"""The document of a run: heading, summary, tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputDocument, OutputTable
from heuncli.output.snapshots.tables import SearchedPage, TablesQuery, make_tables_of_page, search_run
from heuncli.output.summary.indeterminate import find_indeterminate_groups
from heuncli.output.summary.summary_document import Summary, make_summary_table
from heuncli.output.summary.summary_rows import make_run_summary
from heuncli.output.tables.extremes_tables import NOT_SEARCHED
from heuncli.output.tables.heading import make_heading
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study


class RunParts(NamedTuple):
    """The parts of the document of a run.

    summary: None where instants are given or parts of the results are chosen
    """

    title: str
    facts: Sequence[tuple[str, str]]
    summary: Summary | None
    tables: Sequence[OutputTable]

    def make_document(self, *, full: bool = False) -> OutputDocument:
        """Make the document; full: with every row of the summary."""
        return OutputDocument(self.title, self.facts, self.collect_tables(full=full))

    def collect_tables(self, *, full: bool = False) -> list[OutputTable]:
        """Return the table of the summary, if there is one, and the others."""
        if self.summary is None or self.summary.is_empty:
            return [*self.tables]
        return [make_summary_table(self.summary, full=full), *self.tables]


def make_run_parts(
    study: Study, labels: Labels, query: TablesQuery, case: str = "", *, has_summary: bool = True,
    show_reductions: bool = False,
) -> RunParts:  # fmt: skip
    """Make the parts of the document of a run.

    case: name of its load case, if there are several
    has_summary: whether to summarise it, unless instants are given
    """
    searched = search_run(study, labels, query)
    is_summarised = has_summary and query.instants is None and not query.show_all
    summary = summarise(study, searched, case) if is_summarised else None
    facts = make_heading(study.results, show_reductions, brief=not query.full)
    return RunParts(study.results.title, facts, summary, make_tables_of_page(study, searched, query))


def summarise(study: Study, searched: SearchedPage, case: str = "") -> Summary:
    """Summarise a searched run.

    case: name of its load case, if there are several
    """
    page, model = searched.page, study.results.model
    channels = page.make_search().collect(page.results)
    found = make_run_summary(study, searched, channels, case)
    body = model.get("axes")
    axes = f'axes of the "{body}" body' if body else "world axes"
    notes = [] if found.is_searched else [NOT_SEARCHED]
    notes += [found.doubtful_note] if found.doubtful_note else []
    span = float(np.ptp(study.results.time))
    groups = find_indeterminate_groups(page, channels)
    redundant = int(model.get("redundant", 0))
    return Summary(found.rows, groups, page.labels, axes, redundant, span, found.crank, notes)
