"""Random closed chains, solved once for all tests: every kind in the tree, every kind as closure, drives in some.

Where a closure holds what the tree holds already, some reactions are open: the oracle says which.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from tests.oracle.read import Placed
from tests.oracle.scenes import ALL_KINDS, random_scene
from tests.shared.trees import ABOUT, Case, case

SEEDS = range(40)
SOME = range(12)
DRIVEN = range(1000, 1024)
QUICK = frozenset({1, 2, 3, 4, 8, 10, 12, 13, 16, 18, 24, 27, 28, 1000, 1003, 1004, 1005, 1008, 1009, 1011, 1012, 1016})
LOOSE = ("ball", "line", "plane", "rod")  # closures that seldom hold anything twice


def loop_scene(seed: int, **more: Any) -> tuple[dict[str, Any], dict[str, Placed]]:
    """2 to 5 bodies, 1 to 3 loops; from seed 1000 on with one or two drives. `more` as random_scene takes it."""
    rng = np.random.default_rng(seed)
    settings: dict[str, Any] = {
        "n_bodies": int(rng.integers(2, 6)), "loops": 1 + seed % 3, "roots": 0.2,
        "loop_kinds": LOOSE if seed % 2 else ALL_KINDS, "drives": 1 + seed // 2 % 2 if seed >= 1000 else 0,
        "masses": "shapes" if seed // 2 % 2 else "given",
    }  # fmt: skip
    return random_scene(rng, **{**settings, **more})


@cache
def loop(seed: int) -> Case:
    """A random closed chain's run, with the oracle's answer at every instant."""
    scene, _ = loop_scene(seed)
    return case({**scene, "foundation": {"about": ABOUT.tolist()}})
