"""State spaces that move, by differences of solved states: state_space_slopes.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.state_space_slopes import judged


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.third
def test_matrices_are_slopes(seed: int) -> None:
    """A, B, C and D along random directions of states and inputs."""
    found, _ = judged(seed)
    assert found.what == "same", found
