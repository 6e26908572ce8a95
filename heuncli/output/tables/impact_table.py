"""The table of one impact: a row for each vector with its magnitude, and for each other number, under the object's
name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

from heuncli.output.documents.document import OutputColumn, OutputTable, format_cell
from heuncli.output.tables.instants_tables import make_group_cells
from heuncli.output.tables.table_blocks import RowGroup, TableBlock
from heuncli.results.results import Array
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.channels import Channel
from heuncli.study.quantities.digits import OPEN, UNKNOWN, UNKNOWN_NOTE, ZERO_NOTE, StatedErrors

LEADING_COLUMNS = 3  # name, label and unit
NUMBER_HEADS = (*XYZ, "value")  # the value of a vector is its magnitude
EMPTY_CELLS = ("", "0")


def make_impact_table(
    heading: str, blocks: Sequence[TableBlock], times: Array, horizon: float | None, certain: StatedErrors
) -> OutputTable:
    """Combine the blocks of one impact in a single table, without rows and columns that are zero.

    times: the instant of the impact, (1,)
    """
    rows: list[tuple[str, ...] | str] = []
    notes, complete = list[str](), True
    for block in blocks:
        row_cells = [line for group in block.groups for line in _iter_rows(block, group, times, horizon, certain)]
        nonzero = [line for line in row_cells if set(line[LEADING_COLUMNS:-1]) - set(EMPTY_CELLS)]
        complete &= len(nonzero) == len(row_cells)
        if nonzero:
            rows += [block.heading, *_blank_repeated_names(nonzero)]
            notes += block.notes
        cells = {text for line in nonzero for text in line}
        notes += [note for word, note in (block.missing, (UNKNOWN, UNKNOWN_NOTE)) if word in cells]
    if not rows:
        return OutputTable(heading, notes=("all values 0",))
    table = _drop_empty_columns(OutputTable(heading, _make_columns(), tuple(rows)))
    numbers = {column.title for column in table.columns} & set(NUMBER_HEADS)
    notes += [ZERO_NOTE] if not complete or len(numbers) < len(NUMBER_HEADS) else []
    return table._replace(notes=tuple(dict.fromkeys(notes)))


def _make_columns() -> tuple[OutputColumn, ...]:
    leading = [OutputColumn("", "text")] * LEADING_COLUMNS
    return (
        *leading,
        *(OutputColumn(head, vector="numbers") for head in NUMBER_HEADS),
        OutputColumn("", "text", is_optional=True),
    )


def _iter_rows(
    block: TableBlock, group: RowGroup, times: Array, horizon: float | None, certain: StatedErrors
) -> Iterator[tuple[str, ...]]:
    """Yield for each vector, and each other number: name, label, unit, components, value, and the group's note."""
    texts = {
        label: format_cell(cells_of_label[0])
        for label, cells_of_label in make_group_cells(block, group, times, horizon, certain).items()
    }
    magnitudes = {row.family: texts[row.label] for row in group.rows if row.is_magnitude and row.vector}
    for _, vector_rows in groupby(group.rows, key=lambda row: row.vector or row.label):
        rows = list(vector_rows)
        if not _repeats_magnitude(rows[0], texts, magnitudes):
            cells = [texts[row.label] for row in rows]
            before = [""] * (len(NUMBER_HEADS) - len(cells))
            # the heading holds the key: "energy after" becomes "after"
            label = rows[0].vector or rows[0].label.removeprefix(f"{block.key} ")
            yield (group.name, label, certain.units.find(rows[0].unit)[0], *before, *cells, group.note)


def _repeats_magnitude(row: Channel, texts: Mapping[str, str], magnitudes: Mapping[str, str]) -> bool:
    """Return whether the row only repeats the vector's magnitude, as a radial force without an axial one."""
    known = texts[row.label] not in (OPEN, UNKNOWN)
    return known and not row.vector and row.is_magnitude and texts[row.label] == magnitudes.get(row.family)


def _blank_repeated_names(lines: Sequence[tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """Show the name and note of consecutive rows of one object only in the first of them."""
    before = None
    for line in lines:
        yield line if line[0] != before or not before else ("", *line[1:-1], "")
        before = line[0]


def _drop_empty_columns(table: OutputTable) -> OutputTable:
    """Drop the columns that are empty or zero in every row."""
    cells = [row for row in table.rows if not isinstance(row, str)]
    shown_columns = [i for i in range(len(table.columns)) if any(row[i] not in EMPTY_CELLS for row in cells)]
    rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in shown_columns) for row in table.rows)
    return OutputTable(table.heading, tuple(table.columns[i] for i in shown_columns), rows, table.notes)
