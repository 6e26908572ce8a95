"""A change in words and numbers."""

from __future__ import annotations

import math

from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.kept import Value


def number_text(value: Value | str | None, unit: str) -> str:
    """A value to nine digits with its unit, or the word that stands for it."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return f"{value:.9g} {unit}".rstrip() if unit != "1" else f"{value:.9g}"


def difference_text(change: Change) -> str:
    """By how much it changed, and of the larger of the two."""
    difference = change.difference
    if difference is None or not difference:
        return ""
    return f"{difference:+.3g} {change.unit if change.unit != '1' else ''}".rstrip() + f" ({percent(change)})"


def percent(change: Change) -> str:
    """The change relative to what it was, in percent; of nothing, or where the sign turned, in words."""
    old, difference = change.old, change.difference
    if difference is None or isinstance(old, str) or not old or not math.isfinite(difference / old):
        return "from 0" if difference is not None else ""
    share = 100.0 * difference / abs(old)
    return f"{share:+.3g} %"


def why(change: Change) -> str:
    """The sentence that says what is wrong."""
    if change.why:
        return change.why
    more = f"; {change.alike} more of its values" if change.alike else ""
    return f"changed by {difference_text(change)}, allowed {change.allowed or 0.0:.3g}{more}"
