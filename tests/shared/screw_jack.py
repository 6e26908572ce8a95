"""A screw jack, its joints written in any way: what tests of threads share."""

from __future__ import annotations

import math
from typing import Any

LEAD, R, W = 0.01, 0.014, 100 * 9.81
SLOPE = LEAD / (math.tau * R)


def jack(
    mu: float, axes: tuple[float, float] = (1, 1), sides: tuple[int, int] = (1, 1), lead: float = LEAD,
    inertia: float = 0.05, rate: float | None = None, **friction: Any,
) -> dict[str, Any]:  # fmt: skip
    """A nut of 100 kg on a spindle; axes: the senses of its joints, sides: -1 where `to` is the ground."""
    ends = [("ground.A", "spindle.o"), ("ground.B", "nut.o")]
    ends = [pair[::side] for pair, side in zip(ends, sides, strict=True)]
    kinds = zip(("spin", "guide"), ("pin", "slide"), ends, axes, strict=True)
    scene: dict[str, Any] = {
        "gravity": [0, 0, -9.81],
        "ground": {"points": {"A": [0, 0, 0], "B": [0.2, 0, 0]}},
        "bodies": {
            "spindle": {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, inertia], "points": {"o": [0, 0, 0]}},
            "nut": {"mass": 100, "center": [0.2, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0.2, 0, 0]}},
        },
        "joints": {name: {"type": kind, "from": a, "to": b, "axis": [0, 0, s]} for name, kind, (a, b), s in kinds},
        "couplings": {"thread": {"type": "screw", "of": ["spin", "guide"], "lead": lead}},
        "analysis": {"type": "state"},
    }
    scene["couplings"]["thread"]["friction"] = {"coefficient": mu, "radius": R, "speed": 0.01, **friction}
    if rate is not None:
        scene["drives"] = {"motor": {"joint": "spin", "rate": rate}}
    return scene
