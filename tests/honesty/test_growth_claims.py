"""The growth that a probe tells of random chains of bars is that of their variational equations: growth_claims.py."""

from __future__ import annotations

import pytest

from tests.honesty.growth_claims import drawn, faults, right, told


@pytest.mark.parametrize("seed", [0, 5, pytest.param(6, marks=pytest.mark.long), 15])
@pytest.mark.third
def test_the_growth_of_a_chain(seed: int) -> None:
    of = drawn(seed)
    by = right(of)
    growth, reason = told(of)
    assert by is not None and growth is not None, reason
    assert not faults(of, by, growth)
