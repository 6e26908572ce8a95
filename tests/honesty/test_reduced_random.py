"""The smallest model gives what the full one gives, in random scenes of each kind of which less than all may move."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from heuncli.scene.file_format.load import load
from tests.oracle.scenes import SPREAD
from tests.oracle.values import to_yaml
from tests.shared.doubles import redundant_scene
from tests.shared.loops import loop_scene
from tests.shared.moving_in_a_plane import PLANAR, flat_scene
from tests.shared.reduced import Pair, pair, same
from tests.shared.reducible import carried, driven, round_scene, welded
from tests.shared.scenes import moving
from tests.shared.trees import tree_scene

pytestmark = pytest.mark.heavy  # families at random: with the compiled kernel, which has the same bits

TIMES = (0.0, 0.1, 0.3)


def declared(seed: int) -> dict[str, Any]:
    """A scene declared planar."""
    return {**flat_scene(seed, "mirror", "world", PLANAR), "space": "planar"}


# scenes by seed, which seeds, and of how many at least less than all is solved, or nothing is integrated
FAMILIES: dict[str, tuple[Callable[[int], dict[str, Any]], range, int]] = {
    "flat": (flat_scene, range(40, 52), 8),
    "planar": (declared, range(60, 68), 8),
    "welded": (welded, range(40, 50), 6),
    "round": (round_scene, range(8, 17), 3),
    "carried": (carried, range(20, 28), 6),
    "driven": (driven, range(8, 18), 10),
    "trees": (lambda seed: tree_scene(seed)[0], range(60, 66), 0),
    "loops": (lambda seed: loop_scene(seed)[0], range(60, 66), 0),
    "flat, spread loads": (lambda seed: flat_scene(seed, loads=SPREAD), range(20, 30), 5),
    "welded, spread loads": (lambda seed: welded(seed, SPREAD), range(20, 26), 3),
    "carried, spread loads": (lambda seed: carried(seed, SPREAD), range(40, 44), 2),
    "driven, spread loads": (lambda seed: driven(seed, SPREAD), range(8, 14), 5),
    "redundant": (lambda seed: redundant_scene(seed)[1], range(2000, 2006), 0),
}


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.sixth
def test_random(family: str) -> None:
    make, seeds, least = FAMILIES[family]
    fewer = 0
    for seed in seeds:
        both = pair(load(f"{family} {seed}", to_yaml(moving(make(seed), TIMES, 1e-11))))
        same(both)
        fewer += is_less(both)
    assert fewer >= least


def is_less(both: Pair) -> bool:
    """Whether less was solved than there is."""
    return bool(both.told) or both.small.results.model["method"] != both.full.results.model["method"]
