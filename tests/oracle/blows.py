"""Scenes that are struck: random impulses on points and couples, and drives whose rates jump."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

Scene = dict[str, Any]


def with_blows(scene: Mapping[str, Any], seed: int, time: float = 0.0, count: int = 3, couples: bool = True) -> Scene:
    """The scene with some impulses at an instant: forces, and (couples) every third a couple, in either frame."""
    rng = np.random.default_rng(90_000 + seed)
    names = list(scene["bodies"])
    bodies = {name: {**body, "points": dict(body.get("points", {}))} for name, body in scene["bodies"].items()}
    impulses: dict[str, Any] = {}
    for k in range(count):
        name, vector = names[rng.integers(len(names))], (3 * rng.standard_normal(3)).tolist()
        more = {"time": time, "frame": ("world", "body")[int(rng.integers(2))]}
        bodies[name]["points"][f"hit{k}"] = rng.uniform(-0.7, 0.7, 3).tolist()
        if couples and k % 3 == 2:
            impulses[f"twist{k}"] = {"body": name, "couple": vector, **more}
        else:
            impulses[f"blow{k}"] = {"on": f"{name}.hit{k}", "vector": vector, **more}
    return {**scene, "bodies": bodies, "impulses": impulses}
