"""What a run is made of as its scene grows: counts, which hold on any machine, where times do not.

Evaluations are the kernel's own; states answered are factorisations of tree and closures. `python -m tests.bench
growth` prints the counts.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import pytest

from tests.shared.counting import Counts, counts_of
from tests.shared.growing import GROWING

# An attempt at the tolerance answers a sample for each run that is compared: the run, its check, and where rounding may
# matter a third from a start moved by it. This motion takes an attempt with two runs and one with three. The search of
# extremes begins with the samples once more.
OF_A_SAMPLE, SEARCHED = 5, 1
OF_A_STEP, REJECTED = 13, 1  # evaluations: the stages of the method, and the first of a run; steps that were too long
AT_ONCE = 1.6  # times as many extremes to be searched may a larger chain have: its motion is another one
pytestmark = pytest.mark.heavy  # the counts are those of either kernel


@cache
def counted(what: str, table: bool) -> list[Counts]:
    """The counts of the scenes that grow in one thing."""
    scene, sizes = GROWING[what]
    return [counts_of(scene(n), table=table) for n in sizes]


def added(found: list[Counts], key: str) -> list[int]:
    """By how much a count grows from scene to scene."""
    return [b[key] - a[key] for a, b in pairwise(found)]


@pytest.mark.parametrize("table", [False, True])
def test_bodies(table: bool) -> None:
    """A tree of any size is answered as often, and evaluated as often as the steps of its motion ask."""
    found = counted("bodies", table)
    assert found[-1]["answered"] <= AT_ONCE * found[0]["answered"]
    assert all(one["evaluations"] <= OF_A_STEP * (one["steps"] + REJECTED) for one in found)
    assert not any(one["looked"] for one in found)


@pytest.mark.parametrize("table", [False, True])
def test_loops(table: bool) -> None:
    """Self-stresses are looked for at as many instants however many loops there are, and the motion is as dear."""
    found = counted("loops", table)
    assert added(found, "looked") == added(found, "evaluations") == [0, 0]
    assert found[0]["looked"] > 0


def test_a_search_asks_for_each_extreme_once_or_twice() -> None:
    """The instants of a search grow with what there is to be searched, not with what of it is asked at once."""
    sizes, found, bare = GROWING["loops"][1], counted("loops", True), counted("loops", False)
    searched = [one["answered"] - other["answered"] for one, other in zip(found, bare, strict=True)]
    assert searched[0] > 0
    assert searched[-1] / searched[0] <= sizes[-1] / sizes[0]


@pytest.mark.parametrize("table", [False, True])
def test_cuts(table: bool) -> None:
    """Cuts are laid at the instants that are told; nothing else grows with them, the search between neither."""
    sizes, found = GROWING["cuts"][1], counted("cuts", table)
    assert added(found, "answered") == added(found, "evaluations") == [0, 0]
    assert added(found, "cuts") == [51 * (b - a) for a, b in pairwise(sizes)]


@pytest.mark.parametrize("table", [False, True])
def test_samples(table: bool) -> None:
    """A sample costs its answers; the steps of the integrator are as many."""
    sizes, found = GROWING["samples"][1], counted("samples", table)
    most = OF_A_SAMPLE + (SEARCHED if table else 0)
    for more, (a, b) in zip(added(found, "answered"), pairwise(sizes), strict=True):
        assert more <= most * (b - a)
    assert {one["steps"] for one in found} == {found[0]["steps"]}
