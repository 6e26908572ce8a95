"""Open verdicts and certain sums at special poses: special_poses.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.special_poses import judged


@pytest.mark.heavy
@pytest.mark.parametrize("number", range(32))  # hardly two of a kind: all, not only those of every day
@pytest.mark.third
def test_open_where_the_equations_of_the_instant_leave_it_open(number: int) -> None:
    assert judged(number).startswith(("same", "refused"))
