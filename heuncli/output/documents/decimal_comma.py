"""Write the numbers of a document with a decimal comma; JSON, CSV and verbatim texts keep the point."""

from __future__ import annotations

import re
from collections.abc import Sequence

from heuncli.output.documents.document import (
    Cell,
    Chapter,
    Drawing,
    Facts,
    Listing,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Part,
    Sentence,
    TextCell,
    format_cell,
)

NUMBER = re.compile(r"(?<![\w.])(\d+)\.(\d+)(?![\d.]|[A-Za-z_]\w*\.)")  # no version, date or file name
LIST = re.compile(r"(?<=\d), (?=[−-]?\d+(?:\.\d+)?(?![\d.\w]))")  # between numbers


def write_decimal_comma(document: OutputDocument) -> OutputDocument:
    """Return the document with decimal commas."""
    return document._replace(parts=[_convert_part(part) for part in document.parts])


def use_decimal_comma(text: str) -> str:
    """Return a text with decimal commas, and with semicolons between the numbers of a list."""
    return NUMBER.sub(r"\1,\2", LIST.sub("; ", text))


def _convert_part(part: Part) -> Part:
    """Convert a part; a title block and a verbatim text stay as they are."""
    if isinstance(part, Chapter):
        return part._replace(parts=[_convert_part(each) for each in part.parts])
    if isinstance(part, Sentence):
        return part._replace(text=use_decimal_comma(part.text))
    if isinstance(part, Facts) and not part.is_block:
        return Facts([(label, use_decimal_comma(text)) for label, text in part.rows])
    if isinstance(part, Listing):
        return Listing(part.title, [use_decimal_comma(item) for item in part.items])
    if isinstance(part, OutputTable):
        return _convert_table(part)
    if isinstance(part, Drawing):
        return part._replace(caption=use_decimal_comma(part.caption), has_decimal_comma=True)
    return part


def _convert_table(table: OutputTable) -> OutputTable:
    return table._replace(
        heading=use_decimal_comma(table.heading),
        rows=[_convert_row(row, table.columns) for row in table.rows],
        notes=[use_decimal_comma(note) for note in table.notes],
    )


def _convert_row(row: Sequence[Cell] | str, columns: Sequence[OutputColumn]) -> Sequence[Cell] | str:
    if isinstance(row, str):
        return use_decimal_comma(row)
    return [_convert_cell(cell, column) for cell, column in zip(row, columns, strict=True)]


def _convert_cell(cell: Cell, column: OutputColumn) -> Cell:
    if isinstance(cell, TextCell):
        return cell._replace(text=use_decimal_comma(cell.text))
    if isinstance(cell, (NumberCell, float)) or column.is_number:
        return use_decimal_comma(format_cell(cell))
    return use_decimal_comma(cell) if isinstance(cell, str) else cell
