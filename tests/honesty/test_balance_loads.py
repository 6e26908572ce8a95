"""Random loads over a turn against integrals by hand, and the same shafts told otherwise (balance_loads.py)."""

from __future__ import annotations

import pytest

from tests.honesty.balance_loads import RATE, compared, drawn
from tests.shared.seeds import spared

ELSEWHERE = 1.2345  # rad: where the cycle begins


@pytest.mark.parametrize("seed", spared([0, 3], {3}))
def test_orders_means_and_wheels_are_within_what_is_told(seed: int) -> None:
    for own in compared(drawn(seed)):
        assert own.share <= 1.0, own


@pytest.mark.heavy
@pytest.mark.parametrize(
    "told", [{"rate": -RATE}, {"axis": -1}, {"begin": ELSEWHERE}], ids=["backwards", "axis reversed", "elsewhere"]
)
@pytest.mark.third
def test_a_shaft_told_otherwise_has_the_same_numbers(told: dict[str, float]) -> None:
    for own in compared(drawn(3), **told):
        assert own.share <= 1.0, own
