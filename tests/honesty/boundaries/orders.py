"""Orders of a cycle that cancel, and those that do not."""

from __future__ import annotations

from heuncli.commands.balance.verdicts import verdict_of
from tests.honesty.boundaries.part import Part, Row


def left(x: float) -> str:
    """Two bodies whose forces of an order, 2 N and 2 N, leave 4 x N of it."""
    return verdict_of(4.0 * x, 4.0, 10.0)


PART = Part(
    headings=("orders",),
    rows=(Row("CANCELS", left, "cancels", "remains"),),
    exempt={"ORDERS_SETTLED": "how many samples are taken: with more of them the orders are the same to their digits"},
)
