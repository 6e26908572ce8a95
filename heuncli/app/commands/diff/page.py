"""The document of a difference: its table, its JSON, and its lines for a GitHub workflow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputDocument, OutputTable, Part, Sentence, make_text_columns
from heuncli.output.snapshots.change import Change, format_difference, format_value
from heuncli.output.snapshots.changes import EXTRA, MISSING, THROUGHOUT
from heuncli.output.snapshots.outcomes import Annotation, iter_lines
from heuncli.output.tables.nouns import format_count

HEADS = ("quantity", "at", "before", "after", "change", "allowed")
WORDS = {  # word of a change in JSON -> its text in tables
    EXTRA: "only in the second", MISSING: "only in the first", THROUGHOUT: "all times", "verdict": "status",
    "certain": "determinate",
}  # fmt: skip
MAX_ROWS = 200  # of a table; JSON holds all


class CaseChange(NamedTuple):
    """A change, and the load case of its run; empty for the scene as it is."""

    case: str
    change: Change


class Difference(NamedTuple):
    """The difference of two files.

    old_path, new_path: their paths
    changes: in the order in which they are shown
    compared_count: how many numbers were compared
    notes: remarks for the user
    """

    old_path: str
    new_path: str
    changes: Sequence[CaseChange]
    compared_count: int
    notes: Sequence[str] = ()


def sort_changes(changes: Sequence[CaseChange]) -> list[CaseChange]:
    """Sort changes: verdicts and counts first, then numbers by their change relative to the larger of the two."""
    return sorted(changes, key=lambda one: (-one.change.relative, one.case, one.change.path, one.change.what))


def make_document(difference: Difference, form: str) -> OutputDocument:
    """Make the document of a difference: a page that ends with its summary, or a comment in Markdown that begins with
    it.
    """
    notes = list(map(Sentence, difference.notes))
    table = _make_table(difference)
    if form == "markdown":
        paths = Sentence(f"{difference.old_path} → {difference.new_path}")
        return OutputDocument(f"heun diff: {format_summary(difference)}", parts=[paths, table, *notes], level=3)
    omitted = len(difference.changes) - MAX_ROWS
    more = [Sentence(f"{omitted} more: --format json")] if omitted > 0 else []
    parts: list[Part] = [table, *more, Sentence(format_summary(difference)), *notes]
    return OutputDocument(parts=parts, make_block=lambda: _make_difference_block(difference))


def _make_table(difference: Difference) -> OutputTable:
    """Make the table of the first changes."""
    rows = [_make_row(case, change) for case, change in difference.changes[:MAX_ROWS]]
    return OutputTable("CHANGED", make_text_columns(HEADS), rows)


def _make_row(case: str, change: Change) -> tuple[str, ...]:
    """Make the row of a change: both values, the difference, and how large it may be."""
    name = f"{case}: {change.path}" if case else change.path
    change_text = WORDS.get(change.reason, change.reason) or format_difference(change)
    change_text += f"; and {change.n_similar} more values" if change.n_similar else ""
    allowed = f"{change.tolerance:.2g}" if change.tolerance and not change.reason else ""
    values = (WORDS.get(text, text) for text in (format_value(x, change.unit) for x in (change.old, change.new)))
    at = "" if change.what in (EXTRA, MISSING) else WORDS.get(change.what, change.what)
    return (name, at, *values, change_text, allowed)


def format_summary(difference: Difference) -> str:
    """Format how many quantities changed, and how many were compared."""
    if not difference.changes:
        return f"no change exceeds both stated errors: {format_count(difference.compared_count, 'quantity')} compared"
    return (
        f"{format_count(len(difference.changes), 'change')}, "
        f"{format_count(difference.compared_count, 'quantity')} compared"
    )


def _make_difference_block(difference: Difference) -> dict[str, Any]:
    """Return every change as the JSON has it."""
    changed = [_make_block(case, change) for case, change in difference.changes]
    return {
        "before": difference.old_path,
        "after": difference.new_path,
        "compared": difference.compared_count,
        "notes": list(difference.notes),
        "changes": changed,
    }


def _make_block(case: str, change: Change) -> dict[str, Any]:
    """Return a change as the JSON has it."""
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
    """Format the values and the change of a row on two lines, for an annotation."""
    values = f"{row[2]} → {row[3]}" if row[2] or row[3] else ""
    return "\n".join(part for part in (values, row[4]) if part)
