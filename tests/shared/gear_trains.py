"""Gears, belts and screws as dicts: a pair of wheels on the ground, a planetary train, and what they are made of."""

from __future__ import annotations

import math
from typing import Any

STATE = {"type": "state"}


def wheel(about: float, at: Any = (0.0, 0.0, 0.0), mass: float = 1.0, across: float | None = None) -> dict[str, Any]:
    """A wheel about z whose centre is its point c; about, across: its moments of inertia."""
    other = 0.6 * about if across is None else across
    return {"mass": mass, "center": list(at), "inertia": [other, other, about], "points": {"c": list(at)}}


def pin(start: str, to: str, axis: Any = (0.0, 0.0, 1.0), **more: Any) -> dict[str, Any]:
    """A pin."""
    return {"type": "pin", "from": start, "to": to, "axis": list(axis), **more}


def pair(**mesh: Any) -> dict[str, Any]:
    """A pinion of 0.02 kg m^2 that 5 N m turn, and a wheel of 0.2 kg m^2 on its axis 0.4 m away."""
    return {
        "ground": {"points": {"A": [0, 0, 0], "B": [0.4, 0, 0]}},
        "bodies": {"pinion": wheel(0.02), "wheel": wheel(0.2, (0.4, 0.0, 0.0), 2.0)},
        "joints": {
            "p": pin("ground.A", "pinion.c", initial={"angle": 0.5, "rate": 10}),
            "w": pin("ground.B", "wheel.c"),
        },
        "couplings": {"mesh": {"type": "gear", "of": ["p", "w"]} | mesh},
        "forces": {"motor": {"type": "torque", "joint": "p", "value": 5}},
        "analysis": STATE,
    }


def planetary(planets: int = 1, sun_on: str = "ground", alpha: Any = "20 deg") -> dict[str, Any]:
    """Sun of 20, planets of 20, ring of 60 teeth fixed to the ground; 1 N m turn the sun, 3 N m hold the arm back."""
    spots = [(0.1 * math.cos(i * math.tau / planets), 0.1 * math.sin(i * math.tau / planets)) for i in range(planets)]
    arm = wheel(0.06)
    arm["points"] |= {f"p{i}": [x, y, 0.0] for i, (x, y) in enumerate(spots)}
    of_sun = "ground.A" if sun_on == "ground" else "arm.c"
    teeth = {"type": "gear", "pressure_angle": alpha}
    return {
        "ground": {"points": {"A": [0, 0, 0]}},
        "bodies": {"sun": wheel(0.02), "arm": arm}
        | {f"planet{i}": wheel(0.004, (x, y, 0.0), 0.5) for i, (x, y) in enumerate(spots)},
        "joints": {"s": pin(of_sun, "sun.c"), "a": pin("ground.A", "arm.c", initial={"rate": 2})}
        | {f"p{i}": pin(f"arm.p{i}", f"planet{i}.c") for i in range(planets)},
        "couplings": {
            name: own
            for i in range(planets)
            for name, own in (
                (f"sp{i}", {**teeth, "of": ["s", f"p{i}"], "teeth": [20, 20]}),
                (f"pr{i}", {**teeth, "of": [f"p{i}", "a"], "teeth": [20, 60], "internal": True}),
            )
        },
        "forces": {
            "motor": {"type": "couple", "on": "sun.c", "vector": [0, 0, 1]},
            "brake": {"type": "torque", "joint": "a", "value": -3},
        },
        "analysis": STATE,
    }
