"""Find the layout of a CSV text as programs write it: its encoding, separator, headings, and where its rows begin.

Commas, semicolons, tabs or blanks separate cells; empty lines and lines that begin with # are skipped. The headings
are the first row, or the last line with # above it that has as many cells as the numbers.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
from array import array
from collections.abc import Iterator, Sequence
from itertools import islice

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import MAX_WORD_LENGTH, find_similar, list_words
from heuncli.results.results_schema import parse_index
from heuncli.scene.file_format.headings import name_before_letter, name_in_heading

PIECE = 1 << 20  # characters: large enough to make NumPy's overhead negligible, small enough to save memory
MAX_EXAMINED_ROWS = 1000  # rows examined before a message may quote a file's headings
MAX_HEADER_LINE = 1000  # lines searched for the headings that a spec names
NUMERIC_SHARE = 0.9  # of the cells of a column whose heading may be quoted; a footer or an overload is no number
MIN_NUMERIC_COLUMNS = 2  # a file with fewer is no table, and its headings may be private
MAX_NUMBER_LENGTH = 24  # characters; a double needs 24 at most
MAX_TEXT_SAMPLE = 4096  # bytes examined for control characters
NUMERIC_CHARACTERS = frozenset("0123456789+-.,eEdD_% ")
NOT_FINITE = frozenset({"nan", "inf", "infinity"})
GAP_WORDS = frozenset({"", "nan", "-nan", "+nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---"})
FORTRAN_EXPONENT = re.compile(r"(?<=[0-9.])[dD](?=[-+]?[0-9])")
ERROR_CELL = re.compile(r"#(?:N/A|NV|[A-ZÄÖÜ/0]+[!?])[ ]*(?:[,;\t]|\Z)")  # as #DIV/0! of a spreadsheet
BEGINS_AS_NUMBER = re.compile(r"[-+]?[.,]?[0-9]")
QUOTED = re.compile(r'"[^"]*"')
DECLARED_SEPARATOR = re.compile(r'"?sep=([;,\t])"?\s*\Z', re.IGNORECASE)  # the first line of a file for Excel
# hints
ROWS_HINT = "separate the numbers of a row by commas: 0.5, 12"
SKIP_HINT = "in tables, skip: N passes over the first N lines"
NUMBERS_HINT = f"one number per cell, with a decimal point; start lines of text with #; {SKIP_HINT}"
GAPS_HINT = "fill the gap; in tables, gaps: skip leaves such rows out, gaps: linear fills them"
DECIMALS_HINT = "write decimals with a point, put each number in quotes, or separate the cells by semicolons"
WIDTH_HINT = f"give each column a heading, and cells with decimal commas semicolons between them; {SKIP_HINT}"
QUOTES_HINT = "close each quote; plain numbers need none"
TEXT_HINT = "save it as CSV in UTF-8"

Columns = list["array[float]"]


class MissingColumnError(Exception):
    """A requested column does not exist: its index among the requested ones, and the finding."""

    def __init__(self, number: int, finding: Finding) -> None:
        super().__init__(finding.message)
        self.number, self.finding = number, finding


class CsvError(Exception):
    """An error in a CSV file: line, column and finding."""

    def __init__(self, line: int, column: int, finding: Finding) -> None:
        super().__init__(finding.message)
        self.line, self.column, self.finding = line, column, finding


class Heading(NamedTuple):
    """The heading of a column, the line it is on, and the column's number from 1."""

    text: str
    line: int
    number: int


class ColumnLayout(NamedTuple):
    """Layout of a file.

    separator: the cell separator; None: blanks
    names: the headings, or empty
    width: number of cells in the first row
    header_lines: number of lines before the numbers
    names_line: the line of the headings, from 1
    has_hash_names: whether the headings are behind a #
    """

    separator: str | None
    names: list[str]
    width: int
    header_lines: int
    names_line: int = 0
    has_hash_names: bool = False


def decode_text(content: bytes | bytearray) -> str:
    """Decode a text in UTF-8, in UTF-16 with a byte order mark, or else in Latin-1 as Windows has it.

    Raises Finding [table-file] if it is no text.
    """
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            return content.decode("utf-16")
        except UnicodeDecodeError:
            raise Finding("table-file", "it is not UTF-16, which its first bytes say", TEXT_HINT) from None
    if any(byte < 32 and byte not in b"\t\n\v\f\r" for byte in content[:MAX_TEXT_SAMPLE]):
        raise Finding("table-file", "it is not a text", TEXT_HINT)
    for encoding in ("utf-8-sig", "cp1252"):
        try:
            return content.decode(encoding)
        except UnicodeDecodeError:
            continue
    return content.decode("latin-1")


def iter_line_pieces(text: str, header_lines: int = 0) -> Iterator[tuple[int, list[str]]]:
    """Yield the lines after the header in pieces of many lines, each with the number, from 1, of its first line."""
    begin, line = 0, 1
    while begin < len(text):
        end = text.find("\n", begin + PIECE) + 1 or len(text)
        lines = text[begin:end].splitlines()
        skipped = max(header_lines + 1 - line, 0)
        yield line + skipped, lines[skipped:]
        begin, line = end, line + len(lines)


def iter_rows(text: str, header_lines: int = 0) -> Iterator[tuple[int, str]]:
    """Yield the lines after the header that hold a row, with their line numbers."""
    for first, lines in iter_line_pieces(text, header_lines):
        yield from ((n, line) for n, line in enumerate(lines, first) if is_row(line))


def is_row(line: str) -> bool:
    """Whether a line holds a row: neither empty nor a comment; #N/A is a cell without a number."""
    stripped = line.lstrip()
    return stripped != "" and (not stripped.startswith("#") or ERROR_CELL.match(stripped) is not None)


def detect_layout(text: str, skip: int = 0) -> ColumnLayout:
    """Detect the layout of a text from its first rows, after `skip` lines. Raises CsvError."""
    rows = iter_rows(text, skip)
    n, line = next(rows, (0, ""))
    declared = DECLARED_SEPARATOR.match(line)
    if declared is not None:
        n, line = next(rows, (0, ""))
    if not n:
        message = "the file has no rows" + (f" after line {skip}" if skip else "")
        raise CsvError(1, 1, Finding("table-file", message, ROWS_HINT))
    separator = declared[1] if declared is not None else detect_separator(line)
    first = [cell.strip() for cell in split_cells(n, line, separator)]
    are_numbers = [parse_number(cell) is not None for cell in first]
    names, names_line = find_hash_names(text, skip, n, separator, len(first))
    if all(are_numbers):
        return ColumnLayout(separator, names, len(first), n - 1, names_line, bool(names))
    second_line, second_text = next(rows, (0, ""))
    second = split_cells(second_line, second_text, separator) if second_line else []
    if names and any(are_numbers) and [parse_number(cell) is not None for cell in second] == are_numbers:
        return ColumnLayout(separator, names, len(first), n - 1, names_line, bool(names))
    if separator == "," and len(second) == 2 * len(first) and holds_only_numbers(second):
        message = f"the row has {len(second)} cells, the first row {len(first)}: are its commas decimal marks?"
        raise CsvError(second_line, 1, Finding("table-file", message, DECIMALS_HINT))
    return ColumnLayout(separator, first, len(first), n, n)


def detect_separator(line: str) -> str | None:
    """Detect the separator of a row; None: blanks."""
    bare = QUOTED.sub("", line)
    if ";" in bare or "\t" in bare:
        return ";" if ";" in bare else "\t"
    if "," not in bare:
        return None
    by_blanks = line.split()
    has_decimal_commas = all("," in cell.strip(",") and parse_number(cell) is not None for cell in by_blanks)
    is_by_commas = all(parse_number(cell) is not None for cell in bare.split(","))
    return None if len(by_blanks) > 1 and has_decimal_commas and not is_by_commas else ","


def find_hash_names(text: str, skip: int, end: int, separator: str | None, width: int) -> tuple[list[str], int]:
    """Find the last line with # before line `end` that has as many cells as the first row, and its number.

    The names are empty if there is none, or if its cells are numbers.
    """
    found: tuple[list[str], int] = ([], 0)
    for first, lines in iter_line_pieces(text, skip):
        for n, line in enumerate(lines[: max(end - first, 0)], first):
            bare = line.strip().lstrip("#")
            if not line.lstrip().startswith("#") or not bare.strip():
                continue
            for mark in dict.fromkeys((detect_separator(bare), separator)):
                try:
                    cells = [cell.strip() for cell in split_cells(n, bare, mark)]
                except CsvError:
                    continue
                if len(cells) == width and not any(parse_number(cell) is not None for cell in cells):
                    found = cells, n
                    break
        if first + len(lines) > end:
            break
    return found


def is_first_row_a_point(layout: ColumnLayout, indices: Sequence[int], text: str) -> bool:
    """Whether the row taken for headings is the first point of columns requested by number: "0,1,start", "0,1,",
    "0,NaN".

    It is if its x is a number, or if all requested cells begin like one ("0 s,1 N": not a point, but no headings
    either). Numbers still count as headings if they stand next to a word or an empty cell whose column holds numbers.
    """
    first = layout.names
    if not first or not first[0] or layout.has_hash_names:
        return False
    if not is_like_number(first[indices[0]]):
        return all(BEGINS_AS_NUMBER.match(first[i]) for i in indices)
    words = {i for i, cell in enumerate(first) if cell and not is_like_number(cell)} - set(indices)
    n, line = next(iter_rows(text, layout.header_lines), (0, ""))
    second = split_cells(n, line, layout.separator) if n else []
    return not any(parse_number(cell) is not None for i, cell in enumerate(second) if i in words)


def split_cells(n: int, line: str, separator: str | None) -> list[str]:
    """Split a row into its cells. Raises CsvError."""
    if separator is None or '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, strict=True, skipinitialspace=True))
    except csv.Error as error:
        raise CsvError(n, 1, Finding("table-file", f"the row cannot be read: {error}", QUOTES_HINT)) from None


def parse_number(cell: str) -> float | None:
    """Return the finite number in a cell, or None. A comma in a cell is its decimal mark, D an exponent of Fortran."""
    cell = cell.strip()
    if "," in cell and "." not in cell:
        cell = cell.replace(",", ".")
    if "d" in cell or "D" in cell:
        cell = FORTRAN_EXPONENT.sub("e", cell)
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in cell else None


def is_like_number(cell: str) -> bool:
    """Whether a cell is written as a number, even one that is refused: nan, 1e400."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return parse_number(cell) is not None
    return True


def is_gap(cell: str) -> bool:
    """Whether a cell says that its number is missing."""
    return cell.strip().lower() in GAP_WORDS


def quote_cell(cell: str, among_numbers: bool) -> str:
    """Quote a cell for a message, but only if it looks like a number: the file may be private and not a table at
    all.
    """
    if not cell:
        return "an empty cell"
    is_numeric = set(cell) <= NUMERIC_CHARACTERS or cell.lower().lstrip("+-") in NOT_FINITE
    if (is_numeric or among_numbers) and len(cell) <= MAX_NUMBER_LENGTH:
        return f"'{cell}'"
    return "the cell"


def cell_hint(cell: str) -> str:
    """Return a hint on what a cell should hold."""
    return GAPS_HINT if is_gap(cell) else NUMBERS_HINT


def find_column(number: int, key: object, layout: ColumnLayout, text: str) -> int:
    """Return the index, from 0, of a requested column.

    number: index of the request, for the error. Raises MissingColumnError.
    """
    column_number = parse_index(str(key)) if isinstance(key, int | str) else None
    if isinstance(key, str) and column_number is None:
        matches: list[int] = []
        for find_name in (str, name_in_heading, name_before_letter):
            matches = matches or [i for i, name in enumerate(layout.names) if find_name(name) == key.strip()]
        if len(matches) == 1:
            return matches[0]
        if matches:
            number_list = " or ".join(str(i + 1) for i in matches)
            message = f"there are {len(matches)} columns '{key}'"
            raise MissingColumnError(number, Finding("table-file", message, f"give its number: {number_list}"))
        raise MissingColumnError(
            number, Finding("table-file", f"there is no column '{key}'", known_columns_hint(key, layout, text))
        )
    if column_number is None or not 1 <= column_number <= layout.width:
        finding = Finding(
            "table-file", f"there is no column {key}", f"give a number from 1 to {layout.width}; {SKIP_HINT}"
        )
        raise MissingColumnError(number, finding)
    return column_number - 1


def known_columns_hint(key: str, layout: ColumnLayout, text: str) -> str:
    """Return a hint for a missing column."""
    by_number = "columns may also be given by number: 1, 2, ..."
    line = find_name_line(key.strip(), text)
    if line > layout.header_lines:
        return f"line {line} has this name: give skip: {line - 1} to leave out the lines above it"
    names = find_numeric_columns(layout, text)
    if not layout.names:
        return f"the first row contains numbers, not names; {by_number}"
    if not names:
        return f"it has no names above rows of numbers; {SKIP_HINT}; {by_number}"
    near = find_similar(key, names)
    hint = f"columns: {list_words(names)}"
    return f"did you mean {near}? {hint}" if near else f"{hint}; {by_number}"


def find_name_line(key: str, text: str) -> int:
    """Return the first line that has a cell of that name, or 0."""
    for n, line in iter_rows(text):
        if n > MAX_HEADER_LINE:
            break
        if key and key in line:
            cells = [cell.strip().strip('"').strip() for cell in line.split(detect_separator(line))]
            if key in cells or key in map(name_in_heading, cells):
                return n
    return 0


def find_numeric_columns(layout: ColumnLayout, text: str) -> list[str]:
    """Return the headings of the columns that hold numbers in nearly all examined rows; gaps do not count.

    With fewer than two such columns the result is empty: the file may be any file, and messages must not reveal its
    content.
    """
    counts = [[0, 0] for _ in layout.names]  # numbers and all cells of each column
    for n, line in islice(iter_rows(text, layout.header_lines), MAX_EXAMINED_ROWS):
        for count, cell in zip(counts, split_cells(n, line, layout.separator), strict=False):
            is_number = parse_number(cell) is not None
            count[0] += is_number
            count[1] += is_number or not is_gap(cell)
    named = zip(layout.names, counts, strict=True)
    names = [name for name, (numbers, cells) in named if numbers and numbers >= NUMERIC_SHARE * cells]
    if len(names) < MIN_NUMERIC_COLUMNS:
        return []
    return [name for name in names if name and len(name) <= MAX_WORD_LENGTH]


def holds_only_numbers(cells: Sequence[str]) -> bool:
    """Whether cells hold at least one number, and else only gaps."""
    filled = [cell for cell in cells if not is_gap(cell)]
    return bool(filled) and all(parse_number(cell) is not None for cell in filled)
