"""Bodies on more supports than they need, as the oracle's dicts: a door on two balls, a table on four legs."""

from __future__ import annotations

from typing import Any

from tests.oracle.published import held


def door() -> dict[str, Any]:
    """5 kg that turn on two balls, one above the other: what the hinges carry along their line is open."""
    return held(
        {"top": [-0.4, 0, 0.9], "bottom": [-0.4, 0, -0.7]},
        {"type": "ball"},
        {"position": [0.4, 0, 0], "velocity": [0, 0.4 * 2.3, 0], "angular_velocity": [0, 0, 2.3]},
    )


def table(legs: dict[str, tuple[float, float]]) -> dict[str, Any]:
    """A top of 5 kg on legs at these x and y, on each of which it may slide, with a cup of 20 N on it."""
    points = {name: [x, y, 0.0] for name, (x, y) in legs.items()}
    scene = held(points, {"type": "plane", "normal": [0, 0, 1]}, {"center": [0.1, 0.05, 0.7]})
    scene["bodies"]["body"]["points"]["cup"] = [0.3, -0.2, 0.75]
    return {**scene, "forces": {"cup": {"type": "force", "on": "body.cup", "vector": [0, 0, -20.0]}}}


SQUARE = {"A": (-0.6, -0.4), "B": (0.6, -0.4), "C": (0.6, 0.4), "D": (-0.6, 0.4)}
