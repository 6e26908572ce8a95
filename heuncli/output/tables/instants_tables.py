"""Blocks as tables of instants: a line for each, group by group; for one instant a line for each group."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.output.tables.table_blocks import RowGroup, TableBlock, texts_of
from heuncli.output.tables.text_table import TextColumn, TextTable, head
from heuncli.results.results import Array
from heuncli.study.quantities.digits import (
    OPEN,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    Certainty,
    beyond_horizon,
    write_times,
)

Cells = dict[str, dict[str, list[str]]]  # group -> label -> a text for each instant


def instants_tables(block: TableBlock, times: Array, horizon: float | None, certain: Certainty) -> list[TextTable]:
    """A line for each instant, group by group; for one instant a line for each group."""
    word, note = block.missing
    if word != OPEN and all(np.isnan(row.values).all() for group in block.groups for row in group.rows):
        return [TextTable(block.heading, notes=(note,))]
    tables: list[TextTable] = []
    notes = list(block.notes)
    lay = _at_one if len(times) == 1 else _one_below_the_other
    for groups in _same_columns(block.groups):
        cells = {group.name: group_texts(block, group, times, horizon, certain) for group in groups}
        units = {row.label: row.unit for group in groups for row in group.rows}
        labels = _not_zero(groups, cells) if word == OPEN else _in_order(groups)
        if len(labels) < len(units):
            notes.append(ZERO_NOTE if labels else f"0 throughout: {', '.join(group.name for group in groups)}")
        of = {row.label: row.vector for group in groups for row in group.rows}
        columns = [TextColumn(head(label, units[label]), vector=of[label]) for label in labels]
        lead, rows = lay(block, groups, labels, cells, times)
        tables += [TextTable("" if tables else block.heading, (*lead, *columns), tuple(rows))] if labels else []
    shown = {text for table in tables for row in table.rows if not isinstance(row, str) for text in row}
    notes += [note for word, note in (block.missing, (UNKNOWN, UNKNOWN_NOTE)) if word in shown]
    if not tables:
        return [TextTable(block.heading, notes=("0 throughout",))]
    return [*tables[:-1], tables[-1]._replace(notes=tuple(dict.fromkeys(notes)))]


def _at_one(
    block: TableBlock, groups: Sequence[RowGroup], labels: Sequence[str], cells: Cells, times: Array
) -> tuple[list[TextColumn], list[tuple[str, ...] | str]]:
    """Leading columns, and a row for each group."""
    named = any(group.name for group in groups)
    noted = any(group.note for group in groups)
    rows: list[tuple[str, ...] | str] = []
    for group in groups:
        about = [group.name] * named + [group.note] * noted
        rows.append((*about, *(cells[group.name].get(label, [""])[0] for label in labels)))
    return [TextColumn(block.what, "left")] * named + [TextColumn("", "left", once=named)] * noted, rows


def _one_below_the_other(
    block: TableBlock, groups: Sequence[RowGroup], labels: Sequence[str], cells: Cells, times: Array
) -> tuple[list[TextColumn], list[tuple[str, ...] | str]]:
    """Leading columns, and a row for each instant of each group."""
    clock = write_times(times.tolist(), float(np.ptp(times)))
    empty = [""] * len(times)
    rows: list[tuple[str, ...] | str] = []
    for group in groups:
        rows += [group.title] if group.name else []
        columns = [cells[group.name].get(label, empty) for label in labels]
        rows += list(zip(clock, *columns, strict=True))
    return [TextColumn("t [s]")], rows


def _in_order(groups: Sequence[RowGroup]) -> list[str]:
    """The labels of all groups, each after those it follows in its own."""
    order: list[str] = []
    for group in groups:
        behind = 0
        for row in group.rows:
            if row.label not in order:
                order.insert(behind, row.label)
            behind = order.index(row.label) + 1
    return order


def group_texts(
    block: TableBlock, group: RowGroup, times: Array, horizon: float | None, certain: Certainty
) -> dict[str, list[str]]:
    """The cells of a group by label, one an instant."""
    numbers = np.stack([row.values for row in group.rows], axis=1)
    known = [horizon is None or t < horizon for t in times.tolist()]
    words = [{OPEN: UNKNOWN if t in certain.beside else block.missing[0]} for t in times.tolist()]
    cells = {}
    for row, texts in zip(group.rows, texts_of(group, numbers, certain), strict=True):
        own = [
            text if sure else beyond_horizon(value, row.unit, certain, text)
            for value, text, sure in zip(row.values.tolist(), texts, known, strict=True)
        ]
        cells[row.label] = [word.get(text, text) for word, text in zip(words, own, strict=True)]
    return cells


def _not_zero(groups: Sequence[RowGroup], cells: Cells) -> list[str]:
    """The labels of what is not 0 throughout, vectors whole, in their order."""
    whole = {row.label: row.vector or row.label for group in groups for row in group.rows}
    shown = {whole[label] for own in cells.values() for label, texts in own.items() if set(texts) != {"0"}}
    return [label for label in _in_order(groups) if whole[label] in shown]


def _same_columns(groups: Sequence[RowGroup]) -> list[list[RowGroup]]:
    """The groups in tables whose columns have one unit each."""
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
