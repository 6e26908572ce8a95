"""Tables at given instants: a row for each instant, group by group; for one instant a row for each group."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable, format_cell
from heuncli.output.tables.table_blocks import RowGroup, TableBlock, make_cells
from heuncli.results.results import Array
from heuncli.study.quantities.digits import (
    OPEN,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_COLUMNS_NOTE,
    StatedErrors,
    format_unclaimed,
    write_times,
)

Cells = dict[str, dict[str, list[Cell]]]  # group -> label -> a cell for each instant


def make_instants_tables(
    block: TableBlock, times: Array, horizon: float | None, stated_errors: StatedErrors
) -> list[OutputTable]:
    """Make the tables of a block with a row for each instant, group by group; for one instant a row for each group."""
    word, note = block.missing
    if word != OPEN and all(np.isnan(row.values).all() for group in block.groups for row in group.rows):
        return [OutputTable(block.heading, notes=(note,))]
    tables: list[OutputTable] = []
    notes = list(block.notes)
    layout = _layout_single_instant if len(times) == 1 else _layout_instants
    for groups in _split_by_units(block.groups):
        cells = {group.name: make_group_cells(block, group, times, horizon, stated_errors) for group in groups}
        units = {row.label: stated_errors.units.find(row.unit)[0] for group in groups for row in group.rows}
        labels = _find_nonzero_labels(groups, cells) if word == OPEN else _order_labels(groups)
        if len(labels) < len(units):
            notes.append(ZERO_COLUMNS_NOTE if labels else f"all values 0: {', '.join(group.name for group in groups)}")
        vectors = {row.label: row.vector for group in groups for row in group.rows}
        columns = [OutputColumn(label, unit=units[label], vector=vectors[label]) for label in labels]
        lead, rows = layout(block, groups, labels, cells, times)
        tables += [OutputTable("" if tables else block.heading, (*lead, *columns), tuple(rows))] if labels else []
    shown_rows = [row for table in tables for row in table.rows if not isinstance(row, str)]
    shown = {cell.cached_text if isinstance(cell, NumberCell) else cell for row in shown_rows for cell in row}
    notes += [note for word, note in (block.missing, (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    if not tables:
        return [OutputTable(block.heading, notes=("all values 0",))]
    return [*tables[:-1], tables[-1]._replace(notes=tuple(dict.fromkeys(notes)))]


def _layout_single_instant(
    block: TableBlock, groups: Sequence[RowGroup], labels: Sequence[str], cells: Cells, times: Array
) -> tuple[list[OutputColumn], list[tuple[Cell, ...] | str]]:
    """Return the leading columns, and a row for each group."""
    has_names = any(group.name for group in groups)
    has_notes = any(group.note for group in groups)
    rows: list[tuple[Cell, ...] | str] = []
    for group in groups:
        leading_cells = [group.caption] * has_names + [group.note] * has_notes
        rows.append((*leading_cells, *(cells[group.name].get(label, [""])[0] for label in labels)))
    return [OutputColumn(block.what, "text")] * has_names + [
        OutputColumn("", "text", is_shown_once=has_names)
    ] * has_notes, rows


def _layout_instants(
    block: TableBlock, groups: Sequence[RowGroup], labels: Sequence[str], cells: Cells, times: Array
) -> tuple[list[OutputColumn], list[tuple[Cell, ...] | str]]:
    """Return the leading columns, and a row for each instant of each group."""
    clock = write_times(times.tolist(), float(np.ptp(times)))
    empty: list[Cell] = [""] * len(times)
    rows: list[tuple[Cell, ...] | str] = []
    for group in groups:
        rows += [group.title] if group.name else []
        columns = [cells[group.name].get(label, empty) for label in labels]
        rows += list(zip(clock, *columns, strict=True))
    return [OutputColumn("t", "instant", "s")], rows


def _order_labels(groups: Sequence[RowGroup]) -> list[str]:
    """Return the labels of all groups in an order that keeps the order within each group."""
    order: list[str] = []
    for group in groups:
        next_index = 0
        for row in group.rows:
            if row.label not in order:
                order.insert(next_index, row.label)
            next_index = order.index(row.label) + 1
    return order


def make_group_cells(
    block: TableBlock, group: RowGroup, times: Array, horizon: float | None, stated_errors: StatedErrors
) -> dict[str, list[Cell]]:
    """Make the cells of a group by label, one for each instant; a word where a number is not known."""
    numbers = np.stack([row.values for row in group.rows], axis=1)
    within_horizon = [horizon is None or t < horizon for t in times.tolist()]
    words = [{OPEN: UNKNOWN if t in stated_errors.singular_times else block.missing[0]} for t in times.tolist()]
    cells: dict[str, list[Cell]] = {}
    for row, numbers_of_row in zip(group.rows, make_cells(group, numbers, stated_errors), strict=True):
        if all(within_horizon) and not np.isnan(row.values).any():
            cells[row.label] = [*numbers_of_row]
            continue
        cells_of_row: list[Cell] = [
            cell if is_known else format_unclaimed(value, row.unit, stated_errors, cell.text)
            for value, cell, is_known in zip(row.values.tolist(), numbers_of_row, within_horizon, strict=True)
        ]
        cells[row.label] = [word.get(format_cell(cell), cell) for word, cell in zip(words, cells_of_row, strict=True)]
    return cells


def _find_nonzero_labels(groups: Sequence[RowGroup], cells: Cells) -> list[str]:
    """Return the ordered labels of numbers that are not zero throughout; a vector is kept or left out as a whole."""
    vector_of_label = {row.label: row.vector or row.label for group in groups for row in group.rows}
    shown = {
        vector_of_label[label]
        for cells_by_label in cells.values()
        for label, cells_of_label in cells_by_label.items()
        if any(format_cell(cell) != "0" for cell in cells_of_label)
    }
    return [label for label in _order_labels(groups) if vector_of_label[label] in shown]


def _split_by_units(groups: Sequence[RowGroup]) -> list[list[RowGroup]]:
    """Split the groups into tables in which each column has one unit."""
    tables: list[tuple[dict[str, str], list[RowGroup]]] = []
    for group in groups:
        units = {row.label: row.unit for row in group.rows}
        for known, members in tables:
            if all(known.get(label, unit) == unit for label, unit in units.items()):
                known |= units
                members.append(group)
                break
        else:
            tables.append((units, [group]))
    return [members for _, members in tables]
