"""Flyball governors as the oracle's dicts: an arm on a spindle, and Porter's."""

from __future__ import annotations

import math
from typing import Any

G = 9.81


def spindle(kind: str, W: float, theta: float) -> dict[str, Any]:
    """A driven spindle, from whose axis a point hangs on an arm of length 1 at an angle."""
    joint = {"type": kind} | ({"axis": [0, 1, 0]} if kind == "pin" else {})
    attitude = {"axis": [0, 1, 0], "angle": -theta}
    return {
        "gravity": [0, 0, -G],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "shaft": {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"a": [0, 0, 0]}},
            "ball": {"shapes": [{"type": "point", "at": [0, 0, -1], "mass": 2}], "points": {"a": [0, 0, 0]},
                     "orientation": attitude, "angular_velocity": [0, 0, W]},
        },
        "joints": {"spin": {"type": "pin", "axis": [0, 0, 1], "from": "ground.O", "to": "shaft.a"},
                   "arm": {**joint, "from": "shaft.a", "to": "ball.a"}},
        "drives": {"motor": {"joint": "spin", "angle": f"{W}*t"}},
    }  # fmt: skip


def porter(w: float) -> tuple[dict[str, Any], float]:
    """Porter's governor at its pose, cos = (m + M) g / (m l w^2), and the square of its frequency."""
    l, m, M = 0.3, 1.0, 5.0
    c = (m + M) * G / (m * l * w * w)
    s = math.sqrt(1.0 - c * c)
    arm = {"mass": m, "inertia": [0, 0, 0]}
    low = [0, 0, -2 * l * c]
    pin = {"type": "pin", "axis": [0, 1, 0], "from": "spindle.head"}
    balls = {"left": [-l * s, 0, -l * c], "right": [l * s, 0, -l * c]}
    scene = {
        "gravity": [0, 0, -G],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "spindle": {"mass": 2, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"head": [0, 0, 0]}},
            "sleeve": {"mass": M, "center": low, "inertia": [1, 1, 1], "points": {"eye": low}},
            **{name: {**arm, "center": at, "points": {"head": [0, 0, 0], "ball": at}} for name, at in balls.items()},
        },
        "joints": {
            "bearing": {"type": "pin", "axis": [0, 0, 1], "from": "ground.O", "to": "spindle.head"},
            "guide": {"type": "slide", "axis": [0, 0, 1], "from": "spindle.head", "to": "sleeve.eye"},
            **{f"{name}_arm": {**pin, "to": f"{name}.head"} for name in balls},
            **{f"{name}_link": {"type": "rod", "from": f"{name}.ball", "to": "sleeve.eye"} for name in balls},
        },
        "drives": {"motor": {"joint": "bearing", "angle": f"{w}*t"}},
    }  # fmt: skip
    inertia = 2.0 * m * l * l + 4.0 * M * l * l * s * s
    stiffness = 2.0 * (m + M) * G * l * c - 2.0 * m * l * l * w * w * (2.0 * c * c - 1.0)
    return scene, stiffness / inertia
