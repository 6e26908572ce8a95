"""Scenes that are struck: random impulses on points and couples, and drives whose rates jump."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.oracle.values import Kinked

Scene = dict[str, Any]


def with_blows(
    scene: Mapping[str, Any], seed: int, time: float = 0.0, count: int = 3, couples: bool = True, thin: bool = False
) -> Scene:
    """The scene with some more impulses at an instant: forces, and (couples) every third a couple, in either frame.

    thin: on the axes of bodies that are one rod.
    """
    rng = np.random.default_rng(90_000 + seed)
    names = list(scene["bodies"])
    bodies = {name: {**body, "points": dict(body.get("points", {}))} for name, body in scene["bodies"].items()}
    impulses: dict[str, Any] = dict(scene.get("impulses", {}))
    for k in range(len(impulses), len(impulses) + count):
        name, vector = names[rng.integers(len(names))], (3 * rng.standard_normal(3)).tolist()
        more = {"time": time, "frame": ("world", "body")[int(rng.integers(2))]}
        place = rng.uniform(-0.7, 0.7, 3)
        if thin:
            rod = bodies[name]["shapes"][0]
            place = np.array(rod["from"]) + place[0] * (np.array(rod["to"]) - np.array(rod["from"]))
        bodies[name]["points"][f"hit{k}"] = place.tolist()
        if couples and k % 3 == 2:
            impulses[f"twist{k}"] = {"body": name, "couple": vector, **more}
        else:
            impulses[f"blow{k}"] = {"on": f"{name}.hit{k}", "vector": vector, **more}
    return {**scene, "bodies": bodies, "impulses": impulses}


def with_rate_jumps(scene: Mapping[str, Any], seed: int, time: float) -> Scene:
    """The scene with the rates of all its drives jumping at an instant."""
    rng = np.random.default_rng(95_000 + seed)
    drives = {}
    for name, drive in scene["drives"].items():
        quantity = next(q for q in ("angle", "travel", "length") if q in drive)
        value = Kinked(drive[quantity][0], time, float(rng.uniform(0.5, 2) * rng.choice([-1, 1])))
        drives[name] = {**drive, quantity: value.drive()}
    return {**scene, "drives": drives}
