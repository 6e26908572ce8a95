"""Scenes of manual/theory.md, "Closed cases", as the oracle's dicts, placed in closed form: bars, 12, golden case A."""

from __future__ import annotations

import numpy as np

from tests.oracle.read import start_state
from tests.oracle.turns import Array, about

G = 9.81
X, Y, Z = np.eye(3)


def bar(
    length: float, mass: float, R: Array, spin: Array | None = None, at: Array | None = None, v: Array | None = None
) -> dict:
    """A uniform rod along its body's x from its origin."""
    return {
        "shapes": [{"type": "rod", "from": [0, 0, 0], "to": [length, 0, 0], "mass": mass}],
        "points": {"root": [0, 0, 0], "end": [length, 0, 0]},
        "orientation": {"matrix": R.tolist()},
        "position": list(np.zeros(3) if at is None else at),
        "velocity": list(np.zeros(3) if v is None else v),
        "angular_velocity": list(np.zeros(3) if spin is None else spin),
    }


def scene(bodies: dict, joints: dict, gravity: Array | None = None, **more: object) -> dict:
    """Bodies and joints, with a point O of the ground in the origin."""
    return {
        "gravity": list(np.zeros(3) if gravity is None else gravity),
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": bodies,
        "joints": joints,
        **more,
    }


def slider_crank(phi: float, omega: float, **more: object) -> dict:
    """Case 12 at a crank angle and its rate: crank and rod of 0.1 and 0.3 m, uniform, and a slider of 1.5 kg."""
    r, length = 0.1, 0.3
    psi = -np.arcsin(r / length * np.sin(phi))
    psi_rate = -r / length * omega * np.cos(phi) / np.cos(psi)
    pin = r * np.array([np.cos(phi), np.sin(phi), 0])
    v = omega * np.cross(Z, pin)
    wrist = pin + length * np.array([np.cos(psi), np.sin(psi), 0])
    slider = {
        "mass": 1.5,
        "center": [0, 0, 0],
        "inertia": [0.01, 0.01, 0.01],
        "points": {"pin": [0, 0, 0]},
        "position": [wrist[0], 0, 0],
        "velocity": list(v + psi_rate * np.cross(Z, wrist - pin)),
    }
    crank, rod = bar(r, 1.0, about(Z, phi), omega * Z), bar(length, 0.8, about(Z, psi), psi_rate * Z, pin, v)
    return scene(
        {"crank": crank, "rod": rod, "slider": slider},
        {
            "base": {"type": "pin", "from": "ground.O", "to": "crank.root", "axis": [0, 0, 1]},
            "crankpin": {"type": "pin", "from": "crank.end", "to": "rod.root", "axis": [0, 0, 1]},
            "wrist": {"type": "pin", "from": "rod.end", "to": "slider.pin", "axis": [0, 0, 1]},
            "guide": {"type": "slide", "from": "ground.O", "to": "slider.pin", "axis": [1, 0, 0]},
        },
        **more,
    )


GOLDEN_A = {
    "first": {
        "mass": 2.0,
        "center": [0.5, 0.1, -0.05],
        "inertia": [0.2, 0.5, 0.6],
        "points": {"root": [0, 0, 0], "end": [1, 0.2, 0.1]},
        "orientation": {"rodrigues": [0.1, 0.2, 0.3]},
        "position": [0, 0, 0],
        "angular_velocity": [1, -2, 0.5],
    },
    "second": {
        "mass": 1.5,
        "center": [0.4, -0.1, 0.2],
        "inertia": [0.1, 0.3, 0.35],
        "points": {"root": [0, 0, 0]},
        "orientation": {"rodrigues": [-0.2, 0.4, 0.1]},
        "angular_velocity": [-0.5, 1.5, 2],
    },
}


def golden_a() -> dict:
    """Golden case A: two bodies on balls, in the state printed there."""
    first = start_state({"bodies": GOLDEN_A})["first"]
    end = np.array(GOLDEN_A["first"]["points"]["end"])
    second = {**GOLDEN_A["second"], "position": list(first.point(end)), "velocity": list(first.speed(end))}
    return scene(
        {**GOLDEN_A, "second": second},
        {
            "base": {"type": "ball", "from": "ground.O", "to": "first.root"},
            "elbow": {"type": "ball", "from": "first.end", "to": "second.root"},
        },
        -G * Z,
    )
