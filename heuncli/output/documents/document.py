"""A document: what a command or a report says, before a writer prints it as text, Markdown, HTML, JSON or CSV.

A command builds one document from its result: facts below the title, tables with typed columns, sentences, figures.
Numbers stay numbers with their errors until a writer prints them. `app/cli/documents.py` writes it in the asked format;
`as_text`, `as_markdown`, `as_html` and `as_data` (JSON, CSV) are the writers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.study.quantities.digits import Style, format_with_error, trim_zeros, write_numbers

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

MAX_NAMES = 8  # of a list in a sentence
Kind = Literal["number", "text", "instant", "path", "verdict"]  # of a column; numbers are aligned at their points
Mood = Literal["plain", "good", "bad", "unsure"]
Fill = Literal["", "page", "columns", "half"]  # of a table on paper
NUMBER_WITH_POINT = re.compile(r"(?<![\w.])(\d+)\.(\d+)(?![\d.]|[A-Za-z_]\w*\.)")  # no version, date or file name
LIST_COMMA = re.compile(r"(?<=\d), (?=[−-]?\d+(?:\.\d+)?(?![\d.\w]))")  # between numbers


class NumberCell(NamedTuple):
    """A number in the unit of its column, with its error.

    write: prints it, such as `style.write` of its family; None: with the digits that its own error leaves
    cached_text: it as it is printed, where that depends on other cells of its column
    """

    value: float
    error: float = 0.0
    write: Callable[[float], str] | None = None
    cached_text: str = ""

    @property
    def text(self) -> str:
        """The number as it is printed."""
        if self.cached_text:
            return self.cached_text
        return format_with_error(self.value, self.error) if self.write is None else self.write(self.value)


class TextCell(NamedTuple):
    """A text; is_governing: whether its value governs, so that it is bold."""

    text: str
    is_governing: bool = False


Cell = str | float | TextCell | NumberCell | None  # a plain number is printed to six digits, None is an empty cell


class OutputColumn(NamedTuple):
    """A column of a table.

    key: its name in JSON and CSV, if these are made from the table; empty: its head
    vector: in a table too wide for a page, neighbours of one vector stay together
    is_shown_once: it is not repeated in the further parts of a wide table
    is_optional: it is left out of a table that would be too wide with it
    """

    head: str
    kind: Kind = "number"
    unit: str = ""
    key: str = ""
    vector: str = ""
    is_shown_once: bool = False
    is_optional: bool = False

    @property
    def title(self) -> str:
        """The head with the unit."""
        return format_head(self.head, self.unit)

    @property
    def is_number(self) -> bool:
        """Whether it holds numbers, which are aligned at their decimal points; texts are aligned at the left."""
        return self.kind in ("number", "instant")

    @property
    def name(self) -> str:
        """Its name in JSON and CSV."""
        return self.key or self.head


class OutputTable(NamedTuple):
    """A heading, columns, rows of cells, and notes below. A row that is a single string is a title over the rows after
    it. What stands after two blanks in a heading or title explains it. For CSV the rows may be made one by one.

    fill: on paper it takes the whole width, runs through two columns, or stands in one beside another part; by default
    it is as wide as its cells
    """

    heading: str
    columns: Sequence[OutputColumn] = ()
    rows: Sequence[Sequence[Cell] | str] = ()
    notes: Sequence[str] = ()
    fill: Fill = ""

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing below the heading."""
        return not self.rows and not self.notes


class Facts(NamedTuple):
    """Labels with their texts, one per line; further lines of one label have an empty one.

    is_block: whether they stand side by side, as in a title block
    """

    rows: Sequence[tuple[str, str]]
    is_block: bool = False


class Brand(NamedTuple):
    """The line above a title: a company with its logo, a data URI, and a project."""

    company: str = ""
    logo: str = ""
    project: str = ""


class Sentence(NamedTuple):
    """One or a few sentences; mood: whether they report that all is well, a failure, or an uncertainty."""

    text: str
    mood: Mood = "plain"


class Listing(NamedTuple):
    """A list of sentences under a title."""

    title: str
    items: Sequence[str]


class Drawing(NamedTuple):
    """A figure with its caption.

    width: for which it is laid out [pixels]; None: as pictures are
    place: "half" of a page's width beside another, or on the "first" page, which bounds its height
    """

    figure: Figure
    caption: str = ""
    width: float | None = None
    place: Literal["", "half", "first"] = ""
    has_decimal_comma: bool = False


class Verbatim(NamedTuple):
    """Lines that are shown as they are; is_numbered: with line numbers, as the text of a file."""

    text: str
    is_numbered: bool = False


class Chapter(NamedTuple):
    """A chapter; name: the target of links to it."""

    name: str
    title: str
    parts: Sequence[Part]


Part = Sentence | Facts | Brand | Listing | OutputTable | Drawing | Verbatim | Chapter


class OutputDocument(NamedTuple):
    """A title and its parts, and how the same content is written as JSON and CSV.

    title: None if the parts say all
    facts: label and text of the lines below the title
    parts: may be made one by one, when a writer needs them
    make_block: makes the JSON; None: from the tables
    make_records: makes the rows of the CSV, with all digits; None: the first table
    level: of the title in Markdown, 1 to 3
    """

    title: str | None = None
    facts: Sequence[tuple[str, str]] = ()
    parts: Iterable[Part] = ()
    make_block: Callable[[], Any] | None = None
    make_records: Callable[[], OutputTable] | None = None
    level: int = 2


def has_content(part: Part) -> bool:
    """Return whether a part has any content below its heading."""
    if isinstance(part, OutputTable):
        return not part.is_empty
    if isinstance(part, Listing):
        return bool(part.items)
    if isinstance(part, Brand):
        return any(part)
    return bool(part.rows) if isinstance(part, Facts) else True


def make_panels(figure: Figure) -> list[Drawing]:
    """Make the drawing of the panels of a figure, without its sentences; none if it has no panels."""
    return [Drawing(figure._replace(title="", words=(), notes=()))] if figure.panels else []


def format_cell(cell: Cell) -> str:
    """Format a cell as text, without escaping it."""
    if isinstance(cell, NumberCell):  # most cells
        return cell.cached_text or cell.text
    if isinstance(cell, str):
        return cell
    if isinstance(cell, TextCell):
        return cell.text
    return "" if cell is None else str(cell) if isinstance(cell, int) else f"{cell:.6g}"


def is_zero_cell(cell: Cell) -> bool:
    """Return whether a cell is empty, or a number that is printed as 0."""
    return format_cell(cell) in ("", "0")


def is_governing(cell: Cell) -> bool:
    """Return whether the value of a cell governs."""
    return isinstance(cell, TextCell) and cell.is_governing


def make_text_columns(heads: Iterable[str]) -> tuple[OutputColumn, ...]:
    """Make columns of texts."""
    return tuple(OutputColumn(head, "text") for head in heads)


def make_number_cells(values: Sequence[float], style: Style, error: float = 0.0) -> list[NumberCell]:
    """Make the cells of numbers of one family, without the zeros that they would all end in."""
    texts = write_numbers(values, style)
    return [NumberCell(value, error, None, text) for value, text in zip(values, texts, strict=True)]


def trim_cells(numbers: Sequence[tuple[float, float, Style]]) -> list[NumberCell]:
    """Make the cells of numbers, each with its error and style, without the zeros that they would all end in."""
    texts = trim_zeros([style.write(value) for value, _, style in numbers])
    return [NumberCell(value, error, None, text) for (value, error, _), text in zip(numbers, texts, strict=True)]


def format_head(label: str, unit: str) -> str:
    """Format the head of a column of numbers; a plain number has no unit, or "1"."""
    return label if unit in ("", "1") else f"{label} [{unit}]"


def append_unit(text: str, unit: str) -> str:
    """Append the unit to a number, unless it is a plain one."""
    return text if unit in ("", "1") else f"{text} {unit}"


def join_names(names: Sequence[str]) -> str:
    """Join the first few names, and state how many more there are."""
    rest = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + rest


def write_decimal_comma(document: OutputDocument) -> OutputDocument:
    """Return the document with decimal commas."""
    facts = [(label, use_decimal_comma(text)) for label, text in document.facts]
    return document._replace(facts=facts, parts=[_convert_part(part) for part in document.parts])


def use_decimal_comma(text: str) -> str:
    """Return a text with decimal commas, and with semicolons between the numbers of a list."""
    return NUMBER_WITH_POINT.sub(r"\1,\2", LIST_COMMA.sub("; ", text))


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
