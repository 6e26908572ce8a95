"""Open verdicts and certain sums at special poses: special_poses.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.special_poses import judged


# Hardly two of a kind: they are numbers, not seeds. The one alone takes as long as the others together.
@pytest.mark.heavy
@pytest.mark.parametrize("number", [pytest.param(n, marks=pytest.mark.long) if n == 20 else n for n in range(32)])
@pytest.mark.third
def test_open_where_the_equations_of_the_instant_leave_it_open(number: int) -> None:
    assert judged(number).startswith(("same", "refused"))
