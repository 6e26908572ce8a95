"""Random trees of pins, slides and balls in motion, between stops and on ropes that catch."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from tests.oracle.read import model, placed
from tests.oracle.rows import coordinates
from tests.shared.trees import tree_scene

STOPPED = {"pin": "angle", "slide": "travel"}


@cache
def stopped_tree(seed: int) -> dict[str, Any]:
    """Most pins and slides between stops, some bodies on ropes."""
    found, state = tree_scene(seed, kinds=("pin", "slide", "pin", "slide", "ball"), n_bodies=2 + seed % 4, free=0.0,
                              loads=("force", "spring", "torque"), in_time=False)  # fmt: skip
    rng = np.random.default_rng(70_000 + seed)
    stops: dict[str, Any] = {}
    for j in model(found).joints:
        if j.kind in STOPPED and rng.random() < 0.8:
            q = coordinates(j, state)[STOPPED[j.kind]]
            low, high = q - rng.uniform(0.05, 0.4), q + rng.uniform(0.05, 0.4)
            limits = [(low, high), (low, None), (None, high)][int(rng.integers(3))]
            e = float(rng.choice([0.0, 0.3, 0.6, 1.0]))
            stops[f"stop_{j.name}"] = {"joint": j.name, STOPPED[j.kind]: list(limits), "restitution": e}
    joints = dict(found["joints"])
    for k in range(seed % 3):
        a, b = (str(x) for x in rng.permutation([*found["bodies"], "ground"])[:2])
        p, q = rng.uniform(-1, 1, (2, 3))
        length = float(np.linalg.norm(placed(state, a).point(p) - placed(state, b).point(q)) * rng.uniform(1.02, 1.3))
        ends = {"from": {"body": a, "at": p.tolist()}, "to": {"body": b, "at": q.tolist()}}
        joints[f"rope{k}"] = {"type": "rod", **ends, "length": length, "tension_only": True,
                              "restitution": float(rng.choice([0.0, 0.5, 1.0]))}  # fmt: skip
    return {**found, "joints": joints, "stops": stops}
