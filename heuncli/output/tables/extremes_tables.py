"""Tables of extremes: first and last value of each row, lowest and highest with their instants."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_text import INDENT, select_columns
from heuncli.output.documents.document import Cell, OutputColumn, OutputTable, format_cell
from heuncli.output.tables.nouns import join_ranges
from heuncli.output.tables.table_blocks import RowGroup, TableBlock, choose_styles, make_cells
from heuncli.results.results import Array, Extremes
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    StatedErrors,
    format_unclaimed,
    write_times,
)

MAX_FULL_GROUPS = 40  # with more groups, each has one line
PARTLY_OPEN_NOTE = "* open at some times; extremes of the other times"
NOT_SEARCHED = "extremes at output times only: too many quantities to search between them"
NOTES = (ZERO_NOTE, OPEN_NOTE, PARTLY_OPEN_NOTE, UNKNOWN_NOTE)
CONSTANT = "constant"  # in place of the instant of a greatest value
PART = ".on."  # in the names of the loads of a coupling on each body
N_LEADING = 2  # columns before the numbers: label, unit
COLUMNS = (
    OutputColumn("", "text"), OutputColumn("", "text"),
    OutputColumn("first", is_optional=True), OutputColumn("last", is_optional=True),
    OutputColumn("min", vector="extremes"), OutputColumn("at", "instant", "s", vector="extremes"),
    OutputColumn("max", vector="extremes"), OutputColumn("at", "instant", "s", vector="extremes"),
)  # fmt: skip
MARK = "†"  # of an extreme at a doubtful instant
FRICTION_KINDS = frozenset({"foundation", "joints", "sensors", "stops", "couplings", "sections"})  # depend on friction


class DoubtfulInstants(NamedTuple):
    """Instants at which computed loads and accelerations are not those of the real machine, and the note on why."""

    instants: frozenset[float] = frozenset()
    note: str = ""

    @classmethod
    def with_reason(cls, instants: Iterable[float], reason: str) -> DoubtfulInstants:
        """Make the set of instants with the note that explains their mark."""
        return cls(frozenset(instants), f"{MARK} {reason}")

    def add_mark(self, text: str, time: float, kind: str, unit: str) -> str:
        """Append the mark to the text of a number if its instant is doubtful and the number depends on it."""
        depends = kind in FRICTION_KINDS or unit.endswith("/s²")
        return text + MARK if time in self.instants and depends and text not in ("0", OPEN, UNKNOWN) else text


NO_DOUBT = DoubtfulInstants()


class GroupExtremes(NamedTuple):
    """A group with the extremes of its rows.

    last_values: by path, if the run ends beyond its horizon
    """

    group: RowGroup
    extremes: Extremes
    last_values: Mapping[str, float]


def drop_components(block: TableBlock) -> TableBlock:
    """Drop the components of vectors if a block has too many groups for a full table; those of the whole scene stay."""
    if len(block.groups) <= MAX_FULL_GROUPS:
        return block
    whole_rows = [tuple(row for row in group.rows if row.is_magnitude or not row.vector) for group in block.groups]
    groups = zip(block.groups, whole_rows, strict=True)
    return block._replace(
        groups=tuple(group if group.is_whole_scene else group._replace(rows=rows) for group, rows in groups)
    )


def make_extremes_tables(
    block: TableBlock, times: Array, extremes: Extremes, stated_errors: StatedErrors, last_values: Mapping[str, float],
    doubtful: DoubtfulInstants = NO_DOUBT, *, full: bool = True,
) -> list[OutputTable]:  # fmt: skip
    """Make the tables of first, last, lowest and highest values with their instants; one row a group if there are many.

    extremes: of the block's rows, in their order
    last_values: by the paths of the rows, if the run ends beyond its horizon
    doubtful: instants whose extremes are marked
    full: repeat what is constant or indeterminate in every column and group
    """
    counts = np.cumsum([0, *(len(group.rows) for group in block.groups)])
    parts = [
        GroupExtremes(group, extremes.select(slice(*ends)), last_values)
        for group, ends in zip(block.groups, pairwise(counts.tolist()), strict=True)
    ]
    if len(parts) <= MAX_FULL_GROUPS:
        return [_make_full_table(block, parts, times, stated_errors, doubtful, full)]
    scene_parts = [part for part in parts if part.group.is_whole_scene]
    tables = [_make_full_table(block, scene_parts, times, stated_errors, doubtful, full)] if scene_parts else []
    other_parts = [part for part in parts if not part.group.is_whole_scene]
    heading = "" if scene_parts else block.heading
    return [*tables, _make_short_table(block, other_parts, times, stated_errors, heading, doubtful)]


def _make_full_table(
    block: TableBlock, parts: Sequence[GroupExtremes], times: Array, stated_errors: StatedErrors,
    doubtful: DoubtfulInstants, full: bool,
) -> OutputTable:  # fmt: skip
    """Make the table with a row for each number, under a title for each group."""
    rows: list[tuple[Cell, ...] | str] = []
    notes: set[str] = set()
    open_groups: dict[str, list[str]] = {}  # names of groups by their open components
    span = float(np.ptp(times))
    for part in parts:
        lines, open_labels, notes_of_group = _make_group_rows(part, span, stated_errors, block.kind, doubtful)
        notes |= notes_of_group
        if open_labels and part.group.name and not full:
            open_groups.setdefault(", ".join(open_labels), []).append(part.group.name)
        elif open_labels:
            lines.append(f"{INDENT}{OPEN}: {', '.join(open_labels)}")
        elif not lines:
            lines.append(f"{INDENT}all values 0")
        rows += [part.group.title, *lines] if part.group.name and lines else lines
    open_names = {name for names in open_groups.values() for name in names}
    for labels, names in open_groups.items():  # what a coupling exerts on each body is open with the coupling
        named = [name for name in names if name.partition(PART)[0] not in open_names - {name}]
        rows += [f"{OPEN}  {', '.join(join_ranges(named))}: {labels}"] if named else []
    shown_notes = [note for note in (*NOTES, doubtful.note) if note in notes]
    table = OutputTable(block.heading, COLUMNS, tuple(rows), (*block.notes, *shown_notes))
    if all(isinstance(row, str) for row in rows):
        return table._replace(columns=(OutputColumn("", "text"),))  # only titles: there are no numbers
    return table if full else _merge_constants(table)


def _merge_constants(table: OutputTable) -> OutputTable:
    """Show a constant number once, and leave out the columns that are then empty."""
    rows: list[Sequence[Cell] | str] = []
    for row in table.rows:
        numbers = set() if isinstance(row, str) else {format_cell(row[i]) for i in (2, 3, 4, 6)}
        rows.append((*row[:N_LEADING], "", "", "", "", row[6], CONSTANT) if len(numbers) == 1 else row)
    cells = [row for row in rows if not isinstance(row, str)]
    shown = [i for i in range(len(table.columns)) if i < N_LEADING or any(row[i] for row in cells)]
    return select_columns(table._replace(rows=tuple(rows)), shown)


def _make_group_rows(
    part: GroupExtremes, span: float, stated_errors: StatedErrors, kind: str, doubtful: DoubtfulInstants
) -> tuple[list[tuple[Cell, ...] | str], list[str], set[str]]:
    """Make the rows of a group, the labels of its numbers that are open throughout, and the notes they need.

    Numbers that are zero throughout get no row either.
    """
    group, extremes = part.group, part.extremes
    instants = np.stack([extremes.low_at, extremes.high_at])
    notes: set[str] = set()
    cells = _make_extreme_cells(part, stated_errors)
    texts = [[format_cell(cell) for cell in cells_of_row] for cells_of_row in cells]
    words = [set(texts_of_row) for texts_of_row in texts]  # {"0"} of a number that is zero throughout
    lines: list[tuple[Cell, ...] | str] = []
    open_labels = [row.label for row, shown in zip(group.rows, words, strict=True) if shown == {OPEN}]
    nonzero_rows = [row for row, shown in zip(group.rows, words, strict=True) if shown != {"0"}]
    nonzero_counts = Counter(row.vector for row in nonzero_rows if not row.is_magnitude)
    for i, row in enumerate(group.rows):
        if row.label in open_labels:
            continue
        if words[i] == {"0"}:
            notes.add(ZERO_NOTE)
            continue
        if row.is_magnitude and row.vector and nonzero_counts[row.vector] == 1:
            continue  # for a vector along one axis the magnitude adds nothing
        partly_open = bool(np.isnan(row.values).any())
        notes |= {PARTLY_OPEN_NOTE} if partly_open else set()
        notes |= {UNKNOWN_NOTE} if UNKNOWN in words[i] else set()
        low, high = texts[i][2:]
        low_at, high_at = ["", ""] if low == high else write_times(instants[:, i].tolist(), span)
        unit = stated_errors.units.find(row.unit)[0] if row.unit != "1" else ""
        ends = cells[i][2:]
        if low != high:  # else it is constant
            ends_with_instants = zip((low, high), instants[:, i].tolist(), strict=True)
            marked = [doubtful.add_mark(text, at, kind, unit) for text, at in ends_with_instants]
            notes |= {doubtful.note} if marked != [low, high] else set()
            ends = [cell if end == text else end for cell, end, text in zip(ends, marked, (low, high), strict=True)]
        lines.append((row.label + "*" * partly_open, unit, *cells[i][:2], ends[0], low_at, ends[1], high_at))
    if open_labels:
        notes.add(OPEN_NOTE)
    if not lines:
        notes.discard(ZERO_NOTE)  # the group says that all of it is zero
    return lines, open_labels, notes


def _make_extreme_cells(part: GroupExtremes, stated_errors: StatedErrors) -> list[list[Cell]]:
    """Make the cells of the first, last, lowest and highest value of each row."""
    rows = part.group.rows
    first, last = (np.array([row.values[i] for row in rows]) for i in (0, -1))
    numbers = np.stack([first, last, part.extremes.low, part.extremes.high])
    cells: list[list[Cell]] = [[*cells_of_row] for cells_of_row in make_cells(part.group, numbers, stated_errors)]
    for row, cells_of_row in zip(rows, cells, strict=True):
        if row.path in part.last_values:
            text = format_cell(cells_of_row[1])
            cells_of_row[1] = format_unclaimed(part.last_values[row.path], row.unit, stated_errors, text)
    return cells


def _make_short_table(
    block: TableBlock, parts: Sequence[GroupExtremes], times: Array, stated_errors: StatedErrors, heading: str,
    doubtful: DoubtfulInstants,
) -> OutputTable:  # fmt: skip
    """Make the table with a row for each group: of each number, not of components, the value of largest magnitude."""
    span = float(np.ptp(times))
    heads: dict[str, None] = {}
    cells: list[dict[str, tuple[str, str]]] = []
    for group, extremes, _ in parts:
        lower = np.abs(extremes.low) > np.abs(extremes.high)
        farthest = np.where(lower, extremes.low, extremes.high)
        styles = choose_styles(group.rows, farthest[None, :], stated_errors)
        display_units = [stated_errors.units.find(row.unit) for row in group.rows]
        texts = [
            number_style.write(per_si * value)
            for number_style, value, (_, per_si) in zip(styles, farthest, display_units, strict=True)
        ]
        instants = np.where(lower, extremes.low_at, extremes.high_at).tolist()
        clock = write_times(instants, span)
        texts = [
            doubtful.add_mark(text, time, block.kind, row.unit)
            for text, time, row in zip(texts, instants, group.rows, strict=True)
        ]
        cells_of_group = {
            f"{row.label} [{unit}]": (text, "" if text in ("0", OPEN, UNKNOWN) else time)
            for row, (unit, _), text, time in zip(group.rows, display_units, texts, clock, strict=True)
        }
        heads |= dict.fromkeys(head for head, (text, _) in cells_of_group.items() if text != "0")
        cells.append(cells_of_group)
    columns = [OutputColumn(block.what, "text")]
    for head in heads:
        columns += [OutputColumn(head), OutputColumn("at [s]")]
    rows = tuple(
        (part.group.name, *(text for head in heads for text in cells_of_group.get(head, ("", ""))))
        for part, cells_of_group in zip(parts, cells, strict=True)
    )
    what = f"{len(parts)} {block.what or 'group'}s, one line each: value of largest magnitude"
    notes = (*block.notes, f"{what}; components: --at or --format csv")
    shown = {text for row in rows for text in row}
    notes += tuple(note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown)
    notes += (doubtful.note,) if any(text.endswith(MARK) for text in shown) else ()
    return OutputTable(heading, tuple(columns), rows, notes)
