"""Which cases run every time: of random scenes, of costly families; and which the plain kernel is spared."""

from __future__ import annotations

import re
import zlib
from collections import defaultdict
from collections.abc import Container, Hashable, Iterable
from itertools import pairwise
from typing import Any

import pytest


def spared(seeds: Iterable[Any], quick: Container[Any]) -> list[Any]:
    """The seeds, all but the quick ones marked heavy: a plain run of theirs takes more than a second or two."""
    return [seed if seed in quick else pytest.param(seed, marks=pytest.mark.heavy) for seed in seeds]


SHARE = 4  # one seed of so many runs every time
# At least so many of a family, which chooses what it draws by the seed's remainder, by 13 at most; of one that is run
# in several ways at least so many in each.
LEAST, LEAST_OF_A_WAY = 13, 6


SHARES = {"third": 3, "sixth": 6}  # of a family marked so, one case of so many runs every time


def list_long_cases(items: Iterable[pytest.Item]) -> set[pytest.Item]:
    """The cases that only a long run takes: tests marked long, most seeds, most cases of a costly family."""
    marked = {item for item in items if item.get_closest_marker("long")}
    long = list_long_seeds(items)
    families: defaultdict[tuple[str, int], list[pytest.Item]] = defaultdict(list)
    for item in items:
        share = next((share for mark, share in SHARES.items() if item.get_closest_marker(mark)), None)
        if item not in long and share is not None:
            families[item.nodeid.split("[")[0], share].append(item)
    for (family, share), cases in families.items():
        # Another third for each file, so that a scene is met in one; families of one file share what they solve.
        first = zlib.crc32(family.partition("::")[0].encode())
        for start in range(0, len(cases), share):
            neighbours = cases[start : start + share]
            long.update(neighbours)
            # Of seeds those with every remainder, which chooses what is drawn.
            place = (first + (start // share if has_seed(cases[0]) else 0)) % share
            if start == 0 or place < len(neighbours):  # in place of a case marked long one of its neighbours
                turned = neighbours[place:] + neighbours[:place]
                long -= set([case for case in turned if case not in marked][:1])
    return long | marked


def has_seed(item: pytest.Item) -> bool:
    """Whether a case is one of a row of seeds."""
    return (
        isinstance(item, pytest.Function)
        and hasattr(item, "callspec")
        and split_seed(item.callspec.params)[0] is not None
    )


def list_long_seeds(items: Iterable[pytest.Item]) -> set[pytest.Item]:
    """Of each row of consecutive seeds all but the first.

    They are cases with a parameter called `seed`, or called `name` with a seed behind a word: `tree 17`. A seed that
    stands alone was chosen for what it showed, and stays.
    """
    families: defaultdict[str, defaultdict[Hashable, dict[int, list[pytest.Item]]]]
    families = defaultdict(lambda: defaultdict(dict))
    for item in items:
        if isinstance(item, pytest.Function) and hasattr(item, "callspec"):
            seed, way = split_seed(item.callspec.params)
            if seed is not None:
                families[item.nodeid.split("[")[0]][way].setdefault(seed, []).append(item)
    found: set[pytest.Item] = set()
    for ways in families.values():
        least = LEAST if len(ways) == 1 else LEAST_OF_A_WAY
        for cases in ways.values():
            daily = set(list_daily_seeds(cases, least))
            found.update(item for seed, own in cases.items() if seed not in daily for item in own)
    return found


def split_seed(parameters: dict[str, Any]) -> tuple[int | None, Hashable]:
    """The seed among a test's parameters, and the others."""
    seed: int | None = None
    way: list[Hashable] = []
    for name, value in parameters.items():
        if name == "seed" and isinstance(value, int):
            seed = value
        elif name == "name" and isinstance(value, str) and (parts := re.fullmatch(r"([a-z ]+) (\d+)", value)):
            seed = int(parts[2])
            way.append(parts[1])
        else:
            way.append(value if isinstance(value, str | float) else id(value))
    return seed, tuple(way)


def list_daily_seeds(seeds: Iterable[int], least: int = LEAST) -> list[int]:
    """Those of the seeds that run every time."""
    ordered = sorted(seeds)
    step = min((after - before for before, after in pairwise(ordered)), default=1)
    rows: list[list[int]] = []
    for seed in ordered:
        if rows and seed - rows[-1][-1] == step:
            rows[-1].append(seed)
        else:
            rows.append([seed])
    return [seed for row in rows for seed in row[: max(least, -(-len(row) // SHARE))]]
