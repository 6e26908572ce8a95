"""What the oracle's own tests share: scenes by seed, and closeness against a scene's size."""

from __future__ import annotations

import numpy as np

from tests.oracle.read import Placed
from tests.oracle.scenes import random_scene
from tests.oracle.solve import Solution
from tests.oracle.turns import Array

T = 0.0
SEEDS = range(12)


def some_scene(seed: int, **more: object) -> tuple[dict, dict[str, Placed]]:
    """Trees, free bodies, loops and drives, every third of each."""
    rng = np.random.default_rng(seed)
    settings = {
        "n_bodies": int(rng.integers(2, 6)),
        "free": 0.1,
        "roots": 0.2,
        "loops": seed % 3,
        "drives": seed % 2,
        "masses": ("given", "shapes")[seed // 2 % 2],
    }
    return random_scene(rng, **{**settings, **more})  # type: ignore[arg-type]


def size_of(found: Solution) -> float:
    """Largest reaction or load [N]."""
    loads = [np.linalg.norm(p.force) for parts in found.loads.values() for p in parts]
    return float(max([1.0, *loads, *(np.linalg.norm(r.force) for r in found.reactions.values())]))


def close(a: Array, b: Array, size: float = 1.0) -> None:
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-11 * max(size, float(np.abs(b).max())))
