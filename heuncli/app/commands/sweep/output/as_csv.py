"""Write the rows of a sweep as CSV: one line per variant, all digits, units in the heads; an empty cell is unknown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from heuncli.analyses.sweep_rows import SweepHead, SweptRow, make_columns
from heuncli.output.documents.as_csv import format_line


def iter_csv(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """Yield the lines one after the other."""
    columns = make_columns(head)
    yield format_line(columns.headings)
    for row in rows:
        yield format_line(columns.make_cells(row))
