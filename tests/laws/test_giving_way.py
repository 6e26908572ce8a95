"""Giving way is the limit of a small stiffness: random redundant scenes against the same with ever softer joints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.doubles import SEEDS, redundant_scene
from tests.shared.scenes import near, solved

EPS = 1e-9  # of the other stiffnesses: the limit is met to its root at worst, for what gives way strains by its inverse


def with_stiffness(scene: dict[str, Any], seed: int, softness: tuple[float, float]) -> dict[str, Any]:
    """Random stiffnesses of all joints; some forces and moments of some are soft, by two factors in turn."""
    rng = np.random.default_rng(seed)
    joints, n = {}, 0
    for name, j in scene["joints"].items():
        k: dict[str, Any] = {}
        for part in ("force", "moment"):
            k[part] = rng.uniform(0.5, 2.0, 3)
            if rng.uniform() < 0.4:
                k[part] = np.full(3, softness[n % 2])
                n += 1
            k[part] = k[part].tolist()
        joints[name] = {**j, "stiffness": k}
    return {**scene, "joints": joints}


def loads(results: Results) -> np.ndarray[Any, Any]:
    return np.array([np.concatenate([b["force"][0], b["moment"][0]]) for b in results.joints.values()])


@pytest.mark.heavy
@pytest.mark.parametrize("seed", SEEDS[::7])
@pytest.mark.third
def test_the_limit_of_a_small_stiffness(seed: int) -> None:
    """What is told is that limit, whatever the ratio of the small ones; what is open depends on it, or may."""
    scene = redundant_scene(seed)[1]
    told = loads(solved(with_stiffness(scene, seed, (0.0, 0.0))))
    one, other = (loads(solved(with_stiffness(scene, seed, s))) for s in ((EPS, EPS), (EPS, 7 * EPS)))
    F = float(np.abs(one).max())
    certain = ~np.isnan(told)
    assert certain.any()
    near(told[certain], one[certain], F, 1e-6)
    near(told[certain], other[certain], F, 1e-6)
