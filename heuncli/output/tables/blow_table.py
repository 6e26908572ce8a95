"""What a blow does as one table: a line a vector with its size or a line a number, under the name of what it is of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

from heuncli.output.tables.instants_tables import group_texts
from heuncli.output.tables.table_blocks import NumberRow, RowGroup, TableBlock
from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.results.results import Array
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.digits import OPEN, UNKNOWN, UNKNOWN_NOTE, ZERO_NOTE, Certainty

LEAD = 3  # columns of words: of what, which number, its unit
HEADS = (*XYZ, "value")  # of a vector its size
NOTHING = ("", "0")


def blow_table(
    heading: str, blocks: Sequence[TableBlock], times: Array, horizon: float | None, certain: Certainty
) -> TextTable:
    """The blocks of a blow, (1,) `times`, below each other; what is 0 takes no line and no column."""
    rows: list[tuple[str, ...] | str] = []
    notes, whole = list[str](), True
    for block in blocks:
        lines = [line for group in block.groups for line in _lines(block, group, times, horizon, certain)]
        shown = [line for line in lines if set(line[LEAD:-1]) - set(NOTHING)]
        whole &= len(shown) == len(lines)
        if shown:
            rows += [block.heading, *_named_once(shown)]
            notes += block.notes
        cells = {text for line in shown for text in line}
        notes += [note for word, note in (block.missing, (UNKNOWN, UNKNOWN_NOTE)) if word in cells]
    if not rows:
        return TextTable(heading, notes=("0 throughout",))
    table = _without_empty(TextTable(heading, _columns(), tuple(rows)))
    numbers = {column.head for column in table.columns} & set(HEADS)
    notes += [ZERO_NOTE] if not whole or len(numbers) < len(HEADS) else []
    return table._replace(notes=tuple(dict.fromkeys(notes)))


def _columns() -> tuple[TextColumn, ...]:
    words = [TextColumn("", "left")] * LEAD
    return (*words, *(TextColumn(head, vector="numbers") for head in HEADS), TextColumn("", "left", spare=True))


def _lines(
    block: TableBlock, group: RowGroup, times: Array, horizon: float | None, certain: Certainty
) -> Iterator[tuple[str, ...]]:
    """Name, label, unit, components, value, and what it is of: of each vector, and of each other number."""
    texts = {label: own[0] for label, own in group_texts(block, group, times, horizon, certain).items()}
    sizes = {row.family: texts[row.label] for row in group.rows if row.even and row.vector}
    for _, same in groupby(group.rows, key=lambda row: row.vector or row.label):
        rows = list(same)
        if not _told_by_size(rows[0], texts, sizes):
            cells = [texts[row.label] for row in rows]
            before = [""] * (len(HEADS) - len(cells))
            label = rows[0].vector or rows[0].label.removeprefix(
                f"{block.key} "
            )  # under its heading, energy after: after
            yield (group.name, label, rows[0].unit, *before, *cells, group.note)


def _told_by_size(row: NumberRow, texts: Mapping[str, str], sizes: Mapping[str, str]) -> bool:
    """Whether a number is that part of a vector which is all of it: the radial force where none is axial."""
    known = texts[row.label] not in (OPEN, UNKNOWN)
    return known and not row.vector and row.even and texts[row.label] == sizes.get(row.family)


def _named_once(lines: Sequence[tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """The lines, of which only the first of several of one name tells it and what it is of."""
    before = None
    for line in lines:
        yield line if line[0] != before or not before else ("", *line[1:-1], "")
        before = line[0]


def _without_empty(table: TextTable) -> TextTable:
    """The table without the columns in which nothing stands, or nothing but 0."""
    cells = [row for row in table.rows if not isinstance(row, str)]
    kept = [i for i in range(len(table.columns)) if any(row[i] not in NOTHING for row in cells)]
    rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in kept) for row in table.rows)
    return TextTable(table.heading, tuple(table.columns[i] for i in kept), rows, table.notes)
