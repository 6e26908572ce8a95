"""Make the tables of a sweep: rows, measures with extremes and courses, and statistics of random draws."""

from __future__ import annotations

from collections.abc import Iterable

from heuncli.analyses.sweep_rows import SweepHead, SweptRow
from heuncli.app.commands.sweep.output.shown_rows import make_row_table
from heuncli.app.commands.sweep.output.statistics import iter_statistics
from heuncli.app.commands.sweep.output.statistics_tables import make_statistics_tables
from heuncli.app.commands.sweep.output.summary import make_summary_table
from heuncli.app.commands.sweep.output.top_k import select_rows
from heuncli.output.documents.document import OutputTable
from heuncli.output.tables.sparkline import choose_characters
from heuncli.study.quantities.table_units import Units


def make_tables(
    head: SweepHead, rows: Iterable[SweptRow], units: Units, all_of_them: bool, encoding: str | None = None
) -> list[OutputTable]:
    """Make the tables.

    all_of_them: show every row
    encoding: of the terminal; None for UTF-8
    """
    selection = select_rows(head, rows, all_of_them)
    statistics = list(iter_statistics(head, selection.columns))
    return [
        make_row_table(head, selection, units),
        make_summary_table(head, selection, units, choose_characters(encoding), all_of_them),
        *make_statistics_tables(head, statistics, units, all_of_them),
    ]
