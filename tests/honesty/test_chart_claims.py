"""The errors that a chart tells of random linear motions are those of closed forms: chart_claims.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.chart_claims import errors, is_right


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_the_errors_of_a_chain(seed: int) -> None:
    count = 0
    for name, told, right, doubt in errors(seed):
        count += 1
        assert is_right(told, right, doubt), (name, told, right)
    assert count >= 12
