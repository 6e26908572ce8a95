"""Write plain data: a document's own data or its tables, as JSON or as CSV.

JSON has a line for each key. Arrays are written piece by piece, so that memory holds only part of the numbers at a
time, and never a whole array that is stored in a file (stored_arrays.py). CSV has all digits: a line of names, and a
line for each row, as it comes.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from heuncli.base.text_safety import escape
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputDocument, OutputTable, TextCell
from heuncli.results.stored_arrays import AnyArray, StoredArray, iter_chunks
from heuncli.version import VERSION

FORMAT = 1
AT_ONCE = 50_000  # numbers formatted together: some megabytes as Python objects


def render_json(document: OutputDocument) -> str:
    """Render the document as one JSON object: its own block, or its tables."""
    return dump_json(make_block(document) if document.make_block is None else document.make_block())


def make_block(document: OutputDocument) -> dict[str, Any]:
    """Make the JSON of a document from its tables, each under the first word of its heading.

    A row is an object by the names of its columns; a number with an error has `NAME_error` beside it.
    """
    tables = [part for part in document.parts if isinstance(part, OutputTable)]
    return {
        "heun": FORMAT,
        "version": VERSION,
        "title": document.title,
        **{table.heading.partition(" ")[0].lower(): _make_table_block(table) for table in tables},
    }


def _make_table_block(table: OutputTable) -> list[dict[str, Any]]:
    blocks = []
    for row in table.rows:
        if not isinstance(row, str):
            block: dict[str, Any] = {}
            for column, cell in zip(table.columns, row, strict=True):
                block[column.name] = to_value(cell)
                if isinstance(cell, NumberCell) and cell.error:
                    block[f"{column.name}_error"] = cell.error
            blocks.append(block)
    return blocks


def to_value(cell: Cell) -> str | float | None:
    """Return the number or the text of a cell."""
    return cell.value if isinstance(cell, NumberCell) else cell.text if isinstance(cell, TextCell) else cell


def dump_json(value: Any) -> str:
    """Format small plain data as JSON, laid out like the results."""
    return "".join(iter_json(value))


def iter_json(value: Any) -> Iterator[str]:
    """Yield plain data and arrays as JSON in pieces."""
    yield from _iter_nested(value, "")
    yield "\n"


def _iter_nested(value: Any, indent: str) -> Iterator[str]:
    """Yield a value as JSON: mappings with a line for each key, lists of mappings likewise, everything else on one
    line.
    """
    if isinstance(value, dict) and value:
        yield from _iter_members(((f"{_format_json(key)}: ", member) for key, member in value.items()), "{}", indent)
    elif isinstance(value, (list, tuple)) and any(isinstance(member, dict) for member in value):
        yield from _iter_members((("", member) for member in value), "[]", indent)
    elif isinstance(value, StoredArray) or (isinstance(value, np.ndarray) and value.size > AT_ONCE):
        yield from _iter_array(value)
    else:
        yield _format_json(value)


def _iter_members(members: Iterable[tuple[str, Any]], brackets: str, indent: str) -> Iterator[str]:
    inner = indent + " "
    yield brackets[0]
    for number, (label, member) in enumerate(members):
        yield f"{',' if number else ''}\n{inner}{label}"
        yield from _iter_nested(member, inner)
    yield f"\n{indent}{brackets[1]}"


def _iter_array(values: AnyArray) -> Iterator[str]:
    """Yield a long array as JSON, some of its rows at a time."""
    yield "["
    for number, part in enumerate(iter_chunks(values, AT_ONCE)):
        yield ", " * (number > 0) + _format_json(part)[1:-1]
    yield "]"


def _format_json(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = _to_lists(value)
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        value = None
    return escape(json.dumps(value, ensure_ascii=False, allow_nan=False, default=_to_lists))


def _to_lists(values: Any) -> Any:
    """Convert an array to nested lists, with None for numbers that are not finite and without a minus before zero."""
    finite = np.isfinite(values)
    return (
        (values + 0.0).tolist()
        if finite.all()
        else np.where(finite, (values + 0.0).astype(object), np.array(None)).tolist()
    )


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
