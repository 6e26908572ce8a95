"""The rows of a sweep as CSV: a line a variant, all digits, units in the heads; an empty cell is not known."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

from heuncli.analyses.sweep_store.columns import Cell, columns_of
from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.base.foreign_text import shown


def csv_pieces(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """The lines, one after the other."""
    columns = columns_of(head)
    yield _line(columns.heads)
    for row in rows:
        yield _line(columns.cells(row))


def _line(cells: Iterable[Cell]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(shown(cell) if isinstance(cell, str) else cell for cell in cells)
    return text.getvalue()
