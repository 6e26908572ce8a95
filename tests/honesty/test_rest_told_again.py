"""Rest poses of random scenes told otherwise are the same, and told the same: rest_told_again.py beside it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.honesty.rest_told_again import RIGHT, TELLINGS, agree, answer, judged
from tests.shared.rest_scenes import KINDS
from tests.shared.rest_told_again import resting

EACH = 2
WAYS = list(TELLINGS)
SLOW = ("ropes", 1)  # 5 s
CASES = [
    pytest.param(kind, seed, marks=pytest.mark.long) if (kind, seed) == SLOW else (kind, seed)
    for kind in KINDS
    for seed in range(EACH)
]


@pytest.mark.heavy
@pytest.mark.parametrize(("kind", "seed"), CASES)
@pytest.mark.third
def test_it_rests_as_told_before(kind: str, seed: int) -> None:
    """Pose, verdicts and loads within what both tellings state; refused where the first is."""
    way = WAYS[(seed + EACH * list(KINDS).index(kind)) % len(WAYS)]
    found, _ = judged(kind, seed, way)
    assert found.what in RIGHT, (way, found)


@pytest.mark.parametrize("way", ["turned", "mm, t, ms", "sawn"])
@pytest.mark.third
def test_another_scene_is_told_from_it(way: str) -> None:
    """A billionth of the weights is seen."""
    tree = resting("plane", 0)
    first = answer(tree)
    told = TELLINGS[way](tree, np.random.default_rng(0), first)  # type: ignore[arg-type]
    heavier = {**told.tree, "gravity": [(1.0 + 1e-9) * g for g in told.tree["gravity"]]}
    second = answer(heavier)
    assert not isinstance(first, str)
    assert not isinstance(second, str)
    assert agree(first, second, told).what == "farther than stated"
