"""Render the changes as text: a table, JSON, markdown, lines for a GitHub workflow; the largest change first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.change_words import format_difference, format_value
from heuncli.output.snapshots.changes import EXTRA, MISSING, THROUGHOUT
from heuncli.output.tables.export import dump_json
from heuncli.output.tables.markdown_text import escape_line
from heuncli.output.tables.plurals import format_count
from heuncli.output.tables.text_table import TextColumn, TextTable, format_markdown, format_plain
from heuncli.output.tables.workflow_lines import Annotation, iter_lines

HEADS = ("quantity", "at", "before", "after", "change", "allowed")
WORDS = {  # word of a change in JSON -> its text in tables
    EXTRA: "only in the second", MISSING: "only in the first", THROUGHOUT: "all times", "verdict": "status",
    "certain": "determinate",
}  # fmt: skip
MAX_ROWS = 200  # of a table; JSON holds all


class Difference(NamedTuple):
    """The difference of two files.

    old_path, new_path: their paths
    changes: each with its load case
    compared_count: how many numbers were compared
    notes: remarks for the user
    """

    old_path: str
    new_path: str
    changes: Sequence[tuple[str, Change]]
    compared_count: int
    notes: Sequence[str] = ()


def sort_changes(changes: Sequence[tuple[str, Change]]) -> list[tuple[str, Change]]:
    """Sort changes: verdicts and counts first, then numbers by their change relative to the larger of the two."""
    return sorted(changes, key=lambda pair: (-pair[1].relative, pair[0], pair[1].path, pair[1].what))


def render_table(difference: Difference) -> str:
    """Render the changes as a table, and a summary line."""
    changes = _make_table(difference)
    return (format_plain(changes) + "\n" if changes.rows else "") + "".join(
        f"{line}\n" for line in _format_notes(difference)
    )


def render_markdown(difference: Difference) -> str:
    """Render the same as markdown, for a comment or a summary."""
    changes = _make_table(difference)
    paths = escape_line(f"{difference.old_path} → {difference.new_path}")
    head = f"### heun diff: {format_summary(difference)}\n\n{paths}\n"
    notes = "".join(f"\n{escape_line(note)}\n" for note in difference.notes)
    return head + ("\n" + format_markdown(changes) if changes.rows else "") + notes


def _make_table(difference: Difference) -> TextTable:
    rows = [_make_row(case, change) for case, change in difference.changes[:MAX_ROWS]]
    return TextTable("CHANGED", tuple(TextColumn(head, "left") for head in HEADS), tuple(rows))


def _make_row(case: str, change: Change) -> tuple[str, ...]:
    name = f"{case}: {change.path}" if case else change.path
    change_text = WORDS.get(change.reason, change.reason) or format_difference(change)
    change_text += f"; and {change.n_similar} more of its values" if change.n_similar else ""
    allowed = f"{change.tolerance:.2g}" if change.tolerance and not change.reason else ""
    values = (WORDS.get(text, text) for text in (format_value(x, change.unit) for x in (change.old, change.new)))
    at = "" if change.what in (EXTRA, MISSING) else WORDS.get(change.what, change.what)
    return tuple(map(escape, (name, at, *values, change_text, allowed)))


def _format_notes(difference: Difference) -> list[str]:
    omitted = len(difference.changes) - MAX_ROWS
    return [*([f"{omitted} more: --format json"] if omitted > 0 else []), format_summary(difference), *difference.notes]


def format_summary(difference: Difference) -> str:
    """Format how many quantities changed, and how many were compared."""
    if not difference.changes:
        return f"no change exceeds both stated errors: {format_count(difference.compared_count, 'quantity')} compared"
    return (
        f"{format_count(len(difference.changes), 'change')}, "
        f"{format_count(difference.compared_count, 'quantity')} compared"
    )


def render_json(difference: Difference) -> str:
    """Render every change as JSON."""
    changed = [_make_block(case, change) for case, change in difference.changes]
    block: Mapping[str, Any] = {
        "before": difference.old_path,
        "after": difference.new_path,
        "compared": difference.compared_count,
    }
    return dump_json({**block, "notes": list(difference.notes), "changes": changed})


def _make_block(case: str, change: Change) -> dict[str, Any]:
    relative = change.relative if change.difference is not None else None
    return {
        **({"case": case} if case else {}), "of": change.path, "at": change.what, "unit": change.unit,
        "before": change.old, "after": change.new, "difference": change.difference, "relative": relative,
        "allowed": change.tolerance, "why": change.reason, "alike": change.n_similar,
    }  # fmt: skip


def render_github(difference: Difference) -> str:
    """Render one workflow line per change, and the summary."""
    annotations = (
        Annotation("warning", f"heun: {' '.join(row[:2]).strip()}", _format_change(row), difference.new_path)
        for row in (_make_row(case, change) for case, change in difference.changes)
    )
    return "".join(iter_lines(annotations)) + format_summary(difference) + "\n"


def _format_change(row: Sequence[str]) -> str:
    values = f"{row[2]} → {row[3]}" if row[2] or row[3] else ""
    return "\n".join(part for part in (values, row[4]) if part)


FORMS = {"table": render_table, "json": render_json, "markdown": render_markdown, "github": render_github}
