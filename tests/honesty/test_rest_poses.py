"""Rest poses of random scenes are those that the damped motion from their start comes to: rest_poses.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.rest_poses import WRONG, flown, judged
from tests.shared.rest_scenes import KINDS, drawn

QUICK = 1e-8  # of the flow: which pose it comes to; the pose itself is exact
# two ropes, or limits of a rod, that hold where they stand far open at the start: their rows were left out
FAR_OPEN = [("ropes", 21), ("stops", 1143), ("stops", 1265), ("stops", 1670)]
# spins that nothing holds beside friction that makes motions creep: their eigenvalues were taken for one
CREEPING = [("friction", 100309), ("friction", 100583)]
# what a stop carries in a turning frame leaves rounding, of which no load makes anything beside the stop
CARRIED = [("drives", 100229)]
# a rope that stands nearly along the bar that it holds: what closing leaves open moves the bar by far more
NEARLY_DEAD = [("ropes", 100034)]
# two ropes that hold one bar between them: which of the two bears turns about on the way
TURN_ABOUT = [("ropes", 100467)]
# two searches that err alike by accident along what nothing holds: 1.50e-6 m and 1.48e-6 m
ALIKE = [("ropes", 500883)]
SPECIAL = [*FAR_OPEN, *CREEPING, *CARRIED, *NEARLY_DEAD, *TURN_ABOUT, *ALIKE]


@pytest.mark.heavy
@pytest.mark.parametrize(("kind", "seed"), SPECIAL)
@pytest.mark.sixth
def test_the_damped_motion_comes_to_what_was_once_missed(kind: str, seed: int) -> None:
    require_rest_of_the_motion(kind, seed)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.sixth
def test_the_damped_motion_comes_to_it(kind: str, seed: int) -> None:
    require_rest_of_the_motion(kind, seed)


def require_rest_of_the_motion(kind: str, seed: int) -> None:
    """The same pose within what is stated of it, stable where that says so; no rest where it comes to none."""
    scene = drawn(kind, seed)
    found = judged(scene, flown(scene, QUICK))
    assert found.what not in WRONG, found
