"""What becomes of each order: whether no body makes it, the bodies' own cancel, or how much of them remains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.analyses.balancing.results import OrderRow
from heuncli.base import tolerances
from heuncli.results.results import Array

Verdict = Literal["does not arise", "cancels", "remains"]
ALONE = 1e-9  # of the larger of two parts: the smaller is none
FAINT = 1e-3  # of the largest order: smaller ones are summed up in words
MOST_NAMED = 6
SMALLER = "smaller ones"
ENDLESS = ", fainter ones without end"
LETTERS = ("x", "y", "z")


def verdict_of(left: float, own: float, largest: float, least: float = 0.0) -> Verdict:
    """What is left of an order whose bodies make `own` between them; largest: that any order's bodies make.

    least: what is below is rounding of what moves.
    """
    if own <= max(tolerances.CANCELS * largest, least):
        return "does not arise"
    rounding = max(tolerances.ORDERS_SETTLED * largest, least)
    return "cancels" if left <= max(tolerances.CANCELS * own, rounding) else "remains"


def in_words(rows: Sequence[OrderRow], *, endless: bool = False) -> str:
    """The orders that remain, the largest of them, and along what; endless: whether there is no last one."""
    left = [row for row in rows if row.verdict == "remains" and row.order > 0.0]
    if not left:
        return "none" if not any(row.verdict == "cancels" for row in rows) else "all orders cancel"
    largest = max(row.size for row in left)
    told = sorted(sorted(left, key=lambda row: -row.size)[:MOST_NAMED], key=lambda row: row.order)
    told = [row for row in told if row.size > FAINT * largest]
    ways = {direction(row) for row in told}
    way = ways.pop() if len(ways) == 1 else ""
    names = [f"{row.order:g}" + (f" ({direction(row)})" if ways and direction(row) else "") for row in told]
    if len(left) == 1:
        return f"order {names[0]} alone remains{f', {way}' if way else ''}"
    words = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
    begins = f"order{'s' if len(names) > 1 else ''} {words} remain{'' if len(names) > 1 else 's'}"
    begins += f", {way}" if way else ""
    last = max(row.order for row in left)
    if len(left) == len(told):
        return begins
    return f"{begins}; {SMALLER} up to {last:g}{ENDLESS if endless else ''}"


def direction(row: OrderRow) -> str:
    """Along which axis an order acts, or which way it turns; nothing where it is neither."""
    parts: Array = row.amplitude
    if len(parts) < 3:
        return ""
    along = [letter for letter, value in zip(LETTERS, parts, strict=True) if value > ALONE * row.size]
    if len(along) == 1:
        return f"along {along[0]}"
    if row.with_turn is None or row.against is None:
        return ""
    if row.against <= ALONE * row.with_turn and row.across:
        return "with the turn"
    return "against the turn" if row.with_turn <= ALONE * row.against and row.across else ""
