"""Format a change in words and numbers."""

from __future__ import annotations

import math

from heuncli.output.documents.document import append_unit
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.golden_file import Value


def format_value(value: Value | str | None, unit: str) -> str:
    """Format a value to nine digits with its unit; a word stays as it is."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return append_unit(f"{value:.9g}", unit)


def format_difference(change: Change) -> str:
    """Format the difference, and its percentage of the old value."""
    difference = change.difference
    if difference is None or not difference:
        return ""
    return f"{append_unit(f'{difference:+.3g}', change.unit)} ({format_percent(change)})"


def format_percent(change: Change) -> str:
    """Format the change relative to the old value in percent; a change from zero in words."""
    old, difference = change.old, change.difference
    if difference is None or isinstance(old, str) or not old or not math.isfinite(difference / old):
        return "from 0" if difference is not None else ""
    percent = 100.0 * difference / abs(old)
    return f"{percent:+.3g} %"


def describe_failure(change: Change) -> str:
    """Return the sentence that says what is wrong."""
    if change.reason:
        return change.reason
    more = f"; {change.n_similar} more values changed" if change.n_similar else ""
    return f"changed by {format_difference(change)}, allowed {change.tolerance or 0.0:.3g}{more}"
