"""Laws with breaks, each written in several ways. The family is breaks_told_again.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.breaks_told_again import judged


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(5))
def test_every_way_to_write_it_breaks_where_the_law_does(seed: int) -> None:
    assert [(form, what) for form, what, _ in judged(seed) if what != "right"] == []
