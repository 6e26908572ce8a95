"""Random rows and bodies that are struck in sequence, against event-driven codes: impact_sequences.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.impact_sequences import KINDS, RIGHT, event_driven, row, start_of
from tests.shared.seeds import spared

CASES = [*(f"rows {seed}" for seed in range(20)), *(f"bodies {seed}" for seed in range(8))]


@pytest.mark.parametrize("case", spared(CASES, CASES[1:3] + CASES[-2:]))
@pytest.mark.third
def test_it_ends_as_the_reference(case: str) -> None:
    """Jumps, impulses, energy, what is said."""
    kind, seed = case.split()[0], int(case.split()[1])
    verdict, _ = KINDS[kind](seed)
    assert verdict.what in RIGHT, (verdict.what, verdict.ratio, verdict.more)


def test_the_order_of_names_and_of_gaps_matters_as_it_should() -> None:
    """The reference tells sequences apart: with gaps that shrink along the row some rows end otherwise."""
    differ = 0
    for seed in range(40):
        own = row(seed)
        n = len(own.contacts)
        equal, falling = (
            event_driven(own.masses_met, start_of(own), own.contacts, gaps)
            for gaps in ([1.0] * n, [2.0**-k for k in range(n)])
        )
        differ += max(abs(a - b) for a, b in zip(equal.v, falling.v, strict=True)) > 1e-6
    assert differ > 5
