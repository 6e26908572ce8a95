"""Loads shared by elasticity are those of least energy, in any units and axes: splits.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.splits import SAME, differences


@pytest.mark.parametrize("seed", range(2000, 2040))
@pytest.mark.third
def test_a_split_by_stiffness(seed: int) -> None:
    for against, off in differences(seed).items():
        assert off <= SAME, against
