"""Modes of carriers with coupled spinning rotors, by matrices of the test's own: carried_spins.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.carried_spins import drawn, judged, tellings


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_coupled_spins_turn_the_carrier(seed: int) -> None:
    """Frequencies, damping and the verdict "steady" are those of the same motion, whichever shaft has the rate."""
    one = drawn(seed)
    for given, driven, kind in tellings(one, seed):
        found = judged(one, given, driven, kind)
        assert found.what == "right", (one.carrier, one.coupling, given, driven, kind, found)
