"""Tables too wide for a page in parts, below each other: each begins with the columns that say what a line is of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base.wrapping import wrapped
from heuncli.output.tables.text_table import GAP, INDENT, TextTable, aligned

GOES_ON = "continued"
LEAST_TEXT = 24  # places that a last column of text must have to go on in lines of its own


def fit(table: TextTable, width: int) -> list[TextTable]:
    """The table in parts no wider than `width` if that can be; each repeats the leading columns of words."""
    if not table.columns:
        return [table]
    widths = [max(map(len, column)) + len(GAP) for column in zip(*aligned(table), strict=True)]
    indent = len(INDENT) if any(isinstance(row, str) for row in table.rows) else 0
    over = indent + sum(widths) - len(GAP) - width
    if over <= 0:
        return [table]
    if len(widths) > 1 and table.columns[-1].align == "left" and widths[-1] - len(GAP) - over >= LEAST_TEXT:
        return [table._replace(rows=tuple(in_lines(table, widths[-1] - len(GAP) - over)))]
    if table.columns[-1].spare:
        rest = tuple(row if isinstance(row, str) else row[:-1] for row in table.rows)
        return fit(table._replace(columns=table.columns[:-1], rows=rest), width)
    lead = 1 + max((i for i, column in enumerate(table.columns[:3]) if column.align == "left"), default=0)
    again = [i for i in range(lead) if not table.columns[i].once]
    room = [width - indent + len(GAP) - sum(widths[i] for i in columns) for columns in (range(lead), again)]
    parts = shared_out(widths, unparted(table, lead, widths, room[1]), room)
    tables = []
    for number, part in enumerate(parts):
        kept = [*(again if number else range(lead)), *part]
        rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in kept) for row in table.rows)
        notes = table.notes if number == len(parts) - 1 else ()
        tables.append(TextTable(heading(table, number), tuple(table.columns[i] for i in kept), rows, notes))
    return tables


def in_lines(table: TextTable, room: int) -> Iterator[tuple[str, ...] | str]:
    """The rows with the text of the last column in lines of so many places."""
    for row in table.rows:
        if isinstance(row, str):
            yield row
            continue
        first, *rest = wrapped(row[-1], room, 0)
        yield (*row[:-1], first)
        yield from ((*[""] * (len(row) - 1), line) for line in rest)


def heading(table: TextTable, part: int) -> str:
    """The heading of a part: of the first all of it, of the others what it is called."""
    if not part or not table.heading:
        return "" if part else table.heading
    lead, at, behind = table.heading.partition(")  ")  # of a blow, its instant and what struck
    begins, called = (lead + at, behind) if lead.startswith("IMPULSE at") and behind else ("", table.heading)
    return f"{begins}{called.partition('  ')[0]}  {GOES_ON}"


def unparted(table: TextTable, lead: int, widths: Sequence[int], room: int) -> list[list[int]]:
    """The columns behind the leading ones, those of one vector together as long as they have room."""
    found: list[list[int]] = []
    for place in range(lead, len(widths)):
        vector, before = table.columns[place].vector, found[-1] if found else []
        same = vector and before and table.columns[before[-1]].vector == vector
        if same and sum(widths[i] for i in (*before, place)) <= room:
            before.append(place)
        else:
            found.append([place])
    return found


def shared_out(widths: Sequence[int], unparted: Sequence[list[int]], room: Sequence[int]) -> list[list[int]]:
    """The columns of each part, as many as have room; room: of the first part and of the others."""
    parts: list[list[int]] = [[]]
    for columns in unparted:
        if parts[-1] and sum(widths[i] for i in (*parts[-1], *columns)) > room[len(parts) > 1]:
            parts.append([])
        parts[-1] += columns
    return parts
