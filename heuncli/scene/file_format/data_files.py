"""Turn data files of other forms into the text of a CSV file, row by row, so that all is read by the same rules.

    Excel (.xlsx)          a sheet; openpyxl, an optional extra (heuncli[excel])
    Parquet                pyarrow, an optional extra (heuncli[parquet])
    rocket motor (.eng)    time and thrust, from 0 at the time 0 on, as the format of RASP has it
    LabVIEW (.lvm)         the header up to ***End_of_Header*** becomes comments

The line of a value in the text is its row in the sheet, or its line in the file.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from importlib import import_module
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.spelling import list_words, suggest

MAX_UNPACKED_SIZE = 1_000_000_000  # bytes of a workbook
WORKBOOK = "xl/workbook.xml"  # in every .xlsx
MAX_CELLS = 30_000_000
SEPARATOR = "\t"
END_OF_HEADER = "***End_of_Header***"
MOTOR_ENDING, MOTOR_HEADER_WORDS = ".eng", 7  # name, diameter, length, delays, two masses, maker
MOTOR_HEADINGS = "time [s]\tthrust [N]"
CSV_HINT = "save it as CSV in UTF-8"
EXTRAS = {"openpyxl": ("excel", "Excel files"), "pyarrow.parquet": ("parquet", "Parquet")}
UNREADABLE = {
    b"\xd0\xcf\x11\xe0": ("an Excel file of before 2007", "save it as .xlsx or CSV"),
    b"TDSm": ("a binary TDMS file", "export it as CSV, Excel or .lvm"),
    b"MATLAB 5": ("a binary MATLAB file", "export it as CSV: writematrix"),
    b"\x89HDF": ("a binary HDF5 file", "export the columns as CSV or Parquet"),
}


def convert_binary(content: bytes | bytearray, sheet: str | None) -> str | None:
    """Return the text of a binary data file, None for what is none. Raises Finding [table-file, missing-extra]."""
    for mark, (kind, hint) in UNREADABLE.items():
        if content.startswith(mark):
            raise Finding("table-file", f"it is {kind}", hint)
    if content.startswith(b"PK\x03\x04"):
        return join_rows(iter_workbook_rows(content, sheet))
    if sheet is not None:
        raise Finding("table-form", "sheet is given for a file that is no Excel file", "leave sheet out")
    return join_rows(iter_parquet_rows(content)) if content.startswith(b"PAR1") else None


def import_extra(name: str) -> Any:
    """Import a package of an optional extra. Raises Finding [missing-extra]."""
    extra, subject = EXTRAS[name]
    try:
        return import_module(name)
    except ImportError:
        message = f"{subject} require {name.partition('.')[0]}, which is not installed"
        raise Finding("missing-extra", message, f'pip install "heuncli[{extra}]"; or {CSV_HINT}') from None


def iter_workbook_rows(content: bytes | bytearray, sheet: str | None) -> Iterator[Iterable[Any]]:
    """Yield the rows of a sheet, the first one if none is named; of formulas the values. Raises Finding."""
    import zipfile  # few scenes name an Excel file

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as parts:
            size = sum(part.file_size for part in parts.infolist())
            is_workbook = WORKBOOK in parts.namelist()
    except (zipfile.BadZipFile, OSError, ValueError):
        is_workbook = False
    if not is_workbook:
        raise Finding("table-file", "it is not a text, and no workbook of Excel (.xlsx)", CSV_HINT)
    if size > MAX_UNPACKED_SIZE:
        raise Finding("too-large", f"it unpacks to {size / 1e9:.3g} GB", "keep only the columns needed")
    openpyxl = import_extra("openpyxl")
    try:
        book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True, keep_links=False)
    except Exception:  # its type depends on what is broken in the file
        raise Finding("table-file", "its workbook is damaged", CSV_HINT) from None
    names = [one.title for one in book.worksheets]
    if not names or (sheet is not None and sheet not in names):
        message = f"it has no sheet '{sheet}'" if names else "it has no sheet with cells"
        raise Finding("table-file", message, suggest(sheet or "", names, "sheets") if names else CSV_HINT)
    rows = book[sheet or names[0]]
    rows.reset_dimensions()  # some programs write a wrong range
    try:
        yield from rows.iter_rows(values_only=True)
    except Exception:
        raise Finding("table-file", "its sheet is damaged", CSV_HINT) from None


def iter_parquet_rows(content: bytes | bytearray) -> Iterator[Iterable[Any]]:
    """Yield the names of the columns, then the rows. Raises Finding."""
    parquet = import_extra("pyarrow.parquet")
    try:
        file = parquet.ParquetFile(io.BytesIO(content))
        names, size = list(file.schema_arrow.names), file.metadata.num_rows * len(file.schema_arrow.names)
        if size > MAX_CELLS:
            raise Finding("too-large", f"it has {size} cells", "keep only the columns needed")
        yield names
        for batch in file.iter_batches():
            yield from zip(*(column.to_pylist() for column in batch.columns), strict=True)
    except Finding:
        raise
    except Exception:
        raise Finding("table-file", "it is damaged, or not Parquet", CSV_HINT) from None


def join_rows(rows: Iterable[Iterable[Any]]) -> str:
    """Join rows of cells to the text of a CSV file; an empty cell is a gap. Raises Finding [too-large]."""
    lines: list[str] = []
    count = 0
    for row in rows:
        cells = [format_cell(cell) for cell in row]
        count += len(cells)
        if count > MAX_CELLS:
            raise Finding("too-large", f"it has more than {MAX_CELLS} cells", "keep only the columns needed")
        line = SEPARATOR.join(cells)
        lines.append(line if line.strip() else "")
    return "\n".join(lines)


def format_cell(cell: Any) -> str:
    """Format a cell: numbers with all digits, texts on one line without the separator."""
    if cell is None:
        return ""
    if type(cell) is float or type(cell) is int:
        return repr(cell)
    return " ".join(str(cell).replace('"', " ").split())


def convert_text(text: str, name: str) -> str:
    """Return the text of a data file with the headers of other programs turned to comments. Raises Finding."""
    if name.lower().endswith(MOTOR_ENDING):
        return convert_motor(text)
    if END_OF_HEADER in text:
        return convert_labview(text)
    return text


def convert_motor(text: str) -> str:
    """Return the thrust curve of a file with one rocket motor, in the format of RASP. Raises Finding [table-file]."""
    lines = ["" if line.lstrip().startswith(";") else line for line in text.splitlines()]
    headers = [i for i, line in enumerate(lines) if len(line.split()) >= MOTOR_HEADER_WORDS]
    rows = [i for i, line in enumerate(lines) if line.strip() and i not in headers]
    if len(headers) != 1 or not rows or headers[0] > rows[0]:
        names = list_words([lines[i].split()[0] for i in headers])
        message = f"it has several motors: {names}" if len(headers) > 1 else "it has no motor with a thrust curve"
        raise Finding("table-file", message, "keep one motor in the file: a line of seven words, then time and thrust")
    header = headers[0]
    try:
        is_from_zero = float(lines[rows[0]].split()[0]) <= 0.0
    except ValueError:
        is_from_zero = True  # reported when it is read
    for i in rows:
        lines[i] = SEPARATOR.join(lines[i].split())
    lines[header] = MOTOR_HEADINGS if is_from_zero else f"{MOTOR_HEADINGS}\n0\t0"
    if not is_from_zero and header:
        del lines[0]  # a comment, so that each point keeps its line
    return "\n".join(lines)


def convert_labview(text: str) -> str:
    """Return the text of a measurement file of LabVIEW with its headers as comments. Raises Finding [table-file]."""
    lines = text.splitlines()
    ends = [i for i, line in enumerate(lines) if line.strip().startswith(END_OF_HEADER)]
    if len(ends) > 2:
        message = f"it has {len(ends) - 1} segments of measurements"
        raise Finding("table-file", message, "keep one of them in the file")
    last = ends[-1] + 1 if ends else 0
    return "\n".join(["#"] * last + lines[last:])
