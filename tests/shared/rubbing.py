"""Random scenes with one to three loads of friction by what their joints carry."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.oracle.read import Placed
from tests.oracle.scenes import random_scene

KINDS = ("pin", "slide", "pin", "slide", "ball", "cylinder", "universal")


def rubbing_scene(seed: int, loops: int = 0, drives: int = 0) -> tuple[dict[str, Any], dict[str, Placed]]:
    """A tree, or one with loops, in which pins and slides rub by a coefficient up to 0.3; and its state."""
    rng = np.random.default_rng(seed)
    while True:
        scene, state = random_scene(
            rng, int(rng.integers(2, 6)), kinds=KINDS, roots=0.2, loops=loops, drives=drives,
            loads=("force", "couple", "spring", "damper"),
        )  # fmt: skip
        names = [name for name, joint in scene["joints"].items() if joint["type"] in ("pin", "slide")]
        if names:
            break
    rng.shuffle(names)
    rubs = {f"rub_{name}": rub(rng, scene["joints"][name]["type"], name) for name in names[: int(rng.integers(1, 4))]}
    return {**scene, "forces": {**scene.get("forces", {}), **rubs}}, state


def rub(rng: np.random.Generator, kind: str, joint: str) -> dict[str, Any]:
    """Friction in a pin or a slide, every other one of which tilts."""
    coefficient, speed = float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.1, 1.0))
    spec = {"type": "friction", "joint": joint, "coefficient": coefficient, "speed": speed}
    if kind == "pin":
        return spec | {"radius": float(rng.uniform(0.05, 0.2))}
    return spec | ({"length": float(rng.uniform(0.3, 2.0))} if rng.random() < 0.5 else {})


def rubs_of(scene: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The loads of friction by what joints carry, by name."""
    return {name: spec for name, spec in scene["forces"].items() if "coefficient" in spec and "speed" in spec}
