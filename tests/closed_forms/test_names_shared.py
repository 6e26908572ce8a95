"""Loads with one name: what stands on the ground is all told."""

from __future__ import annotations

import numpy as np

from tests.shared.scenes import near, solved

SCENE = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  b: {mass: 1, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0], c: [1, 0, 0]}}
joints: {A: {type: pin, from: ground.O, to: b.o, axis: [0, 0, 1]}}
drives: {m: {joint: A, angle: t**2}}
forces: {m: {type: spring, from: ground.O, to: b.c, stiffness: 10, length: 0.5}}
analysis: {duration: 1, samples: 3}
"""


def test_a_drive_and_a_force() -> None:
    base = solved(SCENE).foundation
    assert set(base["elements"]) == {"m", "drives.m"}
    parts = [*base["supports"].values(), *base["elements"].values()]
    near(sum(part["force"] for part in parts), base["force"], 10.0, 1e-14)
    moment = sum(p["moment"] + np.cross(p.get("point", np.zeros(3)), p["force"]) for p in parts)
    near(moment, base["moment"], 10.0, 1e-14)
