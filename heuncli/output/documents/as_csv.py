"""Write the rows of a table as CSV, with all digits: a line of names, and a line for each row, as it comes."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

from heuncli.base.text_safety import escape
from heuncli.output.documents.as_json import to_value
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable


def make_columns(names: str) -> tuple[OutputColumn, ...]:
    """Make the columns of a CSV from their names, separated by blanks."""
    return tuple(OutputColumn(name) for name in names.split())


def render_csv(document: OutputDocument) -> str:
    """Render the records of the document as CSV; of a document without records, its first table."""
    if document.make_records is not None:
        return "".join(iter_csv(document.make_records()))
    return "".join(iter_csv(next(part for part in document.parts if isinstance(part, OutputTable))))


def iter_csv(table: OutputTable) -> Iterator[str]:
    """Yield the lines one after the other; titles are left out, an empty cell is unknown."""
    yield format_line([column.name for column in table.columns])
    for row in table.rows:
        if not isinstance(row, str):
            yield format_line(map(to_value, row))


def format_line(cells: Iterable[Cell]) -> str:
    """Format a line of values."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(escape(cell) if isinstance(cell, str) else cell for cell in cells)
    return text.getvalue()
