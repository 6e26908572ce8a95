"""Write a sweep as tables, CSV, JSON or Parquet, from rows that are read one after the other, and warn of its failures.

Standard error gets how many variants could not be solved, and warnings with their counts. Impure: writes.
"""

from __future__ import annotations

import importlib.util
import io
import json
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from heuncli.analyses.sweep_rows import SweepColumns, SweepHead, SweptRow, make_columns
from heuncli.analyses.variants.measures import strip_numbers
from heuncli.app.cli import terminal
from heuncli.app.cli.documents import render_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import emit, print_stderr
from heuncli.base import files
from heuncli.base.errors import Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_data import format_line
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


def iter_csv(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """Yield the lines one after the other."""
    columns = make_columns(head)
    yield format_line(columns.headings)
    for row in rows:
        yield format_line(columns.make_cells(row))


GROUP = 50_000  # rows that are written together
INSTALL = 'pip install "heuncli[parquet]"; or -o sweep.csv, which needs no package'


class ByteSink(io.RawIOBase):
    """A stream that keeps what is written until it is taken; it knows its position, which is all that a Parquet file
    needs.
    """

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._written = 0

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, part: Any) -> int:
        """Keep some bytes."""
        self._parts.append(bytes(part))
        self._written += len(self._parts[-1])
        return len(self._parts[-1])

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self._written

    def take(self) -> bytes:
        """Return the bytes written since the last call."""
        parts, self._parts = self._parts, []
        return b"".join(parts)


def require_parquet() -> None:
    """Raise SpecError before the work if pyarrow is missing."""
    if importlib.util.find_spec("pyarrow") is None:
        raise SpecError(Problem("missing-extra", "Parquet requires pyarrow, which is not installed", hint=INSTALL))


def iter_parquet(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[bytes]:
    """Yield the file in pieces."""
    require_parquet()
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = make_columns(head)
    fields = list(zip(columns.headings, _list_types(pa, columns), strict=True))
    schema = pa.schema(fields, metadata={"heun": json.dumps(_make_metadata(head))})
    sink, remaining = ByteSink(), iter(rows)
    with pq.ParquetWriter(sink, schema) as writer:
        while (group := _read_group(pa, schema, columns, remaining)).num_rows:
            writer.write_table(group)
            yield sink.take()
    yield sink.take()


def _read_group(pa: Any, schema: Any, columns: SweepColumns, rows: Iterator[SweptRow]) -> Any:
    """Return the next rows as a table; empty at their end."""
    cells = [columns.make_cells(row) for row in islice(rows, GROUP)]
    by_column = zip(*cells, strict=True) if cells else [()] * len(schema.types)
    arrays = [pa.array(column, kind) for column, kind in zip(by_column, schema.types, strict=True)]
    return pa.Table.from_arrays(arrays, schema=schema)


def _list_types(pa: Any, columns: SweepColumns) -> list[Any]:
    """Return the types of the columns, in their order."""
    of_parameters = [pa.string() if column.unit is None else pa.float64() for column in columns.parameters]
    of_measures = [pa.float64()] * (3 * len(columns.measures))
    return [pa.int64(), *of_parameters, *of_measures, pa.string(), pa.string()]


def _make_metadata(head: SweepHead) -> dict[str, str]:
    """Make the metadata of a Parquet file."""
    return {"version": head.version, "title": head.title, "spec": head.path, "sha256": head.sha256}


MAX_KINDS = 20  # kinds of warnings that are told


class SweepWarnings(NamedTuple):
    """The failures and warnings of a sweep.

    rows: number of variants
    codes: number of failed variants by code
    warnings: by their words without figures, the first of each kind, and the number of variants
    more: number of warnings of further kinds
    absent: by measure, number of variants without it
    """

    rows: int
    codes: Counter[str]
    warnings: dict[str, tuple[str, int]]
    more: int
    absent: Counter[str]

    @property
    def failure_count(self) -> int:
        """Number of variants that could not be solved."""
        return self.codes.total()


def collect_warnings(head: SweepHead, rows: Iterable[SweptRow]) -> SweepWarnings:
    """Collect the failures and warnings of all rows, read once."""
    count, other_kinds = 0, 0
    codes: Counter[str] = Counter()
    warnings: dict[str, tuple[str, int]] = {}
    absent: Counter[str] = Counter()
    for row in rows:
        count += 1
        if row.result.code:
            codes[row.result.code] += 1
        for text in row.result.warnings:
            kind = strip_numbers(text)
            if kind in warnings or len(warnings) < MAX_KINDS:
                first, so_far = warnings.get(kind, (text, 0))
                warnings[kind] = first, so_far + 1
            else:
                other_kinds += 1
        absent.update(
            m.text for m, reading in zip(head.measures, row.result.measures, strict=False) if reading.word == "absent"
        )
    return SweepWarnings(count, codes, warnings, other_kinds, absent)


def print_warnings_summary(summary: SweepWarnings, quiet: bool) -> None:
    """Print to standard error how many variants failed by code, and each warning with its count."""
    if quiet:
        return
    for text, count in summary.warnings.values():
        print_stderr(f"warning: heun: {text} ({_format_share(count, summary.rows)})")
    if summary.more:
        print_stderr(f"warning: heun: and {summary.more} warnings of other kinds; the rows list all")
    for measure, count in summary.absent.items():
        if count == summary.rows - summary.failure_count:
            print_stderr(f"warning: heun: {measure}: no variant has it")
    if summary.failure_count:
        codes = ", ".join(f"{count} {code}" for code, count in summary.codes.most_common())
        print_stderr(f"heun: {_format_share(summary.failure_count, summary.rows)} could not be solved: {codes}")


def _format_share(count: int, rows: int) -> str:
    """Format for how many of the variants a warning holds."""
    return "all variants" if count == rows else f"{count} of {rows} variants"
