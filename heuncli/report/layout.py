"""Blocks laid out as tables: extremes over the run, or instants one below the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heuncli.report.blocks import Block, Group, Row
from heuncli.report.numbers import BEYOND, OPEN, OPEN_NOTE, Certainty, Style, largest, style, write, write_times
from heuncli.report.table import INDENT, Column, Table
from heuncli.results import Array

Indices = NDArray[np.intp]
Cells = dict[str, dict[str, list[str]]]  # group -> label -> a text for each instant

MANY = 40  # groups beyond which each gets one line
ZERO_NOTE = "what is 0 throughout is left out"
PARTLY_OPEN_NOTE = "* open at some instants; the extremes are those of the others"
NOTES = (ZERO_NOTE, OPEN_NOTE, PARTLY_OPEN_NOTE)


class Found(NamedTuple):
    """Extremes of rows, in their order: value, instant, and column of what was searched, (n_rows,) each."""

    low: Array
    low_at: Array
    low_column: Indices
    high: Array
    high_at: Array
    high_column: Indices

    def part(self, place: slice) -> Found:
        """The extremes of some of the rows."""
        return Found._make(own[place] for own in self)


def abridged(block: Block) -> Block:
    """The block without the components of vectors in its groups, where these are so many that each gets one line."""
    if len(block.groups) <= MANY:
        return block
    groups = [
        group if group.whole else group._replace(rows=tuple(row for row in group.rows if row.even or not row.vector))
        for group in block.groups
    ]
    return block._replace(groups=tuple(groups))


def extremes_table(block: Block, times: Array, found: Found, certain: Certainty) -> list[Table]:
    """First and last value, lowest and highest with their instants; one line a group where there are many."""
    counts = np.cumsum([0, *(len(group.rows) for group in block.groups)])
    pairs = [(group, slice(a, b)) for group, a, b in zip(block.groups, counts, counts[1:], strict=False)]
    if len(pairs) <= MANY:
        return [_full(block, pairs, times, found, certain)]
    whole = [pair for pair in pairs if pair[0].whole]
    tables = [_full(block, whole, times, found, certain)] if whole else []
    single = [pair for pair in pairs if not pair[0].whole]
    return [*tables, _one_line_each(block, single, times, found, certain, heading="" if whole else block.heading)]


def instants_tables(block: Block, times: Array, horizon: float | None, certain: Certainty) -> list[Table]:
    """A line for each instant, group by group; for one instant a line for each group."""
    word, note = block.missing
    if word != OPEN and all(np.isnan(row.values).all() for group in block.groups for row in group.rows):
        return [Table(block.heading, notes=(note,))]
    tables: list[Table] = []
    notes = list(block.notes)
    lay = _at_one if len(times) == 1 else _one_below_the_other
    for groups in _same_columns(block.groups):
        cells = {group.name: _group_texts(block, group, times, horizon, certain) for group in groups}
        units = {row.label: row.unit for group in groups for row in group.rows}
        labels = _telling(groups, cells) if word == OPEN else _in_order(groups)
        if len(labels) < len(units):
            notes.append(ZERO_NOTE if labels else f"0 throughout: {', '.join(group.name for group in groups)}")
        columns = [Column(f"{label} [{units[label]}]" if units[label] != "1" else label) for label in labels]
        lead, rows = lay(block, groups, labels, cells, times)
        tables += [Table("" if tables else block.heading, (*lead, *columns), tuple(rows))] if labels else []
    if any(word in row for table in tables for row in table.rows if not isinstance(row, str)):
        notes.append(note)
    if not tables:
        return [Table(block.heading, notes=("0 throughout",))]
    return [*tables[:-1], tables[-1]._replace(notes=tuple(dict.fromkeys(notes)))]


def _at_one(
    block: Block, groups: Sequence[Group], labels: Sequence[str], cells: Cells, times: Array
) -> tuple[list[Column], list[tuple[str, ...] | str]]:
    """Leading columns, and a row for each group."""
    named = any(group.name for group in groups)
    noted = any(group.note for group in groups)
    rows: list[tuple[str, ...] | str] = []
    for group in groups:
        about = [group.name] * named + [group.note] * noted
        rows.append((*about, *(cells[group.name].get(label, [""])[0] for label in labels)))
    return [Column(block.what, "left")] * named + [Column("", "left")] * noted, rows


def _one_below_the_other(
    block: Block, groups: Sequence[Group], labels: Sequence[str], cells: Cells, times: Array
) -> tuple[list[Column], list[tuple[str, ...] | str]]:
    """Leading columns, and a row for each instant of each group."""
    clock = write_times(times.tolist(), float(np.ptp(times)))
    empty = [""] * len(times)
    rows: list[tuple[str, ...] | str] = []
    for group in groups:
        rows += [_title(group)] if group.name else []
        columns = [cells[group.name].get(label, empty) for label in labels]
        rows += list(zip(clock, *columns, strict=True))
    return [Column("t [s]")], rows


def family_styles(rows: Sequence[Row], certain: Certainty) -> dict[tuple[str, str], Style]:
    """The style of each family of rows, by family and unit."""
    scales: dict[tuple[str, str], float] = {}
    for row in rows:
        key = (row.family, row.unit)
        scales[key] = max(scales.get(key, 0.0), largest(row.values))
    return {key: style(scale, certain.error(key[1])) for key, scale in scales.items()}


def _full(block: Block, pairs: Sequence[tuple[Group, slice]], times: Array, found: Found, certain: Certainty) -> Table:
    rows: list[tuple[str, ...] | str] = []
    told: set[str] = set()
    span = float(np.ptp(times))
    for group, place in pairs:
        ends = [[row.values[i] for row in group.rows] for i in (0, -1)]
        numbers = np.stack([*ends, found.low[place], found.high[place]])
        instants = np.stack([found.low_at[place], found.high_at[place]])
        rows += [_title(group)] if group.name else []
        rows += _extreme_lines(group, numbers, instants, span, certain, told)
    heads = ("first", "last", "min", "at [s]", "max", "at [s]")
    columns = (Column("", "left"), Column("", "left"), *(Column(head) for head in heads))
    return Table(block.heading, columns, tuple(rows), (*block.notes, *(note for note in NOTES if note in told)))


def _extreme_lines(
    group: Group, numbers: Array, instants: Array, span: float, certain: Certainty, told: set[str]
) -> list[tuple[str, ...] | str]:
    """The lines of a group, and what has to be told below: rows that are 0 or open throughout take no line."""
    texts = _texts(group, numbers, certain)
    lines: list[tuple[str, ...] | str] = []
    unknown = [row.label for row, own in zip(group.rows, texts, strict=True) if set(own) == {OPEN}]
    seen = Counter(row.vector for row, own in zip(group.rows, texts, strict=True) if set(own) != {"0"} and not row.even)
    for i, (row, (first, last, low, high)) in enumerate(zip(group.rows, texts, strict=True)):
        if row.label in unknown:
            continue
        if {first, last, low, high} == {"0"}:
            told.add(ZERO_NOTE)
            continue
        if row.even and row.vector and seen[row.vector] == 1:
            continue  # the magnitude of a vector along one axis tells nothing new
        partly = bool(np.isnan(row.values).any())
        told |= {PARTLY_OPEN_NOTE} if partly else set()
        low_at, high_at = ["", ""] if low == high else write_times(instants[:, i].tolist(), span)
        unit = row.unit if row.unit != "1" else ""
        lines.append((row.label + "*" * partly, unit, first, last, low, low_at, high, high_at))
    if unknown:
        told.add(OPEN_NOTE)
        lines.append(f"{INDENT}{OPEN}: {', '.join(unknown)}")
    return lines or [f"{INDENT}0 throughout"]


def _texts(group: Group, numbers: Array, certain: Certainty) -> list[list[str]]:
    """The numbers of each row as text, (n, n_rows) -> n_rows lists of n; the rows of a family share their decimals."""
    texts: list[list[str]] = [[] for _ in group.rows]
    for key, how in family_styles(group.rows, certain).items():
        members = [i for i, row in enumerate(group.rows) if (row.family, row.unit) == key]
        flat = write(numbers[:, members].ravel().tolist(), how)
        for place, member in enumerate(members):
            texts[member] = flat[place :: len(members)]
    return texts


def _one_line_each(
    block: Block, pairs: Sequence[tuple[Group, slice]], times: Array, found: Found, certain: Certainty, heading: str
) -> Table:
    """A line a group: of each row but the components of vectors the value farthest from zero, and when."""
    span = float(np.ptp(times))
    heads: dict[str, None] = {}
    cells: list[dict[str, tuple[str, str]]] = []
    for group, place in pairs:
        low, high = found.low[place], found.high[place]
        lower = np.abs(low) > np.abs(high)
        farthest = np.where(lower, low, high)
        styles = family_styles(group.rows, certain)
        texts = [styles[row.family, row.unit].write(value) for row, value in zip(group.rows, farthest, strict=True)]
        clock = write_times(np.where(lower, found.low_at[place], found.high_at[place]).tolist(), span)
        own = {
            f"{row.label} [{row.unit}]": (text, "" if text in ("0", OPEN) else at)
            for row, text, at in zip(group.rows, texts, clock, strict=True)
        }
        heads |= dict.fromkeys(head for head, (text, _) in own.items() if text != "0")
        cells.append(own)
    columns = [Column(block.what, "left")]
    for head in heads:
        columns += [Column(head), Column("at [s]")]
    rows = tuple(
        (group.name, *(text for head in heads for text in own.get(head, ("", ""))))
        for (group, _), own in zip(pairs, cells, strict=True)
    )
    what = f"{len(pairs)} {block.what or 'group'}s, a line each: the value farthest from zero"
    notes = (*block.notes, f"{what}; components: --at, or --format csv")
    notes += (OPEN_NOTE,) if any(OPEN in row for row in rows) else ()
    return Table(heading, tuple(columns), rows, notes)


def _in_order(groups: Sequence[Group]) -> list[str]:
    """The labels of all groups, each after those it follows in its own."""
    order: list[str] = []
    for group in groups:
        place = 0
        for row in group.rows:
            if row.label not in order:
                order.insert(place, row.label)
            place = order.index(row.label) + 1
    return order


def _group_texts(
    block: Block, group: Group, times: Array, horizon: float | None, certain: Certainty
) -> dict[str, list[str]]:
    """The cells of a group by label, one an instant."""
    numbers = np.stack([row.values for row in group.rows], axis=1)
    beyond = [horizon is not None and t >= horizon for t in times.tolist()]
    said = {OPEN: block.missing[0]}
    return {
        row.label: [BEYOND if far else said.get(text, text) for text, far in zip(own, beyond, strict=True)]
        for row, own in zip(group.rows, _texts(group, numbers, certain), strict=True)
    }


def _telling(groups: Sequence[Group], cells: Cells) -> list[str]:
    """The labels of what is not 0 throughout, vectors whole, in their order."""
    whole = {row.label: row.vector or row.label for group in groups for row in group.rows}
    telling = {whole[label] for own in cells.values() for label, texts in own.items() if set(texts) - {BEYOND} != {"0"}}
    return [label for label in _in_order(groups) if whole[label] in telling]


def _same_columns(groups: Sequence[Group]) -> list[list[Group]]:
    """The groups in tables whose columns have one unit each."""
    tables: list[tuple[dict[str, str], list[Group]]] = []
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


def _title(group: Group) -> str:
    return f"{group.name}  {group.note}".rstrip()
