"""A sweep as it is told: tables, CSV, JSON, Parquet, each from rows that come one after the other. Impure: writes."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.app.cli import terminal
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import emit
from heuncli.base import files
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextTable, plain
from heuncli.study.quantities.table_units import Units


class Telling(NamedTuple):
    """How a sweep is told: in which form, where (None: standard output), in which units of tables, all rows or some."""

    form: str
    output: str | None = None
    units: Units = Units()
    all: bool = False


def require_tellable(how: Telling) -> None:
    """Say before the work what could not be told after it. Raises UsageError, SpecError."""
    if how.form != "parquet":
        return
    if how.output in (None, files.STDOUT):
        raise UsageError(Problem("bad-option", "parquet goes to a file only", hint="name it: -o sweep.parquet"))
    from heuncli.app.commands.sweep.telling.as_parquet import require_parquet

    require_parquet()


def tell(head: SweepHead, rows: Iterable[SweptRow], how: Telling) -> None:
    """Write the sweep; rows by rising numbers, read once. Raises OutputError."""
    if how.form == "parquet":
        from heuncli.app.cli import alarm
        from heuncli.app.commands.sweep.telling.as_parquet import parquet_pieces

        assert how.output is not None
        alarm.disarm(late=True)
        files.write(parquet_pieces(head, rows), how.output)
    else:
        emit(pieces(head, rows, how), how.output)


def pieces(head: SweepHead, rows: Iterable[SweptRow], how: Telling) -> Iterator[str]:
    """The sweep as text."""
    if how.form == "csv":
        from heuncli.app.commands.sweep.telling.as_csv import csv_pieces

        return csv_pieces(head, rows)
    if how.form == "json":
        from heuncli.app.commands.sweep.telling.as_json import json_pieces

        return json_pieces(head, rows)
    return _page(head, rows, how)


def _page(head: SweepHead, rows: Iterable[SweptRow], how: Telling) -> Iterator[str]:
    from heuncli.app.commands.sweep.telling.page import tables

    on_terminal = how.output is None and terminal.present()
    found = tables(head, rows, how.units, how.all, sys.stdout.encoding if on_terminal else None)
    texts = terminal.write(found) if on_terminal else [_plain(table) for table in found]
    for number, text in enumerate(texts):
        yield "\n" * (number > 0) + text


def _plain(table: TextTable) -> str:
    return "\n".join(plain(part, WIDTH) for part in fit(table, WIDTH))
