"""Blocks as tables of extremes: first and last value of each row, lowest and highest with their instants."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.table_blocks import RowGroup, TableBlock, family_styles, texts_of
from heuncli.output.tables.text_table import INDENT, TextColumn, TextTable
from heuncli.results.results import Array, Extremes
from heuncli.study.quantities.digits import (
    OPEN,
    OPEN_NOTE,
    UNKNOWN,
    UNKNOWN_NOTE,
    ZERO_NOTE,
    Certainty,
    beyond_horizon,
    write_times,
)

MANY = 40  # groups beyond which each gets one line
PARTLY_OPEN_NOTE = "* open at some instants; the extremes are those of the others"
NOT_SEARCHED = "extremes among the samples only: too many quantities to search between them"
NOTES = (ZERO_NOTE, OPEN_NOTE, PARTLY_OPEN_NOTE, UNKNOWN_NOTE)


OF_AN_INSTANT = frozenset({"foundation", "joints", "stops", "couplings", "sections"})  # kinds that hang on friction


class DoubtedInstants(NamedTuple):
    """Instants at which loads and accelerations are not those of the machine, and the note that says why."""

    instants: frozenset[float] = frozenset()
    note: str = ""

    @classmethod
    def of(cls, instants: Iterable[float], why: str) -> DoubtedInstants:
        """Those instants, with what the mark means."""
        return cls(frozenset(instants), f"{MARK} {why}")

    def mark(self, text: str, at: float, kind: str, unit: str) -> str:
        """The text of a number with a mark, where its instant is one of these and it hangs on it."""
        hangs = kind in OF_AN_INSTANT or unit.endswith("/s²")
        return text + MARK if at in self.instants and hangs and text not in ("0", OPEN, UNKNOWN) else text


NO_DOUBT = DoubtedInstants()
MARK = "†"


class GroupExtremes(NamedTuple):
    """A group with the extremes of its rows, and where the run ends beyond its horizon their last values."""

    group: RowGroup
    extremes: Extremes
    beyond: Array | None = None


def abridged(block: TableBlock) -> TableBlock:
    """The block without the components of vectors in its groups, where these are so many that each gets one line."""
    if len(block.groups) <= MANY:
        return block
    groups = [
        group if group.whole else group._replace(rows=tuple(row for row in group.rows if row.even or not row.vector))
        for group in block.groups
    ]
    return block._replace(groups=tuple(groups))


def extremes_table(
    block: TableBlock, times: Array, extremes: Extremes, certain: Certainty, beyond: Array | None = None,
    doubted: DoubtedInstants = NO_DOUBT,
) -> list[TextTable]:  # fmt: skip
    """First and last value, lowest and highest with their instants; one line a group where there are many.

    beyond: the last value of each row, where the run ends beyond its horizon; doubted: instants whose extremes are
    marked.
    """
    counts = np.cumsum([0, *(len(group.rows) for group in block.groups)])
    own = [slice(a, b) for a, b in pairwise(counts)]
    last = [None if beyond is None else beyond[rows] for rows in own]
    parts = [
        GroupExtremes(group, extremes.part(rows), x) for group, rows, x in zip(block.groups, own, last, strict=True)
    ]
    if len(parts) <= MANY:
        return [_full(block, parts, times, certain, doubted)]
    whole = [part for part in parts if part.group.whole]
    tables = [_full(block, whole, times, certain, doubted)] if whole else []
    single = [part for part in parts if not part.group.whole]
    heading = "" if whole else block.heading
    return [*tables, _one_line_each(block, single, times, certain, heading, doubted)]


def _full(
    block: TableBlock, parts: Sequence[GroupExtremes], times: Array, certain: Certainty, doubted: DoubtedInstants
) -> TextTable:
    """A line a row, under a title a group."""
    rows: list[tuple[str, ...] | str] = []
    notes: set[str] = set()
    span = float(np.ptp(times))
    for part in parts:
        lines, needed = _lines(part, span, certain, block.kind, doubted)
        rows += [part.group.title, *lines] if part.group.name else lines
        notes |= needed
    heads = ("first", "last", "min", "at [s]", "max", "at [s]")
    columns = (TextColumn("", "left"), TextColumn("", "left"), *(TextColumn(head) for head in heads))
    if all(isinstance(row, str) for row in rows):
        columns = (TextColumn("", "left"),)  # a title and what is open of each: no numbers to head
    below = [note for note in (*NOTES, doubted.note) if note in notes]
    return TextTable(block.heading, columns, tuple(rows), (*block.notes, *below))


def _lines(
    part: GroupExtremes, span: float, certain: Certainty, kind: str, doubted: DoubtedInstants
) -> tuple[list[tuple[str, ...] | str], set[str]]:
    """The lines of a group, and the notes they need: rows that are 0 or open throughout take no line."""
    group, extremes = part.group, part.extremes
    instants = np.stack([extremes.low_at, extremes.high_at])
    notes: set[str] = set()
    texts = _texts(part, certain)
    lines: list[tuple[str, ...] | str] = []
    is_open = [row.label for row, own in zip(group.rows, texts, strict=True) if set(own) == {OPEN}]
    seen = Counter(row.vector for row, own in zip(group.rows, texts, strict=True) if set(own) != {"0"} and not row.even)
    for i, (row, (first, last, low, high)) in enumerate(zip(group.rows, texts, strict=True)):
        if row.label in is_open:
            continue
        if {first, last, low, high} == {"0"}:
            notes.add(ZERO_NOTE)
            continue
        if row.even and row.vector and seen[row.vector] == 1:
            continue  # the magnitude of a vector along one axis says nothing new
        partly = bool(np.isnan(row.values).any())
        notes |= {PARTLY_OPEN_NOTE} if partly else set()
        notes |= {UNKNOWN_NOTE} if UNKNOWN in (first, last, low, high) else set()
        low_at, high_at = ["", ""] if low == high else write_times(instants[:, i].tolist(), span)
        unit = row.unit if row.unit != "1" else ""
        ends = low, high
        if low != high:  # else it is the same throughout
            low, high = (doubted.mark(end, float(at), kind, unit) for end, at in zip(ends, instants[:, i], strict=True))
        notes |= {doubted.note} if (low, high) != ends else set()
        lines.append((row.label + "*" * partly, unit, first, last, low, low_at, high, high_at))
    if is_open:
        notes.add(OPEN_NOTE)
        lines.append(f"{INDENT}{OPEN}: {', '.join(is_open)}")
    return lines or [f"{INDENT}0 throughout"], notes


def _texts(part: GroupExtremes, certain: Certainty) -> list[list[str]]:
    """First, last, lowest and highest value of each row."""
    rows, beyond = part.group.rows, part.beyond
    first, last = (np.array([row.values[i] for row in rows]) for i in (0, -1))
    texts = texts_of(part.group, np.stack([first, last, part.extremes.low, part.extremes.high]), certain)
    if beyond is not None:
        for row, value, own in zip(rows, beyond, texts, strict=True):
            own[1] = beyond_horizon(value, row.unit, certain, own[1])
    return texts


def _one_line_each(
    block: TableBlock, parts: Sequence[GroupExtremes], times: Array, certain: Certainty, heading: str,
    doubted: DoubtedInstants,
) -> TextTable:  # fmt: skip
    """A line a group: of each row but the components of vectors the value farthest from zero, and when."""
    span = float(np.ptp(times))
    heads: dict[str, None] = {}
    cells: list[dict[str, tuple[str, str]]] = []
    for group, extremes, _ in parts:
        lower = np.abs(extremes.low) > np.abs(extremes.high)
        farthest = np.where(lower, extremes.low, extremes.high)
        styles = family_styles(group.rows, farthest[None, :], certain)
        texts = [how.write(value) for how, value in zip(styles, farthest, strict=True)]
        instants = np.where(lower, extremes.low_at, extremes.high_at).tolist()
        clock = write_times(instants, span)
        texts = [
            doubted.mark(text, at, block.kind, row.unit)
            for text, at, row in zip(texts, instants, group.rows, strict=True)
        ]
        own = {
            f"{row.label} [{row.unit}]": (text, "" if text in ("0", OPEN, UNKNOWN) else at)
            for row, text, at in zip(group.rows, texts, clock, strict=True)
        }
        heads |= dict.fromkeys(head for head, (text, _) in own.items() if text != "0")
        cells.append(own)
    columns = [TextColumn(block.what, "left")]
    for head in heads:
        columns += [TextColumn(head), TextColumn("at [s]")]
    rows = tuple(
        (part.group.name, *(text for head in heads for text in own.get(head, ("", ""))))
        for part, own in zip(parts, cells, strict=True)
    )
    what = f"{len(parts)} {block.what or 'group'}s, a line each: the value farthest from zero"
    notes = (*block.notes, f"{what}; components: --at, or --format csv")
    shown = {text for row in rows for text in row}
    notes += tuple(note for word, note in ((OPEN, OPEN_NOTE), (UNKNOWN, UNKNOWN_NOTE)) if word in shown)
    notes += (doubted.note,) if any(text.endswith(MARK) for text in shown) else ()
    return TextTable(heading, tuple(columns), rows, notes)
