"""Write a sweep as tables, CSV, JSON or Parquet, from rows that are read one after the other. Impure: writes."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator

from heuncli.analyses.sweep_rows import SweepHead, SweptRow
from heuncli.app.cli import terminal
from heuncli.app.cli.documents import render_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import emit
from heuncli.app.commands.sweep.as_columns import iter_csv, iter_parquet, require_parquet
from heuncli.base import files
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputDocument, OutputTable
from heuncli.study.quantities.table_units import Units


class SweepOutput(NamedTuple):
    """How a sweep is written.

    form: the format
    output: the file; None for standard output
    units: display units of tables
    all: whether tables show every row
    """

    form: str
    output: str | None = None
    units: Units = Units()
    all: bool = False


def require_writable_form(output: SweepOutput) -> None:
    """Raise an error before the work if the sweep could not be written after it: UsageError, SpecError."""
    if output.form != "parquet":
        return
    if output.output in (None, files.STDOUT):
        raise UsageError(Problem("bad-option", "parquet requires a file", hint="name the file: -o sweep.parquet"))
    require_parquet()


def write_sweep(head: SweepHead, rows: Iterable[SweptRow], output: SweepOutput) -> None:
    """Write the sweep from rows in ascending order of their numbers, read once. Raises OutputError."""
    if output.form == "parquet":
        from heuncli.app.cli import timeout

        assert output.output is not None
        timeout.disarm(late=True)
        files.write(iter_parquet(head, rows), output.output)
    else:
        emit(iter_pieces(head, rows, output), output.output)


def iter_pieces(head: SweepHead, rows: Iterable[SweptRow], output: SweepOutput) -> Iterator[str]:
    """Yield the sweep as text."""
    if output.form == "csv":
        return iter_csv(head, rows)
    if output.form == "json":
        from heuncli.app.commands.sweep.as_json import iter_json

        return iter_json(head, rows)
    return _iter_tables(head, rows, output)


def _iter_tables(head: SweepHead, rows: Iterable[SweptRow], output: SweepOutput) -> Iterator[str]:
    """Yield the tables as text."""
    on_terminal = output.output is None and terminal.is_terminal()
    tables = make_tables(head, rows, output.units, output.all, sys.stdout.encoding if on_terminal else None)
    yield from render_document(OutputDocument(parts=tables), "table", output.output)


def make_tables(
    head: SweepHead, rows: Iterable[SweptRow], units: Units, all_of_them: bool, encoding: str | None = None
) -> list[OutputTable]:
    """Make the tables: the selected rows, the measures with their extremes, also by load case, and statistics of draws.

    all_of_them: show every row
    encoding: of the terminal; None for UTF-8
    """
    from heuncli.app.commands.sweep.case_matrix import make_case_matrix
    from heuncli.app.commands.sweep.statistics import iter_statistics, select_rows
    from heuncli.app.commands.sweep.statistics_tables import make_statistics_tables
    from heuncli.app.commands.sweep.tables import make_row_table, make_summary_table
    from heuncli.output.documents.as_text import choose_characters

    selection = select_rows(head, rows, all_of_them)
    statistics = list(iter_statistics(head, selection.columns))
    return [
        make_row_table(head, selection, units),
        make_summary_table(head, selection, units, choose_characters(encoding), all_of_them),
        *make_case_matrix(head, selection, units),
        *make_statistics_tables(head, statistics, units, all_of_them),
    ]
