"""Random closed chains against the independent solution on absolute coordinates, to 1e-9 of the scene's scale."""

from __future__ import annotations

import pytest

from tests.shared import checks
from tests.shared.loops import DRIVEN, QUICK, SEEDS, loop
from tests.shared.seeds import spared

ALL = spared([*SEEDS, *DRIVEN], QUICK)


@pytest.mark.parametrize("seed", ALL)
@pytest.mark.third
def test_accelerations(seed: int) -> None:
    checks.same_accelerations(loop(seed))


@pytest.mark.parametrize("seed", ALL)
@pytest.mark.third
def test_reactions_and_what_is_open(seed: int) -> None:
    checks.same_reactions(loop(seed))


@pytest.mark.parametrize("seed", ALL)
@pytest.mark.third
def test_parts_of_a_reaction(seed: int) -> None:
    checks.same_parts(loop(seed))


@pytest.mark.parametrize("seed", ALL)
def test_foundation(seed: int) -> None:
    checks.same_foundation(loop(seed))


@pytest.mark.parametrize("seed", ALL)
def test_coordinates(seed: int) -> None:
    checks.same_coordinates(loop(seed))


@pytest.mark.parametrize("seed", ALL)
def test_free_directions_carry_nothing(seed: int) -> None:
    checks.free_directions_carry_nothing(loop(seed))


@pytest.mark.parametrize("seed", ALL)
def test_the_run_vouches_for_itself(seed: int) -> None:
    c = loop(seed)
    found = c.study.results.accuracy
    assert found["constraint_gap"] <= 1e-13 * c.length
    assert found["balance_residual"] <= 1e-10
    assert found["energy_drift"] <= 1e-8
    assert found["horizon"] is None
