"""The tables of a sweep: its rows, the measures with their extremes and courses, the statistics of what is drawn."""

from __future__ import annotations

from collections.abc import Iterable

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.app.commands.sweep.telling.kept_rows import kept
from heuncli.app.commands.sweep.telling.shown_rows import table_of_rows
from heuncli.app.commands.sweep.telling.statistics import statistics_of
from heuncli.app.commands.sweep.telling.statistics_tables import tables_of
from heuncli.app.commands.sweep.telling.summary import summary
from heuncli.output.tables.sparkline import letters
from heuncli.output.tables.text_table import TextTable
from heuncli.study.quantities.table_units import Units


def tables(
    head: SweepHead, rows: Iterable[SweptRow], units: Units, all_of_them: bool, encoding: str | None = None
) -> list[TextTable]:
    """The tables; all_of_them: every row; encoding: of the terminal they go to, None where it is UTF-8."""
    shown = kept(head, rows, all_of_them)
    found = list(statistics_of(head, shown.gathered))
    return [
        table_of_rows(head, shown, units),
        summary(head, shown, units, letters(encoding), all_of_them),
        *tables_of(head, found, units, all_of_them),
    ]
