"""Write the rows of a sweep as CSV: one line per variant, all digits, units in the heads; an empty cell is unknown."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

from heuncli.analyses.sweep_store.columns import Cell, make_columns
from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.base.text_safety import escape


def iter_csv(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """Yield the lines one after the other."""
    columns = make_columns(head)
    yield _format_line(columns.headings)
    for row in rows:
        yield _format_line(columns.make_cells(row))


def _format_line(cells: Iterable[Cell]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(escape(cell) if isinstance(cell, str) else cell for cell in cells)
    return text.getvalue()
