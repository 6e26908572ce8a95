"""What changed, as text: a table, JSON, markdown, lines for a GitHub workflow; the largest change of all first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.change_words import difference_text, number_text
from heuncli.output.tables.export import dump
from heuncli.output.tables.markdown_text import escape_line
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import TextColumn, TextTable, markdown, plain
from heuncli.output.tables.workflow_lines import Annotation, lines

HEADS = ("of", "at", "before", "after", "change", "allowed")
MOST_ROWS = 200  # of a table; JSON holds all


class Difference(NamedTuple):
    """Two paths, the changes with their load cases, how many numbers were compared, and what is to be said of it."""

    before: str
    after: str
    changes: Sequence[tuple[str, Change]]
    compared: int
    notes: Sequence[str] = ()


def ordered(changes: Sequence[tuple[str, Change]]) -> list[tuple[str, Change]]:
    """Verdicts and counts first, then by how much a number changed of the larger of the two."""
    return sorted(changes, key=lambda pair: (-pair[1].relative, pair[0], pair[1].path, pair[1].what))


def table(told: Difference) -> str:
    """The changes as a table, and a line that sums it up."""
    made = _table(told)
    return (plain(made) + "\n" if made.rows else "") + "".join(f"{line}\n" for line in _ends(told))


def in_markdown(told: Difference) -> str:
    """The same for a comment or a summary."""
    made = _table(told)
    paths = escape_line(f"{told.before} → {told.after}")
    head = f"### heun diff: {summary(told)}\n\n{paths}\n"
    notes = "".join(f"\n{escape_line(note)}\n" for note in told.notes)
    return head + ("\n" + markdown(made) if made.rows else "") + notes


def _table(told: Difference) -> TextTable:
    rows = [_row(case, change) for case, change in told.changes[:MOST_ROWS]]
    return TextTable("CHANGED", tuple(TextColumn(head, "left") for head in HEADS), tuple(rows))


def _row(case: str, change: Change) -> tuple[str, ...]:
    of = f"{case}: {change.path}" if case else change.path
    by = change.why or difference_text(change)
    by += f"; {change.alike} more of its values" if change.alike else ""
    allowed = f"{change.allowed:.2g}" if change.allowed and not change.why else ""
    values = (number_text(value, change.unit) for value in (change.old, change.new))
    return tuple(map(shown, (of, change.what, *values, by, allowed)))


def _ends(told: Difference) -> list[str]:
    more = len(told.changes) - MOST_ROWS
    return [*([f"{more} more: --format json"] if more > 0 else []), summary(told), *told.notes]


def summary(told: Difference) -> str:
    """How much changed of how much."""
    if not told.changes:
        return f"nothing changed by more than both state: {count(told.compared, 'quantity')} compared"
    return f"{count(len(told.changes), 'change')}, {count(told.compared, 'quantity')} compared"


def in_json(told: Difference) -> str:
    """Every change."""
    changed = [_block(case, change) for case, change in told.changes]
    block: Mapping[str, Any] = {"before": told.before, "after": told.after, "compared": told.compared}
    return dump({**block, "notes": list(told.notes), "changes": changed})


def _block(case: str, change: Change) -> dict[str, Any]:
    relative = change.relative if change.difference is not None else None
    return {
        **({"case": case} if case else {}), "of": change.path, "at": change.what, "unit": change.unit,
        "before": change.old, "after": change.new, "difference": change.difference, "relative": relative,
        "allowed": change.allowed, "why": change.why, "alike": change.alike,
    }  # fmt: skip


def for_github(told: Difference) -> str:
    """A line for each change, and the sum of it all."""
    made = (
        Annotation("warning", f"heun: {' '.join(row[:2]).strip()}", _sentence(row), told.after)
        for row in (_row(case, change) for case, change in told.changes)
    )
    return "".join(lines(made)) + summary(told) + "\n"


def _sentence(row: Sequence[str]) -> str:
    values = f"{row[2]} → {row[3]}" if row[2] or row[3] else ""
    return "\n".join(part for part in (values, row[4]) if part)


FORMS = {"table": table, "json": in_json, "markdown": in_markdown, "github": for_github}
