"""Classify each order: no body causes it, the bodies' contributions cancel, or a part of them remains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.analyses.balancing.results import OrderRow
from heuncli.base import tolerances
from heuncli.results.results import Array

Verdict = Literal["does not arise", "cancels", "remains"]
MAX_NAMED = 6
SMALLER = "smaller ones"
ENDLESS = ", weaker ones without limit"
LETTERS = ("x", "y", "z")


def classify_order(magnitude: float, body_sum: float, largest: float, threshold: float = 0.0) -> Verdict:
    """Classify an order by its magnitude and the sum of the bodies' amplitudes.

    largest: the largest such sum of any order
    threshold: smaller values are rounding
    """
    if body_sum <= max(tolerances.CANCELS * largest, threshold):
        return "does not arise"
    rounding = max(tolerances.ORDERS_SETTLED * largest, threshold)
    return "cancels" if magnitude <= max(tolerances.CANCELS * body_sum, rounding) else "remains"


def format_remaining_orders(rows: Sequence[OrderRow], *, endless: bool = False) -> str:
    """Describe the orders that remain, the largest of them, and their direction.

    endless: whether the orders have no end
    """
    remaining = [row for row in rows if row.verdict == "remains" and row.order > 0.0]
    if not remaining:
        return "none" if not any(row.verdict == "cancels" for row in rows) else "all orders cancel"
    largest = max(row.size for row in remaining)
    named = sorted(sorted(remaining, key=lambda row: -row.size)[:MAX_NAMED], key=lambda row: row.order)
    named = [row for row in named if row.size > tolerances.NAMED_ORDER * largest]
    directions = {format_direction(row) for row in named}
    common_direction = directions.pop() if len(directions) == 1 else ""
    names = [
        f"{row.order:g}" + (f" ({format_direction(row)})" if directions and format_direction(row) else "")
        for row in named
    ]
    if len(remaining) == 1:
        return f"only order {names[0]} remains{f', {common_direction}' if common_direction else ''}"
    joined_names = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
    sentence = f"order{'s' if len(names) > 1 else ''} {joined_names} remain{'' if len(names) > 1 else 's'}"
    sentence += f", {common_direction}" if common_direction else ""
    last = max(row.order for row in remaining)
    if len(remaining) == len(named):
        return sentence
    return f"{sentence}; {SMALLER} up to order {last:g}{ENDLESS if endless else ''}"


def format_direction(row: OrderRow) -> str:
    """Return the axis along which an order acts, or the direction in which it turns; empty if it has neither."""
    amplitudes: Array = row.amplitude
    if len(amplitudes) < 3:
        return ""
    along = [letter for letter, value in zip(LETTERS, amplitudes, strict=True) if value > tolerances.NO_PART * row.size]
    if len(along) == 1:
        return f"along {along[0]}"
    if row.with_turn is None or row.against_turn is None:
        return ""
    if row.against_turn <= tolerances.NO_PART * row.with_turn and row.is_across_axis:
        return "rotating with the shaft"
    return (
        "rotating against the shaft"
        if row.with_turn <= tolerances.NO_PART * row.against_turn and row.is_across_axis
        else ""
    )
